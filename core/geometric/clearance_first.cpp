// SPDX-License-Identifier: BSD-3-Clause
// The airspace, and the first of what a curve can touch.
#include <algorithm>
#include <cmath>

#include "core/geometric/clearance.hpp"
#include "core/geometry/shape.hpp"
#include "core/world/obstacle_distance.hpp"

namespace jink::geometric::detail {

using world::ThreatKind;

Clearance::Bounds Clearance::bounds() const noexcept
{
    const world::Airspace& air = *problem_.airspace;
    const Vec3& origin = problem_.frame.origin;
    const float extra = problem_.obstacle_clearance;  // bounds are kept like obstacles
    const float height = half_.z() + extra;
    return {air.home - origin, air.floor + height - origin.z(), air.ceiling - height - origin.z(),
            air.keep_in_radius - std::sqrt(half_.x() * half_.x() + half_.y() * half_.y()) - extra};
}

world::ThreatKind Clearance::left_airspace(const Curve& curve) const noexcept
{
    if (problem_.airspace == nullptr) {
        return ThreatKind::none;
    }
    const world::Airspace& air = *problem_.airspace;
    const auto [home, floor, ceiling, radius] = bounds();
    const float floor_shrunk = shrink_to_clear(-floor);
    const float ceiling_shrunk = shrink_to_clear(ceiling);
    const float keep_in_shrunk = shrink_to_clear(radius - home.head<2>().norm());
    for (std::size_t i = 0; i < curve.points; ++i) {
        const Seconds t = curve.t[i];
        if (air.has_floor && curve.z[i] - floor + shrink_at(floor_shrunk, t) < 0.0F) {
            return ThreatKind::floor;
        }
        if (air.has_ceiling && ceiling - curve.z[i] + shrink_at(ceiling_shrunk, t) < 0.0F) {
            return ThreatKind::ceiling;
        }
        if (air.has_keep_in) {
            const float x = curve.x[i] - home.x();
            const float y = curve.y[i] - home.y();
            const float reach = radius + shrink_at(keep_in_shrunk, t);
            if (reach < 0.0F || x * x + y * y > reach * reach) {
                return ThreatKind::keep_in;
            }
        }
    }
    return ThreatKind::none;
}

bool Clearance::stays_in_airspace(const Curve& so_far, float level, float vertical) const noexcept
{
    if (problem_.airspace == nullptr) {
        return true;
    }
    if (left_airspace(so_far) != ThreatKind::none) {
        return false;
    }
    const world::Airspace& air = *problem_.airspace;
    const auto [home, floor, ceiling, radius] = bounds();
    const Vec3 last = so_far.position(so_far.points - 1);
    // Far more than rounding takes: what is near is flown and looked at.
    const float slack = 1e-3F * (1.0F + level + vertical + last.cwiseAbs().maxCoeff() + home.cwiseAbs().maxCoeff());
    return (!air.has_floor || last.z() - floor > vertical + slack) &&
           (!air.has_ceiling || ceiling - last.z() > vertical + slack) &&
           (!air.has_keep_in || radius - (last - home).head<2>().norm() > level + slack);
}

bool Clearance::first_threat(const Extent& reach, Seconds longest, bool moving) noexcept
{
    for (std::size_t i = 0; i < problem_.threats.size(); ++i) {
        if (is_moving(problem_.threats[i]) != moving) {
            continue;
        }
        first_ball_ = ball_of(i);
        if (!out_of(reach, first_ball_, longest)) {
            first_ = as_item(moving ? Kind::moving_ball : Kind::static_ball, i, first_ball_);
            return true;
        }
    }
    return false;
}

bool Clearance::find_first(const Extent& reach, Seconds longest) noexcept
{
    if (settings_.security == SecurityMode::swept) {
        return false;  // a moving threat's volume is no ball
    }
    for (const world::Obstacle& obstacle : problem_.obstacles) {
        Ball ball;
        if (settings_.escape_from_margin && !is_out_of({}, obstacle.shape) &&
            !world::as_sphere(obstacle.shape, half_, ball.half, ball.radius)) {
            return false;  // each `collect` spends support calls on it
        }
    }
    if (first_threat(reach, longest, false)) {
        return true;
    }
    for (std::size_t i = 0; i < problem_.obstacles.size(); ++i) {
        const geometry::Shape& shape = problem_.obstacles[i].shape;
        Ball ball;
        if (world::as_sphere(shape, half_, ball.half, ball.radius)) {
            first_ball_ = ball_of(shape);
            if (!out_of(reach, first_ball_, 0.0F)) {
                first_ = as_item(Kind::obstacle_ball, i, first_ball_);
                return true;
            }
        } else if (!is_out_of(reach, shape)) {
            return false;
        }
    }
    return first_threat(reach, longest, true);
}

Room Clearance::room_of_first(float fastest, Seconds duration) const noexcept
{
    return {fastest, first_ball_.velocity.cwiseAbs().maxCoeff(), first_ball_.radius_at(duration), duration};
}

bool Clearance::touches_first(const Curve& curve, std::size_t i, Room& room) const noexcept
{
    if (room.lasts_until(curve.t[i + 1])) {
        return false;
    }
    const Vec3 before = first_ball_.apart(curve, i);
    room.look(before, first_ball_.half, curve.t[i]);
    return !room.lasts_until(curve.t[i + 1]) &&
           touches(curve, i, first_ball_, first_.shrunk, before, first_ball_.apart(curve, i + 1));
}

Verdict Clearance::first_verdict(std::size_t segments, WorkBudget& budget) const noexcept
{
    if (!budget.spend(static_cast<std::uint32_t>(segments))) {
        return {CandidateStatus::not_evaluated, {}};
    }
    return verdict_of(first_);
}

}  // namespace jink::geometric::detail
