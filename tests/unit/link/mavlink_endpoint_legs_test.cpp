// SPDX-License-Identifier: BSD-3-Clause
// Where the autopilot flies to: legs from its mission and from its position targets.
#include <gtest/gtest.h>
#include <limits>

#include "tests/numbers.hpp"
#include "tests/unit/link/mavlink_endpoint_fixture.hpp"

namespace jink::link::mavlink {
namespace {

using namespace test;

class MavlinkEndpointLegs : public HeardEndpointTest {
protected:
    void mission_item(std::uint16_t seq, std::uint8_t frame, std::int32_t x, std::int32_t y, float z,
                      std::uint16_t number = 16, std::uint8_t target = kUs)
    {
        MissionItemInt m;
        m.seq = seq;
        m.frame = frame;
        m.x = x;
        m.y = y;
        m.z = z;
        m.command = number;
        m.target_system = kSystem;
        m.target_component = target;
        autopilot(m);
    }
    void mission_current(std::uint16_t seq)
    {
        MissionCurrent m;
        m.seq = seq;
        autopilot(m);
    }
    void mission_count(std::uint16_t count, std::uint8_t type = 0)
    {
        MissionCount m;
        m.count = count;
        m.mission_type = type;
        autopilot(m);
    }
};

TEST_F(MavlinkEndpointLegs, MissionLegInAllFrames)
{
    origin();
    HomePosition home;
    home.latitude = 473977420;
    home.longitude = 85455940;
    home.altitude = 490000;
    home.z = -2.0F;
    autopilot(home);
    local_position({1, 2, -3});
    constexpr std::int32_t kNorth1000m = 89832;
    struct Case {
        std::uint8_t frame;
        std::int32_t x, y;
        float z;
        Vec3 expected;
    };
    const std::int32_t lat = 473977420 + kNorth1000m;
    const std::int32_t lon = 85455940;
    std::uint16_t seq = 1;
    for (const Case& c : {Case{0, lat, lon, 538.0F, {0, 1000, 50}}, Case{5, lat, lon, 538.0F, {0, 1000, 50}},
                          Case{3, lat, lon, 50.0F, {0, 1000, 52}}, Case{6, lat, lon, 50.0F, {0, 1000, 52}},
                          Case{1, 1'000'000, 200'000, -50.0F, {20, 100, 50}}}) {
        clear();
        mission_current(seq);
        EXPECT_EQ(only<MissionRequestList>(serve(0.1F)).size(), 1U);
        mission_count(20);
        const auto asked = only<MissionRequestInt>(serve(0.1F));
        ASSERT_EQ(asked.size(), 1U);
        EXPECT_EQ(asked[0].seq, seq);
        EXPECT_EQ(asked[0].target_system, kSystem);
        mission_item(seq, c.frame, c.x, c.y, c.z);
        EXPECT_EQ(only<MissionRequestInt>(serve(0.1F)).at(0).seq, seq - 1);
        EXPECT_FALSE(inbox->has_leg);
        mission_item(static_cast<std::uint16_t>(seq - 1), 1, 0, 0, -10.0F);
        ASSERT_TRUE(inbox->has_leg) << "frame " << +c.frame;
        expect_near(inbox->leg.leg.start, {0, 0, 10}, 1e-3F);
        expect_near(inbox->leg.leg.end, c.expected, 0.05F);
        EXPECT_EQ(inbox->leg.leg.speed, 0.0F) << "not said";
        EXPECT_EQ(only<MissionAck>(serve(0.1F)).size(), 1U);
        ++seq;
    }
}

TEST_F(MavlinkEndpointLegs, LegsWithoutAnEndOfTheirOwnAreNone)
{
    origin();
    local_position();
    constexpr std::int32_t kNotSaid = std::numeric_limits<std::int32_t>::max();
    struct Case {
        std::uint8_t frame;
        std::int32_t x, y;
    };
    std::uint16_t seq = 0;
    for (const Case& c :
         {Case{0, 0, 0}, Case{0, kNotSaid, kNotSaid}, Case{10, 473977420, 85455940}, Case{0, 10000000, 10000000}}) {
        endpoint = std::make_unique<Endpoint>();
        heartbeat();
        origin();
        local_position();
        clear();
        mission_current(seq);
        serve(0.1F);
        mission_count(1);
        serve(0.1F);
        mission_item(seq, c.frame, c.x, c.y, 10.0F);
        serve(0.1F);
        EXPECT_FALSE(inbox->has_leg) << c.x;
    }
    mission_item(9, 1, 0, 0, kNan);
    EXPECT_EQ(count().not_finite, 1U);
}

TEST_F(MavlinkEndpointLegs, ALegWaitsForTheOrigin)
{
    local_position();
    mission_current(0);
    serve(0.1F);
    mission_count(1, 1);  // of the fence
    EXPECT_TRUE(only<MissionRequestInt>(serve(0.1F)).empty());
    mission_count(1);
    serve(0.1F);
    mission_item(0, 0, 473977420, 85455940, 500.0F, 16, 190);  // for the ground station
    mission_item(0, 0, 473977420, 85455940, 500.0F);
    EXPECT_FALSE(inbox->has_leg);
    origin();
    ASSERT_TRUE(inbox->has_leg);
    expect_near(inbox->leg.leg.end, {0, 0, 12}, 1e-2F);
    EXPECT_EQ(inbox->leg.leg.start, Vec3(0, 0, 0)) << "from where the vehicle is";
}

TEST_F(MavlinkEndpointLegs, ALegMovesWithTheOrigin)
{
    local_position();
    HomePosition home;
    home.latitude = 473977420;
    home.longitude = 85455940;
    home.altitude = 488000;
    autopilot(home);
    mission_current(0);
    serve(0.1F);
    mission_count(1);
    serve(0.1F);
    mission_item(0, 0, 473977420, 85455940, 500.0F);
    ASSERT_TRUE(inbox->has_leg);
    expect_near(inbox->leg.leg.end, {0, 0, 12}, 1e-2F);
    clear();
    origin(473977420, 85455940, 488000);
    EXPECT_FALSE(inbox->has_leg) << "the same place, of a better source";
    origin(473977420 + 10000, 85455940, 485000);
    ASSERT_TRUE(inbox->has_leg);
    expect_near(inbox->leg.leg.end, {0, -111.3F, 15}, 0.1F);
    clear();
    origin(0, 0, 485000);
    EXPECT_FALSE(inbox->has_leg);
    EXPECT_TRUE(inbox->leg_lost) << "farther away than anything may be";
}

TEST_F(MavlinkEndpointLegs, PositionTargetsGiveALegWhenTheyMove)
{
    local_position({0, 0, -10});
    PositionTargetLocalNed m;
    m.coordinate_frame = 1;
    m.x = 100;
    m.z = -10;
    autopilot(m);
    ASSERT_TRUE(inbox->has_leg);
    expect_near(inbox->leg.leg.start, {0, 0, 10}, 0.0F);
    expect_near(inbox->leg.leg.end, {0, 100, 10}, 0.0F);
    clear();
    m.x = 100.2F;
    autopilot(m);
    EXPECT_FALSE(inbox->has_leg) << "the same target";
    m.x = 150;
    autopilot(m);
    EXPECT_TRUE(inbox->has_leg);
    clear();
    const std::uint32_t ignored = count().frames_ignored;
    m.x = 200;
    m.coordinate_frame = 9;
    autopilot(m);
    m.coordinate_frame = 1;
    m.type_mask = 7;
    autopilot(m);
    m.type_mask = 0;
    heartbeat(3, 4);  // we fly it: the target is our own
    clear();
    autopilot(m);
    EXPECT_FALSE(inbox->has_leg);
    EXPECT_EQ(count().frames_ignored, ignored + 3);
    heartbeat(3, 3);
    m.x = kNan;
    autopilot(m);
    EXPECT_EQ(count().not_finite, 1U);
    m.x = 1e6F;
    autopilot(m);
    EXPECT_EQ(count().out_of_range, 1U);
}

}  // namespace
}  // namespace jink::link::mavlink
