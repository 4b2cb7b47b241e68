// SPDX-License-Identifier: BSD-3-Clause
// Solids that no closed form knows, at rest or moving: what is far is seen by bounds and planes, a straight run is one
// query, and a moving solid is met by the way that the vehicle makes as seen from it.
#include <algorithm>
#include <cmath>

#include "core/base/work_units.hpp"
#include "core/geometric/clearance.hpp"
#include "core/geometric/planes.hpp"
#include "core/geometry/convex.hpp"
#include "core/world/obstacle_distance.hpp"

namespace jink::geometric::detail {

View view_of(const Curve& curve, const Vec3& velocity, Seconds begins) noexcept
{
    View view{curve, velocity, begins, {}};
    view.extent = {view.position(0), view.position(0)};
    for (std::size_t i = 1; i < curve.points; ++i) {
        const Vec3 p = view.position(i);
        view.extent.low = view.extent.low.cwiseMin(p);
        view.extent.high = view.extent.high.cwiseMax(p);
    }
    return view;
}

std::size_t straight_until(const View& view, std::size_t i, const Vec3& along) noexcept
{
    const Vec3 from = view.position(i);
    float farthest = 0.0F;
    std::size_t end = i;
    while (end < view.last()) {
        const Vec3 off = view.position(end + 1) - from;
        const float way = off.dot(along);
        if (way < farthest || (off - way * along).squaredNorm() > kStraight * kStraight) {
            break;
        }
        farthest = way;
        ++end;
    }
    return std::max(end, i + 1);
}

/// Segment `i` keeps off a solid that the escape rule has shrunk and that grows back meanwhile.
bool Clearance::leaves(const View& view, std::size_t i, const Solid& solid, WorkBudget& budget) const noexcept
{
    const Vec3 a = problem_.frame.origin + view.position(i);
    const Vec3 step = view.position(i + 1) - view.position(i);
    const Curve& curve = view.curve;
    const Seconds duration = curve.t[i + 1] - curve.t[i];
    const int parts = escape_parts(duration);
    for (int part = 0; part < parts; ++part) {
        const float from = static_cast<float>(part) / static_cast<float>(parts);
        const float to = static_cast<float>(part + 1) / static_cast<float>(parts);
        const Seconds end = curve.t[i] + to * duration;
        const float margin =
            world::obstacle_margin(half_, a + from * step, a + to * step, solid.shape, budget, solid.growth.at(end)) +
            shrink_at(solid.shrunk, end);
        if (budget.exhausted() || margin < 0.0F) {
            return false;
        }
    }
    return true;
}

/// From point `i` to point `end`, between which the view is straight.
bool Clearance::meets(const View& view, std::size_t i, std::size_t end, const Solid& solid,
                      WorkBudget& budget) const noexcept
{
    const Vec3& origin = problem_.frame.origin;
    const float off = end > i + 1 ? kStraight : 0.0F;
    return geometry::swept_box_contact(half_, origin + view.position(i), origin + view.position(end), solid.shape,
                                       solid.growth.at(view.curve.t[end]) + off, budget) != geometry::Contact::clear;
}

/// Where candidates are farthest from the leg: whoever flies into a wall is in it there.
bool Clearance::touches_at_its_top(const View& view, const Planes& planes, const Solid& solid) const noexcept
{
    const auto is_in_it = [&](std::size_t top) {
        const Seconds t = view.curve.t[top];
        return shrink_at(solid.shrunk, t) <= 0.0F && planes.touch(view.position(top), half_, solid.growth.at(t));
    };
    return is_in_it(view.last() / 2) || is_in_it(2 * view.last() / 3);
}

bool Clearance::touches(const View& view, const Solid& solid, WorkBudget& budget) const noexcept
{
    const Vec3 centre = solid.shape.centre - problem_.frame.origin;
    const float largest = solid.growth.at(view.curve.duration());
    const float bound = geometry::bounding_radius(solid.shape) + largest;
    const std::size_t last = view.last();
    if (apart(centre, centre, view.extent.low, view.extent.high, half_, bound)) {
        return false;
    }
    const std::uint32_t hull = units::hull_units(solid.shape.vertices.size());
    if (!budget.spend(units::kSolidNear + hull)) {
        return true;
    }
    const Planes planes(solid.shape, centre);
    const Vec3 middle = view.extent.middle();
    if (planes.part(middle, middle, half_ + view.extent.half(), largest)) {
        return false;
    }
    if (touches_at_its_top(view, planes, solid)) {
        return true;
    }
    if (!budget.spend(units::points_units(view.curve.points))) {
        return true;
    }
    if (planes.part(view, half_, largest)) {
        return false;
    }
    if (!budget.spend(units::kSolidSegment * static_cast<std::uint32_t>(last))) {
        return true;
    }
    std::size_t i = 0;
    while (i < last) {
        const Vec3 a = view.position(i);
        const Vec3 b = view.position(i + 1);
        const Extent piece = about(a, b);
        if (apart(centre, centre, piece.low, piece.high, half_, bound)) {
            ++i;
            continue;
        }
        if (!budget.spend(units::kSolidPlanes + hull)) {
            return true;
        }
        if (planes.part(a, b, half_, solid.growth.at(view.curve.t[i + 1]))) {
            ++i;
            continue;
        }
        if (shrink_at(solid.shrunk, view.curve.t[i]) > 0.0F) {
            if (!leaves(view, i, solid, budget)) {
                return true;
            }
            ++i;
            continue;
        }
        if (planes.touch(b, half_, solid.growth.at(view.curve.t[i]))) {
            return true;
        }
        const std::size_t end = solid.grows() ? i + 1 : straight_until(view, i, (b - a).stableNormalized());
        if (meets(view, i, end, solid, budget)) {
            return true;
        }
        i = end;
    }
    return false;
}

}  // namespace jink::geometric::detail
