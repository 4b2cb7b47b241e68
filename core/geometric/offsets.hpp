// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/base/static_vector.hpp"
#include "core/geometric/planner.hpp"

// Offsets of the candidates of one plane. Private to this module.

namespace jink::geometric::detail {

/// Most offsets of one plane: Settings::offsets.
using Offsets = StaticVector<float, 64>;

/// How far the main threat extends from the collision point [m]. Of a sphere along the leg: its radius.
struct MainExtent {
    float before = 0.0F;  ///< against the leg, >= 0
    float behind = 0.0F;  ///< along it, >= 0
    float left = 0.0F;    ///< to the positive side of a plane
    float right = 0.0F;   ///< to the other
};
/// Along the leg: the same for all planes. O(vertices of the main threat's shape), as the sides.
[[nodiscard]] MainExtent extent_along(const Problem& problem) noexcept;
/// With the sides of the plane whose positive side is `side` (unit vector).
[[nodiscard]] MainExtent with_sides(const Problem& problem, const Vec3& side, MainExtent extent) noexcept;

/// Offsets w of a family's candidates in the plane whose positive side is `side` (unit vector), ascending. `extent`: of
/// that plane; not read with Pinheiro's offsets. O(offsets).
void offsets_of_plane(const Problem& problem, const Settings& settings, Family family, const Vec3& half_extents,
                      const Vec3& side, const MainExtent& extent, Offsets& out) noexcept;

/// Smallest offset towards `side` with which a family's curve clears the main threat at rest, the box around it: the
/// curve is on its way back when the box's corners leave the threat behind, so a little more than both extents. At
/// least kMinOffset. `aside`: how far the main threat extends to that side; of `extent`, before and behind are read.
///
/// Of threats so near that the curve comes down upon them whatever its offset, the simple family's at 2.5 R foremost,
/// the result says what would clear a third of the way: such candidates are then found out by the contact test. O(1).
[[nodiscard]] float smallest_clearing_offset(const Problem& problem, const Settings& settings, Family family,
                                             const Vec3& half_extents, const Vec3& side, const MainExtent& extent,
                                             float aside) noexcept;

/// Offsets beyond this share of the distance are left out: Pinheiro's go no further (3.2 R at D = 2.5 R).
inline constexpr float kLargestRatio = 1.2801F;
/// An offset below this is no way round anything [m].
inline constexpr float kMinOffset = 0.3F;
/// Clearing offsets clear by this much [m].
inline constexpr float kClearingSlack = 0.05F;

}  // namespace jink::geometric::detail
