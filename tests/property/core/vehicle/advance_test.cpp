// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>

#include "core/base/random.hpp"
#include "core/vehicle/vehicle.hpp"

namespace jink::vehicle {
namespace {

Vec3 random_vector(Random& random, float size)
{
    return {random.uniform(-size, size), random.uniform(-size, size), random.uniform(-size, size)};
}

VehicleLimits random_limits(Random& random)
{
    VehicleLimits limits;
    limits.max_climb = random.uniform(0.5F, 6.0F);
    limits.max_descent = random.uniform(0.5F, 6.0F);
    limits.max_acceleration = random.uniform(0.5F, 12.0F);
    limits.max_vertical_acceleration = random.uniform(0.5F, 8.0F);
    limits.velocity_lag = random.uniform() < 0.1F ? 0.0F : random.uniform(0.01F, 1.5F);
    return limits;
}

/// The differential equation itself, in double, by small Heun steps.
struct Oracle {
    double p[3] = {0.0, 0.0, 0.0};
    double v[3] = {0.0, 0.0, 0.0};

    static void slope(const double (&v)[3], const double (&goal)[3], const VehicleLimits& limits, double (&out)[3])
    {
        const double lag = std::max(static_cast<double>(limits.velocity_lag), 1e-6);
        for (int i = 0; i < 3; ++i) {
            out[i] = (goal[i] - v[i]) / lag;
        }
        const double level = std::hypot(out[0], out[1]);
        if (level > static_cast<double>(limits.max_acceleration)) {
            out[0] *= static_cast<double>(limits.max_acceleration) / level;
            out[1] *= static_cast<double>(limits.max_acceleration) / level;
        }
        const auto vertical = static_cast<double>(limits.max_vertical_acceleration);
        out[2] = std::clamp(out[2], -vertical, vertical);
    }

    void fly(const double (&goal)[3], const VehicleLimits& limits, double dt, int steps)
    {
        const double h = dt / steps;
        for (int k = 0; k < steps; ++k) {
            double a[3];
            double b[3];
            double ahead[3];
            slope(v, goal, limits, a);
            for (int i = 0; i < 3; ++i) {
                ahead[i] = v[i] + h * a[i];
            }
            slope(ahead, goal, limits, b);
            for (int i = 0; i < 3; ++i) {
                const double next = v[i] + 0.5 * h * (a[i] + b[i]);
                p[i] += 0.5 * h * (v[i] + next);
                v[i] = next;
            }
        }
    }
};

TEST(AdvanceLaws, AgreesWithTheDifferentialEquation)
{
    for (std::uint64_t seed = 1; seed <= 300; ++seed) {
        Random random(seed);
        VehicleLimits limits = random_limits(random);
        limits.velocity_lag = random.uniform(0.05F, 1.5F);
        VehicleState state;
        state.velocity = random_vector(random, 8.0F);
        const Vec3 command = random_vector(random, 8.0F);
        const float dt = random.uniform(0.01F, 2.0F);
        Oracle oracle;
        const double goal[3] = {static_cast<double>(command.x()), static_cast<double>(command.y()),
                                static_cast<double>(std::clamp(command.z(), -limits.max_descent, limits.max_climb))};
        for (int i = 0; i < 3; ++i) {
            oracle.v[i] = static_cast<double>(state.velocity[i]);
        }
        oracle.fly(goal, limits, static_cast<double>(dt), 20000);
        advance(state, command, limits, dt);
        for (int i = 0; i < 3; ++i) {
            ASSERT_NEAR(static_cast<double>(state.velocity[i]), oracle.v[i], 1e-4) << "seed " << seed;
            ASSERT_NEAR(static_cast<double>(state.position[i]), oracle.p[i], 1e-4) << "seed " << seed;
        }
    }
}

TEST(AdvanceLaws, TwoHalvesMakeAWhole)
{
    for (std::uint64_t seed = 1; seed <= 20000; ++seed) {
        Random random(seed);
        const VehicleLimits limits = random_limits(random);
        VehicleState whole;
        whole.velocity = random_vector(random, 10.0F);
        const Vec3 command = random_vector(random, 10.0F);
        const float dt = random.uniform(0.001F, 2.0F);
        VehicleState halves = whole;
        advance(whole, command, limits, dt);
        advance(halves, command, limits, 0.5F * dt);
        advance(halves, command, limits, 0.5F * dt);
        ASSERT_LT((whole.velocity - halves.velocity).norm(), 5e-5F) << "seed " << seed;
        ASSERT_LT((whole.position - halves.position).norm(), 1e-4F) << "seed " << seed;
    }
}

TEST(AdvanceLaws, NeverBeyondItsLimits)
{
    for (std::uint64_t seed = 1; seed <= 20000; ++seed) {
        Random random(seed);
        const VehicleLimits limits = random_limits(random);
        VehicleState state;
        state.velocity = random_vector(random, 10.0F);
        state.velocity.z() = random.uniform(-limits.max_descent, limits.max_climb);
        for (int step = 0; step < 5; ++step) {
            const VehicleState before = state;
            const float dt = random.uniform(0.005F, 0.5F);
            const Vec3 command = random_vector(random, 10.0F);
            advance(state, command, limits, dt);
            const Vec3 change = state.velocity - before.velocity;
            ASSERT_LE(change.head<2>().norm(), limits.max_acceleration * dt * 1.0001F + 1e-5F) << "seed " << seed;
            ASSERT_LE(std::abs(change.z()), limits.max_vertical_acceleration * dt * 1.0001F + 1e-5F) << "seed " << seed;
            ASSERT_LE(state.velocity.z(), limits.max_climb * 1.0001F) << "seed " << seed;
            ASSERT_GE(state.velocity.z(), -limits.max_descent * 1.0001F) << "seed " << seed;
            // The velocity error never grows: no overshoot for any step.
            ASSERT_LE((state.velocity - command).head<2>().norm(), (before.velocity - command).head<2>().norm() + 1e-5F)
                << "seed " << seed;
        }
    }
}

TEST(ClampedVelocityLaws, DirectionStaysAndLimitsHold)
{
    for (std::uint64_t seed = 1; seed <= 50000; ++seed) {
        Random random(seed);
        const VehicleLimits limits = random_limits(random);
        const Vec3 direction = random_vector(random, 10.0F);
        const float speed = random.uniform(0.1F, 20.0F);
        const Vec3 velocity = clamped_velocity(direction, speed, limits);
        ASSERT_LE(velocity.norm(), speed * 1.00001F) << "seed " << seed;
        ASSERT_LE(velocity.z(), limits.max_climb) << "seed " << seed;
        ASSERT_GE(velocity.z(), -limits.max_descent) << "seed " << seed;
        ASSERT_LT(velocity.normalized().cross(direction.normalized()).norm(), 2e-6F) << "seed " << seed;
        ASSERT_GT(velocity.dot(direction), 0.0F) << "seed " << seed;
        const bool bound = velocity.z() >= limits.max_climb || velocity.z() <= -limits.max_descent;
        ASSERT_TRUE(bound || std::abs(velocity.norm() - speed) < 1e-5F * speed) << "seed " << seed;
    }
}

}  // namespace
}  // namespace jink::vehicle
