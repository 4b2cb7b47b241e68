// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gtest/gtest.h>

#include <deque>
#include <vector>

#include "core/orca/obstacle_way.hpp"
#include "tests/oracle/obstacle_threats.hpp"
#include "tests/oracle/points.hpp"

// Obstacles about a vehicle at the origin, for tests of their half-spaces.

namespace jink::orca::test {

inline constexpr std::uint32_t kUnlimited = 10'000'000;

/// An envelope of 1 m, a horizon of 1 s, 5 m/s at most.
class ObstacleContract : public ::testing::Test {
protected:
    ObstacleContract()
    {
        settings.horizontal = settings.vertical = settings.horizon = 1.0F;
        own.reach_speed = 5.0F;
    }
    ObstaclePlanes planes(std::uint32_t units = kUnlimited)
    {
        WorkBudget budget(units);
        const ObstaclePlanes found = obstacle_planes(oracle::threats_of(obstacles), own, settings, budget);
        exhausted = budget.exhausted();
        spent = budget.spent();
        return found;
    }
    WayClearance way(const Vec3& velocity, Seconds length, std::uint32_t units = kUnlimited)
    {
        WorkBudget budget(units);
        return clearance_along(oracle::threats_of(obstacles), Vec3::Zero(), velocity, length, settings, budget);
    }
    void add(const geometry::Shape& shape)
    {
        obstacles.push_back({static_cast<world::ObstacleId>(obstacles.size()), shape});
    }
    /// The hull of these vertices, beside what there is; or alone.
    void add_hull(const std::vector<Vec3>& vertices)
    {
        hulls.push_back(oracle::points_of(vertices));
        add(geometry::make_hull(hulls.back(), Vec3::Zero()));
    }
    void only_hull(const std::vector<Vec3>& vertices)
    {
        obstacles.clear();
        add_hull(vertices);
    }
    /// A small sphere whose surface is `distance` away.
    void add_point(const Vec3& direction, float distance)
    {
        add(geometry::make_sphere((distance + 0.125F) * direction, 0.125F));
    }
    ObstacleSettings settings;
    OwnMotion own;
    std::vector<world::Obstacle> obstacles;
    std::deque<std::vector<Point3>> hulls;  ///< what obstacles refer to
    bool exhausted = false;
    std::uint32_t spent = 0;
};

}  // namespace jink::orca::test
