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
constexpr double kLoiterRadius = 60.0;  // WP_LOITER_RAD [m]
constexpr double kSlopeMin = 15.0;      // ALT_SLOPE_MIN [m]
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

/// AP_L1_Control::update_loiter, clockwise: lateral acceleration to the right [m/s2].
double lateral_demand(const Level& from_centre, const Level& velocity) noexcept
{
    const double speed = std::max(velocity.norm(), 1.0);
    const double distance = from_centre.norm();
    const Level out = distance > 0.1 ? Level(from_centre / distance) : Level(velocity / speed);
    // ArduPilot's cross product is of north and east: its sign is the other one here.
    const double across = -cross(out, velocity);
    const double inbound = -velocity.dot(out);
    const double nu = std::clamp(std::atan2(across, inbound), -0.5 * std::numbers::pi, 0.5 * std::numbers::pi);
    const double capture = kL1 * speed * std::sin(nu);
    const double omega = 2.0 * std::numbers::pi / kPeriod;
    const double error = distance - kLoiterRadius;
    double correction = error * omega * omega - inbound * 2.0 * kDamping * omega;
    if (inbound < 0.0 && across < 0.0) {
        correction = std::max(correction, 0.0);
    }
    const double circle = correction + across * across / std::max(0.5 * kLoiterRadius, distance);
    return error > 0.0 && capture < circle ? capture : circle;
}

}  // namespace

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
    const Level velocity = own.velocity.head<2>();
    const Level from_centre = (own.position - point_).head<2>();
    const double demand = lateral_demand(from_centre, velocity);
    const double speed = std::max(velocity.norm(), 1.0);
    const double nu = std::asin(std::clamp(demand / (kL1 * speed), -1.0, 1.0));
    double height = point_.z();
    if (from_.z() - point_.z() >= kSlopeMin) {
        const Level leg = (point_ - from_).head<2>();
        const double share = (own.position - from_).head<2>().dot(leg) / std::max(leg.squaredNorm(), 1.0);
        height = from_.z() + std::clamp(share, 0.0, 1.0) * (point_.z() - from_.z());
    }
    const Level level = turned(velocity / speed * limits_.cruise, -nu);
    return {level.x(), level.y(),
            std::clamp((height - own.position.z()) / kHeightTime, -limits_.max_descent, limits_.max_climb)};
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
