// SPDX-License-Identifier: BSD-3-Clause
// Obstacles, sentence by sentence of their headers: which half-space may be left out, the report of an exhausted
// budget, and the end of a path.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include <Eigen/Geometry>

#include "core/base/random.hpp"
#include "core/orca/obstacle_view.hpp"
#include "tests/oracle/obstacle_threats.hpp"
#include "tests/unit/core/orca/obstacle_contract.hpp"

namespace jink::orca {
namespace {

using test::kUnlimited;
using test::ObstacleContract;

// --- which half-spaces are left out ---

/// The nearer one of two parallel walls binds, in whichever order they come.
TEST_F(ObstacleContract, TheNearerOfTwoParallelWallsIsKept)
{
    for (const bool far_first : {true, false}) {
        obstacles.clear();
        for (const bool far : {far_first, !far_first}) {
            add(geometry::make_box({far ? 5.0F : 4.0F, 0, 0}, {0.5F, 9, 9}));
        }
        const ObstaclePlanes found = planes();
        ASSERT_GE(found.planes.size(), 1U);
        EXPECT_NEAR(found.planes[0].offset, -2.5F, 1e-4F) << "3.5 m less 1 m, in 1 s";
        EXPECT_NEAR(found.margin, 2.5F, 1e-4F);
        EXPECT_EQ(found.nearest, (far_first ? 1 : 0));
    }
}

TEST_F(ObstacleContract, TheSameObstacleTwiceIsOneHalfSpace)
{
    for (int i = 0; i < 2; ++i) {
        add(geometry::make_box({4, 1, 0}, {0.5F, 2, 9}));
        EXPECT_EQ(planes().planes.size(), 1U);
    }
}

/// With the first bounding at 1 m/s ahead, the fastest that is admitted flies 3.315 m/s in the direction 30 degrees
/// off.
TEST_F(ObstacleContract, AHalfSpaceIsLeftOutWhereAllThatIsAdmittedKeepsToIt)
{
    const float angle = 30.0F * kPi / 180.0F;
    const Vec3 aside(std::cos(angle), 0, std::sin(angle));
    const float fastest = std::cos(angle) + std::sqrt(24.0F) * std::sin(angle);
    for (const float more : {-0.05F, 0.05F}) {
        obstacles.clear();
        add_point(Vec3::UnitX(), 2.0F);
        add_point(aside, 1.0F + fastest + more);
        EXPECT_EQ(planes().planes.size(), more > 0.0F ? 1U : 2U) << more;
        std::swap(obstacles[0], obstacles[1]);
        EXPECT_EQ(planes().planes.size(), 2U) << "the farther one says nothing of the nearer one";
    }
}

/// No half-space that is left out is violated by any velocity that those that are returned admit.
TEST_F(ObstacleContract, WhatIsLeftOutIsImplied)
{
    Random random(20261125);
    int left_out = 0;
    for (int i = 0; i < 300; ++i) {
        obstacles.clear();
        const auto count = static_cast<int>(2 + random.below(5));
        std::vector<HalfSpace> all;
        for (int k = 0; k < count; ++k) {
            const Vec3 to = Vec3(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)).normalized();
            // Behind each other, more often than chance has it.
            const Vec3 direction = k > 0 && random.below(2) == 0
                                       ? Vec3((to * 0.3F + obstacles[0].shape.centre.normalized()).normalized())
                                       : to;
            add_point(direction, random.uniform(1.1F, 5.5F));
        }
        const ObstaclePlanes found = planes();
        for (const world::Obstacle& obstacle : obstacles) {
            const float distance = obstacle.shape.centre.norm() - 0.125F;
            all.push_back(
                obstacle_half_space(distance, obstacle.shape.centre.normalized(), {1.0F, 1.0F}, own, settings));
        }
        left_out += static_cast<int>(all.size() - found.planes.size());
        for (int k = 0; k < 200; ++k) {
            const Vec3 to = Vec3(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)).normalized();
            const Vec3 velocity = (k % 4 == 0 ? random.uniform(0.0F, 5.0F) : 5.0F) * to;
            bool admitted = true;
            for (const HalfSpace& plane : found.planes) {
                admitted = admitted && plane.violation(velocity) <= 0.0F;
            }
            for (const HalfSpace& plane : all) {
                ASSERT_TRUE(!admitted || plane.violation(velocity) <= 1e-4F) << "case " << i;
            }
        }
    }
    EXPECT_GT(left_out, 100);
}

