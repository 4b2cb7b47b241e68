// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/base/work_budget.hpp"
#include "core/geometry/shape.hpp"

namespace jink::world {

/// Separations from general convex obstacles are resolved up to here, and no finer than the resolution [m].
inline constexpr float kObstacleReach = 8.0F;
inline constexpr float kObstacleResolution = 0.05F;
/// And overlaps no finer than this share of the largest half extent.
inline constexpr float kOverlapResolution = 1.0F / 64.0F;

/// Margin between the own box (half extents [m]) flown straight from `from` to `to` and an obstacle grown by `extra`
/// (>= 0) [m].
///
/// Spheres and upright capsules: closed form, exact; below 0 where they overlap (no deeper than the radius). Other
/// shapes (libccd; capsules in closed form) never say more than there is, and with a rounding of 3e-5 * (sum of
/// magnitudes of the offset, the way and `half` + bounding radius):
/// * clear: the distance less `extra`, at most kObstacleResolution + rounding too small, the distance capped at
///   kObstacleReach; not below 0 unless what is left is within the rounding, so that a start that is clear is never
///   taken for one inside;
/// * within `extra`: the same, below 0;
/// * overlap with a box: minus `extra` and how far the own box would have to be moved aside where it is deepest, for
/// the
///   whole way at once; exact for an upright box and no way. However deep the own box is, deeper counts as worse;
/// * overlap with another shape: minus `extra` and the part of the own box (in terms of its largest half extent) that
///   has to be taken off until it is clear, at most kOverlapResolution of that half extent too much.
/// A budget that runs out gives the worst value. O(1), O(log) support queries otherwise.
[[nodiscard]] float obstacle_margin(const Vec3& half, const Vec3& from, const Vec3& to, const geometry::Shape& shape,
                                    WorkBudget& budget, float extra = 0.0F) noexcept;

/// True, and the box and radius to use in the sphere's closed form, for shapes that are a sphere but for a taller own
/// box: spheres, and capsules exactly upright. One that leans is none, however little: thickened by its lean it would
/// hold flights that are clear, and the escape rule would give those credit to go in.
[[nodiscard]] bool as_sphere(const geometry::Shape& shape, const Vec3& half, Vec3& effective_half,
                             float& radius) noexcept;

}  // namespace jink::world
