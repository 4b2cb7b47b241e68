// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "core/base/work_budget.hpp"
#include "core/base/work_units.hpp"
#include "core/capacity.hpp"
#include "core/geometry/shape.hpp"

// The own safety box, swept along a segment, against any convex shape. Spheres and capsules have closed forms
// (sweep.hpp). Boxes, cylinders and hulls use libccd's GJK intersection on support functions, and a distance search of
// our own, since libccd gives no distance. libccd's loops end in practice but have no proven bound: beyond a number of
// calls the support functions answer on the wrong side, and every loop ends at once.
//
// libccd says "no" both with a separating plane and when it cannot continue (a flat simplex, a vanished direction). In
// about one of a million grazing cases libccd says "yes" to solids that are a hundredth of their size apart. So `clear`
// always requires a plane that separates the two solids; the support functions watch for such a plane. Where libccd
// finds no plane, the distance search may find one.

namespace jink::geometry {

enum class Contact : std::uint8_t { clear, contact, budget_spent };

/// Support calls (of either solid) allowed for one query; libccd gets half of them, the distance search the rest. Over
/// ten million random pairs, a third of them grazing, no query took more than 106. If the calls are spent without an
/// answer, the answer is contact.
inline constexpr std::uint32_t kSupportCallsPerQuery = 128;

/// Upper bound of a query's work units: libccd's share in its turns, all calls in those of the distance search.
inline constexpr std::uint32_t kUnitsPerQuery =
    units::kSolidQuery + kSupportCallsPerQuery / 4 * (units::kExactTurn + units::hull_units(kMaxHullVertices)) +
    kSupportCallsPerQuery / 2 * (units::kSearchTurn + units::hull_units(kMaxHullVertices));

/// Does the box (half extents [m], world-aligned) swept from `from` to `to` come within `clearance` [m] >= 0 of
/// `shape`?
///
/// Touching counts as contact. `budget_spent`: `budget` was too small; must be treated as contact. A query takes from
/// `budget` the units of core/base/work_units.hpp for a closed form, or for a solid and each turn of a search. If
/// `budget` is too small, the query leaves it marked as exhausted. Accuracy: `clear` is always true; `contact` means
/// that the shape is within `clearance` + 1e-5 * (sum of magnitudes of the offset, the swept segment and `half` +
/// bounding radius + clearance).
/// O(kSupportCallsPerQuery * vertices).
[[nodiscard]] Contact swept_box_contact(const Vec3& half, const Vec3& from, const Vec3& to, const Shape& shape,
                                        float clearance, WorkBudget& budget) noexcept;

/// Lower bound of the distance between the swept box and `shape` [m], capped at `reach` [m] >= 0.
///
/// A separating plane proves the bound (own GJK distance search in float; libccd gives none), so the bound is never
/// above the true distance. It is at most `resolution` [m] >= 0 below the true distance, plus 3e-5 * (sum of magnitudes
/// of the offset, the swept segment and `half` + bounding radius). 0 when in contact or when the budget ran out. A
/// coarse resolution saves turns. `budget` as above.
/// O(kSupportCallsPerQuery * vertices).
[[nodiscard]] float swept_box_distance(const Vec3& half, const Vec3& from, const Vec3& to, const Shape& shape,
                                       float reach, float resolution, WorkBudget& budget) noexcept;

}  // namespace jink::geometry
