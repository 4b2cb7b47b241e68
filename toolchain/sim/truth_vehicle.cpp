// SPDX-License-Identifier: BSD-3-Clause
#include "toolchain/sim/truth_vehicle.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "toolchain/sim/arduplane.hpp"

namespace jink::sim {
namespace {

/// Below this speed the course is undefined [m/s].
constexpr double kCourseSpeed = 0.5;

using Plane = Eigen::Vector2d;

double wrapped(double angle) noexcept { return std::remainder(angle, 2.0 * std::numbers::pi); }

void bound_acceleration(Truth& truth, const TruthLimits& limits) noexcept
{
    Plane level = truth.acceleration.head<2>();
    const Plane course = truth.velocity.head<2>();
    const double speed = course.norm();
    if (limits.max_course_rate > 0.0 && speed > kCourseSpeed) {
        const Plane forward = course / speed;
        const Plane left(-forward.y(), forward.x());
        const double most = limits.max_course_rate * speed;
        level = forward * level.dot(forward) + left * std::clamp(level.dot(left), -most, most);
    }
    const double size = level.norm();
    if (size > limits.max_acceleration) {
        level *= limits.max_acceleration / size;
    }
    truth.acceleration.head<2>() = level;
    truth.acceleration.z() =
        std::clamp(truth.acceleration.z(), -limits.max_vertical_acceleration, limits.max_vertical_acceleration);
}

/// PX4's gains as delivered (MPC_XY_VEL_P_ACC, MPC_XY_VEL_I_ACC, MPC_Z_VEL_P_ACC, MPC_Z_VEL_I_ACC). It knows nothing of
/// drag: a new velocity is reached in part, to gain / (gain + drag), and the rest as the integrator follows.
void move_against_drag(Truth& truth, const Vec& goal, const TruthLimits& limits, double dt) noexcept
{
    static const Vec kGain(1.8, 1.8, 4.0);
    static const Vec kIntegral(0.4, 0.4, 2.0);
    constexpr double kThrustLag = 0.15;  // [s]
    const Vec error = goal - truth.velocity;
    Vec wanted = kGain.cwiseProduct(error) + truth.held;
    const double level = wanted.head<2>().norm();
    if (level > limits.max_acceleration) {
        wanted.head<2>() *= limits.max_acceleration / level;
    } else {
        truth.held.head<2>() += dt * kIntegral.head<2>().cwiseProduct(error.head<2>());
    }
    const double most = limits.max_vertical_acceleration;
    truth.held.z() += std::abs(wanted.z()) > most ? 0.0 : dt * kIntegral.z() * error.z();
    wanted.z() = std::clamp(wanted.z(), -most, most);
    const Vec thrust = truth.acceleration + limits.drag * truth.velocity;
    truth.acceleration = thrust + (wanted - thrust) * (dt / kThrustLag) - limits.drag * truth.velocity;
    const Vec before = truth.velocity;
    truth.velocity += dt * truth.acceleration;
    truth.position += 0.5 * dt * (before + truth.velocity);
}

void turn_nose(Truth& truth, const TruthLimits& limits, double dt) noexcept
{
    const Plane course = truth.velocity.head<2>();
    if (course.norm() < kCourseSpeed) {
        return;
    }
    const double error = wrapped(std::atan2(course.y(), course.x()) - truth.yaw);
    truth.yaw = wrapped(truth.yaw + std::clamp(error, -limits.max_yaw_rate * dt, limits.max_yaw_rate * dt));
}

}  // namespace

void move(Truth& truth, const Vec& command, const TruthLimits& limits, double dt) noexcept
{
    if (limits.min_speed > 0.0) {
        move_plane(truth, command, limits, dt);
        return;
    }
    Vec goal = command;
    goal.z() = std::clamp(goal.z(), -limits.max_descent, limits.max_climb);
    if (limits.drag > 0.0) {
        move_against_drag(truth, goal, limits, dt);
        return;
    }
    const double w = limits.omega;
    truth.acceleration += dt * (w * w * (goal - truth.velocity) - 2.0 * limits.damping * w * truth.acceleration);
    bound_acceleration(truth, limits);
    const Vec before = truth.velocity;
    truth.velocity += dt * truth.acceleration;
    const double vertical = std::clamp(truth.velocity.z(), -limits.max_descent, limits.max_climb);
    if (vertical != truth.velocity.z()) {
        // A gust may push against the limit for long: the acceleration away from the limit keeps building up.
        if (truth.acceleration.z() * truth.velocity.z() > 0.0) {
            truth.acceleration.z() = 0.0;
        }
        truth.velocity.z() = vertical;
    }
    truth.position += 0.5 * dt * (before + truth.velocity);
}

void fly(Truth& truth, const Vec& command, const TruthLimits& limits, double dt) noexcept
{
    move(truth, command, limits, dt);
    turn_nose(truth, limits, dt);
}

Vec along(const Vec& direction, double speed, const TruthLimits& limits) noexcept
{
    const double length = direction.norm();
    if (length < 1e-9) {
        return Vec::Zero();
    }
    Vec velocity = direction * (speed / length);
    const double bound = velocity.z() > 0.0 ? limits.max_climb : limits.max_descent;
    const double vertical = std::abs(velocity.z());
    return vertical > bound ? Vec(velocity * (bound / vertical)) : velocity;
}

}  // namespace jink::sim