TEST_F(ObstacleContract, OfTwoAsNearTheFirstIsSaidAndComesFirst)
{
    add_point(Vec3::UnitX(), 2.0F);
    add_point(-Vec3::UnitX(), 2.0F);
    const ObstaclePlanes found = planes();
    ASSERT_EQ(found.planes.size(), 2U);
    EXPECT_EQ(found.nearest, 0);
    EXPECT_EQ(found.planes[0].source, 0);
    EXPECT_EQ(found.planes[1].source, 1);
}

/// Penetration begins below a margin of zero.
TEST_F(ObstacleContract, AnEnvelopeThatTouchesDoesNotPenetrate)
{
    add(geometry::make_sphere({2, 0, 0}, 1.0F));
    EXPECT_FALSE(planes().penetrating);
    EXPECT_NEAR(planes().margin, 0.0F, 1e-5F);
    own.position.x() = 0.001F;
    EXPECT_TRUE(planes().penetrating);
}

// --- budgets ---

/// If the budget runs out anywhere, the cap keeps clear of all unchecked obstacles, and this is reported.
TEST_F(ObstacleContract, ABudgetThatRunsOutCapsTheSpeedForWhatIsMissing)
{
    settings.vertical = 0.8F;  // every shape but spheres is searched
    for (const bool has_hulls : {false, true}) {
        obstacles.clear();
        if (has_hulls) {
            add_hull({{3, -2, -2}, {3, 2, -2}, {3, 0, 2}, {4, 0, 0}});
            add_hull({{-3, -2, -2}, {-3, 2, -2}, {-3.5F, 0, 2}, {-4, 0, 0}});
        }
        add(geometry::make_capsule({0, 3, -2}, {1, 3, 2}, 0.25F));
        if (!has_hulls) {
            add(geometry::make_box({0, -4, 0}, {3, 1, 3}));
        }
        const ObstaclePlanes all = planes();
        const std::uint32_t needed = spent;
        ASSERT_FALSE(exhausted);
        ASSERT_FALSE(all.truncated);
        EXPECT_TRUE(std::isinf(all.speed_cap));
        bool tighter = false;
        for (std::uint32_t units = 0; units < needed; ++units) {
            const ObstaclePlanes some = planes(units);
            ASSERT_TRUE(exhausted) << units;
            ASSERT_TRUE(some.truncated) << units;
            ASSERT_LE(spent, units);
            // Every velocity within the cap and the half-spaces that there are keeps to all of them.
            for (const HalfSpace& plane : all.planes) {
                bool has = false;
                for (const HalfSpace& found : some.planes) {
                    has = has || (found.source == plane.source && found.offset >= plane.offset - 1e-3F);
                }
                ASSERT_TRUE(has || some.speed_cap <= -plane.offset + 1e-3F) << units << " " << plane.source;
            }
            tighter = tighter || some.speed_cap > 1.2F;
        }
        EXPECT_TRUE(tighter) << "what was proven by then counts";
    }
}

/// Before a search has begun the bound of the whole obstacle counts.
TEST_F(ObstacleContract, WithoutAnyBudgetTheBoundOfTheObstacleCounts)
{
    settings.vertical = 0.8F;
    add(geometry::make_capsule({4, 0, -1}, {4, 0, 1}, 0.25F));
    const ObstaclePlanes none = planes(0);
    EXPECT_TRUE(none.planes.empty());
    // Its middle is 4 m away, and no point of it more than 1.25 m from there, heights stretched by 1.25.
    EXPECT_NEAR(none.speed_cap, (4.0F - 1.25F * 1.25F - 1.0F) / 1.25F, 0.02F);
}

