// SPDX-License-Identifier: BSD-3-Clause
// Reports of other vehicles: positions of systems of the link, UTM_GLOBAL_POSITION, and recognition of our own.
#include <gtest/gtest.h>
#include <limits>

#include "firmware/link/track_ids.hpp"
#include "tests/unit/link/mavlink_endpoint_fixture.hpp"

namespace jink::link::mavlink {
namespace {

using namespace test;

class MavlinkEndpointTraffic : public EndpointTest {
protected:
    static constexpr std::uint8_t kOther = 9;

    void SetUp() override
    {
        heartbeat();
        local_position();
        clear();
    }

    /// 1000 m north, 500 m east, 100 m above the origin.
    [[nodiscard]] GlobalPositionInt position() const
    {
        GlobalPositionInt m;
        m.time_boot_ms = boot_ms() + 7'000;
        m.lat = 473977420 + 89832;
        m.lon = 85455940 + 66348;
        m.alt = 588000;
        m.vx = 100;
        m.vy = 200;
        m.vz = -300;
        return m;
    }
    static UtmGlobalPosition utm(std::uint8_t name = 1)
    {
        UtmGlobalPosition m;
        m.lat = 473977420 + 89832;
        m.lon = 85455940 + 66348;
        m.alt = 588000 + 47000;
        m.vx = 100;
        m.vy = 200;
        m.vz = -300;
        m.h_acc = 700;
        m.v_acc = 1200;
        m.vel_acc = 30;
        m.uas_id.fill(name);
        m.flight_state = 3;
        m.flags = 2 | 4 | 8 | 32 | 64;
        return m;
    }
    /// Sea level lies 47 m above the ellipsoid here.
    void gps(std::int32_t undulation = 47000, std::uint8_t fix = 3)
    {
        GpsRawInt m;
        m.alt = 490000;
        m.alt_ellipsoid = 490000 + undulation;
        m.fix_type = fix;
        autopilot(m);
    }
};

TEST_F(MavlinkEndpointTraffic, AnotherSystemIsATrackOfItsOwn)
{
    origin();
    from(kOther, 1, position());
    ASSERT_EQ(inbox->tracks.size(), 1U);
    const TrackReport& t = inbox->tracks[0];
    EXPECT_EQ(t.id, 0x05000009U);
    EXPECT_EQ(t.source, world::TrackSource::datalink);
    expect_near(t.position, {500, 1000, 100}, 0.3F);
    expect_near(t.velocity, {2, 1, 3}, 1e-5F);
    EXPECT_TRUE(t.has_velocity);
    EXPECT_EQ(t.stamp, now);
    EXPECT_EQ(t.sigma_position, 0.0F) << "not said";
    EXPECT_TRUE(t.unmanned);
    EXPECT_FALSE(t.helpless);
    EXPECT_FALSE(t.at_rest);
    EXPECT_EQ(count().frames_ignored, 0U);
}

TEST_F(MavlinkEndpointTraffic, OwnPositionIsNone)
{
    origin();
    from(kSystem, 1, position());
    from(kSystem, 191, position());
    EXPECT_TRUE(inbox->tracks.empty());
}

TEST_F(MavlinkEndpointTraffic, OnlyAutopilotsOfOtherSystemsAreBelieved)
{
    origin();
    from(kOther, 2, position());
    from(kOther, 191, position());
    from(0, 1, position());
    EXPECT_TRUE(inbox->tracks.empty());
    EXPECT_EQ(count().frames_ignored, 3U);
    LocalPositionNed local;
    local.x = 5.0F;
    from(kOther, 1, local);
    EXPECT_TRUE(inbox->tracks.empty()) << "about an origin of its own";
    EXPECT_FALSE(inbox->has_own_state);
    EXPECT_EQ(count().frames_ignored, 4U);
}

TEST_F(MavlinkEndpointTraffic, AnotherSystemWithoutAPlaceIsRefused)
{
    from(kOther, 1, position());
    EXPECT_EQ(count().no_origin, 1U);
    origin();
    GlobalPositionInt m = position();
    m.lat = m.lon = 0;
    from(kOther, 1, m);
    m.lat = 900000001;
    from(kOther, 1, m);
    m.lat = 0;
    m.lon = -1800000001;
    from(kOther, 1, m);
    EXPECT_EQ(count().out_of_range, 3U);
    EXPECT_TRUE(inbox->tracks.empty());
}

TEST_F(MavlinkEndpointTraffic, WhatTheRadioHeldBackIsOld)
{
    origin();
    from(kOther, 1, position());
    const GlobalPositionInt held = position();
    wait(2.5F);
    from(kOther, 1, held);
    ASSERT_EQ(inbox->tracks.size(), 2U);
    EXPECT_EQ(inbox->tracks[1].stamp.us, now.us - 2'500'000);
    from(kOther + 1, 1, held);
    EXPECT_EQ(inbox->tracks[2].stamp, now) << "another system has another clock";
}

TEST_F(MavlinkEndpointTraffic, DisarmedItDoesNotGiveWay)
{
    origin();
    Heartbeat m;
    m.autopilot = 3;
    m.base_mode = 1;
    from(kOther, 1, m);
    from(kOther, 1, position());
    EXPECT_TRUE(inbox->tracks[0].helpless);
    from(kOther + 1, 1, position());
    EXPECT_FALSE(inbox->tracks[1].helpless);
    m.base_mode = 0x81;
    from(kOther, 1, m);
    from(kOther, 1, position());
    EXPECT_FALSE(inbox->tracks[2].helpless);
    EXPECT_TRUE(count().frames_ignored == 0 && !inbox->has_autopilot);
}

TEST_F(MavlinkEndpointTraffic, UtmHeightsAreBroughtToSeaLevel)
{
    origin();
    gps();
    from(kOther, 1, utm());
    ASSERT_EQ(inbox->tracks.size(), 1U);
    const TrackReport& t = inbox->tracks[0];
    EXPECT_EQ(t.id, track_of_name(utm().uas_id));
    EXPECT_EQ(t.source, world::TrackSource::utm);
    expect_near(t.position, {500, 1000, 100}, 0.3F);
    expect_near(t.velocity, {2, 1, 3}, 1e-5F);
    EXPECT_FLOAT_EQ(t.sigma_position, 1.2F) << "the worse of both";
    EXPECT_FLOAT_EQ(t.sigma_velocity, 0.3F);
    EXPECT_EQ(t.stamp, now);
    EXPECT_TRUE(t.unmanned);
    EXPECT_FALSE(t.helpless);
}

TEST_F(MavlinkEndpointTraffic, WithoutOwnGpsUtmHeightsAreUncertainByTheGeoid)
{
    origin();
    gps(47000, 2);  // no 3D fix
    gps(-490000);   // ellipsoid height 0: unknown
    gps(121'000);   // no geoid on earth
    from(kSystem, 25, GpsRawInt{0, 0, 0, 490000, 0, 0, 0, 0, 3, 9, 537000, 0, 0, 0, 0, 0});  // not the autopilot's
    EXPECT_EQ(count().frames_ignored, 4U);
    from(kOther, 1, utm());
    ASSERT_EQ(inbox->tracks.size(), 1U);
    const TrackReport& t = inbox->tracks[0];
    EXPECT_NEAR(t.position.z(), 147.0F, 0.3F);
    EXPECT_GE(3.0F * t.sigma_position, 107.0F) << "it holds every geoid";
}

TEST_F(MavlinkEndpointTraffic, UtmFlagsAreLookedAt)
{
    origin();
    gps();
    for (const unsigned flags : {0U, 2U | 4U, 2U | 8U, 255U - 4U, 255U - 8U}) {
        UtmGlobalPosition m = utm();
        m.flags = static_cast<std::uint8_t>(flags);
        from(kOther, 1, m);
    }
    EXPECT_EQ(count().out_of_range, 5U);
    EXPECT_TRUE(inbox->tracks.empty());
    UtmGlobalPosition m = utm();
    m.flags = 2 | 4 | 8 | 64;
    from(kOther, 1, m);
    EXPECT_FALSE(inbox->tracks[0].has_velocity);
    EXPECT_EQ(inbox->tracks[0].velocity, Vec3(0, 0, 0));
    m.flags = 2 | 4 | 8 | 32;
    from(kOther, 1, m);
    EXPECT_TRUE(inbox->tracks[1].has_velocity);
    EXPECT_EQ(inbox->tracks[1].velocity.z(), 0.0F);
    EXPECT_GE(inbox->tracks[1].sigma_velocity, 5.0F) << "it may climb";
    m = utm();
    m.lat = m.lon = 0;
    from(kOther, 1, m);
    m = utm();
    m.alt = std::numeric_limits<std::int32_t>::min();
    from(kOther, 1, m);
    EXPECT_EQ(count().out_of_range, 7U);
    from(0, 1, utm());
    EXPECT_EQ(count().frames_ignored, 1U);
    EXPECT_EQ(inbox->tracks.size(), 2U);
}

TEST_F(MavlinkEndpointTraffic, UtmWithoutANameGoesByItsSender)
{
    origin();
    UtmGlobalPosition m = utm();
    m.flags = 4 | 8;
    from(kOther, 1, m);
    from(kOther, 2, m);
    from(kOther, 1, utm(0));  // zeros are no name
    ASSERT_EQ(inbox->tracks.size(), 3U);
    EXPECT_NE(inbox->tracks[0].id, inbox->tracks[1].id);
    EXPECT_EQ(inbox->tracks[0].id, inbox->tracks[2].id);
}

TEST_F(MavlinkEndpointTraffic, WhoeverSaysSoOverUtmDoesNotGiveWay)
{
    origin();
    for (const unsigned state : {0U, 1U, 2U, 3U, 16U, 32U}) {
        UtmGlobalPosition m = utm();
        m.flight_state = static_cast<std::uint8_t>(state);
        clear();
        from(kOther, 1, m);
        ASSERT_EQ(inbox->tracks.size(), 1U);
        EXPECT_EQ(inbox->tracks[0].helpless, state == 2 || state == 16 || state == 32) << state;
    }
}

TEST_F(MavlinkEndpointTraffic, OurOwnUtmComesBackAndIsNoTrack)
{
    origin();
    from(kSystem, 1, utm(5));
    EXPECT_TRUE(inbox->tracks.empty());
    from(kOther, 1, utm(5));
    from(kSystem, 158, utm(5));
    EXPECT_TRUE(inbox->tracks.empty());
    EXPECT_EQ(count().own_heard, 3U);
    from(kSystem, 158, utm(6));
    EXPECT_EQ(inbox->tracks.size(), 1U) << "a receiver of ours hears another";
    // An autopilot that stops reporting its name keeps it; without a name no report counts as our own.
    UtmGlobalPosition nameless = utm(5);
    nameless.flags = 4 | 8;
    from(kSystem, 1, nameless);
    from(kOther, 1, utm(5));
    EXPECT_EQ(count().own_heard, 5U);
    from(kOther, 1, utm(0));
    EXPECT_EQ(inbox->tracks.size(), 2U);
}

TEST_F(MavlinkEndpointTraffic, TheOriginMovesWhatWaits)
{
    origin();
    gps();
    from(kOther, 1, position());
    from(kOther, 1, utm());
    origin(473977420 + 8983);  // 100 m north
    for (const TrackReport& t : inbox->tracks) {
        expect_near(t.position, {500, 900, 100}, 0.5F);
    }
}

TEST_F(MavlinkEndpointTraffic, AConflictWithASystemIsReportedByItsId)
{
    CollisionWarning warning;
    warning.id = track_of_system(kOther);
    endpoint->send_collision(warning);
    Collision m = sent_one<Collision>();
    EXPECT_EQ(m.src, 1);
    EXPECT_EQ(m.id, kOther);
    for (const std::uint32_t id : {0xABCDEFU, 0x01000003U, 0x05000000U, 0x05000100U, 0x40000001U}) {
        warning.id = id;
        endpoint->send_collision(warning);
        m = sent_one<Collision>();
        EXPECT_EQ(m.src, 0);
        EXPECT_EQ(m.id, id);
    }
}

TEST(TrackIds, RangesDoNotMeet)
{
    const auto range = [](world::TrackId id) {
        return id <= 0xFFFFFF ? 1 : is_of_system(id) ? 2 : id >= kWideAddressIds ? 4 : id >= kUtmIds ? 3 : 0;
    };
    for (const std::uint32_t address : {0U, 1U, 0xFFFFFFU}) {
        EXPECT_EQ(track_of_address(address), address);
        EXPECT_EQ(range(track_of_address(address)), 1);
    }
    for (const std::uint32_t address : {0x01000000U, 0x05000009U, 0x40000000U, 0x80000000U, 0xFFFFFFFFU}) {
        EXPECT_EQ(range(track_of_address(address)), 4);
    }
    for (unsigned system = 1; system < 256; ++system) {
        EXPECT_EQ(range(track_of_system(static_cast<std::uint8_t>(system))), 2);
    }
    Random random(4);
    std::array<std::uint8_t, 18> name{};
    for (int i = 0; i < 10'000; ++i) {
        name[random.below(18)] = static_cast<std::uint8_t>(random.below(256));
        ASSERT_EQ(range(track_of_name(name)), 3);
    }
}

TEST(TrackIds, NamesAreHashedAsPublished)
{
    // FNV-1a, 32 bits, of "a" is 0xE40C292C and of "foobar" 0xBF9CF968 (draft-eastlake-fnv).
    const std::array<std::uint8_t, 1> a{'a'};
    EXPECT_EQ(track_of_name(a), 0x40000000U | ((0xE40C292CU >> 30U) ^ (0xE40C292CU & 0x3FFFFFFFU)));
    const std::array<std::uint8_t, 6> foobar{'f', 'o', 'o', 'b', 'a', 'r'};
    EXPECT_EQ(track_of_name(foobar), 0x40000000U | ((0xBF9CF968U >> 30U) ^ (0xBF9CF968U & 0x3FFFFFFFU)));
}

}  // namespace
}  // namespace jink::link::mavlink
