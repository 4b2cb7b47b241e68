// SPDX-License-Identifier: BSD-3-Clause
// Limits and their check exactly where they change sides.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "core/orca/bias.hpp"
#include "core/orca/limits.hpp"

namespace jink::orca {
namespace {

constexpr float kNoFloat = std::numeric_limits<float>::quiet_NaN();
constexpr float kEndless = std::numeric_limits<float>::infinity();

/// A turn of at most 0.05 rad to either side, for any heading.
TEST(LimitEdges, TheTurnIsBoundedToBothSidesInEveryDirection)
{
    MotionLimits limits;
    limits.turn_radius = 0.5F;
    for (int i = 0; i < 16; ++i) {
        const float heading = 0.3F + 2.0F * kPi * static_cast<float>(i) / 16.0F;
        const LimitSet set = limit_set(limits, {std::cos(heading), std::sin(heading), 0.2F});
        ASSERT_EQ(set.size, 2U);
        const auto worst = [&](float by) {
            const Vec3 turned(std::cos(heading + by), std::sin(heading + by), 0.0F);
            return std::max(set.planes[0].violation(turned), set.planes[1].violation(turned));
        };
        for (const float side : {-1.0F, 1.0F}) {
            EXPECT_LT(worst(side * 0.049F), 0.0F) << i;
            EXPECT_GT(worst(side * 0.051F), 0.0F) << i;
            EXPECT_GT(worst(side * 1.5F), 0.0F) << i;
        }
        EXPECT_GT(worst(3.1F), 0.0F) << "nor backwards";
    }
}

TEST(LimitEdges, NoTurnWithinOnePeriodIsARightAngle)
{
    MotionLimits limits;
    limits.turn_radius = 1e-3F;
    const LimitSet set = limit_set(limits, {1, 0, 0});
    ASSERT_EQ(set.size, 2U);
    EXPECT_GT(std::max(set.planes[0].violation({0, 1, 0}), set.planes[1].violation({0, 1, 0})), 0.0F);
    EXPECT_GT(std::max(set.planes[0].violation({0, -1, 0}), set.planes[1].violation({0, -1, 0})), 0.0F);
    EXPECT_LT(std::max(set.planes[0].violation({1, 1, 0}), set.planes[1].violation({1, 1, 0})), 0.0F);
}

TEST(LimitEdges, WhatHoversTurnsOnTheSpot)
{
    MotionLimits limits;
    limits.turn_radius = 5.0F;
    EXPECT_EQ(limit_set(limits, {kHover, 0, 0}).size, 2U) << "left out below this speed";
    EXPECT_EQ(limit_set(limits, {std::nextafter(kHover, 0.0F), 0, 0}).size, 0U);
    EXPECT_EQ(limit_set(limits, {0.1F, 0, 1.0F}).size, 0U) << "across counts";
}

TEST(LimitEdges, AccelerationsUpAndDownCountTogetherOnly)
{
    MotionLimits limits;
    EXPECT_EQ(limit_set(limits, Vec3::Zero()).size, 0U);
    limits.climb_acceleration = 1.0F;
    EXPECT_EQ(limit_set(limits, Vec3::Zero()).size, 0U);
    limits.climb_acceleration = 0.0F;
    limits.sink_acceleration = 1.0F;
    EXPECT_EQ(limit_set(limits, Vec3::Zero()).size, 0U);
    limits.climb_acceleration = 2.0F;
    const LimitSet set = limit_set(limits, {0, 0, 0.5F});
    ASSERT_EQ(set.size, 2U);
    const auto allows = [&](float z) {
        return set.planes[0].violation({0, 0, z}) <= 1e-6F && set.planes[1].violation({0, 0, z}) <= 1e-6F;
    };
    EXPECT_TRUE(allows(0.5F + 0.05F)) << "2 m/s2 up for 25 ms";
    EXPECT_FALSE(allows(0.5F + 0.051F));
    EXPECT_TRUE(allows(0.5F - 0.025F)) << "1 m/s2 down";
    EXPECT_FALSE(allows(0.5F - 0.026F));
}

TEST(LimitEdges, TheReferenceIsTheLastCommandUpToTheDistanceItself)
{
    const Vec3 sent(1, 0, 0);
    EXPECT_FALSE(reference_velocity(sent, Vec3::Zero(), 1.0F).resynchronised);
    EXPECT_EQ(reference_velocity(sent, Vec3::Zero(), 1.0F).velocity, sent);
    EXPECT_TRUE(reference_velocity(sent, Vec3::Zero(), 0.999F).resynchronised);
    EXPECT_EQ(reference_velocity(sent, {0.5F, 0, 0}, 0.4F).velocity, Vec3(0.5F, 0, 0));
    EXPECT_EQ(reference_velocity({kEndless, 0, 0}, sent, kEndless).velocity, sent);
    EXPECT_EQ(reference_velocity({kNoFloat, 0, 0}, sent, 10.0F).velocity, sent);
}

TEST(LimitEdges, ACapThatIsJustReachedIsReached)
{
    LimitSet hovers = limit_set({}, Vec3::Zero());
    EXPECT_TRUE(cap_speed(hovers, 0.0F));
    EXPECT_EQ(hovers.spheres[0].radius, 0.0F);
    LimitSet fast = limit_set({}, {1, 0, 0});
    const float least = 1.0F - 0.99F * 0.05F;
    EXPECT_FALSE(cap_speed(fast, 0.5F));
    EXPECT_NEAR(fast.spheres[0].radius, least, 1e-6F) << "what one period of braking leaves";
    EXPECT_TRUE(cap_speed(fast, kEndless)) << "a cap never raises what is capped";
    EXPECT_NEAR(fast.spheres[0].radius, least, 1e-6F);
    LimitSet slow = limit_set({}, {0.5F, 0, 0});
    EXPECT_TRUE(cap_speed(slow, 0.75F));
    EXPECT_EQ(slow.spheres[0].radius, 0.75F);
}

TEST(LimitEdges, RegionsAndShapesThatAreNoneAreRefused)
{
    const auto with = [](auto change) {
        SafetyQuestion question;
        change(question);
        return check(question);
    };
    EXPECT_EQ(with([](SafetyQuestion&) {}), Unsafe::none);
    for (const float ratio : {0.0F, -0.1F, 1.0F, 1.1F, kNoFloat}) {
        EXPECT_EQ(with([&](SafetyQuestion& q) { q.pair.conflict_ratio = ratio; }), Unsafe::regions) << ratio;
    }
    EXPECT_EQ(with([](SafetyQuestion& q) { q.limits.min_speed = 1.5F; }), Unsafe::regions) << "its top speed";
    EXPECT_EQ(with([](SafetyQuestion& q) { q.limits.min_speed = 2.0F; }), Unsafe::regions);
    EXPECT_EQ(with([](SafetyQuestion& q) { q.limits.min_speed = 1.4F; }), Unsafe::none);
    EXPECT_EQ(with([](SafetyQuestion& q) { q.upright = 0.3F; }), Unsafe::none) << "four times as wide as high";
    EXPECT_EQ(with([](SafetyQuestion& q) { q.upright = 0.299F; }), Unsafe::stretch);
    EXPECT_EQ(with([](SafetyQuestion& q) { q.upright = 2.4F; }), Unsafe::none) << "half as wide as high";
    EXPECT_EQ(with([](SafetyQuestion& q) { q.upright = 2.41F; }), Unsafe::stretch);
}

TEST(LimitEdges, RestHasToBeLongEnoughForBrakingAndForTheDelay)
{
    SafetyQuestion question;
    question.pair.conflict = Conflict::at_rest;
    question.limits.acceleration = 1.0F;  // 1.5 s to brake
    question.delay = 0.1F;
    question.pair.brake = 1.5F;
    EXPECT_EQ(check(question), Unsafe::none);
    question.pair.brake = 1.4F;
    EXPECT_EQ(check(question), Unsafe::rest_brake);
    question.limits.acceleration = 100.0F;
    question.delay = 0.5F;  // e times that are 1.36 s
    EXPECT_EQ(check(question), Unsafe::none);
    question.pair.brake = 1.35F;
    EXPECT_EQ(check(question), Unsafe::rest_brake);
    question.pair.conflict = Conflict::present;
    EXPECT_EQ(check(question), Unsafe::none);
}

TEST(LimitEdges, WithoutADelayTheRampIsBoundByTheAcceleration)
{
    EXPECT_EQ(ramp_speed_for(1.2F, 0.7F, 0.0F, 2.0F), 0.3F);
    EXPECT_EQ(ramp_speed_for(1.2F, 0.7F, 0.0F, 0.1F), 0.1F);
    EXPECT_NEAR(ramp_speed_for(1.2F, 0.7F, 1.0F, 2.0F), 0.36F / 2.7182818F, 1e-6F);
}

TEST(BiasEdges, BlockedIsMoreThanItsTime)
{
    Bias bias;
    for (int i = 0; i < 10; ++i) {
        EXPECT_FALSE(bias.apply(1, {1, 0, 0}, Vec3::Zero(), {}, 0.5F).blocked) << i;
    }
    EXPECT_EQ(bias.stalled(), 5.0F);
    EXPECT_TRUE(bias.apply(1, {1, 0, 0}, Vec3::Zero(), {}, 0.5F).blocked);
}

}  // namespace
}  // namespace jink::orca
