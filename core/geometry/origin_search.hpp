// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>

#include "core/base/work_budget.hpp"
#include "core/geometry/simplex.hpp"

// The distance of the origin from a convex set that is known by its support function. Private to core/geometry: shared
// by convex_distance.cpp and hull_distance.cpp.

namespace jink::geometry::detail {

/// Accuracy that a distance search may stop at.
struct SearchLimits {
    float near = 0.0F;        ///< distances up to this count as contact [m]
    float reach = 0.0F;       ///< distances from this on count as clear [m]
    float resolution = 0.0F;  ///< [m]
    std::uint32_t calls = 0;  ///< support calls allowed, two a turn
};

/// Where a search begins: with a guess of the nearest point, which need not be in the set, or with the nearest point of
/// some of the set's points (`reduce_to_nearest`), which is `upper` away.
struct SearchBegin {
    Vec3 nearest = Vec3::Zero();
    const Simplex* simplex = nullptr;  ///< those points of the set, or none
    float upper = std::numeric_limits<float>::max();
};

/// Result of a search, for whatever reason the search ended.
struct SearchResult {
    float proven = 0.0F;          ///< no point of the set is nearer than this [m]; 0: nothing proven
    float upper = 0.0F;           ///< and some point is as near as this
    Vec3 towards = Vec3::Zero();  ///< unit normal of the separating plane: towards . y >= proven in the set
    Vec3 nearest = Vec3::Zero();  ///< the nearest point found
    bool enclosed = false;        ///< the origin lies in a tetrahedron of points of the set
    bool budget_spent = false;
};

/// Turns without a nearer point before the search ends. The direction still improves when the distance no longer does:
/// its error enters the distance squared.
inline constexpr int kStallsAllowed = 2;

[[nodiscard]] inline bool holds(const Simplex& simplex, const Vec3& point) noexcept
{
    for (std::size_t i = 0; i < simplex.size; ++i) {
        if (simplex.points[i] == point) {
            return true;
        }
    }
    return false;
}

/// GJK (Gilbert, Johnson & Keerthi 1988): the nearest point of a growing simplex is an upper bound, the support plane
/// across it a lower bound. Results rest on the lower bound, so an error of the simplex costs turns, not safety.
///
/// @param support  support(direction) -> point of the set that is farthest in `direction`, which is not zero
/// @param begin    where the search begins; its `nearest` is not zero
/// @param slack    bound of the rounding error of a point's product with a unit vector [m]
/// @param turn     work units that a turn takes from `budget`
/// O(limits.calls) support calls.
template <class Support>
[[nodiscard]] SearchResult search_origin(const Support& support, const SearchBegin& begin, float slack,
                                         const SearchLimits& limits, std::uint32_t turn, WorkBudget& budget) noexcept
{
    SearchResult result;
    result.nearest = begin.nearest;
    result.upper = begin.upper;
    Simplex simplex;
    if (begin.simplex != nullptr) {
        simplex = *begin.simplex;
    }
    int stalls = 0;
    for (std::uint32_t calls = 2; calls <= limits.calls; calls += 2) {
        if (!budget.spend(turn)) {
            result.budget_spent = true;
            break;
        }
        const Vec3 next = support(-result.nearest);
        const float length = result.nearest.norm();
        const float bound = result.nearest.dot(next) / length - slack;
        if (bound > result.proven) {
            result.proven = bound;
            result.towards = result.nearest / length;
        }
        if (result.proven >= limits.reach || holds(simplex, next)) {
            break;
        }
        simplex.points[simplex.size++] = next;
        result.nearest = reduce_to_nearest(simplex);
        const float norm = result.nearest.norm();
        stalls += norm < result.upper ? 0 : 1;
        result.upper = std::min(result.upper, norm);
        const bool decided =
            result.upper <= limits.near + slack || result.upper - result.proven <= limits.resolution + 2.0F * slack;
        result.enclosed = simplex.size == simplex.points.size();
        if (decided || result.enclosed || stalls > kStallsAllowed) {
            break;
        }
    }
    return result;
}

}  // namespace jink::geometry::detail
