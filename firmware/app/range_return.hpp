// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>

#include "core/geometry/shape.hpp"

namespace jink::app {

// What a range sensor saw, as solids. A sensor says how far the nearest thing in its beam is, not where in the beam it
// is: the solid has to cover every point at that distance within the beam. A convex solid that does so reaches nearer
// than the range; by how little is said with each.

/// Least radius of a return [m].
inline constexpr float kMinReturnRadius = 0.25F;
/// Beams wider than this are cut into parts of equal width, level [rad].
inline constexpr float kWidestPart = 10.0F * kPi / 180.0F;
/// Parts of a half circle; half angles beyond that do not exist.
inline constexpr std::size_t kMaxReturnParts = 18;
/// Widest beam that is not level, half angle [rad]: what a wider one sees may be beside the vehicle.
inline constexpr float kWidestSteep = kPi / 3.0F;

/// Number of parts for a beam of this half angle [rad], 0..pi/2: 1..kMaxReturnParts.
[[nodiscard]] std::size_t return_parts(float half_angle) noexcept;

/// Part of a level beam: an upright capsule, since a level scan says nothing of height.
///
/// @param origin       sensor [m]
/// @param yaw          of the part's middle [rad, world]
/// @param range        [m], >= 0
/// @param half_angle   of the part [rad], at most half of kWidestPart
/// @param half_height  of the segment of the capsule [m]
/// Covers the arc of the part at `range` and the origin's height. Nearest surface, level: at least
/// range * (cos(half_angle) - sin(half_angle) / 2), so 0.953 of the range at worst. O(1).
[[nodiscard]] geometry::Shape level_return(const Vec3& origin, float yaw, float range, float half_angle,
                                           float half_height) noexcept;

/// A slanted beam: a sphere over the cap of the beam at `range`.
///
/// @param direction   of the beam, unit vector, world
/// @param half_angle  [rad], at most kWidestSteep
/// Nearest surface: at least range * (cos(half_angle) - 0.27 * sin(half_angle)). O(1).
[[nodiscard]] geometry::Shape slanted_return(const Vec3& origin, const Vec3& direction, float range,
                                             float half_angle) noexcept;

/// A beam straight up: a ceiling, a level slab of `half_width` to each side and as thick as it is wide, since an upward
/// reading says nothing of what is beside it. Its lower face lies at range * cos(half_angle), so that the edge of the
/// beam is covered. O(1).
///
/// @param half_angle  [rad], at most kWidestSteep
[[nodiscard]] geometry::Shape ceiling_return(const Vec3& origin, float range, float half_angle,
                                             float half_width) noexcept;

}  // namespace jink::app
