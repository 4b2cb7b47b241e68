// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "core/base/work_budget.hpp"
#include "core/geometry/shape.hpp"

// The own safety box, swept along a segment, against any convex shape. Spheres and capsules have closed forms (sweep.hpp); for
// boxes, cylinders and hulls it is libccd's GJK intersection on support functions, under a budget of support calls. libccd's
// loops end in practice but have no proven bound; the budget is the bound: past it the support functions answer on the wrong
// side, every loop ends at once, and the result is "budget_spent".
//
// libccd says "no" both with a separating plane in hand and when it cannot go on (a flat simplex, a vanished direction): the
// second is no proof. The support functions watch for the plane, and only a plane makes an answer `clear`.

namespace jink::geometry {

enum class Contact : std::uint8_t { clear, contact, budget_spent };

/// Support calls (of either solid) allowed for one query, at least 2. Queries that do not graze take 46 at most over 500 000 random
/// pairs; the few that graze a rounded surface and would take more than 128 count as contact.
inline constexpr std::uint32_t kSupportCallsPerQuery = 128;

/// Does the box (half extents [m], world-aligned) swept from `from` to `to` come within `clearance` [m] >= 0 of `shape`?
///
/// Touching counts as contact. `budget_spent` must be treated as contact. One unit of `budget` is one support call or one closed
/// form; a query takes what it used, none when the bounding sphere is clear, and leaves the budget marked as exhausted when that
/// was too small. Accuracy: `clear` is always true; `contact` means within 1e-5 * (sum of magnitudes of the offset, the way and
/// `half` + bounding radius + clearance) of it. O(kSupportCallsPerQuery * vertices).
[[nodiscard]] Contact swept_box_contact(const Vec3& half, const Vec3& from, const Vec3& to, const Shape& shape,
                                        float clearance, WorkBudget& budget) noexcept;

/// Lower bound of the distance between the swept box and `shape` [m], capped at `reach` [m].
///
/// Bisection on the clearance of `swept_box_contact`: the result is a clearance that was found clear, at most
/// `resolution` [m] below the true distance (0 when in contact or when the budget ran out). O(log2(reach / resolution)) queries.
[[nodiscard]] float swept_box_distance(const Vec3& half, const Vec3& from, const Vec3& to, const Shape& shape, float reach,
                                       float resolution, WorkBudget& budget) noexcept;

}  // namespace jink::geometry
