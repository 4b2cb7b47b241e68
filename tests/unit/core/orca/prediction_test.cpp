// SPDX-License-Identifier: BSD-3-Clause
// Prediction across the delay (G-ORCA section 11) and its acceptance test T9.
#include "core/orca/prediction.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

namespace jink::orca {
namespace {

constexpr std::int64_t kPeriod = 25'000;  // 40 Hz

vehicle::VehicleState state_at(TimePoint stamp, const Vec3& position, const Vec3& velocity)
{
    vehicle::VehicleState state;
    state.stamp = stamp;
    state.position = position;
    state.velocity = velocity;
    return state;
}

/// A vehicle with a pure delay and a velocity loop, in double and in steps of a microsecond's precision: the reference
/// for T9.
struct Plant {
    double act = 0.0;
    double lag = 0.0;
    double x = 0.0;
    double v = 0.0;
    /// Flies `command` for dt.
    void fly(double command, double dt)
    {
        if (lag == 0.0) {
            v = command;
            x += v * dt;
            return;
        }
        const double kept = std::exp(-dt / lag);
        x += command * dt + (v - command) * lag * (1.0 - kept);
        v = command + (v - command) * kept;
    }
};

/// Worst error of predictions over 4 s of commands: T_d = 0.5 s, 0.3 s of them to sense and 0.2 s to act. The plant
/// flies in steps of 5 ms, of which all times are whole ones.
struct Errors {
    double position = 0.0;
    double velocity = 0.0;
};

template <class Command>
Errors worst_errors(const Command& command, double plant_lag, float believed_lag)
{
    constexpr int kSense = 60;  // steps of 5 ms
    constexpr int kAct = 40;
    constexpr int kTick = 5;
    CommandRing ring;
    std::vector<double> x(1, 0.0);
    std::vector<double> v(1, command(0));
    Plant plant{0.2, plant_lag, 0.0, command(0)};
    const auto acting = [&](int step) { return command(std::max(0, (step - kAct) / kTick * kTick)); };
    for (int step = 0; step < 900; ++step) {
        plant.fly(step < kAct ? command(0) : acting(step), 0.005);
        x.push_back(plant.x);
        v.push_back(plant.v);
    }
    Errors worst;
    for (int step = 0; step + kAct < 800; step += kTick) {
        if (step >= kSense + kAct) {
            const auto measured = static_cast<std::size_t>(step - kSense);
            const Predicted p =
                predict(state_at(TimePoint{5000 * (step - kSense)}, Vec3(static_cast<float>(x[measured]), 0.0F, 0.0F),
                                 Vec3(static_cast<float>(v[measured]), 0.0F, 0.0F)),
                        ring, {0.2F, believed_lag}, TimePoint{5000 * (step + kAct)});
            EXPECT_FALSE(p.clipped) << step;
            const auto then = static_cast<std::size_t>(step + kAct);
            worst.position = std::max(worst.position, std::abs(static_cast<double>(p.position.x()) - x[then]));
            worst.velocity = std::max(worst.velocity, std::abs(static_cast<double>(p.velocity.x()) - v[then]));
        }
        // The command of this tick is not known when its own effect is predicted.
        EXPECT_EQ(ring.add(TimePoint{5000 * step}, Vec3(static_cast<float>(command(step)), 0.0F, 0.0F)),
                  RingStatus::ok);
    }
    return worst;
}

double constant_velocity(int /*step*/) { return 1.25; }
/// 0.5 m/s2: in each tick of 25 ms 0.0125 m/s more.
double ramp(int step) { return 0.0025 * step; }

/// T9: error 0 with the ideal plant; the remainder is the rounding of 10 m in float.
TEST(PredictionT9, ConstantVelocityWithAKnownDelayIsExact)
{
    const Errors worst = worst_errors(constant_velocity, 0.0, 0.0F);
    EXPECT_LT(worst.position, 2e-6);
    EXPECT_EQ(worst.velocity, 0.0);
}
TEST(PredictionT9, ARampWithAKnownDelayIsExact)
{
    const Errors worst = worst_errors(ramp, 0.0, 0.0F);
    EXPECT_LT(worst.position, 5e-6);
    EXPECT_LT(worst.velocity, 2e-7);
}
/// T9: less than 1 cm with the first-order plant, whose time constant is identified; in fact none but rounding.
TEST(PredictionT9, TheFirstOrderPlantIsWithinACentimetre)
{
    for (const auto& command : {constant_velocity, ramp}) {
        const Errors worst = worst_errors(command, 0.2, 0.2F);
        EXPECT_LT(worst.position, 0.01);
        EXPECT_LT(worst.position, 1e-5);
        EXPECT_LT(worst.velocity, 2e-6);
    }
}
/// Taken for ideal, the same plant on a ramp is late by its lag: 0.5 m/s2 * 0.2 s of velocity. The figures show that
/// the tests above can fail.
TEST(PredictionT9, AnIdealLoopIsNotAFirstOrderOne)
{
    const Errors worst = worst_errors(ramp, 0.2, 0.0F);
    EXPECT_NEAR(worst.velocity, 0.1, 0.01);
    EXPECT_GT(worst.position, 0.01);
}

/// By hand: T_act = 0.1 s; commands 1, 2, 3 m/s at 0, 25, 50 ms act from 100, 125, 150 ms on.
class ThreeCommands : public ::testing::Test {
protected:
    void SetUp() override
    {
        for (int i = 0; i < 3; ++i) {
            ASSERT_EQ(ring.add(TimePoint{kPeriod * i}, Vec3(static_cast<float>(i + 1), 0.0F, 0.0F)), RingStatus::ok);
        }
    }
    [[nodiscard]] Predicted from_to(std::int64_t from, std::int64_t to, float lag = 0.0F) const
    {
        return predict(state_at(TimePoint{from}, Vec3::Zero(), Vec3(0.5F, 0.0F, 0.0F)), ring, {0.1F, lag},
                       TimePoint{to});
    }
    CommandRing ring;
};

TEST_F(ThreeCommands, OverlapsOfTheirHoldIntervals)
{
    const Predicted p = from_to(110'000, 160'000);
    EXPECT_NEAR(p.position.x(), 0.015F * 1.0F + 0.025F * 2.0F + 0.010F * 3.0F, 1e-7F);
    EXPECT_EQ(p.velocity.x(), 3.0F);
    EXPECT_FALSE(p.clipped);
}
TEST_F(ThreeCommands, TheLastOneHoldsOn) { EXPECT_NEAR(from_to(150'000, 650'000).position.x(), 1.5F, 1e-6F); }
/// A window that begins before the first command acts: DELAY_CLIPPED.
TEST_F(ThreeCommands, WhatTheyDoNotCoverIsFlownAsMeasured)
{
    const Predicted p = from_to(60'000, 125'000);
    EXPECT_TRUE(p.clipped);
    EXPECT_NEAR(p.position.x(), 0.040F * 0.5F + 0.025F * 1.0F, 1e-7F);
    EXPECT_EQ(p.velocity.x(), 1.0F);
    const Predicted before = from_to(10'000, 60'000);
    EXPECT_TRUE(before.clipped);
    EXPECT_NEAR(before.position.x(), 0.025F, 1e-7F);
    EXPECT_EQ(before.velocity.x(), 0.5F);
}
TEST_F(ThreeCommands, FromTheInstantTheFirstOneActsNothingIsClipped)
{
    EXPECT_FALSE(from_to(100'000, 125'000).clipped);
    EXPECT_TRUE(from_to(99'999, 125'000).clipped);
}
TEST_F(ThreeCommands, BackwardsAlongTheMeasuredVelocity)
{
    const Predicted p = from_to(200'000, 100'000);
    EXPECT_NEAR(p.position.x(), -0.05F, 1e-7F);
    EXPECT_EQ(p.velocity.x(), 0.5F);
}
/// A negligible lag counts as zero.
TEST_F(ThreeCommands, AVanishingLagIsIdeal)
{
    const Predicted ideal = from_to(110'000, 160'000);
    for (const float lag : {1e-3F, 1e-6F, 1e-30F}) {
        const Predicted p = from_to(110'000, 160'000, lag);
        EXPECT_NEAR(p.position.x(), ideal.position.x(), 3.0F * lag + 1e-7F);
        EXPECT_NEAR(p.velocity.x(), 3.0F, 1e-4F) << lag;
    }
}

TEST(Prediction, NoCommandsAtAll)
{
    const Predicted p =
        predict(state_at(TimePoint{0}, Vec3(1, 2, 3), Vec3(1, -1, 0.5F)), CommandRing(), {}, TimePoint{2'000'000});
    EXPECT_TRUE(p.clipped);
    EXPECT_LT((p.position - Vec3(3, 0, 4)).norm(), 1e-6F);
}

/// A delay longer than the ring bridges: 64 commands at 100 Hz are 0.64 s.
TEST(Prediction, ADelayBeyondTheRingIsClipped)
{
    CommandRing ring;
    for (int i = 0; i < 200; ++i) {
        ASSERT_EQ(ring.add(TimePoint{10'000 * i}, Vec3(1, 0, 0)), RingStatus::ok);
    }
    const TimePoint now{2'000'000};
    const VelocityLoop loop{0.3F, 0.0F};
    EXPECT_FALSE(predict(state_at(now - 0.3F, Vec3::Zero(), Vec3::Zero()), ring, loop, now + 0.3F).clipped);
    EXPECT_TRUE(predict(state_at(now - 0.4F, Vec3::Zero(), Vec3::Zero()), ring, loop, now + 0.3F).clipped);
}

}  // namespace
}  // namespace jink::orca
