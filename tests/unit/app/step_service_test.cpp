// SPDX-License-Identifier: BSD-3-Clause
// Faults, the line, parameters, commands and closed areas in Coprocessor::step.
#include <gtest/gtest.h>

#include "tests/unit/app/step_bench.hpp"

namespace jink::app::test {
namespace {

using Bus = StepBench::Bus;

TEST(StepFault, EachHasItsBitAndIsCritical)
{
    StepBench b({}, Bus::there);
    b.fly(2);
    ASSERT_EQ(b.last.faults, 0U);
    ASSERT_EQ(b.last.state, link::SystemState::active);
    b.port.state = hal::PortState::lost;
    b.fly(1);
    EXPECT_EQ(b.last.faults, bit(Fault::port_lost));
    EXPECT_EQ(b.last.state, link::SystemState::critical);
    b.port.state = hal::PortState::closed;
    b.fly(1);
    EXPECT_EQ(b.last.faults, bit(Fault::port_lost));
    b.port.state = hal::PortState::open;
    b.bus.lost = true;
    b.fly(1);
    EXPECT_EQ(b.last.faults, bit(Fault::bus_lost));
    EXPECT_EQ(b.last.state, link::SystemState::critical);
    b.bus.lost = false;
    b.coprocessor.stay_passive();
    b.fly(1);
    EXPECT_EQ(b.last.faults, bit(Fault::passive));
    EXPECT_EQ(b.last.state, link::SystemState::critical);
    EXPECT_EQ(b.counted().faults, 1U) << "times that it became CRITICAL";
}

TEST(StepFault, ALateStepCountsFromTwoTicksAndIsOneFromHalfASecond)
{
    StepBench b;
    b.fly(1);
    const auto after = [&](std::int64_t us) {
        b.coming_us = us;
        b.hear_autopilot();
        b.hear_own();
        b.step(us);
        return b.last.deadline_missed;
    };
    EXPECT_FALSE(after(40'000)) << "two ticks";
    EXPECT_TRUE(after(40'001));
    EXPECT_EQ(b.counted().deadlines_missed, 1U);
    EXPECT_TRUE(after(500'000));
    EXPECT_EQ(b.last.faults, 0U);
    const std::uint64_t fed = b.watchdog.feeds();
    EXPECT_TRUE(after(500'001));
    EXPECT_EQ(b.last.faults, bit(Fault::late));
    EXPECT_EQ(b.watchdog.feeds(), fed);
    EXPECT_EQ(b.counted().deadlines_missed, 3U);
    EXPECT_EQ(b.counted().steps, 5U);
    EXPECT_FALSE(after(20'000));
    EXPECT_EQ(b.watchdog.feeds(), fed + 1);
}

TEST(StepFault, TheFirstStepIsNeverLate)
{
    StepBench b;
    b.hear_autopilot();
    b.step();
    EXPECT_FALSE(b.last.deadline_missed);
    EXPECT_FALSE(b.has(Fault::late));
}

TEST(StepFault, PassiveItPlansNothing)
{
    StepBench b({{Param::mode, 1.0F}});
    b.hear_mast(1, b.position + Vec3(0.0F, 30.0F, 0.0F));
    b.fly(1);
    ASSERT_TRUE(b.last.guidance.conflict.has_value());
    b.coprocessor.stay_passive();
    b.fly(1);
    EXPECT_FALSE(b.last.guidance.conflict.has_value());
    EXPECT_EQ(b.last.work, 0U);
}

TEST(StepLine, TakesWhatThePortTakesInTwoParts)
{
    StepBench b;
    b.wire.waiting.resize(100);
    b.port.arriving = 17;
    b.fly(1);
    EXPECT_EQ(b.last.bytes_in, 17U);
    EXPECT_EQ(b.wire.bytes_in, 17U);
    EXPECT_EQ(b.last.bytes_out, 100U);
    EXPECT_EQ(b.port.writes, 1) << "nothing is left for a second part";
    b.wire.waiting.resize(100);
    b.port.room = 40;
    b.fly(1);
    EXPECT_EQ(b.last.bytes_out, 40U);
    EXPECT_EQ(b.wire.waiting.size(), 60U);
    EXPECT_EQ(b.port.writes, 3);
    b.fly(1);
    EXPECT_EQ(b.last.bytes_out, 0U);
    EXPECT_EQ(b.port.writes, 4) << "a port that takes nothing is not asked again in the step";
    EXPECT_EQ(b.wire.waiting.size(), 60U) << "an open line keeps what waits";
    b.port.room = 1000;
    b.port.most = 25;
    b.fly(1);
    EXPECT_EQ(b.last.bytes_out, 50U) << "two parts";
    EXPECT_EQ(b.wire.waiting.size(), 10U);
    b.port.state = hal::PortState::lost;
    b.fly(1);
    EXPECT_EQ(b.last.bytes_out, 0U);
    EXPECT_TRUE(b.wire.waiting.empty()) << "what was true then does not go out later";
    EXPECT_EQ(b.port.writes, 6);
}

link::ParamRequest& ask(StepBench& b, link::ParamRequestKind kind, std::string_view name = {})
{
    b.wire.in.params.unchecked_push_back({});
    link::ParamRequest& r = b.wire.in.params.back();
    r.kind = kind;
    std::copy(name.begin(), name.end(), r.name.begin());
    return r;
}

TEST(StepParams, AreReadByNameAndIndex)
{
    using Kind = link::ParamRequestKind;
    StepBench b({{Param::lookahead, 9.0F}});
    static_cast<void>(ask(b, Kind::read_by_name, "JNK_LOOKAHEAD"));
    ask(b, Kind::read_by_index).index = 0;
    ask(b, Kind::read_by_index).index = static_cast<std::int16_t>(kParamCount - 1);
    ask(b, Kind::read_by_index).index = static_cast<std::int16_t>(kParamCount);
    ask(b, Kind::read_by_index).index = -1;
    static_cast<void>(ask(b, Kind::read_by_name, "JNK_LOOKAHEA"));
    b.step();
    ASSERT_EQ(b.wire.params.size(), 3U);
    EXPECT_EQ(b.wire.params[0].name, "JNK_LOOKAHEAD");
    EXPECT_EQ(b.wire.params[0].value, 9.0F);
    EXPECT_EQ(b.wire.params[0].index, 1U);
    EXPECT_EQ(b.wire.params[0].count, kParamCount);
    EXPECT_EQ(b.wire.params[1].name, param_table()[0].name);
    EXPECT_EQ(b.wire.params[2].name, param_table()[kParamCount - 1].name);
    EXPECT_EQ(b.counted().params_unknown, 3U);
    EXPECT_EQ(b.counted().params_set + b.counted().params_refused, 0U);
}

TEST(StepParams, ASetIsInForceInTheStepAndARefusedOneAnsweredWithWhatStands)
{
    using Kind = link::ParamRequestKind;
    StepBench b;
    EXPECT_EQ(b.wire.rates, true) << "from the start";
    const auto set = [&](std::string_view name, float value, bool finite = true) {
        link::ParamRequest& r = ask(b, Kind::set, name);
        r.value = value;
        r.value_finite = finite;
        b.step();
        return b.wire.params.empty() ? -1.0F : b.wire.params.back().value;
    };
    EXPECT_EQ(set("JNK_LOOKAHEAD", 12.0F), 12.0F);
    EXPECT_EQ(b.coprocessor.parameters().configuration().rules.lookahead, 12.0F);
    EXPECT_EQ(set("JNK_LOOKAHEAD", 61.0F), 12.0F);
    EXPECT_EQ(set("JNK_LOOKAHEAD", 3.0F, false), 12.0F) << "what the sender did not send as a number";
    EXPECT_EQ(b.counted().params_set, 1U);
    EXPECT_EQ(b.counted().params_refused, 2U);
    EXPECT_EQ(b.coprocessor.parameters().configuration().rules.lookahead, 12.0F);
    EXPECT_EQ(set("JNK_ASK_RATES", 0.0F), 0.0F);
    EXPECT_EQ(b.wire.rates, false);
    const std::size_t answers = b.wire.params.size();
    EXPECT_EQ(set("JNK_NOTHING", 1.0F), 0.0F);
    EXPECT_EQ(b.wire.params.size(), answers) << "an unknown one is not answered";
    EXPECT_EQ(b.counted().params_unknown, 1U);
    EXPECT_EQ(set("TRK_AGE", 1.1F), 1.1F);
    b.hear_track(1, Vec3(100.0F, 0.0F, 50.0F));
    b.fly(1);
    b.fly(60);
    EXPECT_EQ(b.last.tracks, 0U) << "the table knows of it";
}

TEST(StepParams, AListGoesOutAFewAtATimeAndWhole)
{
    StepBench b;
    static_cast<void>(ask(b, link::ParamRequestKind::list));
    std::size_t steps = 0;
    for (std::size_t before = 1; before != b.wire.params.size(); ++steps) {
        before = b.wire.params.size();
        b.step();
        EXPECT_LE(b.wire.params.size() - before, 3U);
    }
    ASSERT_EQ(b.wire.params.size(), kParamCount);
    EXPECT_EQ(steps, (kParamCount + 2) / 3 + 1);
    for (std::size_t i = 0; i < kParamCount; ++i) {
        EXPECT_EQ(b.wire.params[i].index, i);
        EXPECT_EQ(b.wire.params[i].name, param_table()[i].name);
        EXPECT_EQ(b.wire.params[i].value, param_table()[i].initial);
    }
    b.wire.params.clear();
    static_cast<void>(ask(b, link::ParamRequestKind::list));
    b.step();
    static_cast<void>(ask(b, link::ParamRequestKind::list));
    b.step();
    ASSERT_EQ(b.wire.params.size(), 6U);
    EXPECT_EQ(b.wire.params[3].index, 0U) << "asked again, it begins again";
    static_cast<void>(ask(b, link::ParamRequestKind::read_by_name, "JNK_MODE"));
    b.step();
    EXPECT_EQ(b.wire.params.size(), 10U) << "other requests do not wait for the list";
}

TEST(StepCommands, OnlyTheHeartbeatIsSentOnRequest)
{
    StepBench b;
    b.fly(10);
    const std::size_t beats = b.wire.heartbeats.size();
    const auto command = [&](std::uint16_t number, float first) {
        b.wire.in.commands.unchecked_push_back({});
        b.wire.in.commands.back().command = number;
        b.wire.in.commands.back().params[0] = first;
        b.fly(1);
        EXPECT_EQ(b.wire.commands.back().first, number);
        return b.wire.commands.back().second;
    };
    EXPECT_EQ(command(512, 1.0F), link::CommandResult::denied);
    EXPECT_EQ(command(511, 0.0F), link::CommandResult::unsupported);
    EXPECT_EQ(b.wire.heartbeats.size(), beats);
    EXPECT_EQ(command(512, 0.0F), link::CommandResult::accepted);
    EXPECT_EQ(b.wire.heartbeats.size(), beats + 1);
    b.fly(1);
    EXPECT_EQ(b.wire.heartbeats.size(), beats + 1);
    EXPECT_EQ(command(512, 7.0F), link::CommandResult::denied);
    EXPECT_EQ(b.wire.heartbeats.size(), beats + 1);
    EXPECT_EQ(b.counted().commands, 4U);
    EXPECT_EQ(b.counted().commands_refused, 3U);
}

link::Constraint area_at(float north, std::optional<link::GlobalPosition> about = {})
{
    link::Constraint c;
    c.cylinder.circle = {{0.0F, north}, 5.0F};
    c.cylinder.bottom = 0.0F;
    c.cylinder.top = 100.0F;
    c.about = about;
    return c;
}

TEST(StepConstraints, AClosedAreaCountsFromTheStepInWhichItIsReported)
{
    StepBench b({{Param::mode, 1.0F}, {Param::k_sigma, 0.0F}, {Param::lookahead, 20.0F}});
    b.fly(1);
    b.wire.in.constraints.unchecked_push_back({area_at(b.position.y() + 40.0F), 1, 0, 1, 9, 9});
    b.fly(1);
    ASSERT_EQ(b.wire.constraints.size(), 1U);
    EXPECT_EQ(b.wire.constraints[0], link::ConstraintResult::in_force);
    EXPECT_EQ(b.last.cylinders, 1U);
    ASSERT_TRUE(b.last.guidance.conflict.has_value());
    EXPECT_EQ(b.last.guidance.conflict->threat.kind, world::ThreatKind::cylinder);
    EXPECT_NEAR(b.last.guidance.conflict->time_to_loss, (40.0F - 5.0F - 1.0F) / 5.0F, 0.02F);
    b.wire.in.constraints.unchecked_push_back({{}, 2, 0, 0, 9, 9});
    b.fly(1);
    EXPECT_EQ(b.wire.constraints.back(), link::ConstraintResult::in_force) << "an empty set opens all";
    EXPECT_EQ(b.last.cylinders, 0U);
}

TEST(StepConstraints, WithoutAnOriginAnAreaOnTheGlobeIsAFault)
{
    StepBench b;
    const std::array<Constraint, 1> areas{area_at(0.0F, link::GlobalPosition{473977420, 85455940, 488000})};
    b.coprocessor.set_constraints(areas, b.now);
    b.hear_own();
    b.step();
    EXPECT_FALSE(b.has(Fault::airspace_unplaced)) << "no autopilot, nothing to steer";
    b.fly(1);
    EXPECT_EQ(b.last.faults, bit(Fault::airspace_unplaced));
    EXPECT_EQ(b.last.state, link::SystemState::boot) << "waits for it";
    EXPECT_EQ(b.last.cylinders, 0U);
    b.wire.where = link::GlobalPosition{473977420, 85455940, 488000};
    b.fly(1);
    EXPECT_EQ(b.last.faults, 0U);
    EXPECT_EQ(b.last.cylinders, 1U);
}

TEST(StepConstraints, InABussOwnFrameThereAreNone)
{
    StepBench b({}, Bus::there);
    const std::array<Constraint, 1> areas{area_at(30.0F)};
    b.coprocessor.set_constraints(areas, b.now);
    b.hear_bus_own();
    b.step();
    ASSERT_EQ(b.last.own_source, OwnSource::bus);
    EXPECT_EQ(b.last.cylinders, 0U);
    EXPECT_FALSE(b.last.guidance.conflict.has_value());
    b.fly(2);
    EXPECT_EQ(b.last.cylinders, 1U);
    EXPECT_TRUE(b.last.guidance.conflict.has_value());
}

TEST(StepNear, WhatIsNearIsReportedFiveTimesASecond)
{
    StepBench b({{Param::tell_near, 1.0F}, {Param::k_sigma, 2.0F}, {Param::mode, 1.0F}}, Bus::there);
    b.velocity = Vec3::Zero();
    b.hear_mast(1, b.position + Vec3(20.0F, 0.0F, 0.0F)).sigma_position = 0.5F;
    b.fly(1);
    ASSERT_EQ(b.bus.near.size(), 1U);
    EXPECT_NEAR(b.bus.near[0].distance, 20.0F - 1.0F - 2.0F * 0.5F, 0.02F);
    EXPECT_EQ(b.counted().near_reported, 1U);
    b.fly(9);
    EXPECT_EQ(b.bus.near.size(), 1U);
    b.bus.takes_near = false;
    b.fly(1);
    EXPECT_EQ(b.bus.near.size(), 2U) << "0.2 s later";
    EXPECT_EQ(b.counted().near_reported, 1U) << "but not taken";
}

TEST(StepNear, ItIsReportedFromWhereTheVehicleIsNow)
{
    StepBench b({{Param::tell_near, 1.0F}, {Param::k_sigma, 0.0F}}, Bus::there);
    b.fly(1);
    b.bus.near.clear();
    b.step(150'000);
    b.hear_mast(1, Vec3(0.0F, 20.0F, 50.0F));
    b.step(150'000);  // 0.3 s at 5 m/s since the last own state
    ASSERT_EQ(b.bus.near.size(), 1U);
    EXPECT_NEAR(b.bus.near[0].distance, 20.0F - 1.0F - 1.5F, 0.02F);
}

TEST(StepNear, NothingIsReportedUnplacedPassiveOrUnasked)
{
    for (int without = 0; without < 5; ++without) {
        SCOPED_TRACE(without);
        StepBench b({{Param::tell_near, without == 1 ? 0.0F : 1.0F}}, Bus::there);
        if (without == 2) {
            b.coprocessor.stay_passive();
        }
        b.hear_autopilot();
        if (without != 3) {
            b.hear_own().has_yaw = without != 4;
        }
        b.hear_mast(1, b.position + Vec3(20.0F, 0.0F, 0.0F));
        b.step();
        EXPECT_EQ(b.bus.near.size(), without == 0 ? 1U : 0U);
    }
}

TEST(StepBusStatus, SaysTheStateTheFaultsAndWhetherItAdvisesAlone)
{
    StepBench b({}, Bus::there);
    b.step();
    EXPECT_FALSE(b.bus.statuses.back().advising_only) << "without a place it advises nothing";
    EXPECT_TRUE(b.bus.texts.empty());
    b.hear_bus_own();
    b.step();
    EXPECT_TRUE(b.bus.statuses.back().advising_only);
    EXPECT_EQ(b.bus.statuses.back().state, link::SystemState::boot);
    EXPECT_EQ(b.bus.statuses.back().faults, bit(Fault::no_autopilot) | bit(Fault::own_state_missing));
    b.hear_bus_own();
    b.step();
    EXPECT_EQ(b.said("jink: no autopilot heard, advising only"), 1) << "once";
    b.fly(2);
    EXPECT_FALSE(b.bus.statuses.back().advising_only);
    EXPECT_EQ(b.bus.statuses.back().state, link::SystemState::active);
    EXPECT_EQ(b.bus.statuses.back().faults, 0U);
    StepBench off({{Param::mode, 0.0F}}, Bus::there);
    off.hear_bus_own();
    off.step();
    EXPECT_FALSE(off.bus.statuses.back().advising_only);
}

TEST(StepText, WaitsUntilAnAutopilotIsHeardAndGoesToBothLines)
{
    StepBench b({}, Bus::there);
    Text text;
    text << "jink: restarted";
    for (int i = 0; i < 3; ++i) {
        EXPECT_TRUE(b.coprocessor.tell_when_heard(link::Severity::notice, text));
    }
    EXPECT_FALSE(b.coprocessor.tell_when_heard(link::Severity::notice, text)) << "three are kept";
    b.step();
    EXPECT_EQ(b.said("jink: restarted"), 0);
    b.fly(2);
    EXPECT_EQ(b.said("jink: restarted"), 3);
    EXPECT_EQ(b.bus.texts.size(), 3U);
}

}  // namespace
}  // namespace jink::app::test
