// SPDX-License-Identifier: BSD-3-Clause
// What the mission line tells: answers, states, reports, their order and when they come again.
#include <gtest/gtest.h>

#include "tests/numbers.hpp"
#include "tests/unit/app/mission_edges.hpp"

namespace jink::app::test {
namespace {

TEST_F(MissionEdges, AFullQueueRefusesEachKindInItsWay)
{
    for (std::size_t i = 0; i < MissionProtocol::kMostEvents; ++i) {
        line_.send(MapInfo{});
    }
    line_.send(Config{7, 1, 50.0F});
    line_.send(TripAck{1});
    line_.send(MapInfo{});
    TaskUpload part = parts_of(5, line(30))[2];
    line_.send(part);
    const Heard refused = line_.heard();
    ASSERT_EQ(refused.frames.size(), 2U) << "a question and an acknowledgement come again anyway";
    const ConfigAck config = refused.all<ConfigAck>()[0];
    EXPECT_EQ(config.key, 7);
    EXPECT_EQ(config.status, static_cast<std::uint8_t>(ConfigStatus::queue_full));
    EXPECT_EQ(config.value, 0.0F);
    const TaskAck task = refused.all<TaskAck>()[0];
    EXPECT_EQ(task.task, 5U);
    EXPECT_EQ(task.next, 2U);
    EXPECT_EQ(static_cast<TaskStatus>(task.status), TaskStatus::queue_full);
    EXPECT_EQ(protocol_.diagnostics().events, 8U);
    EXPECT_EQ(protocol_.diagnostics().events_refused, 4U);
    EXPECT_EQ(line_.step().all<MapInfo>().size(), 4U);
    EXPECT_EQ(line_.step().all<MapInfo>().size(), 4U);
    EXPECT_TRUE(line_.step().frames.empty());
    EXPECT_EQ(line_.host.setting, 1.5F);
}

TEST_F(MissionEdges, EventsAreAnsweredInTheirOrder)
{
    line_.send(Config{7, 1, 10.0F});
    line_.send(Config{7, 1, 20.0F});
    line_.send(Config{7, 0, kNan});  // a question: its value says nothing
    const auto acks = line_.step().all<ConfigAck>();
    ASSERT_EQ(acks.size(), 3U);
    EXPECT_EQ(acks[0].value, 10.0F);
    EXPECT_EQ(acks[1].value, 20.0F);
    EXPECT_EQ(acks[2].value, 20.0F);
    EXPECT_EQ(acks[2].status, static_cast<std::uint8_t>(ConfigStatus::ok));
    line_.send(Config{7, 0, 90.0F});
    EXPECT_EQ(line_.step().all<ConfigAck>()[0].value, 20.0F) << "read, not set";
    line_.send(Config{7, 1, kInfinity});
    line_.send(Config{8, 1, kInfinity});
    const auto bad = line_.step().all<ConfigAck>();
    ASSERT_EQ(bad.size(), 2U);
    EXPECT_EQ(bad[0].status, static_cast<std::uint8_t>(ConfigStatus::out_of_range));
    EXPECT_EQ(bad[0].value, 20.0F);
    EXPECT_EQ(bad[1].value, 0.0F);
    EXPECT_EQ(line_.host.setting, 20.0F);
}

TEST_F(MissionEdges, OurAgesAreRoundedUpAndNeverTurnOver)
{
    orca::Broadcast mine;
    const auto told = [&](std::int64_t age_us) {
        mine.state.stamp = {line_.now.us - age_us};
        protocol_.tell_state(mine, 0.6F, 0.3F, 10.0F, line_.now);
        return line_.heard().all<StateNeighbour>()[0];
    };
    EXPECT_EQ(told(0).age_ms, 0);
    EXPECT_EQ(told(1).age_ms, 1);
    EXPECT_EQ(told(1000).age_ms, 1);
    EXPECT_EQ(told(1001).age_ms, 2);
    EXPECT_EQ(told(-5000).age_ms, 0) << "a stamp ahead of us";
    EXPECT_EQ(told(65'535'000).age_ms, 65535);
    EXPECT_EQ(told(65'536'000).age_ms, 65535);
    EXPECT_EQ(told(200'000'000).age_ms, 65535);
    mine.commands.unchecked_push_back({{line_.now.us - 70'000'000}, Vec3(1, 0, 0)});
    mine.commands.unchecked_push_back({{line_.now.us - 66'000'000}, Vec3(2, 0, 0)});
    mine.commands.unchecked_push_back({{line_.now.us - 5'000}, Vec3(3, 0, 0)});
    mine.commands.unchecked_push_back({{line_.now.us - 4'500}, Vec3(4, 0, 0)});
    mine.commands.unchecked_push_back({{line_.now.us - 4'000}, Vec3(5, 6, 7)});
    const StateNeighbour s = told(0);
    ASSERT_EQ(s.commands, 3);
    EXPECT_EQ(s.command_age_ms[0], 65535);
    EXPECT_EQ(s.command_age_ms[1], 5);
    EXPECT_EQ(s.command[3], 3.0F) << "the first of a millisecond";
    EXPECT_EQ(s.command_age_ms[2], 4);
    EXPECT_EQ(s.command[6], 5.0F);
    EXPECT_EQ(s.command[8], 7.0F);
}

TEST_F(MissionEdges, AllThatWeSayOfOurselvesGoesOut)
{
    orca::Broadcast mine;
    mine.state.stamp = line_.now;
    mine.state.position = Vec3(1, 2, 3);
    mine.state.velocity = Vec3(4, 5, 6);
    mine.preferred = Vec3(7, 8, 9);
    mine.max_speed = 1.3F;
    mine.max_acceleration = 1.4F;
    mine.loop = {1.6F, 1.7F};
    protocol_.tell_state(mine, 1.1F, 1.2F, 1.5F, line_.now);
    protocol_.tell_command(Vec3(10, 11, 12), 0xABCD, 3);
    const Heard heard = line_.heard();
    ASSERT_EQ(heard.frames.size(), 2U);
    EXPECT_EQ(heard.frames[1].sequence, heard.frames[0].sequence + 1);
    const StateNeighbour s = heard.all<StateNeighbour>()[0];
    EXPECT_EQ(s.position, (std::array<float, 3>{1, 2, 3}));
    EXPECT_EQ(s.velocity, (std::array<float, 3>{4, 5, 6}));
    EXPECT_EQ(s.preferred, (std::array<float, 3>{7, 8, 9}));
    EXPECT_EQ(s.radius_xy, 1.1F);
    EXPECT_EQ(s.radius_z, 1.2F);
    EXPECT_EQ(s.max_speed, 1.3F);
    EXPECT_EQ(s.max_acceleration, 1.4F);
    EXPECT_EQ(s.horizon, 1.5F);
    EXPECT_EQ(s.act, 1.6F);
    EXPECT_EQ(s.lag, 1.7F);
    const CommandSent c = heard.all<CommandSent>()[0];
    EXPECT_EQ(c.velocity, (std::array<float, 3>{10, 11, 12}));
    EXPECT_EQ(c.status, 0xABCDU);
    EXPECT_EQ(c.level, 3);
    EXPECT_TRUE(line_.heard().frames.empty()) << "told once";
}

TEST_F(MissionEdges, ProgressIsToldOnEachChangeAndOnceASecond)
{
    path::GeneratorOutput output;
    output.status = path::GeneratorStatus::tracking;
    output.left = 12.5F;
    output.error = 0.25F;
    const auto told = [&](std::int64_t us) {
        line_.now.us += us;
        protocol_.tell_progress(output, line_.now);
        return line_.heard().all<MissionReport>();
    };
    ASSERT_TRUE(takes_neighbour(50, [](StateNeighbour&) {}));
    const auto first = told(0);
    ASSERT_EQ(first.size(), 1U);
    EXPECT_EQ(first[0].error, 0.25F);
    EXPECT_EQ(first[0].left, 12.5F);
    EXPECT_EQ(first[0].status, static_cast<std::uint8_t>(path::GeneratorStatus::tracking));
    EXPECT_EQ(first[0].neighbours, 1);
    EXPECT_EQ(first[0].task, 0U);
    EXPECT_TRUE(told(999'999).empty());
    EXPECT_EQ(told(1).size(), 1U) << "a second to the microsecond";
    EXPECT_TRUE(told(999'999).empty());
    ASSERT_EQ(line_.upload(parts_of(5, line(3))), TaskStatus::accepted);
    const auto task = told(0);
    ASSERT_EQ(task.size(), 1U) << "another task";
    EXPECT_EQ(task[0].task, 5U);
    EXPECT_TRUE(told(10'000).empty());
    output.status = path::GeneratorStatus::idle;
    EXPECT_EQ(told(10'000).size(), 1U);
    EXPECT_TRUE(told(10'000).empty());
    protocol_.take_preferred(Vec3(1, 0, 0), line_.now);
    const auto faults = told(10'000);
    ASSERT_EQ(faults.size(), 1U) << "other faults";
    EXPECT_EQ(faults[0].faults, bit(MissionFault::own_state_stale));
}

TEST_F(MissionEdges, ATripIsToldAtOnceAndOnceASecond)
{
    const auto watch = [&](std::uint16_t id, int times) {
        const std::vector<orca::MonitoredVehicle> close{{id, Vec3(0.1F, 0, 0.2F)}};
        for (int i = 0; i < times; ++i) {
            line_.now.us += 1000;
            line_.host.monitor.update(line_.now, Vec3::Zero(), close, {});
        }
    };
    const auto told = [&](std::int64_t us) {
        line_.now.us += us;
        protocol_.tell_monitor(line_.host.monitor, line_.now);
        return line_.step(0.0F).all<MonitorTrip>();
    };
    EXPECT_TRUE(told(0).empty());
    EXPECT_FALSE(has(MissionFault::tripped));
    watch(3, 2);
    const auto first = told(1500);
    ASSERT_EQ(first.size(), 1U);
    EXPECT_EQ(first[0].age_ms, 2U) << "rounded up";
    EXPECT_EQ(first[0].trip, 1);
    EXPECT_EQ(first[0].subject, static_cast<std::uint8_t>(orca::Subject::vehicle));
    EXPECT_EQ(first[0].id, 3);
    EXPECT_NEAR(first[0].horizontal, 0.1F, 1e-6F);
    EXPECT_NEAR(first[0].vertical, 0.2F, 1e-6F);
    EXPECT_TRUE(told(999'999).empty());
    EXPECT_EQ(told(1).size(), 1U) << "a second to the microsecond";
    // Acknowledged elsewhere and tripped again between two tellings: another number, told at once.
    line_.host.monitor.acknowledge();
    watch(4, 2);
    const auto second = told(1000);
    ASSERT_EQ(second.size(), 1U);
    EXPECT_EQ(second[0].trip, 2);
    EXPECT_EQ(second[0].id, 4);
    line_.send(TripAck{1});
    static_cast<void>(told(1000));
    EXPECT_EQ(line_.host.acknowledged, 0) << "the one before";
    line_.send(TripAck{2});
    static_cast<void>(told(1000));
    EXPECT_EQ(line_.host.acknowledged, 1);
    line_.send(TripAck{2});
    static_cast<void>(told(1000));
    EXPECT_EQ(line_.host.acknowledged, 1) << "there is nothing to acknowledge";
}

TEST_F(MissionEdges, AnswersGoBeforeStreamsAndTheStreamsTakeTurns)
{
    const auto next = [&] {
        Heard heard;
        Receiver receiver;
        const Bytes bytes(protocol_.pending().begin(), protocol_.pending().end());
        receiver.receive(bytes, line_.now, heard);
        protocol_.consume(bytes.size());
        return heard.frames.size() == 1 ? heard.frames[0].type : MessageType::trip_ack;
    };
    const auto tell = [&] {
        protocol_.tell_command(Vec3::Zero(), 0, 0);
        protocol_.tell_state({}, 0.6F, 0.3F, 10.0F, line_.now);
    };
    tell();
    line_.send(MapInfo{});
    protocol_.step(line_.now);
    EXPECT_EQ(next(), MessageType::map_info);
    EXPECT_EQ(next(), MessageType::state_neighbour);
    tell();
    EXPECT_EQ(next(), MessageType::command);
    tell();
    EXPECT_EQ(next(), MessageType::state_neighbour);
    EXPECT_EQ(next(), MessageType::command);
    EXPECT_TRUE(protocol_.pending().empty());
    // The command's turn, but there is none.
    protocol_.tell_state({}, 0.6F, 0.3F, 10.0F, line_.now);
    EXPECT_EQ(next(), MessageType::state_neighbour);
    protocol_.tell_state({}, 0.6F, 0.3F, 10.0F, line_.now);
    EXPECT_EQ(next(), MessageType::state_neighbour);
}

TEST_F(MissionEdges, ALostLineForgetsEverythingThatWaits)
{
    protocol_.tell_command(Vec3::Zero(), 0, 0);
    protocol_.consume(protocol_.pending().size() - 1);
    EXPECT_EQ(protocol_.pending().size(), 1U);
    protocol_.consume(100);
    EXPECT_TRUE(protocol_.pending().empty()) << "more than there is takes all";
    protocol_.tell_command(Vec3::Zero(), 0, 0);
    static_cast<void>(protocol_.pending());
    protocol_.consume(3);
    protocol_.tell_command(Vec3::Zero(), 0, 0);
    protocol_.tell_state({}, 0.6F, 0.3F, 10.0F, line_.now);
    line_.send(MapInfo{});
    protocol_.step(line_.now);
    protocol_.discard_pending();
    EXPECT_TRUE(protocol_.pending().empty());
    protocol_.tell_command(Vec3(1, 2, 3), 0, 0);
    const Heard after = line_.heard();
    ASSERT_EQ(after.frames.size(), 1U) << "whole, not the rest of another";
    EXPECT_EQ(after.all<CommandSent>()[0].velocity[2], 3.0F);
}

}  // namespace
}  // namespace jink::app::test
