// SPDX-License-Identifier: BSD-3-Clause
// Own state, HEARTBEATs and frames in Coprocessor::step: accepted, refused, extrapolated and forgotten.
#include <gtest/gtest.h>

#include "tests/unit/app/step_bench.hpp"

namespace jink::app::test {
namespace {

using Bus = StepBench::Bus;

std::unique_ptr<StepBench> bench(std::initializer_list<std::pair<Param, float>> changes = {}, Bus bus = Bus::none)
{
    return std::make_unique<StepBench>(changes, bus);
}

/// Without growth of threats: a collision course is a matter of lengths alone.
std::unique_ptr<StepBench> exact_bench(Bus bus = Bus::none)
{
    return bench({{Param::k_sigma, 0.0F}, {Param::mode, 1.0F}, {Param::lookahead, 20.0F}}, bus);
}

TEST(StepOwnState, StampedInTheFutureIsRefused)
{
    const auto b = bench();
    b->hear_autopilot();
    b->hear_own(-0.0501F);
    b->step();
    EXPECT_EQ(b->counted().own_state_refused, 1U);
    EXPECT_EQ(b->counted().own_states, 0U);
    EXPECT_TRUE(b->has(Fault::own_state_missing));
    EXPECT_EQ(b->last.own_source, OwnSource::none);
    b->hear_own(-0.05F);
    b->step();
    EXPECT_EQ(b->counted().own_state_refused, 1U) << "clocks differ by as much";
    EXPECT_EQ(b->counted().own_states, 1U);
    EXPECT_EQ(b->last.faults, 0U);
    EXPECT_EQ(b->last.own_source, OwnSource::autopilot);
}

TEST(StepOwnState, OlderThanWhatIsKnownIsRefused)
{
    const auto b = bench();
    b->fly(2);
    const Vec3 known = b->coprocessor.own().position;
    const TimePoint stamp = b->coprocessor.own().stamp;
    const auto hear = [&](std::int64_t us, float place) {
        link::OwnStateReport& r = b->hear_own();
        r.state.stamp = {us};
        r.state.position = Vec3(place, place, place);
        b->step();
    };
    hear(stamp.us - 1, 9.0F);
    EXPECT_EQ(b->counted().own_state_refused, 1U);
    EXPECT_EQ(b->coprocessor.own().position, known);
    hear(stamp.us, 7.0F);
    EXPECT_EQ(b->counted().own_state_refused, 1U) << "of the same instant";
    EXPECT_EQ(b->coprocessor.own().position, Vec3(7.0F, 7.0F, 7.0F));
    hear(stamp.us + 1000, 8.0F);
    hear(stamp.us + 999, 9.0F);
    EXPECT_EQ(b->coprocessor.own().position, Vec3(8.0F, 8.0F, 8.0F));
    EXPECT_EQ(b->counted().own_state_refused, 2U);
}

/// The own position of `age` ago, extrapolated to now: a mast is 40 m ahead of it. Own box and mast take 2 m.
TEST(StepOwnState, IsFlownOnFromItsStampToNow)
{
    for (const float age : {0.0F, 0.1F, 0.3F, 0.5F}) {
        SCOPED_TRACE(age);
        const auto b = exact_bench();
        b->hear_autopilot();
        b->hear_own(age);
        b->hear_mast(1, b->position + Vec3(0.0F, 40.0F, 0.0F));
        b->step();
        ASSERT_TRUE(b->last.guidance.conflict.has_value());
        EXPECT_NEAR(b->last.guidance.conflict->time_to_loss, (40.0F - 2.0F) / 5.0F - age, 0.01F);
    }
}

TEST(StepOwnState, IsNotFlownBackwardsWhereItsStampLiesAhead)
{
    const auto b = exact_bench();
    b->hear_autopilot();
    b->hear_own(-0.05F);
    b->hear_mast(1, b->position + Vec3(0.0F, 40.0F, 0.0F));
    b->step();
    ASSERT_TRUE(b->last.guidance.conflict.has_value());
    EXPECT_NEAR(b->last.guidance.conflict->time_to_loss, (40.0F - 2.0F) / 5.0F, 0.005F);
}

TEST(StepOwnState, IsAFaultWhenOlderThanItMayBe)
{
    const auto b = bench();
    b->fly(1);
    b->step(480'000);
    b->step(20'000);
    EXPECT_EQ(b->last.faults, 0U) << "0.5 s to the microsecond";
    EXPECT_EQ(b->last.own_source, OwnSource::autopilot);
    b->step(1);
    EXPECT_EQ(b->last.faults, bit(Fault::own_state_stale));
    EXPECT_EQ(b->last.own_source, OwnSource::none);
}

TEST(StepOwnState, WithoutOneNothingIsSeen)
{
    const auto b = exact_bench();
    b->hear_autopilot();
    b->hear_mast(1, b->position + Vec3(0.0F, 40.0F, 0.0F));
    b->step();
    EXPECT_FALSE(b->last.guidance.conflict.has_value());
    EXPECT_EQ(b->last.tracks, 0U);
    b->hear_own();
    b->step();
    EXPECT_TRUE(b->last.guidance.conflict.has_value());
    EXPECT_EQ(b->last.tracks, 1U);
    b->step(600'000);  // too old now
    EXPECT_FALSE(b->last.guidance.conflict.has_value());
}

/// Traffic reports its place on the globe: an aircraft that was forgotten would be missing until its next report.
TEST(StepOwnState, AResetOfTheEstimatorForgetsWhatWasMeasuredFromTheOwnPlaceAndKeepsTraffic)
{
    const auto b = exact_bench();
    b->hear_autopilot();
    b->hear_own().estimator_reset = true;
    b->step();
    EXPECT_EQ(b->counted().estimator_resets, 0U) << "nothing was known before";
    b->hear_own();
    b->hear_mast(1, b->position + Vec3(0.0F, 40.0F, 0.0F));
    b->step();
    ASSERT_EQ(b->last.tracks, 1U);
    b->wire.in.scans.unchecked_push_back({});
    b->wire.in.scans.back().stamp = b->next();
    b->wire.in.scans.back().increment = 0.1F;
    b->wire.in.scans.back().ranges.unchecked_push_back(20.0F);
    b->hear_own();
    b->step();
    ASSERT_EQ(b->last.obstacles, 1U);
    b->hear_own().estimator_reset = true;
    b->step();
    EXPECT_EQ(b->counted().estimator_resets, 1U);
    EXPECT_EQ(b->last.obstacles, 0U);
    EXPECT_EQ(b->last.tracks, 1U);
    EXPECT_TRUE(b->last.guidance.conflict.has_value());
    EXPECT_EQ(b->last.faults, 0U) << "the new one is known";
}

TEST(StepOwnState, AResetInARefusedReportCountsWithTheNextOne)
{
    const auto b = exact_bench();
    b->fly(2);
    link::OwnStateReport& refused = b->hear_own();
    refused.estimator_reset = true;
    refused.state.stamp = refused.state.stamp + 5.0F;
    b->step();
    EXPECT_EQ(b->counted().own_state_refused, 1U);
    EXPECT_EQ(b->counted().estimator_resets, 0U);
    b->hear_own();
    b->step();
    EXPECT_EQ(b->counted().estimator_resets, 1U);
    b->hear_own();
    b->step();
    EXPECT_EQ(b->counted().estimator_resets, 1U) << "once";
}

TEST(StepOwnState, ThatIsNotFiniteSteersNothing)
{
    const auto b = bench({{Param::standby, 1.0F}});
    b->fly(1);
    const std::uint64_t fed = b->watchdog.feeds();
    b->hear_own().state.velocity.y() = std::numeric_limits<float>::quiet_NaN();
    b->step();
    EXPECT_TRUE(b->has(Fault::not_finite));
    EXPECT_EQ(b->last.state, link::SystemState::critical);
    EXPECT_TRUE(b->wire.velocities.empty());
    EXPECT_FALSE(b->last.setpoint_sent);
    EXPECT_EQ(b->watchdog.feeds(), fed) << "an image that computes such a thing is not well";
    EXPECT_EQ(b->counted().setpoints_withheld, 0U) << "no stream was due";
    b->fly(1);
    EXPECT_EQ(b->last.faults, 0U);
    EXPECT_EQ(b->watchdog.feeds(), fed + 1);
}

TEST(StepAutopilot, ARestartForgetsWhatTheFormerOneSaid)
{
    const auto b = exact_bench();
    b->fly(2);
    b->wire.in.has_home = true;
    b->wire.in.home = Vec3(1.0F, 2.0F, 3.0F);
    b->wire.in.has_leg = true;
    b->wire.in.leg.leg = {b->position, b->position + Vec3(0.0F, 500.0F, 0.0F), 5.0F};
    b->hear_mast(1, b->position + Vec3(0.0F, 40.0F, 0.0F));
    b->fly(1);
    ASSERT_EQ(b->coprocessor.home(), Vec3(1.0F, 2.0F, 3.0F));
    ASSERT_TRUE(b->coprocessor.nominal_paths().believes_leg());
    ASSERT_EQ(b->last.tracks, 1U);
    b->hear_autopilot().rebooted = true;
    b->step();
    EXPECT_EQ(b->counted().autopilot_reboots, 1U);
    EXPECT_EQ(b->said("jink: autopilot restarted"), 1);
    EXPECT_TRUE(b->has(Fault::own_state_missing));
    EXPECT_EQ(b->last.own_source, OwnSource::none);
    EXPECT_EQ(b->coprocessor.home(), Vec3::Zero());
    b->hear_own();
    b->step();
    EXPECT_EQ(b->last.faults, 0U);
    EXPECT_EQ(b->last.tracks, 0U);
    EXPECT_FALSE(b->coprocessor.nominal_paths().believes_leg());
    EXPECT_EQ(b->counted().autopilot_reboots, 1U);
}

TEST(StepAutopilot, IsKnownFromItsFirstHeartbeatOn)
{
    const auto b = bench();
    b->hear_own();
    b->step();
    EXPECT_EQ(b->coprocessor.autopilot(), nullptr);
    EXPECT_EQ(b->last.faults, bit(Fault::no_autopilot));
    b->hear_autopilot();
    b->hear_own();
    b->step();
    ASSERT_NE(b->coprocessor.autopilot(), nullptr);
    EXPECT_EQ(b->coprocessor.autopilot()->custom_mode, 3U);
    EXPECT_EQ(b->last.faults, 0U);
}

TEST(StepAutopilot, IsSilentWhenItsHeartbeatIsOlderThanItMayBe)
{
    const auto b = bench({{Param::heartbeat_age, 1.5F}});
    b->fly(1);
    const auto after = [&](std::int64_t us) {
        b->coming_us = us;
        b->hear_own();
        b->step(us);
        return b->last.faults;
    };
    EXPECT_EQ(after(500'000), 0U);
    EXPECT_EQ(after(500'000), 0U);
    EXPECT_EQ(after(500'000), 0U) << "1.5 s to the microsecond";
    EXPECT_EQ(after(1), bit(Fault::autopilot_silent));
}

TEST(StepLeg, IsBelievedUntilItIsLost)
{
    const auto b = exact_bench();
    b->wire.in.has_leg = true;
    b->wire.in.leg.leg = {b->position, b->position + Vec3(0.0F, 500.0F, 0.0F), 5.0F};
    b->fly(3);
    EXPECT_TRUE(b->coprocessor.nominal_paths().believes_leg());
    b->wire.in.leg_lost = true;
    b->fly(1);
    EXPECT_FALSE(b->coprocessor.nominal_paths().believes_leg());
    EXPECT_EQ(b->counted().legs_dropped, 1U);
    b->wire.in.leg_lost = true;
    b->fly(1);
    EXPECT_EQ(b->counted().legs_dropped, 1U) << "there was none to drop";
    b->wire.in.leg_lost = true;
    b->wire.in.has_leg = true;
    b->wire.in.leg.leg = {b->position, b->position + Vec3(0.0F, 500.0F, 0.0F), 5.0F};
    b->fly(1);
    EXPECT_TRUE(b->coprocessor.nominal_paths().believes_leg()) << "the next leg, told in the same step";
}

TEST(StepLeg, IsNotFlownInAModeOfOthers)
{
    const auto b = exact_bench();
    b->wire.in.has_leg = true;
    b->wire.in.leg.leg = {b->position, b->position + Vec3(0.0F, 500.0F, 0.0F), 5.0F};
    b->fly(2);
    ASSERT_TRUE(b->coprocessor.nominal_paths().believes_leg());
    b->hear_autopilot().mode = link::FlightMode::external;
    b->hear_own();
    b->step();
    EXPECT_FALSE(b->coprocessor.nominal_paths().believes_leg());
    b->hear_autopilot();
    b->hear_own();
    b->step();
    EXPECT_TRUE(b->coprocessor.nominal_paths().believes_leg());
}

}  // namespace
}  // namespace jink::app::test
