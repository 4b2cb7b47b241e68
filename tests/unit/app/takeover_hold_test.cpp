// SPDX-License-Identifier: BSD-3-Clause
// Behaviour after a loss of control (the hold mode, requested until confirmed), and PX4's requirement of a prior
// stream.
#include <gtest/gtest.h>

#include "tests/unit/app/takeover_bench.hpp"

namespace jink::app {
namespace {

using namespace test;

Bench flying()
{
    Bench b;
    b.step(wants(Beat::former));
    b.step(wants(Beat::none, 0.1F));
    EXPECT_EQ(b.step(wants(Beat::external, 0.2F)).event, TakeoverEvent::took_over);
    return b;
}

Bench lost()
{
    Bench b = flying();
    const TakeoverOutput out = b.step(fault(Beat::none));
    EXPECT_EQ(out.event, TakeoverEvent::lost);
    EXPECT_EQ(out.action, TakeoverAction::request_hold);
    return b;
}

constexpr Step accepted(float dt) { return {true, false, Beat::none, dt, false, true}; }
constexpr Step dead(Beat beat, float dt) { return {true, false, beat, dt, false, false, false}; }

TEST(TakeoverHold, IsAskedForAgainUntilTheTriesAreUsedUp)
{
    Bench b = lost();
    int asked = 1;
    for (int i = 0; i < 1000; ++i) {
        const TakeoverOutput out = b.step(fault(i % 50 == 0 ? Beat::external : Beat::none));
        asked += out.action == TakeoverAction::request_hold ? 1 : 0;
        ASSERT_FALSE(b.takeover.streaming());
    }
    EXPECT_EQ(asked, Takeover::kHoldTries);
    EXPECT_EQ(b.takeover.diagnostics().hold_requests, static_cast<std::uint32_t>(Takeover::kHoldTries));
}

TEST(TakeoverHold, IsAskedForAgainAfterHalfASecondWithoutAnAnswer)
{
    Bench b = lost();
    EXPECT_EQ(b.step(fault(Beat::external, 0.48F)).action, TakeoverAction::none);
    EXPECT_EQ(b.step(fault(Beat::none, 0.03F)).action, TakeoverAction::request_hold);
    EXPECT_EQ(b.step(fault(Beat::none, 0.02F)).action, TakeoverAction::none);
}

TEST(TakeoverHold, AcceptedButStillNotSeenAfterASecondIsAskedForAgain)
{
    Bench b = lost();
    EXPECT_EQ(b.step(accepted(0.1F)).action, TakeoverAction::none);
    EXPECT_EQ(b.step(fault(Beat::external, 0.5F)).action, TakeoverAction::none) << "sent before it was heeded, perhaps";
    EXPECT_EQ(b.step(fault(Beat::none, 0.5F)).action, TakeoverAction::none) << "accepted, and no HEARTBEAT since";
    EXPECT_EQ(b.step(fault(Beat::external)).action, TakeoverAction::request_hold);
}

/// The vehicle has flown our set-points since the accepted answer.
TEST(TakeoverHold, IsAskedForWhereAFaultComesBetweenTheAcceptedAnswerAndItsHeartbeat)
{
    for (const bool late : {false, true}) {
        Bench b;
        b.step(wants(Beat::former));
        ASSERT_EQ(b.step(wants(Beat::none, 0.1F)).action, TakeoverAction::request_external);
        b.step({true, true, Beat::none, 0.05F, false, true});
        ASSERT_TRUE(b.takeover.follows());
        const TakeoverOutput out = b.step(fault(Beat::none));
        EXPECT_EQ(out.event, TakeoverEvent::lost);
        EXPECT_EQ(out.action, TakeoverAction::none) << "nobody has seen the external mode yet";
        if (late) {
            EXPECT_EQ(b.step(fault(Beat::former)).action, TakeoverAction::none) << "sent before the answer, perhaps";
        }
        EXPECT_EQ(b.step(fault(Beat::external, 0.3F)).action, TakeoverAction::request_hold);
        EXPECT_EQ(b.takeover.diagnostics().lost_by_fault, 1U);
        EXPECT_EQ(b.step(fault(Beat::hold, 0.3F)).action, TakeoverAction::none);
        EXPECT_EQ(b.step(fault(Beat::external, 5.0F)).action, TakeoverAction::none) << "somebody else's";
    }
}

TEST(TakeoverHold, IsNotAskedForWhereTheGrantedModeNeverShows)
{
    Bench b;
    b.step(wants(Beat::former));
    b.step(wants(Beat::none, 0.1F));
    b.step({true, true, Beat::none, 0.05F, false, true});
    b.step(fault(Beat::none));
    EXPECT_EQ(b.step(fault(Beat::former, Takeover::kConfirm)).action, TakeoverAction::none);
    EXPECT_EQ(b.step(fault(Beat::external, 0.5F)).action, TakeoverAction::none) << "somebody else's";
}

TEST(TakeoverHold, AnyOtherModeSeenEndsIt)
{
    for (const Beat beat : {Beat::hold, Beat::manual, Beat::former, Beat::disarmed}) {
        Bench b = lost();
        EXPECT_EQ(b.step(fault(beat, 0.6F)).action, TakeoverAction::none) << describe(fault(beat));
        for (int i = 0; i < 20; ++i) {
            EXPECT_EQ(b.step(fault(Beat::none, 0.5F)).action, TakeoverAction::none) << describe(fault(beat));
            EXPECT_EQ(b.step(fault(Beat::external, 0.5F)).action, TakeoverAction::none) << describe(fault(beat));
        }
    }
}

TEST(TakeoverHold, IsNotAskedForOfAPilotWhoCommandsTheExternalModeAfterwards)
{
    Bench b = lost();
    EXPECT_EQ(b.step(fault(Beat::manual, 0.6F)).event, TakeoverEvent::overruled);
    for (int i = 0; i < 20; ++i) {
        const Step calm_fault{false, false, Beat::external, 0.5F};
        EXPECT_EQ(b.step(calm_fault).action, TakeoverAction::none) << "the conflict is over, the fault is not";
    }
}

TEST(TakeoverHold, IsNotWastedOnALostLine)
{
    Bench b = flying();
    EXPECT_EQ(b.step(dead(Beat::none, 0.02F)).action, TakeoverAction::none);
    for (int i = 0; i < 9; ++i) {
        EXPECT_EQ(b.step(dead(Beat::none, 1.0F)).action, TakeoverAction::none);
    }
    const TakeoverOutput back = b.step(fault(Beat::none));
    EXPECT_EQ(back.action, TakeoverAction::none) << "what the autopilot does now is not known yet";
    EXPECT_TRUE(back.ask_heartbeat);
    EXPECT_EQ(b.step(fault(Beat::external)).action, TakeoverAction::request_hold) << "the answer";
}

TEST(TakeoverHold, IsNotAskedForOfAPilotWhoTookOverWhileTheLineWasLost)
{
    for (const Beat beat : {Beat::manual, Beat::former, Beat::hold, Beat::disarmed}) {
        Bench b = flying();
        b.step(dead(Beat::none, 0.02F));
        b.step(dead(Beat::none, 5.0F));
        for (int i = 0; i < 20; ++i) {
            EXPECT_EQ(b.step(fault(beat, 0.1F)).action, TakeoverAction::none) << describe(fault(beat));
        }
    }
}

TEST(TakeoverHold, ComesAfterControlWasTakenUpAgainAndIsNobodyElses)
{
    Bench b = lost();
    EXPECT_EQ(b.step(wants(Beat::external, 0.1F)).event, TakeoverEvent::took_over);
    const TakeoverOutput out = b.step(wants(Beat::hold, 0.2F));
    EXPECT_EQ(out.event, TakeoverEvent::held);
    EXPECT_EQ(b.control(), Control::autopilot);
    EXPECT_EQ(b.takeover.diagnostics().held, 1U);
    EXPECT_EQ(b.takeover.diagnostics().overruled, 0U);
    b.step(wants(Beat::external, 0.2F));
    EXPECT_EQ(b.control(), Control::autopilot) << "the hold is final";
}

TEST(TakeoverHold, LongAfterTheRequestIsThePilots)
{
    Bench b = lost();
    b.step(wants(Beat::external, 0.1F));
    EXPECT_EQ(b.step(wants(Beat::hold, 1.0F)).event, TakeoverEvent::overruled);
}

TEST(TakeoverHold, StopsWhenControlIsTakenUpAgain)
{
    Bench b = lost();
    b.step(wants(Beat::external, 0.1F));
    for (int i = 0; i < 10; ++i) {
        EXPECT_EQ(b.step(wants(Beat::external, 0.5F)).action, TakeoverAction::none);
    }
    EXPECT_EQ(b.control(), Control::ours);
}

/// A PX4 that plays the documented rule: nothing before the stream is a second old.
TEST(TakeoverPx4, IsAskedAgainUntilTheStreamIsOldEnough)
{
    Bench b;
    b.stack = link::AutopilotStack::px4;
    b.step(wants(Beat::former));
    const TimePoint began = b.now;
    bool denied_next = false;
    int asked = 0;
    bool granted = false;
    bool asked_for = false;
    for (int i = 0; i < 200 && !granted; ++i) {
        Step s = asked_for ? wants(Beat::former) : kWant;  // requests of a HEARTBEAT are served
        s.denied = denied_next;
        const TakeoverOutput out = b.step(s);
        asked_for = out.ask_heartbeat;
        ASSERT_TRUE(b.takeover.streaming());
        denied_next = false;
        if (out.action == TakeoverAction::request_external) {
            ++asked;
            granted = b.now - began > 1.0F;
            denied_next = !granted;
        }
    }
    EXPECT_TRUE(granted);
    EXPECT_LT(b.now - began, 1.3F) << "not a second later than it could";
    EXPECT_LE(asked, 7);
    EXPECT_EQ(b.step(wants(Beat::external)).event, TakeoverEvent::took_over);
}

TEST(TakeoverHold, IsAskedForAlsoWhereAHeartbeatComesInTheStepOfTheLoss)
{
    Bench b;
    b.step(wants(Beat::former));
    b.step(wants(Beat::none, 0.1F));
    ASSERT_EQ(b.step(wants(Beat::external, 0.2F)).event, TakeoverEvent::took_over);
    const TakeoverOutput out = b.step(fault(Beat::external));
    EXPECT_EQ(out.event, TakeoverEvent::lost);
    EXPECT_EQ(out.action, TakeoverAction::request_hold);
}

TEST(TakeoverPx4, ThatNeverGrantsIsGivenUpAfterThreeMoreTries)
{
    Bench b;
    b.stack = link::AutopilotStack::px4;
    b.step(wants(Beat::former));
    const TimePoint began = b.now;
    bool denied_next = false;
    int asked = 0;
    bool asked_for = false;
    while (b.control() != Control::refused && b.now - began < 20.0F) {
        Step s = asked_for ? wants(Beat::former) : kWant;
        s.denied = denied_next;
        const TakeoverOutput out = b.step(s);
        asked_for = out.ask_heartbeat;
        denied_next = out.action == TakeoverAction::request_external;
        asked += denied_next ? 1 : 0;
    }
    EXPECT_EQ(b.control(), Control::refused);
    EXPECT_GE(asked, 4 + Takeover::kTries);
    EXPECT_LE(asked, 7 + Takeover::kTries);
    EXPECT_LT(b.now - began, Takeover::kProof + 3.1F * Takeover::kConfirm + 1.0F);
}

TEST(TakeoverPx4, WithoutAnAnswerIsAskedOnceASecond)
{
    Bench b;
    b.stack = link::AutopilotStack::px4;
    b.step(wants(Beat::former));
    EXPECT_EQ(b.step(wants(Beat::none, 0.1F)).action, TakeoverAction::request_external);
    EXPECT_EQ(b.step(wants(Beat::former, 0.9F)).action, TakeoverAction::none);
    EXPECT_EQ(b.step(wants(Beat::former, 0.11F)).action, TakeoverAction::request_external);
}

}  // namespace
}  // namespace jink::app
