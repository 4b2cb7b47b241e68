// SPDX-License-Identifier: BSD-3-Clause
// A mode is requested on fresh evidence only: a mode that the pilot chose meanwhile is not overridden.
#include <gtest/gtest.h>

#include "tests/unit/app/takeover_bench.hpp"

namespace jink::app {
namespace {

using namespace test;

/// HEARTBEATs of the mission once a second, nothing in conflict: the period is known.
Bench on_mission(link::AutopilotStack stack)
{
    Bench b;
    b.stack = stack;
    for (int i = 0; i < 5; ++i) {
        b.step(calm(Beat::former, 1.0F));
    }
    return b;
}

/// Steps of 20 ms without a HEARTBEAT; the modes asked for.
int requests_within(Bench& b, float seconds, const Step& s = kWant)
{
    int asked = 0;
    for (int i = 0; i < static_cast<int>(seconds * 50.0F); ++i) {
        asked += b.step(s).action != TakeoverAction::none ? 1 : 0;
    }
    return asked;
}

Bench in_control_of(link::AutopilotStack stack)
{
    Bench b = on_mission(stack);
    b.step(wants(Beat::former));
    requests_within(b, 0.1F);
    b.step(wants(Beat::external));
    EXPECT_EQ(b.control(), Control::ours);
    return b;
}

TEST(TakeoverEvidence, PilotsChoiceInALostHeartbeatIsNotOverridden)
{
    Bench b = on_mission(link::AutopilotStack::px4);
    // The next HEARTBEAT, which shows the pilot's mode, is lost. A conflict begins 1.6 s after the last one.
    b.step(calm(Beat::none, 1.6F));
    EXPECT_EQ(requests_within(b, 0.4F), 0);
    EXPECT_EQ(b.control(), Control::autopilot) << "no stream either";
    b.step(wants(Beat::manual));
    EXPECT_EQ(requests_within(b, 3.0F), 0);
}

TEST(TakeoverEvidence, PilotsChoiceBetweenTwoHeartbeatsIsSeenBeforeTheRequest)
{
    Bench b = on_mission(link::AutopilotStack::px4);
    // HEARTBEAT at 0, the pilot chooses POSCTL at 0.2 s, the conflict begins at 0.54 s.
    b.step(calm(Beat::none, 0.52F));
    const TakeoverOutput first = b.step(kWant);
    EXPECT_TRUE(first.ask_heartbeat);
    EXPECT_EQ(first.action, TakeoverAction::none);
    b.step(kWant);
    EXPECT_EQ(b.step(wants(Beat::manual)).event, TakeoverEvent::overruled);  // the answer
    EXPECT_EQ(requests_within(b, 3.0F), 0);
}

TEST(TakeoverEvidence, HeartbeatOfFourSecondsAgoIsNone)
{
    Bench b = on_mission(link::AutopilotStack::ardupilot);
    b.step(calm(Beat::none, 4.3F));
    EXPECT_EQ(requests_within(b, 1.0F), 0);
    EXPECT_FALSE(b.takeover.streaming());
}

TEST(TakeoverEvidence, AnswerLetsTheRequestGoAtOnce)
{
    Bench b = on_mission(link::AutopilotStack::ardupilot);
    b.step(calm(Beat::none, 0.5F));
    EXPECT_TRUE(b.step(kWant).ask_heartbeat);
    EXPECT_EQ(b.step(kWant).action, TakeoverAction::none);
    EXPECT_EQ(b.step(wants(Beat::former)).action, TakeoverAction::request_external);
}

TEST(TakeoverEvidence, WithoutAnAnswerAHeartbeatOfOneAndAHalfPeriodsIsGoodEnough)
{
    Bench b = on_mission(link::AutopilotStack::ardupilot);
    b.step(calm(Beat::none, 0.9F));
    EXPECT_EQ(requests_within(b, 0.24F), 0);
    EXPECT_EQ(requests_within(b, 0.06F), 1);
}

TEST(TakeoverEvidence, PeriodIsMeasured)
{
    Bench b;
    for (int i = 0; i < 8; ++i) {
        b.step(calm(Beat::former, 0.25F));  // 4 Hz
    }
    b.step(calm(Beat::none, 0.4F));
    EXPECT_EQ(requests_within(b, 2.0F), 0) << "older than one and a half periods of 0.25 s";
    b.step(wants(Beat::former));
    EXPECT_EQ(requests_within(b, 0.1F), 1);
}

TEST(TakeoverEvidence, OneLostHeartbeatDoesNotChangeThePeriod)
{
    Bench b;
    for (int i = 0; i < 8; ++i) {
        b.step(calm(Beat::former, 0.25F));
    }
    b.step(calm(Beat::former, 0.5F));
    b.step(calm(Beat::none, 0.4F));
    EXPECT_EQ(requests_within(b, 2.0F), 0);
}

TEST(TakeoverEvidence, RefusedRequestIsNotRepeatedBeforeAnotherHeartbeat)
{
    for (const auto stack : {link::AutopilotStack::ardupilot, link::AutopilotStack::px4}) {
        Bench b = on_mission(stack);
        b.step(wants(Beat::former));
        EXPECT_EQ(requests_within(b, 0.1F), 1);
        b.step(denied(0.02F));
        EXPECT_EQ(requests_within(b, 0.8F), 0);
        EXPECT_EQ(b.step(wants(Beat::former)).action, TakeoverAction::request_external);
        EXPECT_EQ(requests_within(b, 0.8F), 0);
    }
}

TEST(TakeoverEvidence, AcceptedRequestIsNotRepeatedBeforeAHeartbeatContradictsIt)
{
    Bench b = on_mission(link::AutopilotStack::ardupilot);
    b.step(wants(Beat::former));
    EXPECT_EQ(requests_within(b, 0.1F), 1);
    b.step(wants(Beat::former));  // in transit when the request was granted
    Step accepted = kWant;
    accepted.accepted = true;
    b.step(accepted);
    EXPECT_EQ(requests_within(b, 2.0F), 0);
}

TEST(TakeoverEvidence, HeartbeatThatWaitedForUsIsNone)
{
    Bench b = on_mission(link::AutopilotStack::px4);
    b.step(calm(Beat::none, 1.6F));
    b.now = b.now + 0.02F;
    TakeoverInput late = input_of(wants(Beat::former));
    late.report_is_late = true;
    late.may_act = false;
    static_cast<void>(b.takeover.update(late, b.now));
    EXPECT_EQ(requests_within(b, 1.0F), 0);
}

TEST(TakeoverEvidence, AsksForHeartbeatsWhileInControl)
{
    Bench b = on_mission(link::AutopilotStack::px4);
    b.step(wants(Beat::former));
    requests_within(b, 0.1F);
    b.step(wants(Beat::external));
    ASSERT_EQ(b.control(), Control::ours);
    int asked = 0;
    for (int i = 0; i < 100; ++i) {
        const bool ask = b.step(kWant).ask_heartbeat;
        asked += ask ? 1 : 0;
        if (ask) {
            b.step(wants(Beat::external));
        }
    }
    EXPECT_GE(asked, 20) << "the newest is evidence at any time";
    EXPECT_LE(asked, 40);
}

TEST(TakeoverEvidence, FormerModeIsNotGivenBackOnAnOldHeartbeat)
{
    Bench b = on_mission(link::AutopilotStack::px4);
    b.step(wants(Beat::former));
    requests_within(b, 0.1F);
    b.step(wants(Beat::external));
    b.step(wants(Beat::none, 1.6F));
    EXPECT_EQ(requests_within(b, 1.0F, kCalm), 0);
    EXPECT_EQ(b.step(calm(Beat::external)).action, TakeoverAction::request_former);
}

TEST(TakeoverEvidence, SilenceOfMoreThanTenSecondsEndsTheClaim)
{
    Bench b = on_mission(link::AutopilotStack::ardupilot);
    b.step(wants(Beat::former));
    requests_within(b, 0.1F);
    b.step(wants(Beat::external));
    b.step(fault(Beat::none));
    b.step(fault(Beat::none, 10.5F));
    const TakeoverOutput out = b.step(calm(Beat::external));
    EXPECT_EQ(out.event, TakeoverEvent::found);
    EXPECT_EQ(requests_within(b, 3.0F, kCalm), 0) << "somebody may have flown meanwhile";
    EXPECT_FALSE(b.takeover.streaming());
}

TEST(TakeoverEvidence, ExternalModeSeenAndOverDuringAFaultIsNotClaimedAgain)
{
    Bench b = on_mission(link::AutopilotStack::ardupilot);
    b.step(wants(Beat::former));
    EXPECT_EQ(requests_within(b, 0.1F), 1);
    b.step(fault(Beat::none));
    b.step(fault(Beat::external));
    b.step(fault(Beat::former));  // the pilot's choice
    b.step(wants(Beat::external, 0.1F));
    EXPECT_FALSE(b.takeover.streaming());
}

TEST(TakeoverEvidence, PilotsModeBeforeALateGrantInOneStepIsNotMissed)
{
    Bench b = on_mission(link::AutopilotStack::ardupilot);
    b.step(wants(Beat::former));
    EXPECT_EQ(requests_within(b, 0.1F), 1);
    EXPECT_EQ(with_two(b, wants(Beat::manual), wants(Beat::external)).event, TakeoverEvent::overruled);
    EXPECT_FALSE(b.takeover.streaming());
    EXPECT_EQ(requests_within(b, 3.0F), 0);
}

TEST(TakeoverEvidence, EarlierOfTwoHeartbeatsIsNoEvidenceToAskOn)
{
    Bench b = in_control_of(link::AutopilotStack::ardupilot);
    const TakeoverOutput out = with_two(b, calm(Beat::external), calm(Beat::manual));
    EXPECT_EQ(out.action, TakeoverAction::none);
    EXPECT_EQ(out.event, TakeoverEvent::overruled);
}

TEST(TakeoverEvidence, ExternalModeFoundAtTheStartIsSaidOnceAndLeftAlone)
{
    Bench b;
    EXPECT_EQ(b.step(wants(Beat::external)).event, TakeoverEvent::found);
    for (int i = 0; i < 10; ++i) {
        const TakeoverOutput out = b.step(wants(Beat::external, 1.0F));
        EXPECT_EQ(out.event, TakeoverEvent::none);
        EXPECT_EQ(out.action, TakeoverAction::none);
    }
    EXPECT_FALSE(b.takeover.streaming());
}

TEST(TakeoverEvidence, ModeGivenBackIsTheOneOfTheTakeoverNotAnOlderOne)
{
    Bench b = on_mission(link::AutopilotStack::ardupilot);
    b.step(wants(Beat::former));
    EXPECT_EQ(b.takeover.former_mode(), kMission);
    // Another mission-like mode before the request: chosen by another party.
    TakeoverInput other = input_of(wants(Beat::former));
    other.report.custom_mode = 33;
    b.now = b.now + 0.02F;
    EXPECT_EQ(b.takeover.update(other, b.now).event, TakeoverEvent::overruled);
}

TakeoverOutput with(Bench& b, Step s, bool sticks, bool unfollowed)
{
    b.now = b.now + s.dt;
    TakeoverInput input = input_of(s);
    input.report = input.has_report ? input.report : b.last;
    input.sticks_moved = sticks;
    input.unfollowed = unfollowed;
    return b.takeover.update(input, b.now);
}

TEST(TakeoverSticks, EndTheStreamAtOnceAndAskForTheFormerMode)
{
    Bench b = in_control_of(link::AutopilotStack::ardupilot);
    const TakeoverOutput out = with(b, kWant, true, false);
    EXPECT_EQ(out.event, TakeoverEvent::sticks);
    EXPECT_EQ(out.action, TakeoverAction::request_former);
    EXPECT_FALSE(b.takeover.streaming());
    EXPECT_EQ(requests_within(b, 0.9F), 0) << "once, while that may be on its way";
    b.step(wants(Beat::former));
    EXPECT_EQ(requests_within(b, 5.0F), 0) << "hands off in this conflict";
    b.step(calm(Beat::former));
    b.step(wants(Beat::former));
    EXPECT_EQ(b.control(), Control::announcing) << "the next conflict";
}

TEST(TakeoverSticks, PilotsModeAfterwardsStands)
{
    Bench b = in_control_of(link::AutopilotStack::ardupilot);
    with(b, kWant, true, false);
    b.step(wants(Beat::manual));
    EXPECT_EQ(requests_within(b, 3.0F), 0);
    b.step(wants(Beat::external));  // the pilot's own
    EXPECT_EQ(requests_within(b, 3.0F), 0);
    EXPECT_FALSE(b.takeover.streaming());
}

TEST(TakeoverSticks, BeforeTheGrantEndTheAttempt)
{
    Bench b = on_mission(link::AutopilotStack::ardupilot);
    b.step(wants(Beat::former));
    EXPECT_EQ(with(b, kWant, true, false).event, TakeoverEvent::sticks);
    EXPECT_EQ(requests_within(b, 3.0F), 0);
}

TEST(TakeoverSticks, GrantThatComesAfterwardsIsGivenBackWithoutAStream)
{
    Bench b = on_mission(link::AutopilotStack::ardupilot);
    b.step(wants(Beat::former));
    EXPECT_EQ(requests_within(b, 0.1F), 1);
    with(b, kWant, true, false);
    EXPECT_EQ(b.step(wants(Beat::external, 0.1F)).action, TakeoverAction::request_former);
    EXPECT_FALSE(b.takeover.streaming());
}

TEST(TakeoverSticks, GrantInTheFirstOfTwoHeartbeatsIsGivenBackInThatStep)
{
    Bench b = on_mission(link::AutopilotStack::ardupilot);
    b.step(wants(Beat::former));
    EXPECT_EQ(requests_within(b, 0.1F), 1);
    with(b, kWant, true, false);
    b.step(wants(Beat::former));  // sent before the grant
    EXPECT_EQ(with_two(b, wants(Beat::external), wants(Beat::external)).action, TakeoverAction::request_former);
}

TEST(TakeoverUnfollowed, GivesUpAsksForTheHoldAndOnlyAdvisesUntilDisarmed)
{
    Bench b = in_control_of(link::AutopilotStack::ardupilot);
    const TakeoverOutput out = with(b, kWant, false, true);
    EXPECT_EQ(out.event, TakeoverEvent::unfollowed);
    EXPECT_EQ(out.action, TakeoverAction::request_hold);
    EXPECT_FALSE(b.takeover.streaming());
    EXPECT_EQ(b.step(wants(Beat::hold, 0.2F)).event, TakeoverEvent::held);
    b.step(calm(Beat::former, 1.0F));
    b.step(wants(Beat::former, 1.0F));
    EXPECT_EQ(requests_within(b, 3.0F), 0);
    EXPECT_FALSE(b.takeover.streaming());
    b.step(calm(Beat::disarmed));
    b.step(calm(Beat::former, 1.0F));
    b.step(wants(Beat::former, 1.0F));
    EXPECT_EQ(b.control(), Control::announcing);
}

TEST(TakeoverVehicle, ThatCannotBeSteeredIsNeverTakenOver)
{
    Takeover takeover;
    TakeoverInput input = input_of(wants(Beat::former));
    input.report.steerable = false;
    input.urgent_hold = true;
    TimePoint now{1'000'000};
    for (int i = 0; i < 500; ++i) {
        now = now + 0.02F;
        const TakeoverOutput out = takeover.update(input, now);
        ASSERT_EQ(out.action, TakeoverAction::none);
        ASSERT_FALSE(takeover.streaming());
    }
}

}  // namespace
}  // namespace jink::app
