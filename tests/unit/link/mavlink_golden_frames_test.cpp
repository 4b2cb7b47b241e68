// SPDX-License-Identifier: BSD-3-Clause
// Frames made with the official C library, and one signed by node-mavlink (docs/evidence/mavlink.md): byte-equal both
// ways.
#include <bit>
#include <cstring>
#include <gtest/gtest.h>

#include "firmware/link/mavlink/text.hpp"
#include "tests/unit/link/mavlink_tools.hpp"

namespace jink::link::mavlink {
namespace {

using namespace test;

/// `message` encodes to `hex`, and `hex` decodes to a message of the same bytes.
template <Message M>
void expect_golden(const M& message, Header header, std::string_view hex)
{
    EXPECT_EQ(to_hex(frame_of(message, header)), hex);

    Parser parser;
    const std::vector<Received> frames = parse(parser, from_hex(hex));
    ASSERT_EQ(frames.size(), 1U);
    M decoded;
    ASSERT_TRUE(decode(frames[0].frame(), decoded));
    EXPECT_EQ(payload_of(decoded), payload_of(message));
    EXPECT_EQ(frames[0].header.system_id, header.system_id);
    EXPECT_EQ(frames[0].header.component_id, header.component_id);
    EXPECT_EQ(frames[0].header.sequence, header.sequence);
    EXPECT_EQ(frames[0].version, 2);
    EXPECT_EQ(parser.diagnostics().noise_bytes, 0U);
}

constexpr Header kOurHeader{1, 196, 0};

TEST(MavlinkGoldenFrames, Heartbeat)
{
    Heartbeat m;
    m.type = 18;
    m.autopilot = 8;
    m.system_status = 4;
    expect_golden(m, kOurHeader, "fd0900000001c4000000000000001208000403f49a");
}

TEST(MavlinkGoldenFrames, ObstacleDistance)
{
    ObstacleDistance m;
    m.time_usec = 123456789;
    m.distances.fill(65535);
    for (std::uint16_t i = 0; i < 7; ++i) {
        m.distances[i] = static_cast<std::uint16_t>(500 + i);
    }
    m.increment = 5;
    m.min_distance = 20;
    m.max_distance = 4000;
    m.increment_f = 5.0F;
    m.angle_offset = -15.0F;
    m.frame = 12;
    expect_golden(m, kOurHeader,
                  "fda700000001c44a010015cd5b0700000000f401f501f601f701f801f901fa01ffffffffffffffffffffffffffffffffffff"
                  "ffffffffffffffffffffffffffffffffffffffffffffffffffffffffffffffffffffffffffffffffffffffffffffffffffff"
                  "ffffffffffffffffffffffffffffffffffffffffffffffffffffffffffffffffffffffffffffffffffffffffffffffffffff"
                  "ffffffffffffffffffffffff1400a00f00050000a040000070c10c1fa7");
}

TEST(MavlinkGoldenFrames, ObstacleDistance3d)
{
    ObstacleDistance3d m;
    m.time_boot_ms = 1000;
    m.x = 1.5F;
    m.y = -2.25F;
    m.z = 0.5F;
    m.min_distance = 0.2F;
    m.max_distance = 40.0F;
    m.obstacle_id = 7;
    m.frame = 12;
    expect_golden(m, kOurHeader, "fd1c00000001c41d2b00e80300000000c03f000010c00000003fcdcc4c3e000020420700000c3f04");
}

// The next three were made with node-mavlink.
constexpr std::uint8_t kOtherSystem = 9;

TEST(MavlinkGoldenFrames, GlobalPositionInt)
{
    GlobalPositionInt m{123456, 467000123, 82000456, 570789, 1789, 123, -456, 78, 27001};
    expect_golden(m, {kOtherSystem, 1, 5},
                  "fd1c000005090121000040e201003bdbd51b483ae304a5b50800fd0600007b0038fe4e00796961dd");
}

TEST(MavlinkGoldenFrames, UtmGlobalPosition)
{
    UtmGlobalPosition m;
    m.time = 1700000000123456U;
    m.lat = 467000123;
    m.lon = -82000456;
    m.alt = 618789;
    m.relative_alt = 1789;
    m.next_lat = 467000999;
    m.next_lon = 82000999;
    m.next_alt = 620000;
    m.vx = -321;
    m.vy = 654;
    m.vz = -87;
    m.h_acc = 1500;
    m.v_acc = 2500;
    m.vel_acc = 40;
    m.update_rate = 100;
    for (std::uint8_t i = 0; i < 18; ++i) {
        m.uas_id[i] = static_cast<std::uint8_t>(i + 1);
    }
    m.flight_state = 3;
    m.flags = 127;
    expect_golden(
        m, {kOtherSystem, 1, 6},
        "fd46000006090154010040222018240a06003bdbd51bb8c51cfb25710900fd060000a7ded51b673ce304e0750900bffe8e02a9ff"
        "dc05c409280064000102030405060708090a0b0c0d0e0f101112037fbff6");
}

TEST(MavlinkGoldenFrames, GpsRawInt)
{
    GpsRawInt m;
    m.time_usec = 987654321;
    m.lat = 467000123;
    m.lon = 82000456;
    m.alt = 570789;
    m.eph = 80;
    m.epv = 120;
    m.vel = 510;
    m.cog = 9000;
    m.fix_type = 4;
    m.satellites_visible = 17;
    m.alt_ellipsoid = 618789;
    m.h_acc = 500;
    m.v_acc = 800;
    m.vel_acc = 100;
    expect_golden(m, {kOtherSystem, 1, 7},
                  "fd2b0000070901180000b168de3a000000003bdbd51b483ae304a5b5080050007800fe0128230411257109"
                  "00f40100002003000064e221");
}

TEST(MavlinkGoldenFrames, SetPositionTargetLocalNed)
{
    SetPositionTargetLocalNed m;
    m.time_boot_ms = 1000;
    m.vx = 1.0F;
    m.vy = -0.5F;
    m.vz = 0.25F;
    m.type_mask = 0x0DC7;
    m.target_system = 1;
    m.target_component = 1;
    m.coordinate_frame = 1;
    expect_golden(
        m, kOurHeader,
        "fd3500000001c4540000e80300000000000000000000000000000000803f000000bf0000803e0000000000000000000000000000"
        "000000000000c70d010101b1a2");
}

TEST(MavlinkGoldenFrames, Collision)
{
    Collision m;
    m.src = 1;
    m.id = 42;
    m.action = 3;
    m.threat_level = 2;
    m.time_to_minimum_delta = 2.5F;
    m.altitude_minimum_delta = 1.0F;
    m.horizontal_minimum_delta = 3.0F;
    expect_golden(m, kOurHeader, "fd1300000001c4f700002a000000000020400000803f0000404001030217cb");
}

TEST(MavlinkGoldenFrames, CommandAck)
{
    CommandAck m;
    m.command = 511;
    m.target_system = 255;
    m.target_component = 190;
    expect_golden(m, kOurHeader, "fd0a00000001c44d0000ff01000000000000ffbefda4");
}

TEST(MavlinkGoldenFrames, ParamValue)
{
    ParamValue m;
    ASSERT_TRUE(set_text(m.param_id, "CA_RADIUS"));
    m.param_value = 0.75F;
    m.param_type = 9;
    m.param_count = 3;
    m.param_index = 1;
    expect_golden(m, kOurHeader, "fd1900000001c41600000000403f0300010043415f52414449555300000000000000098b27");
}

TEST(MavlinkGoldenFrames, Timesync)
{
    Timesync m;
    m.ts1 = 123456789000;
    m.target_system = 1;
    m.target_component = 1;
    expect_golden(m, kOurHeader, "fd1200000001c46f00000000000000000000081a99be1c00000001016b96");
}

TEST(MavlinkGoldenFrames, LocalPositionNed)
{
    LocalPositionNed m;
    m.time_boot_ms = 1000;
    m.x = 1.0F;
    m.y = 2.0F;
    m.z = -3.0F;
    m.vx = 0.5F;
    m.vz = -0.25F;
    expect_golden(m, {1, 1, 0}, "fd1c0000000101200000e80300000000803f00000040000040c00000003f00000000000080be1792");
}

TEST(MavlinkGoldenFrames, Statustext)
{
    Statustext m;
    m.severity = 4;
    ASSERT_TRUE(set_text(m.text, "avoidance active"));
    expect_golden(m, kOurHeader, "fd1100000001c4fd00000461766f6964616e6365206163746976658bd7");
}

TEST(MavlinkGoldenFrames, AdsbVehicle)
{
    AdsbVehicle m;
    m.ICAO_address = 0xABCDEF;
    m.lat = 473977420;
    m.lon = 85455940;
    m.altitude = 1200000;
    m.heading = 9000;
    m.hor_velocity = 1500;
    m.ver_velocity = -200;
    m.flags = 0x7F;
    m.squawk = 1200;
    ASSERT_TRUE(set_text(m.callsign, "N123AB"));
    m.emitter_type = 14;
    m.tslc = 1;
    expect_golden(
        m, {1, 156, 0},
        "fd26000000019cf60000efcdab004c52401c44f41705804f12002823dc0538ff7f00b004004e31323341420000000e01bee1");
}

// Key = SHA-256("secret"), link 3, time 2026-01-01T00:00:00Z; made by node-mavlink, accepted by the C library.
TEST(MavlinkGoldenFrames, SignedHeartbeat)
{
    constexpr std::string_view kHex = "fd0901000701bf0000000000000012080004030a8c0300e03cd6921f10e83e17f1c0";
    Signing::Key key;
    const Bytes secret = from_hex("2bb80d537b1da3e38bd30361aa855686bde0eacd7162fef6a25fe97bf527a25b");
    std::copy(secret.begin(), secret.end(), key.begin());
    constexpr std::uint64_t kNewYear2026 = 34'715'520'000'000;  // 4018 days of 24 h since 2015, in 10 us
    static_assert(kNewYear2026 == 4018ULL * 24 * 3600 * 100'000);

    Heartbeat m;
    m.type = 18;
    m.autopilot = 8;
    m.system_status = 4;
    Signing sender(key, 3, kNewYear2026 - 1);
    Bytes frame(kMaxFrame);
    frame.resize(encode_signed(m, {1, 191, 7}, sender, frame));
    EXPECT_EQ(to_hex(frame), kHex);

    Signing receiver(key, 0, kNewYear2026);
    Parser parser(&receiver);
    const std::vector<Received> frames = parse(parser, from_hex(kHex));
    ASSERT_EQ(frames.size(), 1U);
    EXPECT_TRUE(frames[0].is_signed);
    Heartbeat decoded;
    ASSERT_TRUE(decode(frames[0].frame(), decoded));
    EXPECT_EQ(payload_of(decoded), payload_of(m));
}

}  // namespace
}  // namespace jink::link::mavlink
