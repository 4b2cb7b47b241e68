// SPDX-License-Identifier: BSD-3-Clause
// Where the autopilot flies to: when a leg begins and ends, and who else speaks of missions on the line.
#include "tests/unit/link/mavlink_mission_fixture.hpp"

namespace jink::link::mavlink {
namespace {

using namespace test;
using MavlinkEndpointLegChanges = MissionEndpointTest;

TEST_F(MavlinkEndpointLegChanges, TheLegEndsWithTheMissionModeAndBeginsAnewWhereItReturns)
{
    for (const std::uint32_t other : {kLoiter, 6U, 9U, 0U}) {
        clear();
        own = {0, 0, -30};
        fly({north(300)});
        clear();
        heartbeat(3, other);
        run(0.02F);
        EXPECT_TRUE(inbox->leg_lost) << other;
        EXPECT_FALSE(inbox->has_leg);
        clear();
        heartbeat(3, kGuided);
        run(0.1F);
        EXPECT_FALSE(inbox->has_leg) << "somebody else's";
        own = {50, 60, -30};
        run(0.02F);
        heartbeat(3, kAuto);
        expect_leg({60, 50, 30}, {0, 300, 30});
    }
}

TEST_F(MavlinkEndpointLegChanges, AnExternalModeThatFollowsTheMissionKeepsTheLeg)
{
    for (const std::uint8_t stack : {std::uint8_t{3}, std::uint8_t{12}}) {
        endpoint = std::make_unique<Endpoint>();
        own = {0, 0, -30};
        fly({north(300)}, stack);
        clear();
        heartbeat(stack, stack == 3 ? kGuided : kPx4Offboard);
        own = {50, 60, -30};
        run(1.0F);
        EXPECT_FALSE(inbox->leg_lost);
        heartbeat(stack, stack == 3 ? kAuto : kPx4Mission);
        expect_leg({60, 50, 30}, {0, 300, 30});
        clear();
        heartbeat(stack, stack == 3 ? kLoiter : kPx4Hold);
        EXPECT_TRUE(inbox->leg_lost);
    }
}

/// The mission is read within seconds of the start, and again when it is replaced: a take-over may come first. Both
/// autopilots go on to the item from where they get the vehicle back.
TEST_F(MavlinkEndpointLegChanges, AMissionThatIsReadInAnExternalModeGivesALegFromThere)
{
    for (const std::uint8_t stack : {std::uint8_t{3}, std::uint8_t{12}}) {
        endpoint = std::make_unique<Endpoint>();
        clear();
        mission = {item_of(16, kLat, kLon, 488.0F, 0), north(300), north(600)};
        own = {0, 0, -30};
        heartbeat(stack, stack == 3 ? kAuto : kPx4Mission);
        origin();
        home();
        local_position(own);
        heartbeat(stack, stack == 3 ? kGuided : kPx4Offboard);
        own = {50, 60, -30};
        run(0.5F);
        EXPECT_FALSE(inbox->has_leg) << "no item is current yet";
        current(1);
        run(0.5F);
        expect_leg({60, 50, 30}, {0, 300, 30});
        clear();
        own = {70, 80, -30};
        run(0.02F);
        current(2);
        run(0.5F);
        expect_leg({80, 70, 30}, {0, 600, 30});
        clear();
        run(0.5F);
        EXPECT_FALSE(inbox->leg_lost);
        own = {90, 80, -30};
        run(0.02F);
        heartbeat(stack, stack == 3 ? kAuto : kPx4Mission);
        expect_leg({80, 90, 30}, {0, 600, 30});
    }
}

/// Nobody's mission is gone on with after a mode in between, nor from an external mode that was there first.
TEST_F(MavlinkEndpointLegChanges, AMissionThatIsReadInAModeOfSomebodyElseGivesNoLeg)
{
    for (const bool after_the_mission : {false, true}) {
        endpoint = std::make_unique<Endpoint>();
        clear();
        mission = {item_of(16, kLat, kLon, 488.0F, 0), north(300)};
        if (after_the_mission) {
            heartbeat(3, kAuto);
            heartbeat(3, kLoiter);
        }
        heartbeat(3, kGuided);
        origin();
        home();
        local_position(own);
        current(1);
        run(1.0F);
        EXPECT_FALSE(inbox->has_leg) << after_the_mission;
    }
}

TEST_F(MavlinkEndpointLegChanges, NoLegBeforeArming)
{
    fly({north(300)});
    heartbeat(3, kAuto, false);
    clear();
    own = {5, 5, 0};
    run(0.5F);
    EXPECT_FALSE(inbox->has_leg);
    heartbeat(3, kAuto, true);
    expect_leg({5, 5, 0}, {0, 300, 30});
}

TEST_F(MavlinkEndpointLegChanges, ARelativeItemWaitsForHomeAndAnyForTheOrigin)
{
    mission = {item_of(16, kLat, kLon, 488.0F, 0), north(300)};
    local_position(own);
    current(1);
    run(0.5F);
    EXPECT_FALSE(inbox->has_leg);
    origin();
    EXPECT_FALSE(inbox->has_leg) << "relative to a home that is not known";
    home(kLat, kLon, 500000);
    expect_leg({0, 0, 30}, {0, 300, 42});
    clear();
    home(kLat, kLon, 489000);
    expect_leg({0, 0, 30}, {0, 300, 31});
    clear();
    origin(kLat + 10000, kLon, 485000);
    expect_leg({0, 0, 30}, {0, 300 - 111.3F, 34});
    origin(0, 0, 485000);
    EXPECT_FALSE(inbox->has_leg);
    EXPECT_TRUE(inbox->leg_lost) << "farther away than anything may be";
}

TEST_F(MavlinkEndpointLegChanges, WhatIsNotForUsIsNotTaken)
{
    origin();
    local_position(own);
    current(0);
    EXPECT_EQ(only<MissionRequestList>(serve(0.1F)).size(), 1U);
    MissionCount count;
    count.count = 1;
    count.target_system = kSystem;
    count.target_component = kUs;
    count.mission_type = 1;  // of the fence
    autopilot(count);
    EXPECT_TRUE(only<MissionRequestInt>(serve(0.1F)).empty());
    count.mission_type = 0;
    autopilot(count);
    EXPECT_EQ(only<MissionRequestInt>(serve(0.1F)).size(), 1U);
    MissionItemInt item = north(300);
    item.target_system = kSystem;
    item.target_component = kUs;
    item.mission_type = 1;
    autopilot(item);
    EXPECT_TRUE(only<MissionAck>(serve(0.1F)).empty());
}

TEST_F(MavlinkEndpointLegChanges, ATransferOfAGroundStationOnOurLineSilencesUs)
{
    const auto is_quiet = [&] {
        for (const Received& f : serve(8.0F)) {
            if (f.message_id >= 40 && f.message_id <= 51) {
                return false;
            }
        }
        return true;
    };
    MissionRequestInt upload;
    upload.target_system = 255;
    upload.target_component = 190;
    MissionCount download;
    download.target_system = 255;
    download.target_component = 190;
    MissionCount begins;
    begins.target_system = kSystem;
    begins.target_component = 1;
    MissionCount of_another = begins;
    of_another.target_system = 9;
    for (int who = 0; who < 3; ++who) {
        endpoint = std::make_unique<Endpoint>();
        heartbeat();
        current(1);
        serve(0.1F);
        who == 0 ? autopilot(upload) : who == 1 ? autopilot(download) : from(255, 190, begins);
        EXPECT_TRUE(is_quiet()) << who;
        MissionAck ends;
        ends.target_system = 255;
        ends.target_component = 190;
        autopilot(ends);
        from(9, 190, of_another);  // another vehicle's mission
        EXPECT_GE(only<MissionRequestList>(serve(2.0F)).size(), 1U);
    }
}

TEST_F(MavlinkEndpointLegChanges, PositionTargetsAreNoLegs)
{
    for (const std::uint8_t stack : {std::uint8_t{3}, std::uint8_t{12}}) {
        for (const std::uint32_t mode : {kAuto, kGuided, kPx4Mission, kPx4Hold}) {
            heartbeat(stack, mode);
            local_position(own);
            PositionTargetLocalNed m;
            m.coordinate_frame = 1;
            m.x = 100;
            m.z = -10;
            autopilot(m);
            EXPECT_FALSE(inbox->has_leg) << "43 of 74 were hit";
        }
    }
}

TEST_F(MavlinkEndpointLegChanges, AnEstimatorResetStartsTheLegAnew)
{
    fly({north(300)});
    clear();
    Odometry m;
    m.frame_id = m.child_frame_id = 1;
    m.q = {1, 0, 0, 0};
    m.time_usec = boot_ms() * std::uint64_t{1000};
    m.x = 1.0F;
    autopilot(m);
    clear();
    m.reset_counter = 1;
    m.x = 20.0F;
    m.time_usec = boot_ms() * std::uint64_t{1000};
    autopilot(m);
    expect_leg({0, 20, 0}, {0, 300, 30});
}

}  // namespace
}  // namespace jink::link::mavlink
