// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "core/base/work_budget.hpp"
#include "core/geometry/shape.hpp"

// The own safety box, swept along a segment, against any convex shape: libccd's GJK intersection on support functions,
// under a budget of support calls. libccd's loops end in practice but have no proven bound; the budget is the bound:
// past it the support functions answer on the wrong side, every loop ends at once, and the result is "budget_spent".

namespace jink::geometry {

enum class Contact : std::uint8_t { clear, contact, budget_spent };

/// Support calls allowed for one query. Worst seen over 500 000 random pairs was 46; 128 leaves a factor above two.
inline constexpr std::uint32_t kSupportCallsPerQuery = 128;

/// Does the box (half extents [m], world-aligned) swept from `from` to `to` come within `clearance` [m] >= 0 of `shape`?
///
/// Touching counts as contact. `budget_spent` must be treated as contact. One unit of `budget` is one support call; a query
/// takes what it used. Accuracy: 1e-4 m for coordinates up to 1 km (libccd in double). O(kSupportCallsPerQuery * vertices).
[[nodiscard]] Contact swept_box_contact(const Vec3& half, const Vec3& from, const Vec3& to, const Shape& shape,
                                        float clearance, WorkBudget& budget) noexcept;

/// Lower bound of the distance between the swept box and `shape` [m], capped at `reach` [m].
///
/// Bisection on the clearance of `swept_box_contact`: the result is a clearance that was found clear, at most
/// `resolution` [m] below the true distance (0 when in contact or when the budget ran out). O(log2(reach / resolution)) queries.
[[nodiscard]] float swept_box_distance(const Vec3& half, const Vec3& from, const Vec3& to, const Shape& shape, float reach,
                                       float resolution, WorkBudget& budget) noexcept;

}  // namespace jink::geometry
