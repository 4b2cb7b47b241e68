// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "core/base/work_budget.hpp"
#include "core/base/work_units.hpp"
#include "core/geometry/origin_search.hpp"
#include "core/geometry/shape.hpp"
#include "core/geometry/sweep.hpp"

// Private to core/geometry: shared by the contact and the distance queries of convex.hpp.

namespace jink::geometry::detail {

/// Largest relative error of one float operation.
inline constexpr float kRounding = 0x1p-24F;

/// The own safety box, swept along a segment.
struct SweptBox {
    const Vec3& half;
    const Vec3& from;
    const Vec3& to;

    [[nodiscard]] float distance_to(const Vec3& point) const noexcept
    {
        return least_distance(half, {from, to - from}, {point, Vec3::Zero()}, 1.0F).distance;
    }
    /// Bound of the rounding error of a distance from `shape` in float [m].
    [[nodiscard]] float slack(const Shape& shape) const noexcept
    {
        return 16.0F * kRounding *
               ((shape.centre - from).cwiseAbs().sum() + (to - from).cwiseAbs().sum() + half.sum() +
                bounding_radius(shape));
    }
    /// Distance from the solid in closed form [m], below 0 when its centre or axis lies closer than its radius.
    [[nodiscard]] float closed_form_distance(const Shape& shape) const noexcept
    {
        if (shape.kind == ShapeKind::sphere) {
            return distance_to(shape.centre) - shape.radius;
        }
        // Relative to `from` before the arm is added: far from the world's origin the ends would be rounded.
        const Vec3 centre = shape.centre - from;
        const Vec3 arm = shape.axes.col(2) * shape.half.z();
        return swept_distance(half, Vec3::Zero(), to - from, centre - arm, centre + arm) - shape.radius;
    }
};

/// Proven lower bound of the distance between the swept box and the solid [m], at most `limits.reach`. 0 if no
/// separating plane is found or the budget ran out. GJK in float, accuracy as stated for `swept_box_distance`.
[[nodiscard]] float proven_distance(const SweptBox& box, const Shape& shape, const SearchLimits& limits,
                                    WorkBudget& budget) noexcept;

/// Whether `closed_form_distance` covers the shape.
[[nodiscard]] inline bool has_closed_form(const Shape& shape) noexcept
{
    return shape.kind == ShapeKind::sphere || shape.kind == ShapeKind::capsule;
}

/// Work units of a query in closed form.
[[nodiscard]] inline std::uint32_t closed_form_units(const Shape& shape) noexcept
{
    return shape.kind == ShapeKind::sphere ? units::kSphereQuery : units::kCapsuleQuery;
}

}  // namespace jink::geometry::detail
