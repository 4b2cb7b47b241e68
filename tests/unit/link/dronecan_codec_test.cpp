// SPDX-License-Identifier: BSD-3-Clause
// Golden frames (made with dronecan's libcanard), data types against their published properties, and each way to fail.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "firmware/link/dronecan/checksum.hpp"
#include "tests/unit/link/dronecan_tools.hpp"

namespace jink::link::dronecan {
namespace {

using namespace test;

NodeStatus golden_status()
{
    NodeStatus status;
    status.uptime = 1000;
    status.vendor_status = 0x1234;
    return status;
}

Proximity golden_proximity(float distance)
{
    Proximity proximity;
    proximity.sensor = 7;
    proximity.reading = Proximity::Reading::good;
    proximity.yaw = 45.0F;
    proximity.pitch = -10.0F;
    proximity.distance = distance;
    return proximity;
}

TEST(DronecanGolden, NodeStatus)
{
    const std::vector<Frame> frames = frames_of(golden_status(), 42);
    ASSERT_EQ(frames.size(), 1U);
    EXPECT_EQ(text_of(frames[0]), "1001552A#E8030000003412C0");

    Receiver receiver(std::span(&NodeStatus::kType, 1));
    const Transfer* const transfer = receiver.accept(frame_of("1001552A#E8030000003412C0"), {});
    ASSERT_NE(transfer, nullptr);
    EXPECT_EQ(transfer->source, 42);
    EXPECT_EQ(transfer->priority, 16);
    NodeStatus status;
    ASSERT_EQ(decode(transfer->payload, status), CodecStatus::ok);
    EXPECT_EQ(print(status), print(golden_status()));
}

TEST(DronecanGolden, ProximityOverTwoFrames)
{
    struct Golden {
        float distance;
        std::uint8_t transfer;
        const char* first;
        const char* second;
    };
    for (const Golden& golden : {Golden{12.5F, 5, "1855962A#01CF0740A0510085", "1855962A#C9404A65"},
                                 Golden{0.3F, 6, "1855962A#9C3D0740A0510086", "1855962A#C9CD3466"}}) {
        const std::vector<Frame> frames =
            frames_of(golden_proximity(golden.distance), 42, golden.transfer, Priority::low);
        ASSERT_EQ(frames.size(), 2U);
        EXPECT_EQ(text_of(frames[0]), golden.first);
        EXPECT_EQ(text_of(frames[1]), golden.second);

        Receiver receiver(std::span(&Proximity::kType, 1));
        EXPECT_EQ(receiver.accept(frame_of(golden.first), {}), nullptr);
        const Transfer* const transfer = receiver.accept(frame_of(golden.second), {});
        ASSERT_NE(transfer, nullptr);
        EXPECT_EQ(transfer->transfer, golden.transfer);
        Proximity proximity;
        ASSERT_EQ(decode(transfer->payload, proximity), CodecStatus::ok);
        EXPECT_EQ(proximity.sensor, 7);
        EXPECT_EQ(proximity.reading, Proximity::Reading::good);
        EXPECT_EQ(proximity.yaw, 45.0F);
        EXPECT_EQ(proximity.pitch, -10.0F);
        EXPECT_NEAR(proximity.distance, golden.distance, golden.distance / 2048.0F);
    }
}

TEST(DronecanGolden, CyphalIsNotTakenForDronecan)
{
    // Heartbeat 1.0 of node 42, whose identifier would be a message of type 32085 here.
    constexpr TypeInfo kSame{TransferKind::message, 0x7D55, 0, 7};
    Receiver receiver(std::span(&kSame, 1));
    EXPECT_EQ(receiver.accept(frame_of("107D552A#E8030000000012E0"), {}), nullptr);
    EXPECT_EQ(receiver.diagnostics().wrong_toggle, 1U);
}

TEST(DronecanTypes, SeedsFollowFromThePublishedSignatures)
{
    struct Published {
        const TypeInfo& type;
        std::uint64_t signature;
    };
    const Published table[] = {
        {NodeStatus::kType, 0x0F0868D0C1A7C6F1},
        {GetNodeInfoRequest::kType, 0xEE468A8121C46A9E},
        {GetNodeInfoResponse::kType, 0xEE468A8121C46A9E},
        {Allocation::kType, 0x0B2A812620A11D40},
        {GlobalTimeSync::kType, 0x20271116A793C2DB},
        {GetSetRequest::kType, 0xA7B622F939D1A4D5},
        {GetSetResponse::kType, 0xA7B622F939D1A4D5},
        {ExecuteOpcodeRequest::kType, 0x3B131AC5EB69D2CD},
        {ExecuteOpcodeResponse::kType, 0x3B131AC5EB69D2CD},
        {LogMessage::kType, 0xD654A48E0C049D75},
        {RangeMeasurement::kType, 0x68FFFE70FC771952},
        {Proximity::kType, 0x99DD3985FB3222CE},
        {TrafficReport::kType, 0x68E45DB60B6981F8},
        {Fix2::kType, 0xCA41E7000F37435F},
        {AhrsSolution::kType, 0x72A63A3C6F41FA9B},
        {TunnelTargetted::kType, 0xB138E7EA72A2A2E9},
        {TunnelBroadcast::kType, 0x5AA2D4D9CF4B1E85},
    };
    for (const Published& published : table) {
        Checksum checksum;
        for (unsigned i = 0; i < 8; ++i) {
            checksum.add(static_cast<std::byte>(published.signature >> (8 * i)));
        }
        EXPECT_EQ(checksum.value(), published.type.crc_seed) << published.type.id;
    }
}

TEST(DronecanChecksum, IsThePublishedOne)
{
    Checksum checksum;
    for (const char c : std::string_view("123456789")) {
        checksum.add(static_cast<std::byte>(c));
    }
    EXPECT_EQ(checksum.value(), 0x29B1);  // CRC-16/CCITT-FALSE's check value
}

TEST(DronecanTypes, TheLongestPayloadOfEachIsThePublishedOne)
{
    // Random messages fill every array often; the longest of them is as long as can be.
    Random random(1);
    for_each_type([&]<class M>() {
        std::size_t longest = 0;
        const int tries = M::kType.max_length > 300 ? 100'000 : 3000;  // many arrays have to be full at once
        for (int i = 0; i < tries; ++i) {
            longest = std::max(longest, payload_of(random_message<M>(random)).size());
        }
        // Without tail array optimisation, as published, a length may take a byte more; Fix2's last field is not ours.
        const std::size_t published = M::kType.max_length;
        if (M::kType.id == Fix2::kType.id) {
            EXPECT_EQ(longest, 48U + 36U * 2U + 2U);
        } else {
            EXPECT_GE(longest + 1, published) << M::kType.id;
            EXPECT_LE(longest, published) << M::kType.id;
        }
        EXPECT_LE(published, kMaxPayload);
    });
}

TEST(DronecanCodec, NoRoom)
{
    Bytes bytes(6);
    std::size_t size = 99;
    EXPECT_EQ(encode(golden_status(), bytes, size), CodecStatus::no_room);
    EXPECT_EQ(size, 0U);
}

TEST(DronecanCodec, NumbersThatDoNotFitTheirFieldAreRefused)
{
    Bytes bytes(kMaxPayload);
    std::size_t size = 0;
    GetSetRequest get;
    get.index = 8191;
    EXPECT_EQ(encode(get, bytes, size), CodecStatus::ok);
    get.index = 8192;
    EXPECT_EQ(encode(get, bytes, size), CodecStatus::out_of_range);

    ExecuteOpcodeRequest opcode;
    for (const std::int64_t fits : {std::int64_t{0}, (std::int64_t{1} << 47) - 1, -(std::int64_t{1} << 47)}) {
        opcode.argument = fits;
        EXPECT_EQ(encode(opcode, bytes, size), CodecStatus::ok);
    }
    for (const std::int64_t too_large : {std::int64_t{1} << 47, -(std::int64_t{1} << 47) - 1}) {
        opcode.argument = too_large;
        EXPECT_EQ(encode(opcode, bytes, size), CodecStatus::out_of_range);
    }

    get.index = 0;
    get.value.tag = static_cast<ParamValue::Tag>(5);
    EXPECT_EQ(encode(get, bytes, size), CodecStatus::out_of_range);
}

TEST(DronecanCodec, FiniteNumbersThatAHalfCannotHoldAreRefusedInfinityIsNot)
{
    Bytes bytes(kMaxPayload);
    std::size_t size = 0;
    EXPECT_EQ(encode(golden_proximity(kMaxFloat16), bytes, size), CodecStatus::ok);
    EXPECT_EQ(encode(golden_proximity(65519.0F), bytes, size), CodecStatus::ok);  // rounds down
    EXPECT_EQ(encode(golden_proximity(65520.0F), bytes, size), CodecStatus::out_of_range);
    EXPECT_EQ(encode(golden_proximity(-1e30F), bytes, size), CodecStatus::out_of_range);
    EXPECT_EQ(encode(golden_proximity(std::numeric_limits<float>::infinity()), bytes, size), CodecStatus::ok);
    EXPECT_EQ(encode(golden_proximity(std::nanf("")), bytes, size), CodecStatus::ok);
}

TEST(DronecanCodec, TooShortAndTooLong)
{
    NodeStatus status;
    status.uptime = 77;
    const Bytes bytes = payload_of(golden_status());
    EXPECT_EQ(decode(std::span(bytes).first(6), status), CodecStatus::too_short);
    EXPECT_EQ(status.uptime, 77U);  // untouched
    Bytes longer = bytes;
    longer.push_back(std::byte{0});
    EXPECT_EQ(decode(longer, status), CodecStatus::too_long);
    EXPECT_EQ(decode(bytes, status), CodecStatus::ok);

    GetNodeInfoRequest request;
    EXPECT_EQ(decode(std::span<const std::byte>{}, request), CodecStatus::ok);
    EXPECT_EQ(decode(std::span(bytes).first(1), request), CodecStatus::too_long);
}

TEST(DronecanCodec, BadLength)
{
    // Fix2's covariance: 36 elements at most, 63 can be said. Its six bits lie at bit 378.
    Fix2 fix;
    Bytes bytes = payload_of(fix);
    ASSERT_EQ(decode(bytes, fix), CodecStatus::ok);
    bytes[47] |= std::byte{37};
    bytes.resize(200);
    EXPECT_EQ(decode(bytes, fix), CodecStatus::bad_length);
    bytes[47] = (bytes[47] & std::byte{0xC0}) | std::byte{36};
    EXPECT_EQ(decode(bytes, fix), CodecStatus::ok);
    EXPECT_EQ(fix.covariance.size(), 36U);

    // A tail array: one element more than there may be.
    Allocation allocation;
    EXPECT_EQ(decode(Bytes(17), allocation), CodecStatus::ok);
    EXPECT_EQ(decode(Bytes(18), allocation), CodecStatus::bad_length);
}

TEST(DronecanCodec, BadTag)
{
    GetSetRequest request;
    Bytes bytes = payload_of(request);
    ASSERT_EQ(bytes.size(), 2U);
    for (unsigned tag = 5; tag < 8; ++tag) {
        bytes[1] = static_cast<std::byte>(tag);
        EXPECT_EQ(decode(bytes, request), CodecStatus::bad_tag) << tag;
    }
}

TEST(DronecanCodec, AFixMayBeFollowedByWhatIsNotOfInterest)
{
    Bytes bytes = payload_of(Fix2{});
    bytes.resize(bytes.size() + 26 + 2 * 9);
    Fix2 fix;
    EXPECT_EQ(decode(bytes, fix), CodecStatus::ok);
}

TEST(DronecanFrameId, PackedAndUnpackedAreTheSame)
{
    Random random(3);
    for (int i = 0; i < 100'000; ++i) {
        const auto bits = static_cast<std::uint32_t>(random.next() & 0x1FFFFFFF);
        EXPECT_EQ(pack(unpack(bits)), bits);
        const auto tail = static_cast<std::byte>(random.next());
        EXPECT_EQ(pack(unpack(tail)), tail);
    }
}

}  // namespace
}  // namespace jink::link::dronecan