/// Of a hull that lies askew in its box: what is proven of it counts.
TEST_F(ObstacleContract, OfAHullThatIsCutShortWhatIsProvenCounts)
{
    // A plate that stands 4.24 m off, askew in a box that holds the vehicle.
    only_hull({{-4, 10, -3}, {10, -4, -4}, {10, -4, 3}, {-3, 9, 4}, {8, 8, 0}, {3, 3, 5}});
    const ObstaclePlanes whole = planes();
    const std::uint32_t needed = spent;
    ASSERT_EQ(whole.planes.size(), 1U);
    EXPECT_NEAR(whole.margin, std::sqrt(18.0F) - 1.0F, 1e-3F);
    float most = 0.0F;
    for (std::uint32_t units = 0; units < needed; ++units) {
        const ObstaclePlanes some = planes(units);
        ASSERT_TRUE(some.truncated) << units;
        ASSERT_GE(some.speed_cap, 0.0F) << units;
        ASSERT_LE(some.speed_cap, whole.margin + 1e-3F) << units;
        most = std::max(most, some.speed_cap);
    }
    EXPECT_GT(most, 0.1F);
}

// --- single obstacles ---

TEST_F(ObstacleContract, ASearchWithoutABudgetHasNoDirection)
{
    add(geometry::make_capsule({3.5F, 0, -1}, {4.5F, 0, 1}, 0.25F));
    add_hull({{4, -1, -1}, {4, 1, -1}, {4, 0, 1}, {5, 0, 0}});
    const std::vector<world::Threat> threats = oracle::threats_of(obstacles);
    const detail::ObstacleView view{threats, {1.25F, 1.0F}, 1e-4F};
    for (const std::size_t i : {0U, 1U}) {
        WorkBudget none(0);
        const detail::Sighting seen = view.obstacle(i, Vec3::Zero(), 9.0F, none);
        EXPECT_TRUE(none.exhausted());
        EXPECT_EQ(seen.direction, Vec3::Zero()) << "nothing was known";
        EXPECT_EQ(seen.distance, 0.0F);
    }
}

/// An obstacle that may stand out of its shape is as near as if it did, whatever its shape, also in the stretched space
/// and within it.
TEST_F(ObstacleContract, UncertaintyMakesObstaclesLarger)
{
    add(geometry::make_box({4, 0, 0}, {1, 9, 9}));
    add_hull({{3, -9, -9}, {3, 9, -9}, {3, -9, 9}, {3, 9, 9}, {5, 0, 0}});
    for (const std::size_t i : {0U, 1U}) {
        obstacles[i].uncertainty = 0.25F;
        for (const float stretch : {0.5F, 1.0F, 2.0F}) {
            const std::vector<world::Threat> threats = oracle::threats_of(obstacles);
            const detail::ObstacleView view{threats, {stretch, 1.0F}, 1e-4F};
            const float grown = 0.25F * std::max(1.0F, stretch);
            WorkBudget budget(kUnlimited);
            const detail::Sighting outside = view.obstacle(i, Vec3::Zero(), 9.0F, budget);
            EXPECT_NEAR(outside.distance, 3.0F - grown, 1e-3F) << i;
            EXPECT_NEAR(outside.upper, 3.0F - grown, 1e-3F) << i;
            EXPECT_FALSE(outside.bounded);
            EXPECT_LE(view.obstacle_bound(i, Vec3(-20, 0, 0)), outside.distance + 20.0F);
            const detail::Sighting between = view.obstacle(i, Vec3(2.9F, 0, 0), 9.0F, budget);
            EXPECT_NEAR(between.distance, 0.1F - grown, 1e-3F) << i;
            EXPECT_NEAR(between.direction.x(), 1.0F, 1e-3F) << i;
            EXPECT_NEAR(view.obstacle(i, Vec3(3.5F, 0, 0), 9.0F, budget).distance, -0.5F - grown, 1e-3F) << i;
        }
    }
    const float bare = planes().margin;
    obstacles[0].uncertainty = 0.5F;
    EXPECT_NEAR(planes().margin, bare - 0.25F, 1e-3F);
    EXPECT_EQ(planes().nearest, 0);
    EXPECT_NEAR(way({1, 0, 0}, 4.0F).clear_until, 3.0F - 0.5F - 1.0F, 1e-3F);
}

