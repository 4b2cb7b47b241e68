// SPDX-License-Identifier: BSD-3-Clause
#include "core/geometric/along_reference.hpp"

#include <algorithm>
#include <cmath>

#include "core/geometric/run.hpp"

namespace jink::geometric {

Vec3 collision_point_along(const Problem& problem) noexcept
{
    return path::point_of(problem.ahead, problem.frame.origin, problem.frame.axes.col(0), problem.distance).position;
}

namespace detail {
namespace {

/// A joint whose tangents differ by less is none [-].
constexpr float kNoCorner = 1e-4F;
/// The part after a joint is sampled this far past it, so that rounding does not find the part before it [m].
constexpr float kPastJoint = 1e-3F;
/// No chord takes less, however short it is: times rise strictly and velocities are numbers [s].
constexpr Seconds kMinDuration = 1e-3F;
/// Tangents by which the planes are carried to the collision point.
constexpr int kCarrySteps = 8;
/// The tangent at the collision point is taken between points this share of D before and behind it.
constexpr float kTangentShare = 0.02F;
/// Points by which the reach of curves is found.
constexpr int kReachPoints = 16;

/// Half way between two unit vectors, as long as sqrt(2); nowhere between opposite ones.
Vec3 half_way(const Vec3& from, const Vec3& to) noexcept
{
    constexpr float kOpposite = 1e-4F;
    const float both = 1.0F + from.dot(to);  // half the square of their sum
    return both > kOpposite ? Vec3((from + to) / std::sqrt(both)) : Vec3(Vec3::Zero());
}

/// Unit vector between the neighbours of a point.
Vec3 tangent_of(const BaseCurve& base, std::size_t i) noexcept
{
    return (base.position(i + 1) - base.position(i - 1)).normalized();
}

}  // namespace

ReferenceAhead::ReferenceAhead(const Problem& problem, const vehicle::VehicleLimits& limits, float end) noexcept
    : problem_(problem), end_(end)
{
    const path::RouteAhead& ahead = problem.ahead;
    const Vec3 straight = problem.frame.axes.col(0);
    round(ahead.straight, ahead.route.at(ahead.joined_at + kPastJoint).along - straight, problem.speed, limits);
    const std::span<const path::RouteSegment> segments = ahead.route.segments();
    float joint = 0.0F;
    for (std::size_t i = 0; i + 1 < segments.size(); ++i) {
        joint += segments[i].length;
        if (joint > ahead.joined_at + kPastJoint) {
            const Vec3 before = path::point_of(segments[i], segments[i].length).along;
            round(ahead.straight + (joint - ahead.joined_at), segments[i + 1].along - before, problem.speed, limits);
        }
    }
}

/// Along a parabola of `half` to either side of the corner the velocity changes by `change` times the speed in
/// 2 half / speed.
void ReferenceAhead::round(float way, const Vec3& change, float speed, const vehicle::VehicleLimits& limits) noexcept
{
    const float level = std::sqrt(change.x() * change.x() + change.y() * change.y());
    const float asked =
        std::max(level / limits.max_acceleration, std::abs(change.z()) / limits.max_vertical_acceleration);
    const float half = std::min({0.5F / kCornerShare * speed * speed * asked, way, end_ - way});
    if (change.norm() > kNoCorner && half > 0.0F) {
        corners_.unchecked_push_back({way, half, change});
    }
}

Vec3 ReferenceAhead::position(float way) const noexcept
{
    const Vec3& origin = problem_.frame.origin;
    Vec3 position = path::point_of(problem_.ahead, origin, problem_.frame.axes.col(0), way).position - origin;
    for (const Corner& corner : corners_) {
        const float past = way - corner.way;
        if (std::abs(past) < corner.half) {
            const float in = past + corner.half;
            position += (in * in / (4.0F * corner.half) - std::max(past, 0.0F)) * corner.change;
        }
    }
    return position;
}

Vec3 ReferenceAhead::along(float way) const noexcept
{
    return path::point_of(problem_.ahead, problem_.frame.origin, problem_.frame.axes.col(0), way).along;
}

void make_base(const UnitCurve& unit, const Problem& problem, const vehicle::VehicleLimits& limits,
               BaseCurve& base) noexcept
{
    const float step = scale_of(problem) * unit.step;
    const float end = step * static_cast<float>(unit.points - 1);
    if (base.end == end) {
        return;
    }
    base.end = end;
    const ReferenceAhead ahead(problem, limits, end);
    base.rejoin = ahead.along(end);
    for (std::size_t i = 0; i < unit.points; ++i) {
        const Vec3 position = ahead.position(step * static_cast<float>(i));
        base.x[i] = position.x();
        base.y[i] = position.y();
        base.z[i] = position.z();
    }
    Vec3 tangent = problem.frame.axes.col(0);
    for (std::size_t i = 0; i < unit.points; ++i) {
        const bool is_last = i + 1 == unit.points;
        const Vec3 next = i == 0 ? tangent : is_last ? base.rejoin : tangent_of(base, i);
        const Vec3 half = half_way(tangent, next);
        base.half_x[i] = half.x();
        base.half_y[i] = half.y();
        base.half_z[i] = half.z();
        tangent = next;
    }
}

void make_curve_along(const UnitCurve& unit, const BaseCurve& base, const Vec3& side, float offset, float speed,
                      const vehicle::VehicleLimits& limits, Curve& out) noexcept
{
    out.points = unit.points;
    out.fastest = kUnitTolerance * speed;
    const float per_speed = 1.0F / speed;
    const float per_climb = 1.0F / limits.max_climb;
    const float per_descent = -1.0F / limits.max_descent;
    Vec3 carried = side;
    Vec3 before = base.position(0) + (offset * unit.f[0]) * side;
    Seconds now = 0.0F;
    for (std::size_t i = 0; i < unit.points; ++i) {
        carried = base.carried(carried, i);
        const Vec3 position = base.position(i) + (offset * unit.f[i]) * carried;
        const Vec3 step = position - before;
        const Seconds needed =
            std::max(step.norm() * per_speed, std::max(step.z() * per_climb, step.z() * per_descent));
        now += i > 0 ? std::max(needed, kMinDuration) : 0.0F;
        out.x[i] = position.x();
        out.y[i] = position.y();
        out.z[i] = position.z();
        out.t[i] = now;
        before = position;
    }
}

void make_candidate(const UnitCurve& unit, const Problem& problem, const vehicle::VehicleLimits& limits,
                    const Vec3& side, float offset, BaseCurve& base, Curve& out) noexcept
{
    if (problem.ahead.route.empty()) {
        base.rejoin = problem.frame.axes.col(0);
        make_curve(unit, base.rejoin, side, scale_of(problem), offset, problem.speed, limits, out);
    } else {
        make_base(unit, problem, limits, base);
        make_curve_along(unit, base, side, offset, problem.speed, limits, out);
    }
}

void bend_along(const ReferenceAhead& ahead, Curve& curve) noexcept
{
    for (std::size_t i = 0; i < curve.points; ++i) {
        const Vec3 position = ahead.position(curve.x[i]);
        curve.x[i] = position.x();
        curve.y[i] = position.y();
        curve.z[i] = position.z();
    }
}

Problem seen_at_collision(const Problem& problem, const vehicle::VehicleLimits& limits) noexcept
{
    const ReferenceAhead ahead(problem, limits, kSymmetricLength * scale_of(problem));
    const float distance = problem.distance;
    Problem seen = problem;
    Vec3 tangent = problem.frame.axes.col(0);
    for (int i = 1; i <= kCarrySteps; ++i) {
        const float part = static_cast<float>(i) / static_cast<float>(kCarrySteps);
        const float beside = kTangentShare * distance;
        const Vec3 next =
            (ahead.position(part * distance + beside) - ahead.position(part * distance - beside)).normalized();
        for (const int axis : {1, 2}) {
            seen.frame.axes.col(axis) = path::carried(seen.frame.axes.col(axis), tangent, next);
        }
        tangent = next;
    }
    const Vec3 point = problem.frame.origin + ahead.position(distance);
    seen.frame.axes.col(0) = tangent;
    seen.frame.origin = point - distance * tangent;
    seen.main_centre_offset += collision_point(problem) - point;
    seen.ahead = {};
    return seen;
}

void reach_along(const Problem& problem, float length, float widest, float slowest, Extent& reach,
                 Seconds& longest) noexcept
{
    const Vec3& origin = problem.frame.origin;
    const Vec3 along = problem.frame.axes.col(0);
    const float step = length / static_cast<float>(kReachPoints);
    reach = {};
    for (int i = 1; i <= kReachPoints; ++i) {
        const float way = step * static_cast<float>(i);
        const Vec3 position = path::point_of(problem.ahead, origin, along, way).position - origin;
        reach.low = reach.low.cwiseMin(position);
        reach.high = reach.high.cwiseMax(position);
    }
    // Between two points the reference is no step away from either; a rounded corner lies within it.
    const Vec3 aside = Vec3::Constant(widest + step);
    reach.low -= aside;
    reach.high += aside;
    // Outside of a bend a curve is longer by its offset times the turn; no corner turns further than back.
    float turn = 0.0F;
    for (const path::RouteSegment& segment : problem.ahead.route.segments()) {
        turn += (segment.is_arc() ? segment.length / segment.radius : 0.0F) + kPi;
    }
    longest += widest * turn / slowest;
}

}  // namespace detail
}  // namespace jink::geometric
