// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/orca/obstacle_plane.hpp"

// Where single obstacles lie. Shared by the half-spaces and by the check along a way; not meant for other modules.

namespace jink::orca::detail {

/// One convex obstacle seen from a point, in the stretched space.
struct Sighting {
    float distance = 0.0F;  ///< proven [m]; below 0: the point is in the obstacle, its way out that long
    float upper = 0.0F;     ///< no farther than this [m]
    Vec3 direction =
        Vec3::UnitX();     ///< unit vector towards it; zero where the budget ran out before anything was known
    bool bounded = false;  ///< the search was cut short: `distance` may be less than could be known
};

/// The obstacles in the space that is stretched for the vehicle's envelope.
struct ObstacleView {
    Obstacles obstacles;
    Envelope envelope;
    float resolution = 1e-4F;  ///< [m]

    /// Grown by its uncertainty; `reach` as in geometry::DistanceQuery. With an exhausted budget what was proven by
    /// then.
    [[nodiscard]] Sighting obstacle(std::size_t index, const Vec3& point, float reach,
                                    WorkBudget& budget) const noexcept;
    /// A lower bound of its distance. O(1), O(vertices) for a hull.
    [[nodiscard]] float obstacle_bound(std::size_t index, const Vec3& point) const noexcept;

private:
    [[nodiscard]] float stretched_uncertainty(std::size_t index) const noexcept;
};

}  // namespace jink::orca::detail
