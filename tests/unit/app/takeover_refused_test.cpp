// SPDX-License-Identifier: BSD-3-Clause
// An autopilot that refused the external mode is asked to hold in time: where, when and how often.
#include <gtest/gtest.h>

#include "tests/unit/app/takeover_bench.hpp"

namespace jink::app {
namespace {

using namespace test;

Bench never_granted()
{
    Bench b;
    b.step(wants(Beat::former));
    EXPECT_EQ(b.step(wants(Beat::none, 0.1F)).action, TakeoverAction::request_external);
    EXPECT_EQ(b.step(wants(Beat::former, 1.01F)).action, TakeoverAction::request_external);
    EXPECT_EQ(b.step(wants(Beat::former, 1.01F)).action, TakeoverAction::request_external);
    EXPECT_EQ(b.step(wants(Beat::none, 1.01F)).event, TakeoverEvent::refused);
    return b;
}

TEST(TakeoverRefused, HoldIsNotAskedForUnderAFault)
{
    Bench b = never_granted();
    for (int i = 0; i < 100; ++i) {
        ASSERT_EQ(b.step(fault(Beat::former)).action, TakeoverAction::none) << i;
    }
    EXPECT_EQ(b.takeover.diagnostics().hold_requests, 0U);
    EXPECT_EQ(b.step(wants(Beat::former)).action, TakeoverAction::request_hold) << "the fault is over";
}

TEST(TakeoverRefused, HoldIsAskedForOnAHeartbeatAfterTheLastRequestAlone)
{
    Bench b = never_granted();
    EXPECT_EQ(b.step(kWant).action, TakeoverAction::none) << "the last HEARTBEAT came with the last request";
    EXPECT_EQ(b.step(wants(Beat::former)).action, TakeoverAction::request_hold);
}

TEST(TakeoverRefused, HoldWaitsUntilItIsUrgent)
{
    Bench b = never_granted();
    TakeoverInput input = input_of(wants(Beat::former));
    input.urgent_hold = false;
    for (int i = 0; i < 100; ++i) {
        b.now = b.now + 0.02F;
        ASSERT_EQ(b.takeover.update(input, b.now).action, TakeoverAction::none) << i;
    }
    input.urgent_hold = true;
    EXPECT_EQ(b.takeover.update(input, b.now + 0.02F).action, TakeoverAction::request_hold);
}

TEST(TakeoverRefused, MissionInTheFirstOfTwoHeartbeatsIsAskedToHoldInThatStep)
{
    Bench b = never_granted();
    EXPECT_EQ(b.step(wants(Beat::former)).action, TakeoverAction::request_hold);
    EXPECT_EQ(b.step(wants(Beat::hold, 1.0F)).action, TakeoverAction::none);
    EXPECT_EQ(with_two(b, wants(Beat::former), wants(Beat::former, 0.05F)).action, TakeoverAction::request_hold)
        << "the mission was resumed, and the conflict goes on";
    EXPECT_EQ(b.takeover.diagnostics().hold_requests, 2U);
}

TEST(TakeoverRefused, MissionThatIsOverWithinTheStepIsNotAskedToHold)
{
    Bench b = never_granted();
    EXPECT_EQ(b.step(wants(Beat::former)).action, TakeoverAction::request_hold);
    b.step(wants(Beat::hold, 1.0F));
    const TakeoverOutput out = with_two(b, wants(Beat::former), wants(Beat::manual, 0.05F));
    EXPECT_EQ(out.action, TakeoverAction::none);
    EXPECT_EQ(out.event, TakeoverEvent::overruled);
    EXPECT_EQ(b.takeover.diagnostics().hold_requests, 1U) << "no request is counted that was not sent";
}

}  // namespace
}  // namespace jink::app
