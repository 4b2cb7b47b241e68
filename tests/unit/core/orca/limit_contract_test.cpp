// SPDX-License-Identifier: BSD-3-Clause
// Limits, biases, predictions and smoothing, sentence by sentence of their headers.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "core/orca/bias.hpp"
#include "core/orca/limits.hpp"
#include "core/orca/prediction.hpp"
#include "core/orca/smoothing.hpp"

namespace jink::orca {
namespace {

constexpr float kNoLimit[] = {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity(),
                              -std::numeric_limits<float>::infinity()};

// --- limits ---

TEST(LimitContract, SinkingIsClampedAsClimbingIs)
{
    MotionLimits limits;
    limits.max_speed = 10.0F;
    limits.climb_rate = 3.0F;
    limits.sink_rate = 2.0F;
    EXPECT_EQ(clamped(limits, {1, 0, -5}), Vec3(1, 0, -2));
    EXPECT_EQ(clamped(limits, {1, 0, -1.5F}), Vec3(1, 0, -1.5F));
    EXPECT_EQ(clamped(limits, {1, 0, 5}), Vec3(1, 0, 3));
    EXPECT_EQ(limit_set(limits, {1, 0, -5}).reference, Vec3(1, 0, -2));
    limits.sink_rate = 0.0F;
    EXPECT_EQ(clamped(limits, {1, 0, -5}), Vec3(1, 0, -5)) << "optional";
}

/// The reference keeps to all of the limits, so they are never empty: also where rounding makes it slower than it may.
TEST(LimitContract, TheReferenceKeepsToTheLeastSpeed)
{
    MotionLimits limits;
    limits.max_speed = 20.0F;
    limits.min_speed = 10.0F;
    for (int i = 0; i < 2000; ++i) {
        const float a = 0.001F * static_cast<float>(i);
        const LimitSet set = limit_set(limits, {3.0F * std::cos(a), 3.0F * std::sin(a), 0.7F + a});
        ASSERT_EQ(set.size, 1U);
        EXPECT_FALSE(set.stalled);
        EXPECT_LE(set.planes[0].offset, set.reference.norm()) << i;
        EXPECT_NEAR(set.planes[0].offset, 10.0F, 1e-4F);
        EXPECT_LT((set.planes[0].normal - set.reference.normalized()).norm(), 1e-6F);
    }
    // Straight up there is no direction across; as fast as rounding lets it be, it is not stalled.
    EXPECT_FALSE(limit_set(limits, {0, 0, 10.0F * (1.0F - 1e-6F)}).stalled);
    EXPECT_TRUE(limit_set(limits, {0, 0, 9.999F}).stalled);
    EXPECT_TRUE(limit_set(limits, {1e-6F, 0, 0}).stalled) << "a micrometre a second is no direction";
    EXPECT_FALSE(limit_set(limits, {1.1e-6F, 0, 0}).stalled);
}

/// A turn of nearly a right angle is the most there is, less 0.01 rad.
TEST(LimitContract, TheTurnEndsShortOfARightAngle)
{
    for (const float turn : {1.5F, 1.57F, 1.58F, 2.0F, 9.0F}) {
        MotionLimits limits;
        limits.turn_radius = limits.period / turn;
        const LimitSet set = limit_set(limits, {1, 0, 0});
        ASSERT_EQ(set.size, 2U);
        const float most = std::min(turn, 0.5F * kPi - 0.01F);
        const auto worst = [&](float by) {
            const Vec3 turned(std::cos(by), std::sin(by), 0.0F);
            return std::max(set.planes[0].violation(turned), set.planes[1].violation(turned));
        };
        for (const float side : {-1.0F, 1.0F}) {
            EXPECT_LT(worst(side * (most - 0.002F)), 0.0F) << turn;
            EXPECT_GT(worst(side * (most + 0.002F)), 0.0F) << turn;
        }
    }
}

/// A rate that is no less than the top speed needs no half-space.
TEST(LimitContract, RatesBeyondTheTopSpeedBindNothing)
{
    MotionLimits limits;
    limits.max_speed = limits.climb_rate = limits.sink_rate = 2.0F;
    EXPECT_EQ(limit_set(limits, Vec3::Zero()).size, 0U);
    limits.climb_rate = 1.9F;
    EXPECT_EQ(limit_set(limits, Vec3::Zero()).size, 1U);
    limits.sink_rate = 1.8F;
    const LimitSet set = limit_set(limits, Vec3::Zero());
    ASSERT_EQ(set.size, 2U);
    EXPECT_EQ(set.planes[0].source, 0U);
    EXPECT_EQ(set.planes[1].source, 1U);
    EXPECT_EQ(set.planes[1].level, Level::limits);
}

TEST(LimitContract, EveryNumberIsLookedAt)
{
    const auto cause = [](auto change) {
        SafetyQuestion q;
        change(q);
        return check(q);
    };
    const std::array positive{&MotionLimits::max_speed, &MotionLimits::acceleration, &MotionLimits::period};
    const std::array optional{&MotionLimits::min_speed,         &MotionLimits::climb_acceleration,
                              &MotionLimits::sink_acceleration, &MotionLimits::turn_radius,
                              &MotionLimits::climb_rate,        &MotionLimits::sink_rate};
    const std::array pairs{&PairSettings::horizon, &PairSettings::recovery_speed, &PairSettings::recovery_time,
                           &PairSettings::brake, &PairSettings::period};
    const std::array sizes{&SafetyQuestion::across, &SafetyQuestion::upright, &SafetyQuestion::obstacle_horizon};
    for (const float bad : {kNoLimit[0], kNoLimit[1], kNoLimit[2], -1.0F, 0.0F}) {
        for (const auto member : positive) {
            EXPECT_EQ(cause([&](SafetyQuestion& q) { q.limits.*member = bad; }), Unsafe::not_positive);
        }
        for (const auto member : pairs) {
            EXPECT_EQ(cause([&](SafetyQuestion& q) { q.pair.*member = bad; }), Unsafe::not_positive);
        }
        for (const auto member : sizes) {
            EXPECT_EQ(cause([&](SafetyQuestion& q) { q.*member = bad; }), Unsafe::not_positive);
        }
        const Unsafe wanted = bad == 0.0F ? Unsafe::none : Unsafe::not_positive;
        for (const auto member : optional) {
            EXPECT_EQ(cause([&](SafetyQuestion& q) { q.limits.*member = bad; }), wanted) << bad;
        }
        EXPECT_EQ(cause([&](SafetyQuestion& q) { q.pair.ramp_speed = bad; }), wanted);
        EXPECT_EQ(cause([&](SafetyQuestion& q) { q.delay = bad; }), wanted);
    }
}

/// The required value suffices, up to its rounding of 1e-5, and no smaller value does.
TEST(LimitContract, WhatIsAskedForIsEnough)
{
    constexpr float kShare = 1.0F + 1e-5F;
    // A time whose slack equals exactly the braking distance.
    const auto brakes_for = [](SafetyQuestion& q, float time) {
        q.limits.acceleration = 1.0F;
        q.limits.max_speed = time;
        q.delay = 0.0F;
        q.pair.horizon = q.obstacle_horizon = 100.0F;
    };
    for (const float time : {0.7F, 1.3F, 1.9F}) {
        for (const bool beyond : {false, true}) {
            const float asked = beyond ? std::nextafter(time * kShare, 9.0F) : time * kShare;
            SafetyQuestion q;
            brakes_for(q, asked);
            q.obstacle_horizon = time;
            EXPECT_EQ(check(q), beyond ? Unsafe::obstacle_horizon_brakes : Unsafe::none) << time;
            brakes_for(q, 0.5F * asked);
            q.pair.horizon = time;
            EXPECT_EQ(check(q), beyond ? Unsafe::horizon_brakes : Unsafe::none) << time;
            brakes_for(q, asked);
            q.pair.conflict = Conflict::at_rest;
            q.pair.brake = time;
            EXPECT_EQ(check(q), beyond ? Unsafe::rest_brake : Unsafe::none) << time;
            SafetyQuestion ramp;
            ramp.delay = 0.0F;
            ramp.pair.ramp_speed = beyond ? std::nextafter(2.0F * kShare, 9.0F) : 2.0F * kShare;
            ramp.limits.acceleration = 2.0F;
            EXPECT_EQ(check(ramp), beyond ? Unsafe::ramp_acceleration : Unsafe::none);
        }
    }
}

/// The same for the delay: searches the product that equals the slack to the bit.
TEST(LimitContract, WhatTheDelayAsksForIsEnough)
{
    constexpr float kShare = 1.0F + 1e-5F;
    constexpr float kE = 2.7182818F;
    int met = 0;
    for (float delay = 0.5F; delay < 0.6F; delay += 0.00031F) {
        float time = kE * delay / kShare;
        for (int k = 0; k < 8 && time * kShare < kE * delay; ++k) {
            time = std::nextafter(time, 9.0F);
        }
        if (time * kShare != kE * delay) {
            continue;
        }
        ++met;
        for (const bool beyond : {false, true}) {
            const auto with = [&](float SafetyQuestion::*own, float PairSettings::*pair) {
                SafetyQuestion q;
                q.limits.max_speed = 0.1F;
                q.delay = beyond ? std::nextafter(delay, 9.0F) : delay;
                q.pair.ramp_speed = 0.0F;
                q.pair.horizon = q.obstacle_horizon = q.pair.recovery_time = 100.0F;
                if (own != nullptr) {
                    q.*own = time;
                } else {
                    q.pair.*pair = time;
                }
                return check(q);
            };
            EXPECT_EQ(with(&SafetyQuestion::obstacle_horizon, nullptr),
                      beyond ? Unsafe::obstacle_horizon_delay : Unsafe::none);
            EXPECT_EQ(with(nullptr, &PairSettings::horizon), beyond ? Unsafe::horizon_delay : Unsafe::none);
            EXPECT_EQ(with(nullptr, &PairSettings::recovery_time), beyond ? Unsafe::recovery_delay : Unsafe::none);
        }
    }
    EXPECT_GT(met, 3);
}

/// The same for the ramp: as fast as the delay permits within the gap between both regions.
TEST(LimitContract, TheRampThatTheDelayBearsIsNotTooFast)
{
    SafetyQuestion q;
    const float delayed = 2.7182818F * q.delay;
    const float most = q.across * (1.0F - q.pair.conflict_ratio) * (1.0F + 1e-5F);
    int met = 0;
    float ramp = most / delayed * (1.0F - 1e-6F);
    for (int k = 0; k < 64; ++k) {
        ramp = std::nextafter(ramp, 1.0F);
        q.pair.ramp_speed = ramp;
        EXPECT_EQ(check(q), ramp * delayed > most ? Unsafe::ramp_gain : Unsafe::none);
        met += ramp * delayed == most ? 1 : 0;
    }
    EXPECT_GT(met, 0) << "to the bit";
}

// --- symmetry and progress ---

TEST(BiasContract, WhoIsJustAsFarAwayBiasesNothing)
{
    Bias bias;  // 4 m
    const std::vector<BiasNeighbour> at_the_rim{{2, {4, 0, 0}, {0, -1, 0}}};
    EXPECT_EQ(bias.apply(1, {1, 0, 0}, {1, 0, 0}, at_the_rim, 0.025F).preferred, Vec3(1, 0, 0));
    const std::vector<BiasNeighbour> within{{2, {3.999F, 0, 0}, {0, -1, 0}}};
    EXPECT_LT(bias.apply(1, {1, 0, 0}, {1, 0, 0}, within, 0.025F).preferred.y(), -0.04F);
    const std::vector<BiasNeighbour> beside{{2, {0, 3, 0}, {1, 0, 0}}};
    EXPECT_EQ(bias.apply(1, {1, 0, 0}, {1, 0, 0}, beside, 0.025F).preferred, Vec3(1, 0, 0)) << "not ahead";
}

/// However long it has flown, a stall is timed from its own begin.
TEST(BiasContract, AFlightIsNoCreditForAStall)
{
    Bias bias;
    for (int i = 0; i < 1000; ++i) {
        static_cast<void>(bias.apply(1, {1, 0, 0}, {1, 0, 0}, {}, 0.025F));
        ASSERT_EQ(bias.stalled(), 0.0F);
    }
    for (int i = 0; i < 210; ++i) {
        const bool blocked = bias.apply(1, {1, 0, 0}, Vec3::Zero(), {}, 0.025F).blocked;
        ASSERT_TRUE(blocked || i < 201) << i;
    }
}

// --- predictions ---

/// Without a lag the command is flown at once, to the bit.
TEST(PredictionContract, WithoutALagTheCommandIsFlownAtOnce)
{
    vehicle::VehicleState state;
    state.velocity = {3, 0.7F, -2};
    CommandRing ring;
    ASSERT_EQ(ring.add({0}, {0.1F, 0.3F, 0.9F}), RingStatus::ok);
    const Predicted there = predict(state, ring, {0.0F, 0.0F}, {1'000'000});
    EXPECT_EQ(there.velocity, Vec3(0.1F, 0.3F, 0.9F));
    EXPECT_LT((there.position - Vec3(0.1F, 0.3F, 0.9F)).norm(), 1e-6F);
}

/// A prediction ends where it is asked for, amid a command as well.
TEST(PredictionContract, NothingIsFlownBeyondTheInstant)
{
    CommandRing ring;
    for (int i = 0; i < 4; ++i) {
        ASSERT_EQ(ring.add({100'000 * i}, {static_cast<float>(i + 1), 0, 0}), RingStatus::ok);
    }
    vehicle::VehicleState state;
    const Predicted there = predict(state, ring, {0.0F, 0.0F}, {150'000});
    EXPECT_FLOAT_EQ(there.position.x(), 0.1F + 0.1F);
    EXPECT_EQ(there.velocity.x(), 2.0F);
    const Predicted early = predict(state, ring, {0.0F, 0.0F}, {50'000});
    EXPECT_FLOAT_EQ(early.position.x(), 0.05F);
    EXPECT_EQ(early.velocity.x(), 1.0F);
}

// --- smoothing ---

/// Rounding does not add up: after long large commands small ones come out exactly.
TEST(SmoothingContract, RoundingDoesNotAddUp)
{
    CommandFilter filter(3);
    for (int i = 0; i < 5000; ++i) {
        static_cast<void>(filter.add({i % 7 == 0 ? 19.93F : -20.0F + 0.37F * static_cast<float>(i % 11), 0, 0}));
    }
    Vec3 mean = Vec3::Zero();
    for (std::size_t i = 0; i < 2 * CommandFilter::kExact; ++i) {
        mean = filter.add({0.001F, 0, 0});
    }
    EXPECT_NEAR(mean.x(), 0.001F, 1e-7F);
}

}  // namespace
}  // namespace jink::orca