/// A search that ends because enough is proven has not been cut short.
TEST_F(ObstacleContract, EnoughIsNotABound)
{
    add(geometry::make_box({9, 2, 1}, {1, 3, 2}, Eigen::AngleAxisf(0.5F, Vec3(0, 0.6F, 0.8F)).toRotationMatrix()));
    const std::vector<world::Threat> threats = oracle::threats_of(obstacles);
    const Obstacles scene(threats);
    const detail::ObstacleView view{scene, {1.25F, 1.0F}, 1e-4F};
    WorkBudget budget(kUnlimited);
    const detail::Sighting exact = view.obstacle(0, Vec3::Zero(), 100.0F, budget);
    EXPECT_FALSE(exact.bounded);
    EXPECT_NEAR(exact.upper, exact.distance, 1e-3F);
    for (const float reach : {0.1F, 1.0F, 3.0F}) {
        const detail::Sighting some = view.obstacle(0, Vec3::Zero(), reach, budget);
        EXPECT_GE(some.distance, reach);
        EXPECT_LE(some.distance, exact.upper);
        EXPECT_FALSE(some.bounded) << reach;
    }
}

/// A smooth shape near its edge, with a resolution beyond float: the distance is a bound, and marked as such.
TEST_F(ObstacleContract, ASearchThatIsCutShortIsABound)
{
    settings.vertical = 0.8F;
    settings.resolution = 1e-9F;
    add(geometry::make_sphere({0, 0, 3}, 0.5F));
    add(geometry::make_cylinder({30, 30, -3}, {30, 30, 3}, 40.0F));
    int bounded = 0;
    for (int i = 0; i < 40; ++i) {
        own.position = Vec3(0.01F * static_cast<float>(i), -0.02F * static_cast<float>(i), 1.0F);
        const ObstaclePlanes found = planes();
        bounded += found.bounded ? 1 : 0;
        const ObstaclePlanes reversed = [&] {
            std::swap(obstacles[0], obstacles[1]);
            return planes();
        }();
        EXPECT_EQ(reversed.bounded, found.bounded) << "whichever comes first, " << i;
    }
    EXPECT_GT(bounded, 0);
}

/// A lower bound also of large obstacles near by.
TEST_F(ObstacleContract, TheBoundOfALargeObstacleIsNeverAboveItsDistance)
{
    Random random(20261126);
    for (int i = 0; i < 3000; ++i) {
        obstacles.clear();
        const float radius = random.uniform(100.0F, 1000.0F);
        const Vec3 to = Vec3(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)).normalized();
        add(geometry::make_sphere((radius + random.uniform(0.1F, 5.0F)) * to, radius));
        const std::vector<world::Threat> threats = oracle::threats_of(obstacles);
        const Obstacles scene(threats);
        const detail::ObstacleView view{scene, {1.0F, 1.0F}, 1e-4F};
        const double distance =
            obstacles[0].shape.centre.cast<double>().norm() - static_cast<double>(obstacles[0].shape.radius);
        ASSERT_LE(static_cast<double>(view.obstacle_bound(0, Vec3::Zero())), distance) << i;
    }
}

/// Just outside a face, just inside, and on it: never above the true distance, and below it by at most the stated
/// accuracy.
TEST_F(ObstacleContract, BesideAFaceNothingIsClaimedThatIsNotSo)
{
    add(geometry::make_box({0, 0, 0}, {5, 5, 5}));
    std::vector<Vec3> corners;
    for (int c = 0; c < 8; ++c) {
        corners.emplace_back((c & 1) != 0 ? 5.0F : -5.0F, (c & 2) != 0 ? 5.0F : -5.0F, (c & 4) != 0 ? 5.0F : -5.0F);
    }
    add_hull(corners);
    const std::vector<world::Threat> threats = oracle::threats_of(obstacles);
    for (const float stretch : {1.0F, 1.375F}) {
        const detail::ObstacleView view{threats, {stretch, 1.0F}, 1e-4F};
        for (float off = -1e-3F; off <= 1e-3F; off += 1.7e-5F) {
            const Vec3 point(0.3F, 5.0F + off, -0.2F);
            const float true_distance = point.y() - 5.0F;
            for (const std::size_t i : {0U, 1U}) {
                WorkBudget budget(kUnlimited);
                const detail::Sighting seen = view.obstacle(i, point, 9.0F, budget);
                EXPECT_LE(seen.distance, true_distance + 5e-6F) << off;
                EXPECT_GE(seen.distance, true_distance - 1.5e-4F) << off;
                EXPECT_GE(seen.upper, true_distance - 5e-6F) << off;
                EXPECT_LE(seen.distance, seen.upper) << off;
                EXPECT_NEAR(seen.direction.y(), -1.0F, 1e-3F) << "towards it, or further into it";
            }
        }
    }
}

}  // namespace
}  // namespace jink::orca
