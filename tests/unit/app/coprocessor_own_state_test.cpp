// SPDX-License-Identifier: BSD-3-Clause
// The own state between two reports of it.
#include <memory>

#include <gtest/gtest.h>

#include "tests/unit/app/direct_flight.hpp"
#include "tests/unit/app/flight.hpp"

namespace jink::app::test {
namespace {

/// 5 m/s towards a point obstacle, last own-state report some ticks ago.
TEST(CoprocessorOwnState, IsCarriedForwardToTheStepByItsVelocity)
{
    const auto f = std::make_unique<Flight>();
    f->obeys = false;
    f->obstacles = {Vec3(0.0F, 60.0F, 50.0F)};
    ASSERT_TRUE(f->until([](const StepReport& r) { return r.guidance.conflict.has_value(); }));
    f->fly(5);
    ASSERT_TRUE(f->last.guidance.conflict.has_value());
    const float before = f->last.guidance.conflict->time_to_loss;
    f->own_state = false;
    constexpr int kTicks = 20;
    f->fly(kTicks);
    ASSERT_TRUE(f->last.guidance.conflict.has_value());
    EXPECT_NEAR(f->last.guidance.conflict->time_to_loss, before - 0.02F * static_cast<float>(kTicks), 0.03F);
}

/// A link whose clock runs ahead. 50 ms are taken for jitter, and not flown backwards.
TEST(CoprocessorOwnState, FromTheFutureIsRefusedAndCounted)
{
    DirectLink link;
    SilentPort port;
    IdleWatchdog watchdog;
    const auto coprocessor = std::make_unique<Coprocessor>(link, port, watchdog, Parameters{});
    TimePoint now{5'000'000};
    const auto give = [&](Seconds ahead, float north) {
        link.next.has_own_state = true;
        link.next.own_state.state.stamp = now + ahead;
        link.next.own_state.state.position = Vec3(0.0F, north, 50.0F);
        link.next.own_state.state.velocity = Vec3(0.0F, 5.0F, 0.0F);
        static_cast<void>(coprocessor->step(now));
        now = now + 0.02F;
    };
    give(0.0F, 1.0F);
    give(0.1F, 2.0F);
    EXPECT_EQ(coprocessor->diagnostics().own_state_refused, 1U);
    EXPECT_EQ(coprocessor->own().position.y(), 1.0F);
    give(0.04F, 3.0F);
    EXPECT_EQ(coprocessor->diagnostics().own_state_refused, 1U);
    EXPECT_EQ(coprocessor->own().position.y(), 3.0F);
}

}  // namespace
}  // namespace jink::app::test
