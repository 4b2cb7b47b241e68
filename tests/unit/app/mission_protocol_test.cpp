// SPDX-License-Identifier: BSD-3-Clause
// Streams, reports and losses of the mission line (G-ORCA 16).
#include "tests/unit/app/mission_bench.hpp"

#include <limits>

#include <gtest/gtest.h>

namespace jink::app::test {
namespace {

class MissionProtocolTest : public ::testing::Test {
protected:
    const std::unique_ptr<Line> owned_ = std::make_unique<Line>();
    Line& line_ = *owned_;
    MissionProtocol& protocol_ = line_.protocol;
    [[nodiscard]] MissionInput input() const { return owned_->protocol.input(owned_->now); }
    [[nodiscard]] static bool has(std::uint16_t faults, MissionFault fault) { return (faults & bit(fault)) != 0; }
};

StateOwn own_at(float x)
{
    StateOwn state;
    state.age_ms = 20;
    state.position = {x, 0, 0};
    state.velocity = {1, 0, 0};
    return state;
}

/// No STATE_OWN for 0.2 s -> hold v = 0 and a status; its age counts from when it was measured.
TEST_F(MissionProtocolTest, HoldsWithoutAnOwnState)
{
    EXPECT_TRUE(input().hold);
    EXPECT_TRUE(has(input().faults, MissionFault::own_state_stale));
    line_.send(own_at(3.0F));
    EXPECT_FALSE(input().hold);
    EXPECT_EQ(input().own.position.x(), 3.0F);
    EXPECT_NEAR(static_cast<double>(line_.now.us - input().own.stamp.us), 30'000.0, 1.0) << "its age, and the way";
    line_.now = line_.now + 0.169F;
    EXPECT_FALSE(input().hold);
    line_.now = line_.now + 0.002F;
    EXPECT_TRUE(input().hold);
    EXPECT_EQ(input().preferred, Vec3::Zero());
}
/// No v_pref for 0.5 s -> 0 is preferred; avoidance goes on.
TEST_F(MissionProtocolTest, PrefersNothingWithoutAPreferredVelocity)
{
    const auto keep_own = [&] { line_.send(own_at(3.0F)); };
    keep_own();
    EXPECT_TRUE(has(input().faults, MissionFault::no_preferred));
    protocol_.take_preferred(Vec3(1, 2, 0), line_.now);
    EXPECT_EQ(input().preferred, Vec3(1, 2, 0));
    EXPECT_EQ(input().faults, 0U);
    line_.now = line_.now + 0.499F;
    keep_own();
    EXPECT_EQ(input().preferred, Vec3(1, 2, 0));
    line_.now = line_.now + 0.002F;
    keep_own();
    EXPECT_EQ(input().preferred, Vec3::Zero());
    EXPECT_FALSE(input().hold);
    EXPECT_TRUE(has(input().faults, MissionFault::no_preferred));
}
TEST_F(MissionProtocolTest, ThePreferredVelocityThatIsNoNumberWasNotSaid)
{
    line_.send(own_at(3.0F));
    protocol_.take_preferred(Vec3(std::numeric_limits<float>::quiet_NaN(), 0, 0), line_.now);
    EXPECT_EQ(input().preferred, Vec3::Zero());
    EXPECT_TRUE(has(input().faults, MissionFault::no_preferred));
}
TEST_F(MissionProtocolTest, TheNewestOwnStateWins)
{
    line_.send(own_at(3.0F));
    StateOwn older = own_at(2.0F);
    older.age_ms = 50;
    line_.send(older);
    EXPECT_EQ(input().own.position.x(), 3.0F);
    EXPECT_EQ(protocol_.diagnostics().older, 1U);
    StateOwn bad = own_at(4.0F);
    bad.age_ms = 0;
    bad.velocity[2] = std::numeric_limits<float>::infinity();
    line_.send(bad);
    EXPECT_EQ(input().own.position.x(), 3.0F);
    EXPECT_EQ(protocol_.diagnostics().refused, 1U);
    vehicle::VehicleState ahead;
    ahead.stamp = line_.now + 1.0F;
    protocol_.take_own_state(ahead, line_.now);
    EXPECT_EQ(protocol_.diagnostics().refused, 2U) << "it would be believed for too long";
}

TEST_F(MissionProtocolTest, NeighboursComeWithTheirCommands)
{
    StateNeighbour state;
    state.age_ms = 40;
    state.position = {5, 6, 7};
    state.velocity = {1, 0, 0};
    state.preferred = {0, 1, 0};
    state.act = 0.2F;
    state.commands = 2;
    state.command_age_ms[0] = 60;
    state.command_age_ms[1] = 30;
    state.command[3] = 0.5F;
    line_.send(state, 42);
    ASSERT_EQ(protocol_.neighbours().size(), 1U);
    const MissionNeighbour& n = protocol_.neighbours()[0];
    EXPECT_EQ(n.heard.id, 42);
    EXPECT_NEAR(static_cast<double>(line_.now.us - n.heard.state.stamp.us), 50'000.0, 1.0);
    EXPECT_EQ(n.heard.preferred, Vec3(0, 1, 0));
    ASSERT_EQ(n.heard.commands.size(), 2U);
    EXPECT_NEAR(static_cast<double>(line_.now.us - n.heard.commands[1].issued.us), 40'000.0, 1.0);
    EXPECT_EQ(n.heard.commands[1].velocity, Vec3(0.5F, 0, 0));
    EXPECT_TRUE(n.cooperative);
    state.position = {9, 6, 7};
    line_.send(state, 42);
    EXPECT_EQ(protocol_.neighbours()[0].heard.state.position.x(), 5.0F) << "of the same instant";
    line_.now = line_.now + 0.05F;
    line_.send(state, 42);
    EXPECT_EQ(protocol_.neighbours()[0].heard.state.position.x(), 9.0F);
    ASSERT_EQ(protocol_.neighbours().size(), 1U);
    protocol_.forget(42);
    EXPECT_TRUE(protocol_.neighbours().empty());
}
/// What a vehicle says of itself is what the others hear of it.
TEST_F(MissionProtocolTest, OurStateIsANeighboursOne)
{
    orca::Broadcast own;
    own.state.stamp = line_.now - 0.03F;
    own.state.position = Vec3(1, 2, 3);
    own.state.velocity = Vec3(-1, 0, 0.5F);
    own.loop = {0.2F, 0.1F};
    for (int i = 0; i < 8; ++i) {
        own.commands.unchecked_push_back(
            {line_.now - 0.025F * static_cast<float>(8 - i), Vec3(0.1F * static_cast<float>(i), 0, 0)});
    }
    protocol_.tell_state(own, 0.6F, 0.3F, 10.0F, line_.now);
    const Heard heard = line_.heard();
    ASSERT_EQ(heard.frames.size(), 1U);
    EXPECT_EQ(heard.frames[0].sender, 1);
    const auto other = std::make_unique<Line>();
    other->send(heard.all<StateNeighbour>()[0], 1);
    EXPECT_TRUE(other->protocol.neighbours().empty()) << "its own name";
    MissionProtocol second(2, 0.0F, other->generator, other->host);
    second.receive(frame_of(heard.all<StateNeighbour>()[0], 1), line_.now);
    ASSERT_EQ(second.neighbours().size(), 1U);
    const orca::Broadcast& there = second.neighbours()[0].heard;
    EXPECT_EQ(there.state.position, own.state.position);
    EXPECT_LE(there.state.stamp, own.state.stamp) << "never told younger";
    EXPECT_GE(there.state.stamp.us, own.state.stamp.us - 1000);
    ASSERT_EQ(there.commands.size(), 8U);
    EXPECT_EQ(there.commands[3].velocity, own.commands[3].velocity);
    const TimePoint at = line_.now + 0.2F;
    EXPECT_LT(
        (orca::predict_neighbour(there, at, {}, 50.0F).position - orca::predict_neighbour(own, at, {}, 50.0F).position)
            .norm(),
        5e-3F);
}
TEST_F(MissionProtocolTest, RefusesNeighboursThatCannotBe)
{
    const auto refuses = [&](auto change) {
        StateNeighbour state;
        change(state);
        const std::uint32_t before = protocol_.diagnostics().refused;
        line_.send(state, 9);
        return protocol_.neighbours().empty() && protocol_.diagnostics().refused == before + 1;
    };
    const float nan = std::numeric_limits<float>::quiet_NaN();
    EXPECT_TRUE(refuses([&](StateNeighbour& s) { s.position[0] = nan; }));
    EXPECT_TRUE(refuses([](StateNeighbour& s) { s.position[0] = 1e6F; }));
    EXPECT_TRUE(refuses([](StateNeighbour& s) { s.velocity[1] = 2000.0F; }));
    EXPECT_TRUE(refuses([&](StateNeighbour& s) { s.preferred[2] = nan; }));
    EXPECT_TRUE(refuses([](StateNeighbour& s) { s.radius_xy = 0.0F; }));
    EXPECT_TRUE(refuses([](StateNeighbour& s) { s.radius_z = -1.0F; }));
    EXPECT_TRUE(refuses([](StateNeighbour& s) { s.max_speed = 0.0F; }));
    EXPECT_TRUE(refuses([&](StateNeighbour& s) { s.max_acceleration = nan; }));
    EXPECT_TRUE(refuses([](StateNeighbour& s) { s.horizon = 0.0F; }));
    EXPECT_TRUE(refuses([](StateNeighbour& s) { s.act = -0.1F; }));
    EXPECT_TRUE(refuses([](StateNeighbour& s) { s.act = 11.0F; }));
    EXPECT_TRUE(refuses([&](StateNeighbour& s) { s.lag = nan; }));
    EXPECT_TRUE(refuses([](StateNeighbour& s) { s.commands = 9; }));
    EXPECT_TRUE(refuses([](StateNeighbour& s) { s.commands = 2; })) << "two at once";
    EXPECT_TRUE(refuses([&](StateNeighbour& s) {
        s.commands = 1;
        s.command[0] = nan;
    }));
    EXPECT_FALSE(refuses([](StateNeighbour& /*s*/) {}));
}
/// Section 18: 64 are tracked; the farthest gives way, and that is told.
TEST_F(MissionProtocolTest, TheFarthestNeighbourGivesWay)
{
    line_.send(own_at(0.0F));
    for (std::uint16_t id = 10; id < 10 + MissionProtocol::kMostNeighbours; ++id) {
        StateNeighbour state;
        state.position = {static_cast<float>(id), 0, 0};
        line_.send(state, id);
    }
    EXPECT_FALSE(has(input().faults, MissionFault::neighbour_dropped));
    StateNeighbour far;
    far.position = {500, 0, 0};
    line_.send(far, 900);
    StateNeighbour near;
    near.position = {5, 0, 0};
    line_.send(near, 901);
    EXPECT_TRUE(has(input().faults, MissionFault::neighbour_dropped));
    ASSERT_EQ(protocol_.neighbours().size(), MissionProtocol::kMostNeighbours);
    for (const MissionNeighbour& n : protocol_.neighbours()) {
        EXPECT_NE(n.heard.id, 900);
        EXPECT_NE(n.heard.id, 10 + MissionProtocol::kMostNeighbours - 1) << "the farthest of them";
    }
    EXPECT_EQ(protocol_.diagnostics().neighbours_dropped, 2U);
}

TEST_F(MissionProtocolTest, SettingsAreReadAndSet)
{
    const auto answer = [&](const Config& config) {
        line_.send(config);
        const auto acks = line_.step().all<ConfigAck>();
        return acks.size() == 1 ? acks[0] : ConfigAck{0, 255, -1.0F};
    };
    EXPECT_EQ(answer({7, 0, 0.0F}).value, 1.5F);
    const ConfigAck set = answer({7, 1, 20.0F});
    EXPECT_EQ(set.key, 7);
    EXPECT_EQ(set.status, static_cast<std::uint8_t>(ConfigStatus::ok));
    EXPECT_EQ(set.value, 20.0F);
    const ConfigAck refused = answer({7, 1, 1000.0F});
    EXPECT_EQ(refused.status, static_cast<std::uint8_t>(ConfigStatus::out_of_range));
    EXPECT_EQ(refused.value, 20.0F) << "what is in force";
    const ConfigAck nan = answer({7, 1, std::numeric_limits<float>::quiet_NaN()});
    EXPECT_EQ(nan.status, static_cast<std::uint8_t>(ConfigStatus::out_of_range));
    EXPECT_EQ(nan.value, 20.0F);
    EXPECT_EQ(answer({8, 1, 1.0F}).status, static_cast<std::uint8_t>(ConfigStatus::unknown_key));
    EXPECT_EQ(answer({8, 1, 1.0F}).value, 0.0F);
    EXPECT_EQ(line_.host.setting, 20.0F);
}
TEST_F(MissionProtocolTest, TellsOfItsMap)
{
    line_.send(MapInfo{});
    const auto infos = line_.step().all<MapInfo>();
    ASSERT_EQ(infos.size(), 1U);
    EXPECT_EQ(infos[0].crc, 0x12345678U);
    EXPECT_EQ(infos[0].pieces, 99);
}

/// MISSION_REPORT: on a change, and every second.
TEST_F(MissionProtocolTest, ReportsProgress)
{
    const auto told = [&](path::GeneratorStatus status, float dt) {
        line_.now = line_.now + dt;
        path::GeneratorOutput output;
        output.status = status;
        output.left = 12.5F;
        protocol_.tell_progress(output, line_.now);
        return line_.heard().all<MissionReport>();
    };
    const auto first = told(path::GeneratorStatus::idle, 0.0F);
    ASSERT_EQ(first.size(), 1U);
    EXPECT_EQ(first[0].left, 12.5F);
    EXPECT_EQ(told(path::GeneratorStatus::idle, 0.5F).size(), 0U);
    EXPECT_EQ(told(path::GeneratorStatus::idle, 0.51F).size(), 1U);
    const auto changed = told(path::GeneratorStatus::path_lost, 0.01F);
    ASSERT_EQ(changed.size(), 1U);
    EXPECT_EQ(changed[0].status, static_cast<std::uint8_t>(path::GeneratorStatus::path_lost));
    EXPECT_EQ(changed[0].faults, bit(MissionFault::own_state_stale) | bit(MissionFault::no_preferred));
    line_.send(own_at(1.0F));
    EXPECT_EQ(told(path::GeneratorStatus::path_lost, 0.01F).size(), 1U) << "other faults";
}

/// MONITOR_TRIP: every second until the trip that was told is acknowledged.
TEST_F(MissionProtocolTest, RepeatsATripUntilItIsAcknowledged)
{
    const std::vector<orca::MonitoredVehicle> close{{3, Vec3(0.1F, 0, 0)}};
    const auto told = [&](float dt, bool still) {
        line_.now = line_.now + dt;
        line_.host.monitor.update(line_.now, Vec3::Zero(), still ? close : std::vector<orca::MonitoredVehicle>{}, {});
        protocol_.tell_monitor(line_.host.monitor, line_.now);
        return line_.step(0.0F).all<MonitorTrip>();
    };
    EXPECT_EQ(told(0.1F, true).size(), 0U);
    const auto first = told(0.1F, true);
    ASSERT_EQ(first.size(), 1U);
    EXPECT_EQ(first[0].id, 3);
    EXPECT_EQ(first[0].trip, 1);
    EXPECT_TRUE(has(input().faults, MissionFault::tripped));
    EXPECT_EQ(told(0.5F, false).size(), 0U);
    const auto again = told(0.6F, false);
    ASSERT_EQ(again.size(), 1U);
    EXPECT_NEAR(static_cast<float>(again[0].age_ms), 1100.0F, 2.0F);
    line_.send(TripAck{7});
    EXPECT_EQ(told(0.1F, false).size(), 0U);
    EXPECT_EQ(line_.host.acknowledged, 0) << "another trip's number";
    line_.send(TripAck{1});
    told(0.1F, false);
    EXPECT_EQ(line_.host.acknowledged, 1);
    EXPECT_FALSE(has(input().faults, MissionFault::tripped));
    EXPECT_EQ(told(2.0F, false).size(), 0U);
    told(0.1F, true);
    EXPECT_EQ(told(0.1F, true).size(), 1U) << "the next one";
}

/// On a line that takes nothing, the newest of each stream waits, and answers up to kMostAnswers; then they are
/// counted.
TEST_F(MissionProtocolTest, AStalledLineKeepsTheNewest)
{
    for (int i = 0; i < 50; ++i) {
        protocol_.tell_command(Vec3(static_cast<float>(i), 0, 0), 0, 0);
        orca::Broadcast own;
        own.state.position.x() = static_cast<float>(i);
        protocol_.tell_state(own, 0.6F, 0.3F, 10.0F, line_.now);
        line_.send(MapInfo{});
        protocol_.step(line_.now);
    }
    const Heard heard = line_.heard();
    const auto commands = heard.all<CommandSent>();
    ASSERT_EQ(commands.size(), 1U);
    EXPECT_EQ(commands[0].velocity[0], 49.0F);
    ASSERT_EQ(heard.all<StateNeighbour>().size(), 1U);
    EXPECT_EQ(heard.all<StateNeighbour>()[0].position[0], 49.0F);
    EXPECT_EQ(heard.all<MapInfo>().size(), MissionProtocol::kMostAnswers);
    EXPECT_EQ(protocol_.diagnostics().answers_dropped, 50 - MissionProtocol::kMostAnswers);
}
/// On a line that takes one frame per tick, both streams get their turn.
TEST_F(MissionProtocolTest, StreamsTakeTurns)
{
    int commands = 0;
    for (int i = 0; i < 20; ++i) {
        protocol_.tell_command(Vec3::Zero(), 0, 0);
        protocol_.tell_state({}, 0.6F, 0.3F, 10.0F, line_.now);
        const auto bytes = protocol_.pending();
        commands += bytes.size() == frame_size(size_of(CommandSent::kFields)) ? 1 : 0;
        protocol_.consume(bytes.size());
    }
    EXPECT_EQ(commands, 10);
}
TEST_F(MissionProtocolTest, APartlySentFrameStays)
{
    protocol_.tell_command(Vec3(1, 0, 0), 0, 0);
    const Bytes whole(protocol_.pending().begin(), protocol_.pending().end());
    protocol_.consume(5);
    protocol_.tell_command(Vec3(2, 0, 0), 0, 0);
    const Bytes rest(protocol_.pending().begin(), protocol_.pending().end());
    EXPECT_EQ(rest, Bytes(whole.begin() + 5, whole.end()));
    protocol_.discard_pending();
    EXPECT_TRUE(protocol_.pending().empty());
}
TEST_F(MissionProtocolTest, WhatOnlyGoesOutIsNotTakenIn)
{
    line_.send(TaskAck{});
    line_.send(CommandSent{});
    line_.send(MissionReport{});
    line_.send(MonitorTrip{});
    line_.send(ConfigAck{});
    EXPECT_EQ(protocol_.diagnostics().unexpected, 5U);
    EXPECT_TRUE(line_.step().frames.empty());
}

}  // namespace
}  // namespace jink::app::test
