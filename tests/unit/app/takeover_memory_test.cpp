// SPDX-License-Identifier: BSD-3-Clause
// The take-over's memory of an earlier request, loss or flight, and evidence that it needs again.
#include <gtest/gtest.h>

#include "tests/unit/app/takeover_bench.hpp"

namespace jink::app {
namespace {

using namespace test;

const Change kLate = [](TakeoverInput& in) { in.report_is_late = true; };

TEST(TakeoverMemory, DropByAFaultIsSilenceAndAsksForNothing)
{
    Bench b = commanding();
    b.takeover.drop(true);
    for (int i = 0; i < 20; ++i) {
        EXPECT_EQ(b.step(fault(Beat::external, 0.3F)).action, TakeoverAction::none) << i;
    }
}

TEST(TakeoverMemory, HoldSoonAfterANewTakeoverIsThePilots)
{
    Bench b = commanding();
    ASSERT_EQ(b.step(fault(Beat::external)).action, TakeoverAction::request_hold);
    b.step(fault(Beat::former));  // the pilot's choice
    b.step(wants(Beat::former));
    ASSERT_EQ(b.control(), Control::announcing);
    ASSERT_EQ(b.step(wants(Beat::none, 0.07F)).action, TakeoverAction::request_external);
    ASSERT_EQ(b.step(wants(Beat::external, 0.1F)).event, TakeoverEvent::took_over);
    EXPECT_EQ(b.step(wants(Beat::hold, 0.1F)).event, TakeoverEvent::overruled) << "nobody asked this one to hold";
}

TEST(TakeoverMemory, SecondTakeoverOwesNothingToTheReturnOfTheFirst)
{
    Bench b = commanding();
    ASSERT_EQ(b.step(calm(Beat::external)).action, TakeoverAction::request_former);
    ASSERT_EQ(b.step(calm(Beat::former)).event, TakeoverEvent::gave_back);
    b.step(wants(Beat::former));
    ASSERT_EQ(b.control(), Control::announcing);
    ASSERT_EQ(b.step(wants(Beat::none, 0.07F)).action, TakeoverAction::request_external)
        << "the first request was answered: nothing is waited for";
    ASSERT_EQ(b.step(wants(Beat::external, 0.1F)).event, TakeoverEvent::took_over);
    EXPECT_EQ(b.step(wants(Beat::former, 0.1F)).event, TakeoverEvent::overruled) << "the pilot's choice";
    EXPECT_EQ(b.takeover.diagnostics().taken, 2U);
}

TEST(TakeoverMemory, FormerModeSoonAfterARetakenTakeoverIsThePilots)
{
    Bench b = commanding();
    b.step(fault(Beat::external));
    ASSERT_EQ(b.step(wants(Beat::external)).event, TakeoverEvent::took_over);
    EXPECT_EQ(b.step(wants(Beat::former)).event, TakeoverEvent::overruled) << "it was never asked for";
}

TEST(TakeoverMemory, PilotsHoldDuringAFaultAfterTheRequestIsFinal)
{
    Bench b = awaiting();
    b.step(fault(Beat::none));
    EXPECT_EQ(b.step(fault(Beat::hold)).event, TakeoverEvent::overruled);
    EXPECT_EQ(b.control(), Control::overruled);
}

TEST(TakeoverMemory, ExternalModeIsTakenUpAgainOnFreshEvidenceAlone)
{
    Bench b = commanding();
    b.step(fault(Beat::external));
    b.step(fault(Beat::external));  // observed since the loss
    b.step(fault(Beat::none, 2.0F));
    for (int i = 0; i < 20; ++i) {
        const TakeoverOutput out = b.step(wants(Beat::none, 0.1F));
        EXPECT_FALSE(b.takeover.streaming()) << i;
        EXPECT_TRUE(out.ask_heartbeat) << i;
    }
    EXPECT_EQ(b.step(wants(Beat::external)).event, TakeoverEvent::took_over);
}

TEST(TakeoverMemory, NoStreamBeginsForATickOnOldEvidence)
{
    Bench b;
    b.step(calm(Beat::former));
    b.step(calm(Beat::none, 1.6F));
    for (int i = 0; i < 50; ++i) {
        b.step(kWant);
        EXPECT_FALSE(b.takeover.streaming()) << i;
    }
}

TEST(TakeoverMemory, AfterAFaultTheModeHasToBeSeenAnew)
{
    Bench b;
    b.step(wants(Beat::former));
    ASSERT_EQ(b.control(), Control::announcing);
    b.step(fault(Beat::none));
    for (int i = 0; i < 10; ++i) {
        b.step(kWant);
        EXPECT_FALSE(b.takeover.streaming()) << i;
    }
    b.step(wants(Beat::former));
    EXPECT_TRUE(b.takeover.streaming());
    b.step(fault(Beat::former));
    b.step(kWant);
    EXPECT_TRUE(b.takeover.streaming()) << "seen in the tick of the fault";
}

TEST(TakeoverMemory, LateHeartbeatWhileWaitingDoesNotEndTheClaim)
{
    Bench b = awaiting();
    EXPECT_EQ(varied(b, wants(Beat::former, 1.1F), kLate).action, TakeoverAction::none);
    ASSERT_EQ(b.control(), Control::requesting);
    EXPECT_EQ(b.step(wants(Beat::external)).event, TakeoverEvent::took_over);
}

TEST(TakeoverMemory, EndOfTheWishAsksForNoHeartbeat)
{
    Bench b;
    b.step(wants(Beat::former));
    ASSERT_EQ(b.control(), Control::announcing);
    b.now = b.now + 0.04F;
    EXPECT_FALSE(b.step(kCalm).ask_heartbeat);
    EXPECT_EQ(b.control(), Control::autopilot);
}

TEST(TakeoverMemory, YoungStreamIsAskedAgainByAPx4WhateverTheTries)
{
    Bench b;
    b.stack = link::AutopilotStack::px4;
    b.step(wants(Beat::former));
    b.step(wants(Beat::none, 0.1F));
    b.step(wants(Beat::former, 1.3F));
    for (int i = 1; i < Takeover::kTries; ++i) {
        b.step(wants(Beat::former, 1.0F));
    }
    ASSERT_EQ(b.takeover.diagnostics().requests, 4U) << "one by a young stream and kTries";
    b.step(fault(Beat::former, 1.1F));
    b.step(wants(Beat::former));
    ASSERT_EQ(b.control(), Control::announcing);
    EXPECT_EQ(b.step(wants(Beat::none, 0.07F)).action, TakeoverAction::request_external);
}

TEST(TakeoverMemory, ReturnIsOurWorkUntilAHeartbeatShowsThatItWasLost)
{
    Bench b = commanding();
    ASSERT_EQ(b.step(calm(Beat::external)).action, TakeoverAction::request_former);
    b.step(kWant);
    EXPECT_EQ(b.control(), Control::ours);
    b.step(kCalm);
    EXPECT_EQ(b.control(), Control::returning) << "it is still on its way";
    b.step(wants(Beat::none, 1.1F));
    EXPECT_EQ(b.step(wants(Beat::former)).event, TakeoverEvent::gave_back);
}

TEST(TakeoverMemory, DeniedVehicleIsAskedToHoldAtOnceAndThatIsNoNews)
{
    Bench b = awaiting();
    for (int i = 0; i < 2; ++i) {
        b.step(denied(0.02F));
        ASSERT_EQ(b.step(wants(Beat::former, 0.05F)).action, TakeoverAction::request_external) << i;
    }
    b.step(denied(0.02F));
    ASSERT_EQ(b.step(wants(Beat::none, 0.05F)).event, TakeoverEvent::refused);
    EXPECT_EQ(b.step(wants(Beat::former)).action, TakeoverAction::request_hold);
    EXPECT_EQ(b.step(wants(Beat::hold)).event, TakeoverEvent::none);
    EXPECT_EQ(b.takeover.diagnostics().held, 0U) << "control was never given up";
    EXPECT_EQ(b.control(), Control::refused);
}

TEST(TakeoverMemory, GrantAfterMovedSticksIsWaitedForWhileNothingIsHeard)
{
    Bench b = awaiting();
    ASSERT_EQ(varied(b, kWant, [](TakeoverInput& in) { in.sticks_moved = true; }).event, TakeoverEvent::sticks);
    for (int i = 0; i < 15; ++i) {
        EXPECT_EQ(b.step(wants(Beat::none, 0.1F)).action, TakeoverAction::none);
    }
    EXPECT_EQ(b.step(wants(Beat::external)).action, TakeoverAction::request_former);
}

TEST(TakeoverMemory, PilotsModeIsReportedThoughAnotherHeartbeatFollowsInTheStep)
{
    Bench b = commanding();
    TakeoverInput input = input_of(wants(Beat::former));
    const std::array<link::AutopilotReport, 2> earlier{input_of(wants(Beat::manual)).report, input.report};
    input.earlier = earlier;
    EXPECT_EQ(b.takeover.update(input, b.now + 0.02F).event, TakeoverEvent::overruled);
    EXPECT_EQ(b.control(), Control::overruled);
    EXPECT_EQ(b.takeover.diagnostics().overruled, 1U);
}

TEST(TakeoverMemory, ExternalModeIsFoundAnewAfterASilenceThatEndedAClaimOnly)
{
    Bench found;
    EXPECT_EQ(found.step(calm(Beat::former)).event, TakeoverEvent::none) << "a mission is nothing to report";
    EXPECT_EQ(found.step(calm(Beat::external, 11.0F)).event, TakeoverEvent::none) << "the pilot's";
    Bench asked = awaiting();
    EXPECT_EQ(asked.step(wants(Beat::external, 11.0F)).event, TakeoverEvent::overruled);
    EXPECT_FALSE(asked.takeover.streaming());
    Bench lost = commanding();
    lost.step(fault(Beat::none));
    EXPECT_EQ(lost.step(fault(Beat::external, 11.0F)).event, TakeoverEvent::found);
}

TEST(TakeoverMemory, NoStreamIsProvenToAVehicleThatDidNotFollow)
{
    Bench b;
    b.stack = link::AutopilotStack::px4;
    b.stands_by = true;
    b.step(calm(Beat::former));
    ASSERT_TRUE(b.takeover.proving());
    ASSERT_EQ(b.step(wants(Beat::former, 2.0F)).action, TakeoverAction::request_external);
    ASSERT_EQ(b.step(wants(Beat::external)).event, TakeoverEvent::took_over);
    ASSERT_EQ(varied(b, kWant, [](TakeoverInput& in) { in.unfollowed = true; }).event, TakeoverEvent::unfollowed);
    b.step(calm(Beat::hold));
    for (int i = 0; i < 5; ++i) {
        b.step(calm(Beat::former, 0.5F));
        EXPECT_FALSE(b.takeover.proving()) << i;
    }
    b.step(calm(Beat::disarmed));
    b.step(calm(Beat::former));
    EXPECT_TRUE(b.takeover.proving()) << "another flight";
}

TEST(TakeoverMemory, SticksBeforeARebootAreForgottenInTheNextTakeover)
{
    Bench b = commanding();
    ASSERT_EQ(varied(b, wants(Beat::external), kSticks).action, TakeoverAction::request_former);
    b.takeover.drop(false);
    b.step(wants(Beat::former));
    ASSERT_EQ(b.step(wants(Beat::none, 0.07F)).action, TakeoverAction::request_external);
    ASSERT_EQ(b.step(wants(Beat::external)).event, TakeoverEvent::took_over);
    ASSERT_EQ(b.step(wants(Beat::manual)).event, TakeoverEvent::overruled);
    for (int i = 0; i < 5; ++i) {
        EXPECT_EQ(b.step(wants(Beat::external, 0.5F)).action, TakeoverAction::none) << "the pilot's external mode";
    }
    b.step(calm(Beat::external));
    EXPECT_EQ(b.control(), Control::autopilot);
}

TEST(TakeoverMemory, NoFormerModeIsAskedForAfterASilenceThatEndedTheClaim)
{
    for (const float silence : {9.0F, 11.0F}) {
        Bench b = commanding();
        const TakeoverOutput out = varied(b, kWant, [](TakeoverInput& in) {
            in.sticks_moved = true;
            in.link_alive = false;
        });
        ASSERT_EQ(out.event, TakeoverEvent::sticks);
        ASSERT_EQ(out.action, TakeoverAction::none);
        EXPECT_EQ(b.step(wants(Beat::external, silence)).action,
                  silence < 10.0F ? TakeoverAction::request_former : TakeoverAction::none);
    }
}

TEST(TakeoverMemory, TriesAreCountedAnewAfterATakeover)
{
    Bench b = awaiting();
    b.step(wants(Beat::former, 1.01F));
    ASSERT_EQ(b.step(wants(Beat::external, 0.2F)).event, TakeoverEvent::took_over);
    const Step still = wants(Beat::external);
    TakeoverInput input = input_of(still);
    input.wants_control = false;
    b.now = b.now + 0.02F;
    ASSERT_EQ(b.takeover.update(input, b.now).action, TakeoverAction::request_former);
    TakeoverInput back = input_of(wants(Beat::former));
    b.now = b.now + 0.02F;
    ASSERT_EQ(b.takeover.update(back, b.now).event, TakeoverEvent::gave_back);
    int requests = 0;
    for (int i = 0; i < 100 && b.control() != Control::refused; ++i) {
        requests += b.step(wants(Beat::former, 0.1F)).action == TakeoverAction::request_external ? 1 : 0;
    }
    EXPECT_EQ(requests, Takeover::kTries) << "the same conflict, another take-over";
}

TEST(TakeoverMemory, DenialIsThatOfOneRequest)
{
    Bench b = awaiting();
    b.step(denied(0.02F));
    ASSERT_EQ(b.step(wants(Beat::former, 0.05F)).action, TakeoverAction::request_external);
    for (int i = 0; i < 9; ++i) {
        EXPECT_EQ(b.step(wants(Beat::former, 0.1F)).action, TakeoverAction::none) << "nobody has denied this one";
    }
    EXPECT_EQ(b.step(wants(Beat::former, 0.2F)).action, TakeoverAction::request_external);
}

TEST(TakeoverMemory, VehicleThatDoesNotFollowHasItsOwnHoldRequests)
{
    Bench b = commanding();
    for (int i = 0; i < 20; ++i) {
        Step s = fault(Beat::external, 0.5F);
        s.accepted = i == 17;
        b.step(s);
    }
    ASSERT_EQ(b.takeover.diagnostics().hold_requests, static_cast<std::uint32_t>(Takeover::kHoldTries));
    ASSERT_EQ(b.step(wants(Beat::external)).event, TakeoverEvent::took_over);
    EXPECT_EQ(varied(b, wants(Beat::external), kUnfollowed).action, TakeoverAction::request_hold);
    EXPECT_EQ(b.step(wants(Beat::external, 0.51F)).action, TakeoverAction::request_hold) << "unanswered";
}

TEST(TakeoverMemory, ExternalModeRightAfterTheReturnIsThePilots)
{
    Bench b = commanding();
    ASSERT_EQ(b.step(calm(Beat::external)).action, TakeoverAction::request_former);
    ASSERT_EQ(b.step(calm(Beat::former)).event, TakeoverEvent::gave_back);
    EXPECT_EQ(b.step(wants(Beat::external)).event, TakeoverEvent::none);
    EXPECT_FALSE(b.takeover.streaming());
}

TEST(TakeoverMemory, ExternalModeAfterARefusedMissionWentOnIsThePilots)
{
    Bench b = declined();
    varied(b, wants(Beat::former), [](TakeoverInput& in) { in.urgent_hold = false; });
    b.step(wants(Beat::external));
    EXPECT_EQ(b.control(), Control::refused);
    EXPECT_FALSE(b.takeover.streaming());
}

}  // namespace
}  // namespace jink::app
