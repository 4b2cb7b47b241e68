// SPDX-License-Identifier: BSD-3-Clause
// Times of the take-over, to the microsecond: each does nothing a microsecond before, and acts when it is reached.
#include <cmath>

#include <gtest/gtest.h>

#include "tests/unit/app/takeover_bench.hpp"

namespace jink::app {
namespace {

using namespace test;

/// Microseconds that the clock counts as exactly this long.
std::int64_t us_of(Seconds time)
{
    const std::int64_t us = std::llround(static_cast<double>(time) * 1e6);
    EXPECT_EQ(TimePoint{us} - TimePoint{}, time);
    return us;
}

/// A step `time` after `from`, or a microsecond before that.
TakeoverOutput step_at(Bench& b, TimePoint from, Seconds time, Step s, std::int64_t early_us = 0)
{
    b.now.us = from.us + us_of(time) - early_us;
    s.dt = 0.0F;
    return b.step(s);
}

Bench announced()
{
    Bench b;
    b.step(wants(Beat::former));
    EXPECT_EQ(b.control(), Control::announcing);
    return b;
}

Bench asked()
{
    Bench b = announced();
    EXPECT_EQ(step_at(b, b.now, 0.1F, kWant).action, TakeoverAction::request_external);
    return b;
}

Bench granted()
{
    Bench b = asked();
    EXPECT_EQ(b.step(wants(Beat::external, 0.2F)).event, TakeoverEvent::took_over);
    return b;
}

Bench given_back_at_once()
{
    Bench b = granted();
    EXPECT_EQ(b.step(calm(Beat::external)).action, TakeoverAction::request_former);
    return b;
}

Bench lost_at_once()
{
    Bench b = granted();
    EXPECT_EQ(b.step(fault(Beat::external)).action, TakeoverAction::request_hold);
    return b;
}

TakeoverOutput sticks_moved(Bench& b, const Step& s)
{
    b.now = b.now + s.dt;
    TakeoverInput input = input_of(s);
    input.report = input.has_report ? input.report : b.last;
    input.sticks_moved = true;
    return b.takeover.update(input, b.now);
}

TEST(TakeoverEdges, StreamIsAnnouncedForItsWholeTimeBeforeTheRequest)
{
    Bench b = announced();
    const TimePoint began = b.now;
    EXPECT_EQ(step_at(b, began, Takeover::kAnnounce, kWant, 1).action, TakeoverAction::none);
    EXPECT_EQ(step_at(b, began, Takeover::kAnnounce, kWant).action, TakeoverAction::request_external);
}

TEST(TakeoverEdges, StreamThatEndedIsAnnouncedAnew)
{
    Bench b = announced();
    b.step(kCalm);
    EXPECT_FALSE(b.takeover.streaming());
    b.step(kWant);
    const TimePoint again = b.now;
    ASSERT_EQ(b.control(), Control::announcing);
    EXPECT_EQ(step_at(b, again, Takeover::kAnnounce, wants(Beat::former), 1).action, TakeoverAction::none);
    EXPECT_EQ(step_at(b, again, Takeover::kAnnounce, kWant).action, TakeoverAction::request_external);
}

TEST(TakeoverEdges, RequestIsRepeatedWhenTheTimeForAConfirmationIsOver)
{
    Bench b = asked();
    const TimePoint first = b.now;
    EXPECT_EQ(step_at(b, first, Takeover::kConfirm, wants(Beat::former), 1).action, TakeoverAction::none);
    EXPECT_EQ(step_at(b, first, Takeover::kConfirm, kWant).action, TakeoverAction::request_external);
}

TEST(TakeoverEdges, RefusedWhenTheTimeOfTheLastTryIsOver)
{
    Bench b = asked();
    EXPECT_EQ(step_at(b, b.now, 1.0F, wants(Beat::former)).action, TakeoverAction::request_external);
    EXPECT_EQ(step_at(b, b.now, 1.0F, wants(Beat::former)).action, TakeoverAction::request_external);
    const TimePoint third = b.now;
    EXPECT_EQ(step_at(b, third, Takeover::kConfirm, wants(Beat::former), 1).event, TakeoverEvent::none);
    EXPECT_EQ(step_at(b, third, Takeover::kConfirm, kWant).event, TakeoverEvent::refused);
    EXPECT_EQ(b.takeover.diagnostics().requests, 3U);
    EXPECT_EQ(b.takeover.diagnostics().refused, 1U);
}

TEST(TakeoverEdges, WithoutAnyHeartbeatTheWaitIsThatOfAllTries)
{
    Bench b = asked();
    const TimePoint first = b.now;
    EXPECT_EQ(step_at(b, first, 2.0F, kWant).event, TakeoverEvent::none);
    EXPECT_EQ(step_at(b, first, 3.0F, kWant, 1).event, TakeoverEvent::none);
    EXPECT_EQ(b.control(), Control::requesting);
    EXPECT_EQ(step_at(b, first, 3.0F, kWant).event, TakeoverEvent::refused);
    EXPECT_EQ(b.takeover.diagnostics().requests, 1U) << "nothing was asked for on old evidence";
}

TEST(TakeoverEdges, RefusalIsAnsweredByAnotherRequestAfterTheStacksOwnPause)
{
    for (const auto& [stack, pause] : {std::pair{link::AutopilotStack::ardupilot, Takeover::kRetry},
                                       std::pair{link::AutopilotStack::px4, Takeover::kAskAgain}}) {
        Bench b;
        b.stack = stack;
        b.step(wants(Beat::former));
        ASSERT_EQ(step_at(b, b.now, 0.1F, kWant).action, TakeoverAction::request_external);
        const TimePoint first = b.now;
        EXPECT_EQ(b.step(denied(0.01F)).action, TakeoverAction::none);
        EXPECT_EQ(step_at(b, first, pause, wants(Beat::former), 1).action, TakeoverAction::none);
        EXPECT_EQ(step_at(b, first, pause, kWant).action, TakeoverAction::request_external);
    }
}

/// A PX4 that refuses: requests count as tries from the instant that its stream is old enough.
TEST(TakeoverEdges, TriesOfAPx4CountOnceTheStreamIsOldEnough)
{
    for (const std::int64_t early : {std::int64_t{0}, std::int64_t{1}}) {
        Bench b;
        b.stack = link::AutopilotStack::px4;
        b.stands_by = true;
        b.step(calm(Beat::former));
        const TimePoint proven_from = b.now;
        ASSERT_TRUE(b.takeover.proving());
        step_at(b, proven_from, 1.125F, wants(Beat::none));
        ASSERT_EQ(b.takeover.diagnostics().requests, 0U) << "the HEARTBEAT is too old";
        int requests = 0;
        for (int i = 0; i < 9; ++i) {
            const TakeoverOutput out = i == 0 ? step_at(b, proven_from, Takeover::kProof, wants(Beat::former), early)
                                              : step_at(b, b.now, 1.0F, wants(Beat::former));
            requests += out.action == TakeoverAction::request_external ? 1 : 0;
        }
        EXPECT_EQ(requests, early == 0 ? Takeover::kTries : Takeover::kTries + 1);
    }
}

TEST(TakeoverEdges, RequestBeforeAFaultIsWaitedFor)
{
    Bench b = asked();
    const TimePoint first = b.now;
    b.step(fault(Beat::none));
    EXPECT_EQ(b.control(), Control::autopilot);
    step_at(b, first, 0.8F, wants(Beat::former));
    ASSERT_EQ(b.control(), Control::announcing);
    step_at(b, first, 0.96875F, wants(Beat::former));
    EXPECT_EQ(step_at(b, first, 1.0F, kWant, 1).action, TakeoverAction::none) << "its answer may be on the way";
    EXPECT_EQ(step_at(b, first, 1.0F, kWant).action, TakeoverAction::request_external);
}

TEST(TakeoverEdges, ExternalModeIsOursUntilAnotherModeIsSeenAfterTheTimeForAConfirmation)
{
    for (const std::int64_t early : {std::int64_t{0}, std::int64_t{1}}) {
        Bench b = asked();
        const TimePoint first = b.now;
        b.step(fault(Beat::none));
        step_at(b, first, Takeover::kConfirm, fault(Beat::former), early);
        EXPECT_EQ(b.step(calm(Beat::external, 0.1F)).event,
                  early == 0 ? TakeoverEvent::none : TakeoverEvent::took_over);
        EXPECT_EQ(b.takeover.streaming(), early != 0);
    }
}

TEST(TakeoverEdges, FormerModeIsOurWorkUntilTheTimeForItsConfirmationIsOver)
{
    for (const std::int64_t early : {std::int64_t{0}, std::int64_t{1}}) {
        Bench b = given_back_at_once();
        const TimePoint back = b.now;
        b.step(kWant);
        step_at(b, back, Takeover::kConfirm, wants(Beat::external), early);
        EXPECT_EQ(b.step(wants(Beat::former)).event, early == 0 ? TakeoverEvent::overruled : TakeoverEvent::gave_back);
    }
}

TEST(TakeoverEdges, FormerModeAskedForJustBeforeAFaultIsOurWorkForAsLong)
{
    for (const std::int64_t early : {std::int64_t{0}, std::int64_t{1}}) {
        Bench b = given_back_at_once();
        const TimePoint back = b.now;
        EXPECT_EQ(b.step(fault(Beat::none)).event, TakeoverEvent::lost);
        EXPECT_EQ(step_at(b, back, Takeover::kConfirm, wants(Beat::external), early).event, TakeoverEvent::took_over);
        EXPECT_EQ(b.step(wants(Beat::former)).event, early == 0 ? TakeoverEvent::overruled : TakeoverEvent::gave_back);
    }
}

TEST(TakeoverEdges, FormerModeIsAskedForAgainWhenTheTimeForAConfirmationIsOver)
{
    Bench b = given_back_at_once();
    const TimePoint back = b.now;
    EXPECT_EQ(step_at(b, back, Takeover::kConfirm, calm(Beat::external), 1).action, TakeoverAction::none);
    EXPECT_EQ(step_at(b, back, Takeover::kConfirm, kCalm).action, TakeoverAction::request_former);
}

TEST(TakeoverEdges, HoldIsRepeatedAfterHalfASecondAndOnceAcceptedAfterOne)
{
    Bench b = lost_at_once();
    const TimePoint first = b.now;
    EXPECT_EQ(step_at(b, first, Takeover::kHoldRepeat, fault(Beat::external), 1).action, TakeoverAction::none);
    EXPECT_EQ(step_at(b, first, Takeover::kHoldRepeat, fault(Beat::none)).action, TakeoverAction::request_hold);
    const TimePoint second = b.now;
    Step accepted = fault(Beat::none, 0.1F);
    accepted.accepted = true;
    b.step(accepted);
    EXPECT_EQ(step_at(b, second, Takeover::kHoldRepeat, fault(Beat::external)).action, TakeoverAction::none);
    EXPECT_EQ(step_at(b, second, Takeover::kConfirm, fault(Beat::external), 1).action, TakeoverAction::none);
    EXPECT_EQ(step_at(b, second, Takeover::kConfirm, fault(Beat::external)).action, TakeoverAction::request_hold);
    const TimePoint third = b.now;
    EXPECT_EQ(step_at(b, third, Takeover::kHoldRepeat, fault(Beat::external), 1).action, TakeoverAction::none);
    EXPECT_EQ(step_at(b, third, Takeover::kHoldRepeat, fault(Beat::none)).action, TakeoverAction::request_hold)
        << "the acceptance was that of the one before";
}

TEST(TakeoverEdges, HoldAfterALossIsOursForTheTimeOfAConfirmation)
{
    for (const std::int64_t early : {std::int64_t{0}, std::int64_t{1}}) {
        Bench b = lost_at_once();
        const TimePoint hold = b.now;
        EXPECT_EQ(b.step(wants(Beat::external)).event, TakeoverEvent::took_over);
        EXPECT_EQ(step_at(b, hold, Takeover::kConfirm, wants(Beat::hold), early).event,
                  early == 0 ? TakeoverEvent::overruled : TakeoverEvent::held);
    }
}

TEST(TakeoverEdges, RefusedVehicleIsAskedToHoldOnceASecond)
{
    Bench b = asked();
    for (int i = 0; i < 3; ++i) {
        step_at(b, b.now, 1.0F, wants(Beat::former));
    }
    ASSERT_EQ(b.control(), Control::refused);
    EXPECT_EQ(step_at(b, b.now, 0.02F, wants(Beat::former)).action, TakeoverAction::request_hold);
    const TimePoint first = b.now;
    EXPECT_EQ(step_at(b, first, Takeover::kConfirm, wants(Beat::former), 1).action, TakeoverAction::none);
    EXPECT_EQ(step_at(b, first, Takeover::kConfirm, kWant).action, TakeoverAction::request_hold);
    EXPECT_EQ(b.takeover.diagnostics().hold_requests, 2U);
}

TEST(TakeoverEdges, SticksThatMoveWhileItReturnsWaitForTheAnswerOnItsWay)
{
    Bench b = given_back_at_once();
    const TimePoint back = b.now;
    const TakeoverOutput out = sticks_moved(b, calm(Beat::external));
    EXPECT_EQ(out.event, TakeoverEvent::sticks);
    EXPECT_EQ(out.action, TakeoverAction::none);
    EXPECT_EQ(step_at(b, back, Takeover::kConfirm, wants(Beat::external), 1).action, TakeoverAction::none);
    EXPECT_EQ(step_at(b, back, Takeover::kConfirm, kWant).action, TakeoverAction::request_former);
    EXPECT_EQ(step_at(b, b.now, 1.0F, wants(Beat::external)).action, TakeoverAction::request_former);
    for (int i = 0; i < 5; ++i) {
        EXPECT_EQ(step_at(b, b.now, 1.0F, wants(Beat::external)).action, TakeoverAction::none)
            << "kTries, the first of them before the sticks moved";
    }
}

TEST(TakeoverEdges, SticksThatMoveAfterAnUnansweredReturnAskAtOnceAndThrice)
{
    for (const std::int64_t early : {std::int64_t{0}, std::int64_t{1}}) {
        Bench b = given_back_at_once();
        const TimePoint back = b.now;
        b.step(calm(Beat::external));
        b.now.us = back.us + us_of(Takeover::kConfirm) - early;
        const TakeoverOutput out = sticks_moved(b, calm(Beat::external, 0.0F));
        EXPECT_EQ(out.event, TakeoverEvent::sticks);
        EXPECT_EQ(out.action, early == 0 ? TakeoverAction::request_former : TakeoverAction::none);
        int requests = early == 0 ? 1 : 0;
        for (int i = 0; i < 10; ++i) {
            const TakeoverOutput next = step_at(b, b.now, 1.0F, wants(Beat::external));
            requests += next.action == TakeoverAction::request_former ? 1 : 0;
        }
        EXPECT_EQ(requests, early == 0 ? Takeover::kTries : Takeover::kTries - 1) << "one was on its way";
    }
}

TEST(TakeoverEdges, FormerModeAfterMovedSticksIsAskedForThriceASecondApart)
{
    Bench b = granted();
    EXPECT_EQ(sticks_moved(b, wants(Beat::external)).action, TakeoverAction::request_former);
    for (int i = 1; i < Takeover::kTries; ++i) {
        const TimePoint last = b.now;
        EXPECT_EQ(step_at(b, last, Takeover::kConfirm, wants(Beat::external), 1).action, TakeoverAction::none) << i;
        EXPECT_EQ(step_at(b, last, Takeover::kConfirm, kWant).action, TakeoverAction::request_former) << i;
    }
    const TimePoint last = b.now;
    EXPECT_EQ(step_at(b, last, Takeover::kConfirm, wants(Beat::external)).action, TakeoverAction::none);
    EXPECT_EQ(step_at(b, last, 2.0F, wants(Beat::external)).action, TakeoverAction::none);
    EXPECT_FALSE(b.takeover.streaming());
}

TEST(TakeoverEdges, HandsStayOffUntilTheLastRequestAfterMovedSticksWasAnsweredOrTimedOut)
{
    Bench b = granted();
    EXPECT_EQ(sticks_moved(b, calm(Beat::external)).action, TakeoverAction::request_former);
    EXPECT_EQ(step_at(b, b.now, 1.0F, calm(Beat::external)).action, TakeoverAction::request_former);
    EXPECT_EQ(step_at(b, b.now, 1.0F, calm(Beat::external)).action, TakeoverAction::request_former);
    const TimePoint third = b.now;
    step_at(b, third, Takeover::kConfirm, kCalm, 1);
    b.step({false, true, Beat::none, 0.0F});
    EXPECT_EQ(b.control(), Control::overruled);
    step_at(b, third, Takeover::kConfirm, kCalm);
    b.step(kCalm);
    EXPECT_NE(b.control(), Control::overruled);
}

TEST(TakeoverEdges, GrantAfterMovedSticksIsOursToGiveBackForTheTimeOfAConfirmation)
{
    for (const std::int64_t early : {std::int64_t{0}, std::int64_t{1}}) {
        Bench b = asked();
        const TimePoint first = b.now;
        EXPECT_EQ(sticks_moved(b, kWant).event, TakeoverEvent::sticks);
        step_at(b, first, Takeover::kConfirm, wants(Beat::former), early);
        EXPECT_EQ(b.step(wants(Beat::external)).action,
                  early == 0 ? TakeoverAction::none : TakeoverAction::request_former);
    }
}

TEST(TakeoverEdges, ClaimLastsThroughASilenceOfTenSecondsAndNotLonger)
{
    for (const std::int64_t late : {std::int64_t{0}, std::int64_t{1}}) {
        Bench b = granted();
        const TimePoint heard = b.now;
        EXPECT_EQ(b.step(fault(Beat::none)).event, TakeoverEvent::lost);
        EXPECT_EQ(step_at(b, heard, Takeover::kClaim, calm(Beat::external), -late).event,
                  late == 0 ? TakeoverEvent::took_over : TakeoverEvent::found);
        EXPECT_EQ(b.takeover.streaming(), late == 0);
    }
}

TEST(TakeoverEdges, NoHoldIsAskedForOnceTheSilenceHasEndedTheClaim)
{
    for (const float silence : {9.0F, 11.0F}) {
        Bench b = granted();
        Step dead = fault(Beat::none);
        dead.alive = false;
        EXPECT_EQ(b.step(dead).event, TakeoverEvent::lost);
        dead.dt = silence;
        b.step(dead);
        int asked_to_hold = 0;
        for (int i = 0; i < 100; ++i) {
            asked_to_hold += b.step(fault(Beat::external, 0.1F)).action == TakeoverAction::request_hold ? 1 : 0;
        }
        EXPECT_EQ(asked_to_hold, silence < 10.0F ? Takeover::kHoldTries : 0);
    }
}

TEST(TakeoverEdges, SilenceInControlLeavesTheClaim)
{
    Bench b = granted();
    b.step(wants(Beat::none, 11.0F));
    b.step(wants(Beat::external));
    EXPECT_EQ(b.control(), Control::ours);
    EXPECT_EQ(b.step(fault(Beat::external)).action, TakeoverAction::request_hold) << "the vehicle flew our commands";
}

TEST(TakeoverEdges, AnnouncementWaitsWithoutAStreamOnceTheEvidenceIsOld)
{
    Bench b;
    for (int i = 0; i < 5; ++i) {
        b.step(calm(Beat::former, 1.0F));
    }
    const TimePoint heard = b.now;
    step_at(b, heard, 1.45F, kWant);
    ASSERT_EQ(b.control(), Control::announcing);
    step_at(b, heard, 1.5F, kWant);
    EXPECT_EQ(b.control(), Control::announcing);
    const TakeoverOutput out = step_at(b, heard, 1.6F, kWant);
    EXPECT_EQ(b.control(), Control::autopilot);
    EXPECT_TRUE(out.ask_heartbeat);
    EXPECT_EQ(out.action, TakeoverAction::none);
    b.step(wants(Beat::former));
    EXPECT_EQ(b.control(), Control::announcing);
}

}  // namespace
}  // namespace jink::app
