// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>

#include "core/base/point3.hpp"
#include "core/base/vec3.hpp"
#include "core/base/work_budget.hpp"
#include "core/base/work_units.hpp"
#include "core/capacity.hpp"
#include "core/geometry/shape.hpp"

// Distances of convex solids, each proven by a plane after a bounded number of turns: GJK (Gilbert, Johnson & Keerthi
// 1988) in float; libccd gives no distance. Where the vehicle's envelope is an ellipsoid of revolution, space is
// stretched along z until the envelope is a sphere (Alejo 7.29-7.31), and distances are those of the stretched space.

namespace jink::geometry {

/// Turns of one search. Of a million random hulls of up to 31 vertices and a point none took more than 13
/// (JINK_CASES=1000000 property_geometry --gtest_filter=PointHull*); smooth shapes may take more. If the turns are used
/// up, the answer is the distance proven by then.
inline constexpr std::uint32_t kMaxDistanceTurns = 24;

/// Where the second solid lies, relative to the first.
struct Separation {
    /// Proven lower bound of the distance [m]. 0: nothing is proven, the solids may touch or overlap.
    float distance = 0.0F;
    /// Upper bound of the distance, but for rounding [m]; infinite when the search ended before it had a point.
    float upper = 0.0F;
    /// Unit vector from the first solid to the second. Its product with each point of the second solid exceeds its
    /// product with each point of the first by `distance` or more. Zero where nothing is proven.
    Vec3 direction = Vec3::Zero();
};

/// Required accuracy of an answer, and where the search begins.
struct DistanceQuery {
    float stretch = 1.0F;       ///< weight of z against x and y, > 0
    float reach = 1e9F;         ///< the search ends when this distance is proven [m], > 0; `upper` may be coarse then
    float resolution = 1e-4F;   ///< the search ends when both bounds differ by no more [m]
    Vec3 start = Vec3::Zero();  ///< direction of the last answer times its distance, if any; zero: none
};

/// Distance of `point` from the hull of `vertices`, 1..kMaxHullVertices of them, all finite.
///
/// `distance` is never above the true one. Where the search ends by itself, `distance` is below the true one by at most
/// `resolution` + 3e-6 * (largest sum of magnitudes of the stretched vertices relative to `point`). For a triangle that
/// is a thousand times as long as it is wide the last term is 3e-4 * that sum. Where `budget` or kMaxDistanceTurns
/// ends the search, `distance` is the bound proven by then. Takes kSearchTurn + hull_units of `budget` a turn. A good
/// `start` needs one or two turns.
/// O(kMaxDistanceTurns * vertices).
[[nodiscard]] Separation point_hull_distance(const Vec3& point, std::span<const Point3> vertices,
                                             const DistanceQuery& query, WorkBudget& budget) noexcept;

/// The same of a point and any shape. Where nothing is stretched, spheres and capsules are exact but for rounding (2e-6
/// * the sum of magnitudes of place and size); of all others as above, but that a curved one may be left with a gap of
/// 1e-5 * that sum. Hulls that are not turned take the search above. O(kMaxDistanceTurns * vertices).
[[nodiscard]] Separation point_shape_distance(const Vec3& point, const Shape& shape, const DistanceQuery& query,
                                              WorkBudget& budget) noexcept;

/// The face by which a point leaves a solid soonest.
struct Exit {
    float depth = 0.0F;              ///< to that face's plane [m], below 0 for a point outside
    Vec3 direction = Vec3::UnitZ();  ///< unit vector out of the solid, square to the face, in the stretched space
};

/// Out of any shape: along the best of its own axes and the direction away from its centre or its axis, of a hull also
/// across its first three vertices, which is the way out of a flat one. `depth` is not below the true one, and it is
/// that of spheres, boxes, capsules and cylinders where nothing is stretched. O(vertices).
[[nodiscard]] Exit exit_of_shape(const Vec3& point, const Shape& shape, float stretch) noexcept;

/// Work units of one turn of a search on a hull, or on a shape.
[[nodiscard]] constexpr std::uint32_t distance_turn_units(std::size_t vertices) noexcept
{
    return units::kSearchTurn + units::hull_units(vertices);
}

}  // namespace jink::geometry
