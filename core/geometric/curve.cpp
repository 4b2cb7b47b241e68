// SPDX-License-Identifier: BSD-3-Clause
#include "core/geometric/curve.hpp"

#include <algorithm>
#include <cmath>

#include "core/base/angle.hpp"
#include "core/geometric/planner.hpp"

namespace jink::geometric::detail {
namespace {

/// Rounding of the finite differences that accelerations are taken from.
constexpr float kDifferenceRounding = 1.001F;

bool within(const Vec3& change, Seconds time, const vehicle::VehicleLimits& limits) noexcept
{
    const float level = kDifferenceRounding * limits.max_acceleration * time;
    const float vertical = kDifferenceRounding * limits.max_vertical_acceleration * time;
    return change.x() * change.x() + change.y() * change.y() <= level * level && std::abs(change.z()) <= vertical;
}

/// How far a speed across the leg carries before the vehicle has taken it off: lag, then full acceleration.
float overshoot(float speed, float acceleration, Seconds lag) noexcept
{
    return speed * (lag + 0.5F * speed / acceleration);
}

}  // namespace

UnitCurve make_unit_curve(Family family, std::uint16_t waypoints, float length) noexcept
{
    UnitCurve unit;
    unit.points = waypoints;
    unit.step = length / static_cast<float>(waypoints - 1);
    for (std::size_t i = 0; i < unit.points; ++i) {
        unit.f[i] = unit_offset(family, unit.step * static_cast<float>(i));
    }
    return unit;
}

Vec3 plane_direction(const PathFrame& frame, float plane) noexcept
{
    const SineCosine turned = sine_cosine(plane);
    return turned.cosine * frame.axes.col(1) + turned.sine * frame.axes.col(2);
}

void make_curve(const UnitCurve& unit, const Vec3& along, const Vec3& side, float distance, float offset, float speed,
                const vehicle::VehicleLimits& limits, Curve& out) noexcept
{
    out.points = unit.points;
    out.fastest = kUnitTolerance * speed;
    const Vec3 leg = distance * along;
    const Vec3 out_to = offset * side;
    for (std::size_t i = 0; i < unit.points; ++i) {
        const float u = unit.step * static_cast<float>(i);
        out.x[i] = u * leg.x() + unit.f[i] * out_to.x();
        out.y[i] = u * leg.y() + unit.f[i] * out_to.y();
        out.z[i] = u * leg.z() + unit.f[i] * out_to.z();
    }
    const float per_speed = 1.0F / speed;
    const float per_climb = 1.0F / limits.max_climb;
    const float per_descent = -1.0F / limits.max_descent;
    const float advance = distance * unit.step;
    Coordinates duration;
    for (std::size_t i = 0; i + 1 < unit.points; ++i) {
        const float aside = offset * (unit.f[i + 1] - unit.f[i]);
        const float rise = out.z[i + 1] - out.z[i];
        const float length = std::sqrt(advance * advance + aside * aside);
        duration[i] = std::max(length * per_speed, std::max(rise * per_climb, rise * per_descent));
    }
    out.t[0] = 0.0F;
    for (std::size_t i = 0; i + 1 < unit.points; ++i) {
        out.t[i + 1] = out.t[i] + duration[i];
    }
}

void make_waiting_curve(const Wait& wait, const Vec3& along, std::size_t waypoints, Curve& out) noexcept
{
    const float slow = wait.share * wait.speed;
    const float change = wait.start_speed > slow ? -wait.acceleration : wait.acceleration;
    const Seconds settled = std::min(wait.until, (slow - wait.start_speed) / change);
    const float slowest = wait.start_speed + change * settled;
    const auto speed_at = [&](Seconds t) {
        return t <= wait.until ? wait.start_speed + change * std::min(t, settled)
                               : std::min(wait.speed, slowest + wait.acceleration * (t - wait.until));
    };
    const float waited = 0.5F * (wait.start_speed + slowest) * settled + slowest * (wait.until - settled);
    const Seconds speeding_up = std::max(0.0F, wait.speed - slowest) / wait.acceleration;
    const Seconds total = wait.until + speeding_up + std::max(0.0F, wait.length - waited) / wait.speed;
    const Seconds step = total / static_cast<float>(waypoints - 1);
    out.points = waypoints;
    out.fastest = kUnitTolerance * std::max(wait.start_speed, wait.speed);
    float way = 0.0F;
    for (std::size_t i = 0; i < waypoints; ++i) {
        const Seconds t = step * static_cast<float>(i);
        way += i > 0 ? 0.5F * step * (speed_at(t - step) + speed_at(t)) : 0.0F;
        out.x[i] = way * along.x();
        out.y[i] = way * along.y();
        out.z[i] = way * along.z();
        out.t[i] = t;
    }
}

void to_timed_path(const Curve& curve, const Vec3& origin, path::TimedPath& out) noexcept
{
    out.points.resize(curve.points);
    for (std::size_t i = 0; i < curve.points; ++i) {
        const std::size_t segment = std::min(i, curve.points - 2);
        out.points[i] = {origin + curve.position(i), curve.velocity(segment), curve.t[i]};
    }
}

bool is_flyable(const Curve& curve, const Vec3& velocity_before, const Vec3& rejoin,
                const vehicle::VehicleLimits& limits) noexcept
{
    // The first chord is reached half a segment after the start: from straight flight, that is the curvature at the
    // start.
    Vec3 before = velocity_before;
    Seconds middle = 0.0F;
    for (std::size_t i = 0; i + 1 < curve.points; ++i) {
        const Vec3 velocity = curve.velocity(i);
        const Seconds next_middle = 0.5F * (curve.t[i] + curve.t[i + 1]);
        if (!within(velocity - before, next_middle - middle, limits)) {
            return false;
        }
        before = velocity;
        middle = next_middle;
    }
    const Vec3 across = before - before.dot(rejoin) * rejoin;
    const float level = std::sqrt(across.x() * across.x() + across.y() * across.y());
    return overshoot(level, limits.max_acceleration, limits.velocity_lag) <= kRejoinOvershoot &&
           overshoot(std::abs(across.z()), limits.max_vertical_acceleration, limits.velocity_lag) <= kRejoinOvershoot;
}

}  // namespace jink::geometric::detail
