// SPDX-License-Identifier: BSD-3-Clause
// The airspace's bounds.
#include <algorithm>
#include <cmath>

#include "core/geometric/clearance.hpp"
#include "core/geometry/shape.hpp"
#include "core/world/obstacle_distance.hpp"

namespace jink::geometric::detail {

using world::ThreatKind;

Clearance::Bounds Clearance::bounds_of(const Problem& problem, const Vec3& half) noexcept
{
    Bounds bounds;
    const Vec3& origin = problem.frame.origin;
    for (const world::Threat& threat : problem.threats) {
        const float extra = threat.growth.radius;
        const float height = half.z() + extra;
        switch (threat.form) {
        case world::ThreatForm::floor: bounds.floor = threat.position.z() + height - origin.z(); break;
        case world::ThreatForm::ceiling: bounds.ceiling = threat.position.z() - height - origin.z(); break;
        case world::ThreatForm::keep_in:
            bounds.home = threat.position - origin;
            bounds.radius = threat.level_radius - std::sqrt(half.x() * half.x() + half.y() * half.y()) - extra;
            break;
        default: return bounds;  // bounds come first
        }
    }
    return bounds;
}

world::ThreatKind Clearance::left_airspace(const Curve& curve) const noexcept
{
    if (problem_.threats.empty() || !problem_.threats.front().is_bound()) {
        return ThreatKind::none;
    }
    const auto& [home, floor, ceiling, radius] = bounds_;
    const float floor_shrunk = shrink_to_clear(-floor);
    const float ceiling_shrunk = shrink_to_clear(ceiling);
    const float keep_in_shrunk = shrink_to_clear(radius - home.head<2>().norm());
    for (std::size_t i = 0; i < curve.points; ++i) {
        const Seconds t = curve.t[i];
        if (curve.z[i] - floor + shrink_at(floor_shrunk, t) < 0.0F) {
            return ThreatKind::floor;
        }
        if (ceiling - curve.z[i] + shrink_at(ceiling_shrunk, t) < 0.0F) {
            return ThreatKind::ceiling;
        }
        const float x = curve.x[i] - home.x();
        const float y = curve.y[i] - home.y();
        const float reach = radius + shrink_at(keep_in_shrunk, t);
        if (reach < 0.0F || x * x + y * y > reach * reach) {
            return ThreatKind::keep_in;
        }
    }
    return ThreatKind::none;
}

}  // namespace jink::geometric::detail
