// SPDX-License-Identifier: BSD-3-Clause
// Where the autopilot flies to: the leg that follows from the mission's current item.
#include "tests/unit/link/mavlink_mission_fixture.hpp"

namespace jink::link::mavlink {
namespace {

using namespace test;
using MavlinkEndpointLegs = MissionEndpointTest;

TEST_F(MavlinkEndpointLegs, MissionLegInAllFrames)
{
    struct Case {
        std::uint8_t frame;
        std::int32_t x, y;
        float z;
        Vec3 expected;
    };
    own = {1, 2, -3};
    const std::int32_t lat = kLat + kNorth1000m;
    for (const Case& c : {Case{0, lat, kLon, 538.0F, {0, 1000, 50}}, Case{5, lat, kLon, 538.0F, {0, 1000, 50}},
                          Case{3, lat, kLon, 50.0F, {0, 1000, 52}}, Case{6, lat, kLon, 50.0F, {0, 1000, 52}},
                          Case{1, 1'000'000, 200'000, -50.0F, {20, 100, 50}}}) {
        endpoint = std::make_unique<Endpoint>();
        clear();
        heartbeat();
        home(kLat, kLon, 490000);
        fly({item_of(16, c.x, c.y, c.z, c.frame)});
        home(kLat, kLon, 490000);
        expect_leg({2, 1, 3}, c.expected);
        EXPECT_EQ(inbox->leg.leg.speed, 0.0F) << "not said";
    }
}

TEST_F(MavlinkEndpointLegs, ItemsWithoutAKnownPlaceGiveNoLeg)
{
    constexpr std::int32_t kNotSaid = std::numeric_limits<std::int32_t>::max();
    for (const MissionItemInt& m :
         {item_of(16, 0, 0, 30), item_of(16, kNotSaid, kNotSaid, 30), item_of(16, kLat, kLon, 30, 10),
          item_of(16, kLat, kLon, 30, 11), item_of(16, 10000000, 10000000, 30), item_of(16, kLat, kLon, kNan),
          item_of(20, 0, 0, 0), item_of(21, 0, 0, 0), item_of(17, 0, 0, 0), north(300, 30, 18), north(300, 30, 31),
          north(300, 30, 82), north(300, 30, 93), north(300, 30, 177)}) {
        endpoint = std::make_unique<Endpoint>();
        clear();
        fly({m});
        EXPECT_FALSE(inbox->has_leg) << m.command << " " << m.x;
    }
}

TEST_F(MavlinkEndpointLegs, LoiterTurnsIsNotALegToItsCentre)
{
    fly({north(300), north(400, 30, 18)});
    ASSERT_TRUE(inbox->has_leg);
    clear();
    current(2);
    run(0.2F);
    EXPECT_FALSE(inbox->has_leg) << "40 of 73 were hit";
    EXPECT_TRUE(inbox->leg_lost);
}

TEST_F(MavlinkEndpointLegs, ALoiterItemIsALegUntilItsPlaceIsReached)
{
    fly({north(300, 30, 19)});
    expect_leg({0, 0, 30}, {0, 300, 30});
    clear();
    own = {299, 0, -30};
    run(0.1F);
    EXPECT_TRUE(inbox->leg_lost);
    clear();
    own = {280, 0, -30};  // blown off
    run(0.1F);
    EXPECT_FALSE(inbox->has_leg) << "it holds its place";
}

TEST_F(MavlinkEndpointLegs, ArduPilotsFirstLegStartsWhereTheVehicleIsAndNotAtHomeOnTheGround)
{
    own = {0, 40, -30};
    fly({north(300)});
    expect_leg({40, 0, 30}, {0, 300, 30});
}

TEST_F(MavlinkEndpointLegs, AJumpStartsTheLegWhereTheVehicleIs)
{
    fly({north(300), north(600), item_of(16, kLat, kLon + 50000, 30)});
    own = {100, 0, -30};
    run(0.1F);
    clear();
    current(3);
    EXPECT_TRUE(inbox->leg_lost) << "not known until it is compared";
    run(0.2F);
    expect_leg({0, 100, 30}, {376.8F, 0, 30}, 0.5F);
}

TEST_F(MavlinkEndpointLegs, AReachedItemIsWhereTheNextLegStarts)
{
    for (const bool reached_first : {true, false}) {
        endpoint = std::make_unique<Endpoint>();
        clear();
        own = {0, 0, -30};
        fly({north(300), item_of(16, kLat, kLon + 50000, 30)});
        own = {291, 0, -30};  // PX4 turns 10 m before
        run(0.1F);
        clear();
        if (reached_first) {
            reached(1);
        }
        current(2);
        run(0.06F);
        if (!reached_first) {
            reached(1);
        }
        expect_leg({0, 300, 30}, {376.8F, 0, 30}, 0.5F);
    }
}

TEST_F(MavlinkEndpointLegs, APlaneTurnsToItsNextLegFarBeforeTheWaypoint)
{
    constexpr std::uint32_t kPlaneMission = 10;
    for (const float before : {74.0F, 130.0F}) {
        endpoint = std::make_unique<Endpoint>();
        clear();
        own = {0, 0, -30};
        mission = {item_of(16, kLat, kLon, 488.0F, 0), north(300), item_of(16, kLat, kLon + 50000, 30)};
        heartbeat(3, kPlaneMission, true, 1);
        origin();
        home();
        local_position(own);
        current(1);
        run(0.5F);
        expect_leg({0, 0, 30}, {0, 300, 30});
        own = {300.0F - before, 0, -30};
        run(0.1F);
        clear();
        reached(1);
        current(2);
        run(0.2F);
        const bool turns = before < 120.0F;
        expect_leg({0, turns ? 300.0F : 300.0F - before, 30}, {376.8F, 0, 30}, 0.5F);
    }
}

TEST_F(MavlinkEndpointLegs, ATakeoffLeadsStraightUpWhateverItsPlace)
{
    for (const std::int32_t lat : {0, kLat + 5000}) {
        endpoint = std::make_unique<Endpoint>();
        clear();
        own = {3, 4, 0};
        fly({item_of(22, lat, lat == 0 ? 0 : kLon, 30, 3)});
        expect_leg({4, 3, 0}, {4, 3, 30});
    }
}

TEST_F(MavlinkEndpointLegs, Px4FliesToTheTakeoffsPlaceOnceItHasClimbed)
{
    own = {0, 0, 0};
    fly({north(100, 30, 22)}, 12);
    expect_leg({0, 0, 0}, {0, 0, 30});
    own = {0, 0, -29};
    run(0.1F);
    expect_leg({0, 0, 29}, {0, 100, 30});
}

TEST_F(MavlinkEndpointLegs, ALandingIsLevelUntilAboveItsPlaceAndThenNotKnown)
{
    fly({north(300, 0, 21)});
    expect_leg({0, 0, 30}, {0, 300, 30});
    clear();
    own = {298, 0, -30};
    run(0.1F);
    EXPECT_TRUE(inbox->leg_lost);
}

TEST_F(MavlinkEndpointLegs, AnAltitudeOfZeroIsThePresentOneToArduPilotAlone)
{
    fly({north(300, 0)});
    expect_leg({0, 0, 30}, {0, 300, 30});
    endpoint = std::make_unique<Endpoint>();
    clear();
    fly({north(300, 0)}, 12);
    expect_leg({0, 0, 30}, {0, 300, 0});
}

TEST_F(MavlinkEndpointLegs, TheMissionsSpeedIsReported)
{
    MissionItemInt speed = item_of(178, 0, 0, 0, 2);
    speed.param1 = 1.0F;
    speed.param2 = 12.0F;
    fly({speed, north(300)});
    expect_leg({0, 0, 30}, {0, 300, 30});
    EXPECT_EQ(inbox->leg.leg.speed, 12.0F);
}

TEST_F(MavlinkEndpointLegs, AnotherPlaceUnderTheSameNumberIsNoticed)
{
    fly({north(300), north(600)});
    own = {100, 0, -30};
    mission[1] = item_of(16, kLat, kLon + 50000, 30);  // same count, no id: ArduPilot
    clear();
    run(6.0F);
    expect_leg({0, 100, 30}, {376.8F, 0, 30}, 0.5F);
    mission[1] = north(500);
    clear();
    Statustext text;
    constexpr std::string_view kText = "Auto mission changed, restarted command";
    std::copy(kText.begin(), kText.end(), text.text.begin());
    autopilot(text);
    run(0.2F);
    expect_leg({0, 100, 30}, {0, 500, 30}, 0.5F);
}

}  // namespace
}  // namespace jink::link::mavlink
