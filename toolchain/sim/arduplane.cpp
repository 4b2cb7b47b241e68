// SPDX-License-Identifier: BSD-3-Clause
#include "toolchain/sim/arduplane.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "toolchain/sim/geodesy.hpp"

namespace jink::sim {
namespace {

using Level = Eigen::Vector2d;

constexpr double kPeriod = 17.0;        // NAVL1_PERIOD [s]
constexpr double kDamping = 0.75;       // NAVL1_DAMPING
constexpr double kWaypointRadius = 90;  // WP_RADIUS [m]
constexpr double kHeightTime = 5.0;     // TECS_TIME_CONST [s]
constexpr double kRollTime = 0.5;       // RLL2SRV_TCONST [s]
constexpr double kSpeedTime = 2.0;      // [s]
constexpr double kClimbTime = 1.0;      // [s]
constexpr double kMaxThrust = 2.0;      // [m/s2]
/// Lateral acceleration over speed and the sine of the course error, K_L1 * V / L1_dist [1/s].
constexpr double kL1 = 4.0 * kDamping / (kPeriod / std::numbers::pi);

constexpr std::uint8_t kPlaneAccepted = 0;
constexpr std::uint8_t kPlaneDenied = 2;
constexpr std::uint8_t kPlaneUnsupported = 3;
constexpr std::uint8_t kPlaneFailed = 4;
constexpr std::uint16_t kPlaneReposition = 192;

double cross(const Level& a, const Level& b) noexcept { return a.x() * b.y() - a.y() * b.x(); }

Level turned(const Level& v, double angle) noexcept
{
    return {std::cos(angle) * v.x() - std::sin(angle) * v.y(), std::sin(angle) * v.x() + std::cos(angle) * v.y()};
}

/// Course for which the L1 law commands the lateral acceleration `demand` to the right [m/s2].
Vec course_of(const Level& velocity, double demand) noexcept
{
    const double speed = std::max(velocity.norm(), 1.0);
    const double nu = std::asin(std::clamp(demand / (kL1 * speed), -1.0, 1.0));
    const Level level = turned(velocity, -nu);
    return {level.x(), level.y(), 0.0};
}

/// The course towards `goal`.
Vec straight_to(const Level& goal, double speed) noexcept
{
    const Level level = goal.normalized() * speed;
    return {level.x(), level.y(), 0.0};
}

}  // namespace

PlaneCircle circle_course(const Truth& own, const Vec& centre, double radius) noexcept
{
    const Level velocity = own.velocity.head<2>();
    const Level from_centre = (own.position - centre).head<2>();
    const double speed = std::max(velocity.norm(), 1.0);
    const double distance = from_centre.norm();
    const Level out = distance > 0.1 ? Level(from_centre / distance) : Level(velocity / speed);
    // ArduPilot's cross product is of north and east: the sign is reversed here.
    const double across = -cross(out, velocity);
    const double inbound = -velocity.dot(out);
    const double nu = std::clamp(std::atan2(across, inbound), -0.5 * std::numbers::pi, 0.5 * std::numbers::pi);
    const double capture = kL1 * speed * std::sin(nu);
    const double omega = 2.0 * std::numbers::pi / kPeriod;
    const double error = distance - radius;
    double correction = error * omega * omega - inbound * 2.0 * kDamping * omega;
    if (inbound < 0.0 && across < 0.0) {
        correction = std::max(correction, 0.0);
    }
    const double circle = correction + across * across / std::max(0.5 * radius, distance);
    const bool captures = error > 0.0 && capture < circle;
    return {course_of(velocity, captures ? capture : circle), !captures};
}

Vec line_course(const Truth& own, const Vec& from, const Vec& to) noexcept
{
    const Level velocity = own.velocity.head<2>();
    const double speed = std::max(velocity.norm(), 1.0);
    const double ahead = kDamping * kPeriod * speed / std::numbers::pi;
    const Level span = (to - from).head<2>();
    const Level here = (own.position - from).head<2>();
    const double length = span.norm();
    const Level left = (to - own.position).head<2>();
    if (length < 1e-3) {
        return left.norm() < 1e-3 ? Vec(velocity.x(), velocity.y(), 0.0) : straight_to(left, speed);
    }
    const Level along = span / length;
    const double done = here.dot(along);
    if (here.norm() > ahead && done < -0.7071 * here.norm()) {
        return straight_to(-here, speed);
    }
    if (done > length + 3.0 * speed) {
        return straight_to(left, speed);
    }
    const double back = std::asin(std::clamp(cross(along, here) / ahead, -0.7071, 0.7071));
    const Level level = turned(along, -back) * speed;
    return {level.x(), level.y(), 0.0};
}

double turn_distance(double speed, double angle) noexcept
{
    const double right_angle = std::min(kWaypointRadius, kDamping * kPeriod * speed / std::numbers::pi);
    return right_angle * std::min(angle / (0.5 * std::numbers::pi), 1.0);
}

double height_on_the_way(const Vec& from, const Vec& to, const Vec& here, bool climbs_at_once) noexcept
{
    const double rise = to.z() - from.z();
    if (std::abs(rise) < kPlaneSlopeMin || (climbs_at_once && rise > 0.0)) {
        return to.z();
    }
    const Level leg = (to - from).head<2>();
    const double share = (here - from).head<2>().dot(leg) / std::max(leg.squaredNorm(), 1.0);
    return from.z() + std::clamp(share, 0.0, 1.0) * rise;
}

double climb_to(double height, const Truth& own, const TruthLimits& limits) noexcept
{
    return std::clamp((height - own.position.z()) / kHeightTime, -limits.max_descent, limits.max_climb);
}

std::uint8_t PlaneGuidance::hear(const link::mavlink::CommandInt& command, bool guided, const Vec& here)
{
    if (command.command != kPlaneReposition) {
        return kPlaneUnsupported;
    }
    const bool relative = command.frame == 3 || command.frame == 6;
    const bool on_earth = std::abs(command.x) <= 900000000 && std::abs(command.y) <= 1800000000;
    if (!on_earth || !std::isfinite(command.z) || (command.frame != 0 && command.frame != 5 && !relative) ||
        command.param2 != 0.0F) {
        return kPlaneDenied;
    }
    if (!guided) {
        return kPlaneFailed;
    }
    from_ = here;
    point_ = to_local({command.x, command.y, 0});
    point_.z() = static_cast<double>(command.z) - (relative ? 0.0 : kHomeAltitude);
    return kPlaneAccepted;
}

Vec PlaneGuidance::command(const Truth& own) const
{
    Vec command = circle_course(own, point_, kPlaneLoiterRadius).course;
    command.z() = climb_to(height_on_the_way(from_, point_, own.position, true), own, limits_);
    return command;
}

void move_plane(Truth& truth, const Vec& command, const TruthLimits& limits, double dt) noexcept
{
    const Level velocity = truth.velocity.head<2>();
    const double speed = std::max(velocity.norm(), 1.0);
    const Level forward = velocity / speed;
    const Level left(-forward.y(), forward.x());
    const Level wanted = command.head<2>();
    const double nu = std::clamp(std::atan2(cross(forward, wanted), forward.dot(wanted)), -0.5 * std::numbers::pi,
                                 0.5 * std::numbers::pi);
    const double bank = std::clamp(kL1 * speed * std::sin(nu), -limits.max_acceleration, limits.max_acceleration);
    double lateral = truth.acceleration.head<2>().dot(left);
    lateral += (bank - lateral) * dt / kRollTime;
    const double thrust =
        std::clamp((std::max(limits.cruise, limits.min_speed) - speed) / kSpeedTime, -kMaxThrust, kMaxThrust);
    const double climb = std::clamp(command.z(), -limits.max_descent, limits.max_climb);
    const double rise = std::clamp((climb - truth.velocity.z()) / kClimbTime, -limits.max_vertical_acceleration,
                                   limits.max_vertical_acceleration);
    const Vec before = truth.velocity;
    const Level after = turned(forward * std::max(speed + thrust * dt, limits.min_speed), lateral / speed * dt);
    truth.velocity = Vec(after.x(), after.y(), before.z() + rise * dt);
    const Level along = after.normalized();
    truth.acceleration.head<2>() = thrust * along + lateral * Level(-along.y(), along.x());
    truth.acceleration.z() = rise;
    truth.position += 0.5 * dt * (before + truth.velocity);
}

}  // namespace jink::sim
