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
    if (problem.airspace == nullptr) {
        return {Vec3::Zero()};
    }
    const world::Airspace& air = *problem.airspace;
    const Vec3& origin = problem.frame.origin;
    const float extra = problem.obstacle_clearance;  // bounds are kept like obstacles
    const float height = half.z() + extra;
    return {air.home - origin, air.floor + height - origin.z(), air.ceiling - height - origin.z(),
            air.keep_in_radius - std::sqrt(half.x() * half.x() + half.y() * half.y()) - extra};
}

world::ThreatKind Clearance::left_airspace(const Curve& curve) const noexcept
{
    if (problem_.airspace == nullptr) {
        return ThreatKind::none;
    }
    const world::Airspace& air = *problem_.airspace;
    const auto& [home, floor, ceiling, radius] = bounds_;
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

}  // namespace jink::geometric::detail
