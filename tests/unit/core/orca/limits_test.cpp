// SPDX-License-Identifier: BSD-3-Clause
// Limits of flight as spheres and half-spaces (G-ORCA specification, section 5), and settings that are refused.
#include "core/orca/limits.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

namespace jink::orca {
namespace {

bool lets_pass(const LimitSet& set, const Vec3& v)
{
    const auto planes = set.half_spaces();
    return std::all_of(planes.begin(), planes.end(), [&](const HalfSpace& p) { return p.violation(v) <= 1e-5F; }) &&
           std::all_of(set.spheres.begin(), set.spheres.end(),
                       [&](const Sphere& b) { return (v - b.centre).norm() <= b.radius + 1e-5F; });
}

TEST(Limits, SpeedAndAcceleration)
{
    MotionLimits limits;
    limits.max_speed = 2.0F;
    limits.acceleration = 4.0F;
    limits.period = 0.1F;
    const LimitSet set = limit_set(limits, {1, 0, 0});
    EXPECT_EQ(set.size, 0U);
    EXPECT_EQ(set.spheres[0].radius, 2.0F);
    EXPECT_NEAR(set.spheres[1].radius, 0.4F, 1e-6F);
    EXPECT_TRUE(lets_pass(set, {1.4F, 0, 0}));
    EXPECT_FALSE(lets_pass(set, {1.41F, 0, 0}));
    // A reference beyond the limits is brought within.
    EXPECT_NEAR(limit_set(limits, {3, 0, 4}).reference.norm(), 2.0F, 1e-6F);
}

TEST(Limits, LeastSpeedIsAHalfSpaceBeyondIt)
{
    MotionLimits limits;
    limits.max_speed = 20.0F;
    limits.min_speed = 10.0F;
    limits.acceleration = 1000.0F;
    const LimitSet set = limit_set(limits, {0, 12, 0});
    ASSERT_EQ(set.size, 1U);
    EXPECT_TRUE(lets_pass(set, {0, 10, 0}));
    EXPECT_FALSE(lets_pass(set, {0, 9.9F, 0}));
    EXPECT_FALSE(lets_pass(set, {9.9F, 9.9F, 0}));  // fast enough, but outside the convex part
    // Too slow: compensated across. Without a direction across: omitted, and reported.
    EXPECT_NEAR(limit_set(limits, {3, 0, 6}).reference.x(), 8.0F, 1e-5F);
    EXPECT_EQ(limit_set(limits, {3, 0, 6}).reference.z(), 6.0F);
    const LimitSet still = limit_set(limits, Vec3::Zero());
    EXPECT_TRUE(still.stalled);
    EXPECT_EQ(still.size, 0U);
}

TEST(Limits, TurnIsAWedgeOfHeadings)
{
    MotionLimits limits;
    limits.max_speed = 10.0F;
    limits.acceleration = 1000.0F;
    limits.turn_radius = 5.0F;
    limits.period = 0.1F;  // 0.1 rad at 5 m/s
    const LimitSet set = limit_set(limits, {0, 5, 0});
    ASSERT_EQ(set.size, 2U);
    const auto at = [](float angle) { return Vec3(-std::sin(angle) * 6.0F, std::cos(angle) * 6.0F, 3.0F); };
    EXPECT_TRUE(lets_pass(set, at(0.099F)));
    EXPECT_TRUE(lets_pass(set, at(-0.099F)));
    EXPECT_FALSE(lets_pass(set, at(0.101F)));
    EXPECT_FALSE(lets_pass(set, at(-0.101F)));
    EXPECT_FALSE(lets_pass(set, {0, -1, 0}));
    EXPECT_EQ(limit_set(limits, {0.1F, 0.1F, 5}).size, 0U);  // hovers
    limits.turn_radius = 0.01F;
    EXPECT_TRUE(lets_pass(limit_set(limits, {0, 5, 0}), {4, 0.05F, 0}));  // nearly a right angle at most
    EXPECT_FALSE(lets_pass(limit_set(limits, {0, 5, 0}), {4, -0.05F, 0}));
}

TEST(Limits, ClimbAndSink)
{
    MotionLimits limits;
    limits.max_speed = 10.0F;
    limits.acceleration = 1000.0F;
    limits.climb_rate = 3.0F;
    limits.sink_rate = 2.0F;
    const LimitSet set = limit_set(limits, {0, 0, 5});
    EXPECT_EQ(set.reference, Vec3(0, 0, 3));
    ASSERT_EQ(set.size, 2U);
    EXPECT_TRUE(lets_pass(set, {1, 0, 3}));
    EXPECT_FALSE(lets_pass(set, {1, 0, 3.01F}));
    EXPECT_TRUE(lets_pass(set, {1, 0, -2}));
    EXPECT_FALSE(lets_pass(set, {1, 0, -2.01F}));
    // Accelerations that differ: from where it is.
    limits.climb_acceleration = 5.0F;
    limits.sink_acceleration = 10.0F;
    limits.period = 0.1F;
    const LimitSet apart = limit_set(limits, {0, 0, 1});
    EXPECT_TRUE(lets_pass(apart, {1, 0, 1.5F}));
    EXPECT_FALSE(lets_pass(apart, {1, 0, 1.51F}));
    EXPECT_TRUE(lets_pass(apart, {1, 0, 0}));
    EXPECT_FALSE(lets_pass(apart, {1, 0, -0.01F}));
}

TEST(Limits, ACapGoesAsFarAsBrakingDoes)
{
    MotionLimits limits;
    limits.max_speed = 2.0F;
    limits.acceleration = 4.0F;
    limits.period = 0.1F;
    LimitSet set = limit_set(limits, {1, 0, 0});
    EXPECT_TRUE(cap_speed(set, std::numeric_limits<float>::infinity()));
    EXPECT_EQ(set.spheres[0].radius, 2.0F);
    EXPECT_TRUE(cap_speed(set, 0.8F));
    EXPECT_EQ(set.spheres[0].radius, 0.8F);
    EXPECT_FALSE(cap_speed(set, 0.1F));
    EXPECT_GT(set.spheres[0].radius, 0.6F);  // the rest after a period of braking
    EXPECT_LT(set.spheres[0].radius, 0.61F);
}

TEST(Limits, ReferenceIsTheLastCommandUnlessItIsFarOff)
{
    EXPECT_EQ(reference_velocity({1, 0, 0}, {0.8F, 0, 0}, 0.5F).velocity, Vec3(1, 0, 0));
    EXPECT_FALSE(reference_velocity({1, 0, 0}, {0.8F, 0, 0}, 0.5F).resynchronised);
    const Reference far = reference_velocity({1, 0, 0}, {0.2F, 0, 0}, 0.5F);
    EXPECT_EQ(far.velocity, Vec3(0.2F, 0, 0));
    EXPECT_TRUE(far.resynchronised);
    EXPECT_TRUE(reference_velocity({std::nanf(""), 0, 0}, {0.2F, 0, 0}, 0.5F).resynchronised);
}

/// Settings of the final flights (Alejo table 8.1), with a delay that their horizons bear.
SafetyQuestion final_flights()
{
    SafetyQuestion q;
    q.limits.max_speed = 1.5F;
    q.limits.acceleration = 2.0F;
    q.delay = 0.5F;
    return q;
}

TEST(Settings, OfTheFinalFlightsAreSafe) { EXPECT_EQ(check(final_flights()), Unsafe::none); }

TEST(Settings, EachInequalityHasItsCause)
{
    const auto cause = [](auto change) {
        SafetyQuestion q = final_flights();
        change(q);
        return check(q);
    };
    using Q = SafetyQuestion&;
    EXPECT_EQ(cause([](Q q) { q.limits.max_speed = 0.0F; }), Unsafe::not_positive);
    EXPECT_EQ(cause([](Q q) { q.delay = std::nanf(""); }), Unsafe::not_positive);
    EXPECT_EQ(cause([](Q q) { q.limits.turn_radius = -1.0F; }), Unsafe::not_positive);
    EXPECT_EQ(cause([](Q q) { q.pair.conflict_ratio = 1.0F; }), Unsafe::regions);
    EXPECT_EQ(cause([](Q q) { q.upright = 0.29F; }), Unsafe::stretch);
    EXPECT_EQ(cause([](Q q) { q.upright = 2.41F; }), Unsafe::stretch);
    EXPECT_EQ(cause([](Q q) { q.limits.acceleration = 0.5F; }), Unsafe::obstacle_horizon_brakes);  // 3 s to stop
    EXPECT_EQ(cause([](Q q) { q.obstacle_horizon = 1.3F; }), Unsafe::obstacle_horizon_delay);      // e * 0.5 s = 1.36 s
    EXPECT_EQ(cause([](Q q) { q.pair.horizon = 1.4F; }), Unsafe::horizon_brakes);                  // twice 0.75 s
    EXPECT_EQ(cause([](Q q) {
                  q.limits.max_speed = 1.0F;
                  q.pair.horizon = 1.3F;
              }),
              Unsafe::horizon_delay);
    EXPECT_EQ(cause([](Q q) { q.pair.ramp_speed = 0.27F; }), Unsafe::ramp_gain);  // 0.36 m / 1.36 s = 0.265 m/s
    EXPECT_EQ(cause([](Q q) {
                  q.limits.acceleration = 0.2F;
                  q.limits.max_speed = 0.3F;
                  q.pair.ramp_speed = 0.25F;
              }),
              Unsafe::ramp_acceleration);
    EXPECT_EQ(cause([](Q q) { q.pair.recovery_time = 1.3F; }), Unsafe::recovery_delay);
    EXPECT_EQ(cause([](Q q) { q.pair.conflict = Conflict::at_rest; }), Unsafe::rest_brake);
    EXPECT_EQ(cause([](Q q) {
                  q.pair.conflict = Conflict::at_rest;
                  q.pair.brake = 1.36F;
              }),
              Unsafe::none);
}

TEST(Settings, RampThatTheDelayBears)
{
    EXPECT_NEAR(ramp_speed_for(1.2F, 0.7F, 0.5F, 2.0F), 0.36F / (2.7182818F * 0.5F), 1e-5F);
    EXPECT_EQ(ramp_speed_for(1.2F, 0.7F, 0.0F, 2.0F), 0.3F);
    EXPECT_EQ(ramp_speed_for(1.2F, 0.7F, 0.05F, 0.1F), 0.1F);
}

}  // namespace
}  // namespace jink::orca
