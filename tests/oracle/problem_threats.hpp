// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "core/geometric/planner.hpp"

namespace jink::geometric {

/// A moving sphere, extended up and down by `half_height`, in the form used by tests.
struct Sphere {
    geometry::Motion motion;
    float radius = 0.0F;               ///< at time 0 [m]
    float radius_rate = 0.0F;          ///< [m/s]
    float radius_acceleration = 0.0F;  ///< [m/s2]
    float half_height = 0.0F;          ///< [m]

    [[nodiscard]] world::Threat threat(std::size_t index) const
    {
        return world::track_threat(index, motion, {radius, radius_rate, radius_acceleration}, half_height);
    }
};

/// A moving convex solid, in the form used by tests.
struct MovingSolid {
    geometry::Shape shape;
    Vec3 velocity = Vec3::Zero();
    float uncertainty = 0.0F;
    float radius_rate = 0.0F;
    float radius_acceleration = 0.0F;
};

/// Threats of a problem: bounds, spheres, closed areas, static obstacles, moving solids.
struct ProblemThreats {
    std::vector<Sphere> threats;
    std::vector<world::Obstacle> obstacles;
    std::vector<MovingSolid> solids;
    world::Airspace airspace;
    float uncertainty = 0.0F;  ///< margin to bounds and obstacles [m]

    /// Valid until the next call; of a copy, its own.
    void put_into(Problem& problem)
    {
        const auto bounds = world::bounds_of(airspace, uncertainty);
        all_.assign(bounds.begin(), bounds.end());
        for (const Sphere& sphere : threats) {
            all_.push_back(sphere.threat(all_.size() - bounds.size()));
        }
        for (const world::Cylinder& cylinder : airspace.cylinders) {
            all_.push_back(world::cylinder_threat(all_.size() - bounds.size() - threats.size(), cylinder, uncertainty));
        }
        std::size_t index = 0;
        for (const world::Obstacle& obstacle : obstacles) {
            all_.push_back(world::obstacle_threat(index++, obstacle.shape, uncertainty));
        }
        for (const MovingSolid& solid : solids) {
            all_.push_back(world::solid_threat(index++, solid.shape, solid.velocity,
                                               {solid.uncertainty, solid.radius_rate, solid.radius_acceleration}));
        }
        problem.threats = all_;
        problem.main_clearance = uncertainty;
    }

private:
    std::vector<world::Threat> all_;
};

}  // namespace jink::geometric
