// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <span>

#include "core/world/cylinder.hpp"

// Closed airspace and weather: a circle about a polygon, between two heights, that may move (Gomola 6.5.3, 6.6.5).

namespace jink::reach {

using world::Circle;
using world::Cylinder;
using world::Vec2;

/// Corners of one polygon. A polygon with more corners is refused.
inline constexpr std::size_t kMaxCorners = 32;

/// The smallest circle around all points, grown by 1e-5 of their extent for rounding. For no points: radius 0 about the
/// origin. O(n^3) for n <= kMaxCorners points, n^2 on average; deterministic.
[[nodiscard]] Circle smallest_circle(std::span<const Vec2> points) noexcept;

}  // namespace jink::reach
