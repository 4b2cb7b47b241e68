// SPDX-License-Identifier: BSD-3-Clause
// What the mission line just takes and what no longer: own state, preferred velocity, neighbours.
#include <gtest/gtest.h>

#include "tests/numbers.hpp"
#include "tests/unit/app/mission_edges.hpp"

namespace jink::app::test {
namespace {

TEST_F(MissionEdges, OwnStateUpToTheFarthestAndFastestAndNotBeyond)
{
    for (int axis = 0; axis < 3; ++axis) {
        for (const float sign : {-1.0F, 1.0F}) {
            const auto place = [&](float x) {
                return takes([&](vehicle::VehicleState& s) { s.position[axis] = sign * x; });
            };
            const auto velocity = [&](float v) {
                return takes([&](vehicle::VehicleState& s) { s.velocity[axis] = sign * v; });
            };
            EXPECT_TRUE(place(100'000.0F));
            EXPECT_FALSE(place(100'001.0F));
            EXPECT_FALSE(place(kInfinity));
            EXPECT_FALSE(place(kNan));
            EXPECT_TRUE(velocity(1000.0F));
            EXPECT_FALSE(velocity(1000.1F));
            EXPECT_FALSE(velocity(kInfinity));
            EXPECT_FALSE(velocity(kNan));
        }
    }
    EXPECT_FALSE(takes([](vehicle::VehicleState& s) { s.yaw = kNan; }));
    EXPECT_FALSE(takes([](vehicle::VehicleState& s) { s.yaw = kInfinity; }));
    EXPECT_TRUE(takes([](vehicle::VehicleState& s) { s.yaw = -3.0F; }));
}

TEST_F(MissionEdges, OwnStateOfNowIsTakenOneOfLaterRefusedAndTheSameAgainOlder)
{
    EXPECT_FALSE(takes([](vehicle::VehicleState& s) { s.stamp.us += 1; }));
    EXPECT_EQ(protocol_.diagnostics().refused, 1U);
    EXPECT_TRUE(input().hold) << "nothing is known yet";
    EXPECT_TRUE(takes([](vehicle::VehicleState&) {}));
    const TimePoint known = input().own.stamp;
    vehicle::VehicleState again = own();
    again.stamp = known;
    again.position.x() = 5.0F;
    protocol_.take_own_state(again, line_.now);
    EXPECT_EQ(protocol_.diagnostics().older, 1U);
    EXPECT_EQ(input().own.position.x(), 0.0F);
    EXPECT_TRUE(takes([&](vehicle::VehicleState& s) { s.stamp.us = known.us + 1; }));
}

/// Before anything is known, any instant is news: also one before the clock's zero.
TEST_F(MissionEdges, TheFirstOwnStateIsTakenWhateverItsStamp)
{
    vehicle::VehicleState state;
    state.stamp = {-5};
    protocol_.take_own_state(state, line_.now);
    EXPECT_EQ(protocol_.diagnostics().states, 1U);
    EXPECT_EQ(input().own.stamp.us, -5);
}

TEST_F(MissionEdges, HoldsWhenTheOwnStateIsOlderThanItsAge)
{
    protocol_.take_own_state(own(), line_.now);
    protocol_.take_preferred(Vec3(1, 0, 0), line_.now);
    line_.now.us += 200'000;
    EXPECT_FALSE(input().hold) << "0.2 s to the microsecond";
    EXPECT_EQ(input().preferred, Vec3(1, 0, 0));
    line_.now.us += 1;
    EXPECT_TRUE(input().hold);
    EXPECT_EQ(input().preferred, Vec3::Zero());
    EXPECT_TRUE(has(MissionFault::own_state_stale));
    EXPECT_FALSE(has(MissionFault::no_preferred)) << "that is still wanted";
}

TEST_F(MissionEdges, ThePreferredVelocityCountsForItsAge)
{
    EXPECT_TRUE(has(MissionFault::no_preferred));
    protocol_.take_preferred(Vec3(1000, -1000, 1000), line_.now);
    protocol_.take_own_state(own(), line_.now);
    EXPECT_EQ(input().preferred, Vec3(1000, -1000, 1000));
    for (const Vec3& bad : {Vec3(1000.1F, 0, 0), Vec3(0, -1000.1F, 0), Vec3(0, 0, kNan), Vec3(0, kInfinity, 0)}) {
        protocol_.take_preferred(bad, line_.now);
        EXPECT_EQ(input().preferred, Vec3(1000, -1000, 1000)) << "what is none was not said";
    }
    EXPECT_EQ(protocol_.diagnostics().refused, 4U);
    line_.now.us += 500'000;
    protocol_.take_own_state(own(), line_.now);
    EXPECT_FALSE(has(MissionFault::no_preferred)) << "0.5 s to the microsecond";
    line_.now.us += 1;
    EXPECT_TRUE(has(MissionFault::no_preferred));
    EXPECT_EQ(input().preferred, Vec3::Zero());
    protocol_.take_preferred(Vec3(2, 0, 0), line_.now);
    EXPECT_FALSE(has(MissionFault::no_preferred));
}

TEST_F(MissionEdges, NeighboursUpToWhatIsPossible)
{
    EXPECT_TRUE(takes_neighbour(5, [](StateNeighbour& s) {
        s.position = {100'000.0F, -100'000.0F, 100'000.0F};
        s.velocity = {1000.0F, -1000.0F, 1000.0F};
        s.preferred = {-1000.0F, 1000.0F, -1000.0F};
        s.act = 10.0F;
        s.commands = kCommandsPerState;
        for (std::size_t i = 0; i < kCommandsPerState; ++i) {
            s.command_age_ms[i] = static_cast<std::uint16_t>(100 - i);
        }
    }));
    EXPECT_TRUE(takes_neighbour(6, [](StateNeighbour& s) { s.act = s.lag = 0.0F; }));
    const std::vector<std::function<void(StateNeighbour&)>> impossible{
        [](StateNeighbour& s) { s.position[2] = 100'001.0F; },
        [](StateNeighbour& s) { s.velocity[0] = -1000.1F; },
        [](StateNeighbour& s) { s.velocity[2] = kNan; },
        [](StateNeighbour& s) { s.preferred[1] = 1000.1F; },
        [](StateNeighbour& s) { s.radius_xy = kInfinity; },
        [](StateNeighbour& s) { s.radius_z = 0.0F; },
        [](StateNeighbour& s) { s.max_speed = kNan; },
        [](StateNeighbour& s) { s.max_acceleration = 0.0F; },
        [](StateNeighbour& s) { s.horizon = kInfinity; },
        [](StateNeighbour& s) { s.lag = -0.001F; },
        [](StateNeighbour& s) { s.act = 10.001F; },
        [](StateNeighbour& s) { s.act = kNan; },
        [](StateNeighbour& s) { s.commands = kCommandsPerState + 1; },
        [](StateNeighbour& s) {
            s.commands = 3;
            s.command_age_ms = {30, 20, 20};
        },
        [](StateNeighbour& s) {
            s.commands = 3;
            s.command_age_ms = {30, 20, 25};
        },
        [](StateNeighbour& s) {
            s.commands = 2;
            s.command_age_ms = {30, 20};
            s.command[5] = 1000.1F;
        },
        [](StateNeighbour& s) {
            s.commands = 2;
            s.command_age_ms = {30, 20};
            s.command[0] = kNan;
        },
    };
    for (std::size_t i = 0; i < impossible.size(); ++i) {
        EXPECT_FALSE(takes_neighbour(7, impossible[i])) << i;
        EXPECT_FALSE(knows(7)) << i;
    }
    EXPECT_TRUE(takes_neighbour(7, [](StateNeighbour& s) {
        s.commands = 1;
        s.command_age_ms = {30, 40};  // the second is none
        s.command[3] = kNan;
    }));
    EXPECT_TRUE(knows(7));
    EXPECT_FALSE(takes_neighbour(1, [](StateNeighbour&) {})) << "ourselves";
}

TEST_F(MissionEdges, EverythingThatANeighbourSaysIsKept)
{
    StateNeighbour s;
    s.age_ms = 100;
    s.position = {1, 2, 3};
    s.velocity = {4, 5, 6};
    s.preferred = {7, 8, 9};
    s.radius_xy = 1.1F;
    s.radius_z = 1.2F;
    s.max_speed = 1.3F;
    s.max_acceleration = 1.4F;
    s.horizon = 1.5F;
    s.act = 1.6F;
    s.lag = 1.7F;
    s.cooperative = 0;
    s.commands = 2;
    s.command_age_ms = {200, 150};
    s.command = {10, 11, 12, 13, 14, 15};
    line_.send(s, 77);
    ASSERT_EQ(protocol_.neighbours().size(), 1U);
    const MissionNeighbour& n = protocol_.neighbours()[0];
    EXPECT_EQ(n.heard.id, 77);
    EXPECT_EQ(n.heard.state.stamp.us, (line_.now - 0.01F).us - 100'000) << "its age, and the way";
    EXPECT_EQ(n.heard.state.position, Vec3(1, 2, 3));
    EXPECT_EQ(n.heard.state.velocity, Vec3(4, 5, 6));
    EXPECT_EQ(n.heard.preferred, Vec3(7, 8, 9));
    EXPECT_EQ(n.radius_xy, 1.1F);
    EXPECT_EQ(n.radius_z, 1.2F);
    EXPECT_EQ(n.heard.max_speed, 1.3F);
    EXPECT_EQ(n.heard.max_acceleration, 1.4F);
    EXPECT_EQ(n.horizon, 1.5F);
    EXPECT_EQ(n.heard.loop.act, 1.6F);
    EXPECT_EQ(n.heard.loop.lag, 1.7F);
    EXPECT_FALSE(n.cooperative);
    EXPECT_EQ(n.arrival, line_.now);
    ASSERT_EQ(n.heard.commands.size(), 2U);
    EXPECT_EQ(n.heard.commands[0].issued.us, (line_.now - 0.01F).us - 200'000);
    EXPECT_EQ(n.heard.commands[0].velocity, Vec3(10, 11, 12));
    EXPECT_EQ(n.heard.commands[1].velocity, Vec3(13, 14, 15));
    // Older, and of the same instant: what is known stays.
    s.position = {9, 9, 9};
    line_.send(s, 77);
    s.age_ms = 101;
    line_.send(s, 77);
    EXPECT_EQ(protocol_.diagnostics().older, 2U);
    EXPECT_EQ(protocol_.diagnostics().neighbour_states, 1U);
    EXPECT_EQ(protocol_.neighbours()[0].heard.state.position, Vec3(1, 2, 3));
    s.age_ms = 99;
    line_.send(s, 77);
    EXPECT_EQ(protocol_.neighbours()[0].heard.state.position, Vec3(9, 9, 9));
    EXPECT_EQ(protocol_.diagnostics().neighbour_states, 2U);
}

/// Farthest from the vehicle, not from the origin.
TEST_F(MissionEdges, WhoGivesWayIsTheFarthestFromTheVehicle)
{
    vehicle::VehicleState state = own();
    state.position = Vec3(1000, 0, 0);
    protocol_.take_own_state(state, line_.now);
    const auto add = [&](std::uint16_t id, float x) {
        EXPECT_TRUE(takes_neighbour(id, [&](StateNeighbour& s) { s.position = {x, 0, 0}; }));
    };
    for (std::uint16_t i = 0; i < MissionProtocol::kMostNeighbours; ++i) {
        // The farthest in the middle of them.
        add(static_cast<std::uint16_t>(100 + i), i == 30 ? 500.0F : 1000.0F + static_cast<float>(i));
    }
    EXPECT_FALSE(has(MissionFault::neighbour_dropped));
    add(900, 1600.0F);
    EXPECT_FALSE(knows(900)) << "600 m against 500 m";
    EXPECT_TRUE(knows(130));
    EXPECT_TRUE(has(MissionFault::neighbour_dropped));
    add(901, 600.0F);
    EXPECT_TRUE(knows(901)) << "400 m against 500 m";
    EXPECT_FALSE(knows(130));
    EXPECT_EQ(protocol_.diagnostics().neighbours_dropped, 2U);
    EXPECT_EQ(protocol_.diagnostics().neighbour_states, 66U);
    protocol_.forget(2);  // not known
    EXPECT_EQ(protocol_.neighbours().size(), MissionProtocol::kMostNeighbours);
    protocol_.forget(150);
    EXPECT_FALSE(knows(150));
    EXPECT_EQ(protocol_.neighbours().size(), MissionProtocol::kMostNeighbours - 1);
    EXPECT_FALSE(has(MissionFault::neighbour_dropped)) << "there is room again";
    add(150, 1001.0F);
    EXPECT_FALSE(!has(MissionFault::neighbour_dropped)) << "full, and some were dropped";
}

}  // namespace
}  // namespace jink::app::test
