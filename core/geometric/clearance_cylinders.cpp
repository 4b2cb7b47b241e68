// SPDX-License-Identifier: BSD-3-Clause
// Upright cylinders, at rest or moving: closed areas and weather.
#include "core/base/work_units.hpp"
#include "core/geometric/clearance.hpp"
#include "core/world/cylinder.hpp"

namespace jink::geometric::detail {

/// As wide as it is kept clear of.
world::Cylinder Clearance::kept_clear_of(const world::Threat& threat) const noexcept
{
    world::Cylinder body = *threat.cylinder;
    body.circle.radius += problem_.keeps_soft_margins ? body.margin : 0.0F;
    return body;
}

void Clearance::add_cylinders(const Extent& reach, Seconds longest) noexcept
{
    const Seconds start = problem_.lead + problem_.begins;
    for (const world::Threat& threat : cylinders_) {
        if (!is_cylinder_out_of(reach, threat, 0.0F, longest)) {
            const float margin = world::cylinder_distance(half_, problem_.frame.origin, kept_clear_of(threat), start) -
                                 at_start(problem_, threat).growth.radius;
            items_.unchecked_push_back({index_of(threat), shrink_to_clear(margin)});
        }
    }
}

/// Between two times after the start, by bounding boxes: never where they overlap.
bool Clearance::is_cylinder_out_of(const Extent& extent, const world::Threat& threat, Seconds from,
                                   Seconds until) const noexcept
{
    const world::Cylinder body = kept_clear_of(threat);
    const Vec3& origin = problem_.frame.origin;
    const auto corner = [&](Seconds t, float height, float side) -> Vec3 {
        const world::Vec2 level = body.circle.centre + body.velocity * (problem_.lead + problem_.begins + t);
        return Vec3(level.x() + side * body.circle.radius, level.y() + side * body.circle.radius, height) - origin;
    };
    const Vec3 low = corner(from, body.bottom, -1.0F).cwiseMin(corner(until, body.bottom, -1.0F));
    const Vec3 high = corner(from, body.top, 1.0F).cwiseMax(corner(until, body.top, 1.0F));
    return apart(low, high, extent.low, extent.high, half_, threat.growth.radius);
}

/// Segment `i`. While the escape rule shrinks the body, it is as large in each part as at the part's end.
bool Clearance::touches_cylinder(const Curve& curve, std::size_t i, const world::Threat& threat, float shrunk,
                                 WorkBudget& budget) const noexcept
{
    const Seconds duration = curve.t[i + 1] - curve.t[i];
    const Vec3 velocity =
        duration > 0.0F ? Vec3((curve.position(i + 1) - curve.position(i)) / duration) : Vec3(Vec3::Zero());
    const world::Cylinder body = kept_clear_of(threat);
    const int parts = shrink_at(shrunk, curve.t[i]) > 0.0F ? escape_parts(duration) : 1;
    const Seconds span = duration / static_cast<float>(parts);
    for (int part = 0; part < parts; ++part) {
        const Seconds from = span * static_cast<float>(part);
        const float outset = threat.growth.radius - shrink_at(shrunk, curve.t[i] + from + span);
        const world::detail::CylinderApproach approach(
            half_, {problem_.frame.origin + curve.position(i) + from * velocity, velocity}, body,
            problem_.lead + problem_.begins + curve.t[i] + from, outset, 0.0F);
        if (!(approach.least(span, 0.0F, budget).distance >= 0.0F)) {
            return true;
        }
    }
    return false;
}

bool Clearance::touches_cylinder(const Curve& curve, const world::Threat& threat, float shrunk,
                                 WorkBudget& budget) const noexcept
{
    for (std::size_t i = 0; i + 1 < curve.points; ++i) {
        if (!budget.spend(units::kSphereCheck)) {
            return true;
        }
        const Extent piece = about(curve.position(i), curve.position(i + 1));
        if (!is_cylinder_out_of(piece, threat, curve.t[i], curve.t[i + 1]) &&
            touches_cylinder(curve, i, threat, shrunk, budget)) {
            return true;
        }
    }
    return false;
}

}  // namespace jink::geometric::detail
