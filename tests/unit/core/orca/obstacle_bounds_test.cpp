// SPDX-License-Identifier: BSD-3-Clause
// Obstacles whose distances are exact in single precision: at the reach, at the end of a path, and equally near.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "core/orca/obstacle_view.hpp"
#include "tests/oracle/obstacle_threats.hpp"
#include "tests/unit/core/orca/obstacle_contract.hpp"

namespace jink::orca {
namespace {

using test::ObstacleContract;

/// What is proven of the distance of an obstacle.
float distance_of(Obstacles scene, std::size_t i, const Vec3& point)
{
    WorkBudget budget(test::kUnlimited);
    const detail::ObstacleView view{scene, {1.0F, 1.0F}, 1e-4F};
    return view.obstacle(i, point, 100.0F, budget).distance;
}

/// 5 m/s for 1 s beside an envelope of 1 m: no contact at 6 m is possible in time. One float step to either side.
TEST_F(ObstacleContract, WhatLiesAtTheReachIsLeftOut)
{
    add(geometry::make_sphere({7, 0, 0}, 1.0F));
    int at_the_reach = 0;
    for (int step = -40; step <= 40; ++step) {
        own.position.x() = static_cast<float>(step) * 0x1p-22F;
        const float distance = distance_of(oracle::threats_of(obstacles), 0, own.position);
        EXPECT_EQ(std::isfinite(planes().margin), distance < 6.0F) << step;
        at_the_reach += distance == 6.0F ? 1 : 0;
    }
    EXPECT_GT(at_the_reach, 0);
}

/// Of more than there are half-spaces for, all as near, the last ones are left out.
TEST_F(ObstacleContract, OfMoreThanThereIsRoomForAsNearTheFirstStay)
{
    // Points of integers at 15 m.
    std::vector<Vec3> at;
    for (int x = -15; x <= 15; ++x) {
        for (int y = -15; y <= 15; ++y) {
            for (int z = -15; z <= 15; ++z) {
                if (x * x + y * y + z * z == 225) {
                    at.emplace_back(static_cast<float>(x), static_cast<float>(y), static_cast<float>(z));
                }
            }
        }
    }
    ASSERT_GT(at.size(), kMaxObstaclePlanes + 1);
    // Spread over all directions.
    std::vector<Vec3> spread{at.front()};
    while (spread.size() < kMaxObstaclePlanes + 1) {
        const auto nearest = [&](const Vec3& p) {
            float out = std::numeric_limits<float>::infinity();
            for (const Vec3& other : spread) {
                out = std::min(out, (p - other).norm());
            }
            return out;
        };
        spread.push_back(*std::max_element(at.begin(), at.end(),
                                           [&](const Vec3& a, const Vec3& b) { return nearest(a) < nearest(b); }));
    }
    own.reach_speed = 1000.0F;
    for (const Vec3& centre : spread) {
        add(geometry::make_sphere(centre, 1.0F));
    }
    // Their proven distances differ by rounding: in that order, the last two equally near.
    const auto distance = [](const world::Obstacle& obstacle) {
        return distance_of(oracle::threats_of({&obstacle, 1}), 0, Vec3::Zero());
    };
    std::stable_sort(obstacles.begin(), obstacles.end(), [&](const world::Obstacle& one, const world::Obstacle& other) {
        return distance(one) < distance(other);
    });
    ASSERT_EQ(distance(obstacles[kMaxObstaclePlanes - 1]), distance(obstacles[kMaxObstaclePlanes]));
    const ObstaclePlanes found = planes();
    ASSERT_EQ(found.planes.size(), kMaxObstaclePlanes);
    EXPECT_TRUE(found.truncated);
    EXPECT_NEAR(found.speed_cap, 13.0F, 1e-3F);
    for (std::size_t i = 0; i < found.planes.size(); ++i) {
        EXPECT_EQ(found.planes[i].source, i);
    }
}

/// Deep in one obstacle only the fastest exit remains, which also satisfies an obstacle behind, but not one ahead.
TEST_F(ObstacleContract, AHalfSpaceThatLeavesOneVelocitySpeaksForThatOne)
{
    own.reach_speed = settings.recovery_speed;
    add(geometry::make_sphere({1.0F, 0, 0}, 0.5F));
    add_point(Vec3(0.6F, 0, 0.8F), 1.1F);
    EXPECT_EQ(planes().planes.size(), 1U);
    obstacles.pop_back();
    add_point(-Vec3::UnitX(), 1.1F);
    EXPECT_EQ(planes().planes.size(), 2U);
}

/// A path of exactly the proven distance is clear; contact half of the resolution before its end is not.
TEST_F(ObstacleContract, AWayMayEndWhereTheMarginBegins)
{
    for (const bool box : {false, true}) {
        obstacles.clear();
        add(box ? geometry::make_box({5, 0, 0}, {1, 1, 1}) : geometry::make_sphere({5, 0, 0}, 1.0F));
        const float free = distance_of(oracle::threats_of(obstacles), 0, Vec3::Zero()) - 1.0F;
        EXPECT_NEAR(free, 3.0F, 1e-4F);
        EXPECT_TRUE(way({1, 0, 0}, free).clear) << box;
        EXPECT_EQ(way({1, 0, 0}, free).clear_until, free);
        EXPECT_FALSE(way({1, 0, 0}, free + 5e-5F).clear);
        EXPECT_NEAR(way({1, 0, 0}, free + 5e-5F).clear_until, free, 2e-4F);
    }
}

}  // namespace
}  // namespace jink::orca
