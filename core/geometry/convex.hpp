// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "core/base/work_budget.hpp"
#include "core/base/work_units.hpp"
#include "core/capacity.hpp"
#include "core/geometry/shape.hpp"

// The own safety box, swept along a segment, against any convex shape. Spheres and capsules have closed forms
// (sweep.hpp). Boxes, cylinders and hulls go through libccd's GJK intersection on support functions, and through a
// distance search of our own, since libccd gives no distance. libccd's loops end in practice but have no proven bound:
// past a number of calls the support functions answer on the wrong side, and every loop ends at once.
//
// libccd says "no" both with a separating plane in hand and when it cannot go on (a flat simplex, a vanished
// direction), and in about one of a million grazing cases it says "yes" to solids that are a hundredth of their size
// apart. So nothing is `clear` without a plane that parts the two, which the support functions watch for; where libccd
// found none, the distance search may.

namespace jink::geometry {

enum class Contact : std::uint8_t { clear, contact, budget_spent };

/// Support calls (of either solid) allowed for one query; libccd gets half of them, the distance search what is left.
/// Over ten million random pairs, a third of them grazing, no query took more than 106; without an answer by then it is
/// contact.
inline constexpr std::uint32_t kSupportCallsPerQuery = 128;

/// Units of work that no query takes more than: libccd's share in its turns, all calls in those of the distance search.
inline constexpr std::uint32_t kUnitsPerQuery =
    units::kSolidQuery + kSupportCallsPerQuery / 4 * (units::kExactTurn + units::hull_units(kMaxHullVertices)) +
    kSupportCallsPerQuery / 2 * (units::kSearchTurn + units::hull_units(kMaxHullVertices));

/// Does the box (half extents [m], world-aligned) swept from `from` to `to` come within `clearance` [m] >= 0 of
/// `shape`?
///
/// Touching counts as contact. `budget_spent`: `budget` was too small; must be treated as contact. A query takes from
/// `budget` what core/base/work_units.hpp says of a closed form, or of a solid and of each turn of a search, and leaves
/// it marked as exhausted when that was too small. Accuracy: `clear` is always true; `contact` means
/// within 1e-5 * (sum of magnitudes of the offset, the way and `half` + bounding radius + clearance) of it.
/// O(kSupportCallsPerQuery * vertices).
[[nodiscard]] Contact swept_box_contact(const Vec3& half, const Vec3& from, const Vec3& to, const Shape& shape,
                                        float clearance, WorkBudget& budget) noexcept;

/// Lower bound of the distance between the swept box and `shape` [m], capped at `reach` [m] >= 0.
///
/// Proven by a separating plane (own GJK distance search in float; libccd gives none), so never above the true
/// distance, and at most `resolution` [m] >= 0 below it, plus 3e-5 * (sum of magnitudes of the offset, the way and
/// `half` + bounding radius). 0 when in contact or when the budget ran out. A coarse resolution saves rounds.
/// `budget` as above.
/// O(kSupportCallsPerQuery * vertices).
[[nodiscard]] float swept_box_distance(const Vec3& half, const Vec3& from, const Vec3& to, const Shape& shape,
                                       float reach, float resolution, WorkBudget& budget) noexcept;

}  // namespace jink::geometry
