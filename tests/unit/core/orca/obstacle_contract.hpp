// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gtest/gtest.h>

#include <vector>

#include "core/orca/obstacle_way.hpp"
#include "tests/oracle/obstacle_threats.hpp"

// Obstacles about a vehicle at the origin, for tests of what is made of them.

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
        const ObstaclePlanes found = obstacle_planes({map, oracle::threats_of(obstacles)}, own, settings, budget);
        exhausted = budget.exhausted();
        spent = budget.spent();
        return found;
    }
    WayClearance way(const Vec3& velocity, Seconds length, std::uint32_t units = kUnlimited)
    {
        WorkBudget budget(units);
        return clearance_along({map, oracle::threats_of(obstacles)}, Vec3::Zero(), velocity, length, settings, budget);
    }
    void add(const geometry::Shape& shape)
    {
        obstacles.push_back({static_cast<world::ObstacleId>(obstacles.size()), shape});
    }
    /// A small sphere whose surface is `distance` away.
    void add_point(const Vec3& direction, float distance)
    {
        add(geometry::make_sphere((distance + 0.125F) * direction, 0.125F));
    }
    ObstacleSettings settings;
    OwnMotion own;
    std::vector<world::Obstacle> obstacles;
    const geometry::MeshMap* map = nullptr;
    bool exhausted = false;
    std::uint32_t spent = 0;
};

}  // namespace jink::orca::test
