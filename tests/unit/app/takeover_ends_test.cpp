// SPDX-License-Identifier: BSD-3-Clause
// How a take-over ends: by the pilot's mode or sticks, by commands that are not followed, by a fault; and the reported
// finding.
#include <gtest/gtest.h>

#include "tests/unit/app/takeover_bench.hpp"

namespace jink::app {
namespace {

using namespace test;

TEST(TakeoverEnds, AcceptanceOfAModeThatWasSeenAlreadyAsksForNoOtherHeartbeat)
{
    Bench b = commanding();
    Step accepted = calm(Beat::none);
    accepted.accepted = true;
    EXPECT_EQ(b.step(accepted).action, TakeoverAction::request_former) << "the mode was seen before its acceptance";
}

TEST(TakeoverEnds, AcceptedReturnIsNotRepeatedBeforeAHeartbeatContradictsIt)
{
    Bench b = commanding();
    ASSERT_EQ(b.step(calm(Beat::external)).action, TakeoverAction::request_former);
    b.step(calm(Beat::external));  // in transit when the request was granted
    Step accepted = calm(Beat::none);
    accepted.accepted = true;
    b.step(accepted);
    for (int i = 0; i < 100; ++i) {
        EXPECT_EQ(b.step(kCalm).action, TakeoverAction::none);
    }
    EXPECT_EQ(b.step(calm(Beat::external)).action, TakeoverAction::request_former);
}

TEST(TakeoverEnds, PilotsModeCountsBeforeSticksFaultsAndCommandsNotFollowed)
{
    const Change all = [](TakeoverInput& in) {
        in.sticks_moved = in.unfollowed = true;
        in.may_act = false;
    };
    for (const Beat beat : {Beat::manual, Beat::former, Beat::hold, Beat::disarmed}) {
        Bench b = commanding();
        const TakeoverOutput out = varied(b, wants(beat), all);
        EXPECT_EQ(out.event, TakeoverEvent::overruled) << describe(wants(beat));
        EXPECT_EQ(out.action, TakeoverAction::none);
        EXPECT_EQ(b.takeover.diagnostics().sticks + b.takeover.diagnostics().unfollowed, 0U);
        EXPECT_EQ(b.takeover.diagnostics().lost_by_fault, 0U);
    }
    Bench returning = commanding();
    returning.step(calm(Beat::external));
    EXPECT_EQ(varied(returning, calm(Beat::former), all).event, TakeoverEvent::gave_back);
}

TEST(TakeoverEnds, SticksCountBeforeFaultsAndCommandsNotFollowed)
{
    Bench b = commanding();
    const TakeoverOutput out = varied(b, wants(Beat::external), [](TakeoverInput& in) {
        in.sticks_moved = in.unfollowed = true;
        in.may_act = false;
    });
    EXPECT_EQ(out.event, TakeoverEvent::sticks);
    EXPECT_EQ(out.action, TakeoverAction::request_former);
    EXPECT_EQ(b.takeover.diagnostics().sticks, 1U);
    EXPECT_EQ(b.takeover.diagnostics().lost_by_fault, 0U);
}

TEST(TakeoverEnds, SticksThatMoveWithoutAStreamSayNothing)
{
    Bench b;
    EXPECT_EQ(varied(b, calm(Beat::former), kSticks).event, TakeoverEvent::none);
    Bench refused = declined();
    EXPECT_EQ(varied(refused, kWant, kSticks).event, TakeoverEvent::none);
    EXPECT_EQ(refused.control(), Control::refused);
}

TEST(TakeoverEnds, SticksThatMoveBeforeTheRequestLeaveAnExternalModeToThePilot)
{
    Bench b;
    b.step(wants(Beat::former));
    ASSERT_EQ(varied(b, kWant, kSticks).event, TakeoverEvent::sticks);
    for (int i = 0; i < 5; ++i) {
        EXPECT_EQ(b.step(wants(Beat::external, 0.5F)).action, TakeoverAction::none);
        EXPECT_FALSE(b.takeover.streaming());
    }
}

TEST(TakeoverEnds, AfterMovedSticksADeadLineIsWaitedFor)
{
    Bench b = commanding();
    const Change dead = [](TakeoverInput& in) { in.link_alive = false; };
    EXPECT_EQ(varied(b, wants(Beat::external),
                     [](TakeoverInput& in) {
                         in.sticks_moved = true;
                         in.link_alive = false;
                     })
                  .action,
              TakeoverAction::none);
    for (int i = 0; i < 10; ++i) {
        EXPECT_EQ(varied(b, wants(Beat::external, 0.5F), dead).action, TakeoverAction::none);
    }
    EXPECT_EQ(b.step(wants(Beat::external)).action, TakeoverAction::request_former);
}

TEST(TakeoverEnds, CommandsAreFollowedOrNotInControlAlone)
{
    for (Bench b : {awaiting(), declined()}) {
        const Control before = b.control();
        EXPECT_EQ(varied(b, kWant, kUnfollowed).event, TakeoverEvent::none);
        EXPECT_EQ(b.control(), before);
    }
    Bench returning = commanding();
    returning.step(calm(Beat::external));
    EXPECT_EQ(varied(returning, calm(Beat::external), kUnfollowed).event, TakeoverEvent::unfollowed);
}

TEST(TakeoverEnds, VehicleThatDoesNotFollowIsLeftAloneInTheExternalModeToo)
{
    for (const int conflict : {3, 20}) {  // steps that it lasts
        Bench b = commanding();
        ASSERT_EQ(varied(b, wants(Beat::external), kUnfollowed).action, TakeoverAction::request_hold);
        EXPECT_EQ(b.takeover.diagnostics().unfollowed, 1U);
        int holds = 1;
        for (int i = 0; i < 20; ++i) {
            const TakeoverOutput out = b.step(i < conflict ? wants(Beat::external, 0.5F) : calm(Beat::external, 0.5F));
            holds += out.action == TakeoverAction::request_hold ? 1 : 0;
            EXPECT_FALSE(b.takeover.streaming()) << i;
        }
        EXPECT_EQ(holds, Takeover::kHoldTries) << "in the conflict and after it";
    }
}

TEST(TakeoverEnds, HoldOfAVehicleThatDoesNotFollowIsSaidOnce)
{
    Bench b = commanding();
    ASSERT_EQ(varied(b, kWant, kUnfollowed).event, TakeoverEvent::unfollowed);
    EXPECT_EQ(b.step(wants(Beat::hold)).event, TakeoverEvent::held);
    for (int i = 0; i < 5; ++i) {
        const TakeoverOutput out = b.step(wants(Beat::hold, 0.5F));
        EXPECT_EQ(out.event, TakeoverEvent::none);
        EXPECT_EQ(out.action, TakeoverAction::none);
    }
    EXPECT_EQ(b.takeover.diagnostics().held, 1U);
    EXPECT_EQ(b.step(wants(Beat::manual)).event, TakeoverEvent::overruled);
}

TEST(TakeoverEnds, PilotsModeAfterCommandsNotFollowedIsNotAskedToHold)
{
    Bench b = commanding();
    ASSERT_EQ(varied(b, kWant, kUnfollowed).action, TakeoverAction::request_hold);
    EXPECT_EQ(b.step(wants(Beat::manual, 0.2F)).event, TakeoverEvent::overruled);
    for (int i = 0; i < 10; ++i) {
        EXPECT_EQ(b.step(wants(i % 2 == 0 ? Beat::external : Beat::former, 0.5F)).action, TakeoverAction::none);
    }
}

TEST(TakeoverEnds, EveryLossHasItsOwnHoldRequests)
{
    Bench b = commanding();
    for (int loss = 0; loss < 3; ++loss) {
        int holds = 0;
        for (int i = 0; i < 20; ++i) {
            Step s = fault(Beat::external, 0.5F);
            s.accepted = i == 1;
            holds += b.step(s).action == TakeoverAction::request_hold ? 1 : 0;
            EXPECT_EQ(i == 0, holds == 1 && i == 0);
        }
        EXPECT_EQ(holds, Takeover::kHoldTries) << loss;
        EXPECT_EQ(b.step(wants(Beat::external)).event, TakeoverEvent::took_over) << loss;
    }
    EXPECT_EQ(b.takeover.diagnostics().hold_requests, 3U * static_cast<std::uint32_t>(Takeover::kHoldTries));
    EXPECT_EQ(b.takeover.diagnostics().lost_by_fault, 3U);
    EXPECT_EQ(b.takeover.diagnostics().taken, 1U);
}

TEST(TakeoverEnds, NewLossDoesNotWaitForTheAnswerOfTheOneBefore)
{
    Bench b = commanding();
    ASSERT_EQ(b.step(fault(Beat::external)).action, TakeoverAction::request_hold);
    Step accepted = fault(Beat::none);
    accepted.accepted = true;
    b.step(accepted);
    ASSERT_EQ(b.step(wants(Beat::external)).event, TakeoverEvent::took_over);
    ASSERT_EQ(b.step(fault(Beat::external)).action, TakeoverAction::request_hold) << "at once";
    EXPECT_EQ(b.step(fault(Beat::external, 0.51F)).action, TakeoverAction::request_hold)
        << "without an answer after half a second";
}

TEST(TakeoverEnds, DisarmedInTheHoldModeIsNoHoldThatWasAskedFor)
{
    const Change disarmed = [](TakeoverInput& in) { in.report.armed = false; };
    Bench lost = commanding();
    ASSERT_EQ(lost.step(fault(Beat::external)).action, TakeoverAction::request_hold);
    ASSERT_EQ(lost.step(wants(Beat::external)).event, TakeoverEvent::took_over);
    EXPECT_EQ(varied(lost, wants(Beat::hold), disarmed).event, TakeoverEvent::overruled);
    Bench refused = declined();
    ASSERT_EQ(refused.step(wants(Beat::former)).action, TakeoverAction::request_hold);
    EXPECT_EQ(varied(refused, wants(Beat::hold), disarmed).event, TakeoverEvent::overruled);
}

TEST(TakeoverEnds, HoldThatNobodyAskedForIsThePilots)
{
    Bench refused = declined();
    EXPECT_EQ(refused.step(wants(Beat::hold)).event, TakeoverEvent::overruled);
    Bench commanded = commanding();
    EXPECT_EQ(commanded.step(wants(Beat::hold)).event, TakeoverEvent::overruled);
}

TEST(TakeoverEnds, MissionAloneIsAskedToHoldAfterARefusal)
{
    for (const FlightMode mode : {FlightMode::going_home, FlightMode::other, FlightMode::external}) {
        Bench b = declined();
        const TakeoverOutput out = varied(b, wants(Beat::former), [&](TakeoverInput& in) {
            in.may_act = mode != FlightMode::external;  // else a late grant
            in.report.mode = mode;
        });
        EXPECT_EQ(out.action, TakeoverAction::none);
    }
}

TEST(TakeoverEnds, CountsWhatHappened)
{
    Bench b = commanding();
    b.step(calm(Beat::external));
    b.step(calm(Beat::former));
    const TakeoverDiagnostics& d = b.takeover.diagnostics();
    EXPECT_EQ(d.given_back, 1U);
    b.step(wants(Beat::former));
    b.step(wants(Beat::none, 0.1F));
    b.step(wants(Beat::manual));
    EXPECT_EQ(d.overruled, 1U);
    EXPECT_EQ(d.requests, 2U);
    EXPECT_EQ(d.taken, 1U);
    EXPECT_EQ(d.held + d.sticks + d.unfollowed + d.refused + d.hold_requests + d.lost_by_fault, 0U);
}

TEST(TakeoverEnds, HeartbeatsAreAskedForWhileAnAnswerIsOpenAndCounted)
{
    Bench b = awaiting();
    const std::uint32_t before = b.takeover.diagnostics().heartbeats_asked;
    std::uint32_t asked = 0;
    for (int i = 0; i < 50; ++i) {
        asked += b.step(kCalm).ask_heartbeat ? 1U : 0U;
    }
    EXPECT_GE(asked, 8U) << "every 0.1 s, in whole ticks";
    EXPECT_LE(asked, 10U);
    EXPECT_EQ(b.takeover.diagnostics().heartbeats_asked - before, asked);
    Bench idle;
    idle.step(calm(Beat::former));
    for (int i = 0; i < 100; ++i) {
        EXPECT_FALSE(idle.step(kCalm).ask_heartbeat) << "nothing to know";
    }
    EXPECT_EQ(idle.takeover.diagnostics().heartbeats_asked, 0U);
}

TEST(TakeoverEnds, ExternalModeIsFoundOnceAndOnlyWhereItIsArmedAndNobodys)
{
    Bench disarmed;
    EXPECT_EQ(varied(disarmed, calm(Beat::external), [](TakeoverInput& in) { in.report.armed = false; }).event,
              TakeoverEvent::none);
    EXPECT_EQ(disarmed.step(calm(Beat::external)).event, TakeoverEvent::none) << "not the first one";
    Bench mission;
    mission.step(calm(Beat::former));
    EXPECT_EQ(mission.step(calm(Beat::external)).event, TakeoverEvent::none) << "the pilot's choice in flight";
    Bench found;
    EXPECT_EQ(found.step(kCalm).event, TakeoverEvent::none) << "nothing heard";
    EXPECT_EQ(found.step(calm(Beat::external)).event, TakeoverEvent::found);
    EXPECT_EQ(found.step(calm(Beat::external)).event, TakeoverEvent::none);
}

TEST(TakeoverEnds, EarlierHeartbeatsOfTheSameModeAreNoNews)
{
    Bench b = commanding();
    EXPECT_EQ(with_two(b, wants(Beat::external), wants(Beat::external)).event, TakeoverEvent::none);
    EXPECT_EQ(b.control(), Control::ours);
    Bench disarmed = commanding();
    TakeoverInput input = input_of(wants(Beat::external));
    link::AutopilotReport earlier = input.report;
    earlier.armed = false;
    input.earlier = {&earlier, 1};
    EXPECT_EQ(disarmed.takeover.update(input, disarmed.now + 0.02F).event, TakeoverEvent::overruled)
        << "disarmed and armed again within the step";
}

TEST(TakeoverEnds, EarlierHeartbeatOfAnotherMissionIsAnothersChoice)
{
    Bench b = awaiting();
    TakeoverInput input = input_of(wants(Beat::former));
    link::AutopilotReport earlier = input.report;
    earlier.custom_mode = 33;
    input.earlier = {&earlier, 1};
    EXPECT_EQ(b.takeover.update(input, b.now + 0.02F).event, TakeoverEvent::overruled);
}

TEST(TakeoverEnds, PeriodIsNotMeasuredByEarlierHeartbeats)
{
    Bench b;
    for (int i = 0; i < 6; ++i) {
        b.step(calm(Beat::former, 1.0F));
    }
    b.step(calm(Beat::hold, 1.0F));
    with_two(b, calm(Beat::manual), calm(Beat::former, 1.0F));  // two within one step
    with_two(b, calm(Beat::manual), calm(Beat::former, 1.0F));
    with_two(b, calm(Beat::manual), calm(Beat::former, 1.0F));
    b.step(calm(Beat::none, 1.2F));
    b.step(kWant);
    EXPECT_EQ(b.control(), Control::announcing) << "1.5 periods of a second";
}

}  // namespace
}  // namespace jink::app
