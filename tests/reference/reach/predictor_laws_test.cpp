// SPDX-License-Identifier: BSD-3-Clause
// Trajectories against the equations of motion, stepped in double.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/base/random.hpp"
#include "tests/reference/reach/predictor.hpp"

namespace jink::reach {
namespace {

constexpr double kStep15 = 0.26179938779914943;

struct Plan {
    AutomatonSettings settings;
    FlightState start;
    std::vector<Order> orders;
};

Plan random_plan(Random& random)
{
    Plan plan;
    plan.settings.period = random.uniform(0.2F, 2.0F);
    plan.settings.least_holding = random.uniform(0.0F, 0.5F);
    if (random.below(2) == 0) {
        plan.settings.transitions = {random.uniform(0.0F, 0.2F), random.uniform(0.0F, 0.2F),
                                     random.uniform(0.0F, 0.2F)};
    }
    plan.start.pose.yaw = random.uniform(-3.0F, 3.0F);
    plan.start.pose.pitch = random.uniform(-0.3F, 0.3F);
    plan.start.pose.position = Vec3(random.uniform(-9.0F, 9.0F), random.uniform(-9.0F, 9.0F), 0.0F);
    plan.start.speed = random.uniform(0.5F, 15.0F);
    float speed = plan.start.speed;
    for (std::size_t n = 1 + random.below(12); n > 0; --n) {
        Order order;
        order.movement = static_cast<Movement>(random.below(kMovements));
        speed = random.below(3) == 0 ? random.uniform(0.0F, 15.0F) : speed;
        order.speed = speed;
        order.duration = least_duration(plan.settings, order) + random.uniform(0.05F, 1.0F);
        plan.orders.push_back(order);
    }
    return plan;
}

struct Truth {
    double x, y, z, pitch, yaw;
};
/// The change, the order and the change back, each by the midpoint rule in small steps.
void fly(Truth& truth, double seconds, double speed, double pitch_rate, double yaw_rate)
{
    constexpr int kSteps = 400;
    const double dt = seconds / kSteps;
    for (int i = 0; i < kSteps; ++i) {
        const double p = truth.pitch + 0.5 * dt * pitch_rate;
        const double y = truth.yaw + 0.5 * dt * yaw_rate;
        truth.x += dt * speed * std::cos(p) * std::cos(y);
        truth.y += dt * speed * std::cos(p) * std::sin(y);
        truth.z -= dt * speed * std::sin(p);
        truth.pitch += dt * pitch_rate;
        truth.yaw += dt * yaw_rate;
    }
}
/// A change takes as long as its slowest channel; each channel by steps of one turn.
double change(const TransitionTimes& times, const Turn& a, double speed_a, const Turn& b, double speed_b)
{
    const double turn = static_cast<double>(times.turn) * std::abs(a.yaw - b.yaw);
    const double pitch = static_cast<double>(times.pitch) * std::abs(a.pitch - b.pitch);
    return std::max({turn, pitch, speed_a == speed_b ? 0.0 : static_cast<double>(times.speed)});
}

TEST(PredictorLaws, TrajectoriesObeyTheEquationsOfMotion)
{
    constexpr std::uint64_t kSeed = 20261123;
    Random random(kSeed);
    for (int i = 0; i < 1500; ++i) {
        const Plan plan = random_plan(random);
        Trajectory t;
        const Exit before{Movement::straight, plan.start.speed};
        ASSERT_EQ(predict(plan.settings, Segments(), plan.start, before, 0.0F, plan.orders, t), PredictStatus::complete)
            << "seed " << kSeed << ", case " << i;
        const Pose<double> pose{plan.start.pose.position.cast<double>(), static_cast<double>(plan.start.pose.pitch),
                                static_cast<double>(plan.start.pose.yaw)};
        Truth truth{pose.position.x(), pose.position.y(), pose.position.z(), pose.pitch, pose.yaw};
        Turn last{0, 0};
        double speed = static_cast<double>(plan.start.speed);
        double seconds = 0.0;
        double length = 1.0;
        for (std::size_t n = 0; n < plan.orders.size(); ++n) {
            const Order& order = plan.orders[n];
            const Turn turn = turn_of(order.movement);
            const auto own = static_cast<double>(order.speed);
            const double entry = change(plan.settings.transitions, last, speed, turn, own);
            const bool ends = n + 1 == plan.orders.size();
            const double leave = ends ? change(plan.settings.transitions, turn, own, Turn{}, own) : 0.0;
            const double held = static_cast<double>(order.duration) - entry - leave;
            ASSERT_GE(held, static_cast<double>(plan.settings.least_holding) - 1e-5);
            const double rate = kStep15 / static_cast<double>(plan.settings.period);
            fly(truth, entry, speed, 0.0, 0.0);
            fly(truth, held, own, rate * turn.pitch, rate * turn.yaw);
            fly(truth, leave, own, 0.0, 0.0);
            last = turn;
            length += entry * speed + (held + leave) * own;
            speed = own;
            seconds += static_cast<double>(order.duration);
            FlightState state;
            ASSERT_TRUE(project(t, std::min(static_cast<float>(seconds), t.end()), state));
            const Point<double> at = state.pose.position.cast<double>();
            // Position error of a rounded time, and the rule's own error.
            ASSERT_NEAR((at - Point<double>(truth.x, truth.y, truth.z)).norm(), 0.0,
                        1e-5 * length + 2e-6 * seconds * 15)
                << "seed " << kSeed << ", case " << i << ", order " << n;
            ASSERT_NEAR(static_cast<double>(state.pose.yaw), truth.yaw, 1e-4);
            ASSERT_NEAR(static_cast<double>(state.pose.pitch), truth.pitch, 1e-4);
        }
    }
}

/// Nothing jumps, and nothing is faster than the fastest order.
TEST(PredictorLaws, TrajectoriesAreContinuous)
{
    constexpr std::uint64_t kSeed = 6;
    Random random(kSeed);
    for (int i = 0; i < 500; ++i) {
        const Plan plan = random_plan(random);
        Trajectory t;
        ASSERT_EQ(predict(plan.settings, Segments(), plan.start, {}, 0.0F, plan.orders, t), PredictStatus::complete);
        FlightState before = plan.start;
        const float dt = t.end() / 500.0F;
        for (int k = 1; k <= 500; ++k) {
            FlightState state;
            ASSERT_TRUE(project(t, std::min(dt * static_cast<float>(k), t.end()), state));
            ASSERT_LE((state.pose.position - before.pose.position).norm(), 15.0F * dt * 1.001F + 1e-4F)
                << "seed " << kSeed << ", case " << i << ", step " << k;
            before = state;
        }
        Reference reference;
        ASSERT_EQ(sample(t, 4, reference), PredictStatus::complete);
        ASSERT_EQ(reference.samples.size(), 4 * plan.orders.size() + 1);
        ASSERT_EQ(reference.samples.front().position, plan.start.pose.position);
        ASSERT_EQ(reference.samples.back().time, t.end());
    }
}

}  // namespace
}  // namespace jink::reach
