// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>
#include <vector>

#include "tests/oracle/obstacle_threats.hpp"
#include "tests/oracle/points.hpp"

namespace jink::oracle {

/// Hulls as obstacles, with the vertices that they refer to.
class HullObstacles {
public:
    explicit HullObstacles(const std::vector<std::vector<Vec3>>& hulls, float uncertainty = 0.0F)
    {
        for (const std::vector<Vec3>& hull : hulls) {
            points_.push_back(points_of(hull));
        }
        for (const std::vector<Point3>& points : points_) {
            obstacles_.push_back({static_cast<world::ObstacleId>(obstacles_.size()),
                                  geometry::make_hull(points, Vec3::Zero()), uncertainty});
        }
        threats_ = threats_of(obstacles_);
    }
    HullObstacles(const HullObstacles&) = delete;
    HullObstacles& operator=(const HullObstacles&) = delete;

    [[nodiscard]] std::span<const world::Obstacle> all() const { return obstacles_; }
    /// The same as threats; the own place is exact.
    [[nodiscard]] std::span<const world::Threat> threats() const { return threats_; }

private:
    std::vector<std::vector<Point3>> points_;
    std::vector<world::Obstacle> obstacles_;
    std::vector<world::Threat> threats_;
};

}  // namespace jink::oracle
