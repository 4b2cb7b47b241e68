// SPDX-License-Identifier: BSD-3-Clause
// Paths along obstacles, and levels that yield in sequence, at their limits.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/orca/obstacle_way.hpp"
#include "core/orca/program.hpp"
#include "tests/oracle/obstacle_threats.hpp"

namespace jink::orca {
namespace {

/// A sphere of 1 m; the envelope has 1 m about the own centre in every direction.
class WayEdges : public ::testing::Test {
protected:
    WayEdges() { settings.horizontal = settings.vertical = 1.0F; }
    [[nodiscard]] WayClearance along(const Vec3& velocity, std::uint32_t units = 10'000'000,
                                     const Vec3& from = Vec3::Zero()) const
    {
        WorkBudget budget(units);
        return clearance_along(oracle::threats_of(obstacles), from, velocity, 4.0F, settings, budget);
    }
    void add(const Vec3& centre)
    {
        obstacles.push_back({static_cast<world::ObstacleId>(obstacles.size()), geometry::make_sphere(centre, 1.0F)});
    }
    ObstacleSettings settings;
    std::vector<world::Obstacle> obstacles;
};

TEST_F(WayEdges, TheWayEndsWhereTheFirstObstacleIsMet)
{
    add({0, 9, 0});
    add({8, 0, 0});
    add({5, 0, 0});
    add({6.5F, 0, 0});
    const WayClearance way = along({1.5F, 0, 0});
    EXPECT_FALSE(way.clear);
    EXPECT_FALSE(way.bounded);
    EXPECT_NEAR(way.clear_until, 2.0F, 1e-3F);
    EXPECT_EQ(way.source, 2);
    const WayClearance shorter = along({0.7F, 0, 0});
    EXPECT_TRUE(shorter.clear) << "2.8 m in 4 s, 3 m are free";
    EXPECT_EQ(shorter.clear_until, 4.0F);
    EXPECT_TRUE(along({-1, 0, 0}).clear);
}

TEST_F(WayEdges, WithinAMarginOnlyComingNearerCounts)
{
    add({1.5F, 0, 0});
    EXPECT_TRUE(along(Vec3::Zero()).clear) << "it comes no nearer";
    EXPECT_TRUE(along({0, 1, 0}).clear);
    EXPECT_TRUE(along({-1, 0, 0}).clear);
    const WayClearance nearer = along({0.5F, 0, 0});
    EXPECT_FALSE(nearer.clear);
    EXPECT_EQ(nearer.clear_until, 0.0F);
}

TEST_F(WayEdges, WhatWasNotLookedAtIsNotClear)
{
    settings.vertical = 0.8F;  // stretched, so that a capsule is searched
    obstacles.push_back({0, geometry::make_capsule({5, -3, -2}, {5, 3, 2}, 0.5F)});
    const WayClearance whole = along({1.5F, 0, 0});
    ASSERT_FALSE(whole.clear || whole.bounded);
    const WayClearance way = along({1.5F, 0, 0}, 0);
    EXPECT_FALSE(way.clear);
    EXPECT_TRUE(way.bounded);
    EXPECT_LE(way.clear_until, whole.clear_until);
}

/// Two half-spaces along an axis: at least `low`, at most `high`.
void between(std::vector<HalfSpace>& planes, const Vec3& axis, float low, float high, Level level, float yield = 1.0F)
{
    planes.push_back({axis, low, level, 0, yield});
    planes.push_back({-axis, -high, level, 0, 1.0F});
}

Solution levels_solved(const std::vector<HalfSpace>& planes, const Vec3& preferred)
{
    const std::vector<Sphere> spheres{{Vec3::Zero(), 5.0F}};
    Scratch<16> scratch;
    WorkBudget budget(1'000'000);
    return solve({planes, spheres, preferred, Vec3::Zero()}, scratch.view(), budget);
}

TEST(LevelsGiveWay, EachForThoseBeforeItAndAllAreSaid)
{
    const Vec3 x = Vec3::UnitX();
    const Vec3 y = Vec3::UnitY();
    const Vec3 z = Vec3::UnitZ();
    for (int broken = 0; broken < 8; ++broken) {
        const bool obstacles = (broken & 1) != 0;
        const bool conflict = (broken & 2) != 0;
        const bool warning = (broken & 4) != 0;
        std::vector<HalfSpace> planes;
        between(planes, x, obstacles ? 0.1F : -0.5F, obstacles ? -0.1F : 0.5F, Level::obstacles);
        between(planes, y, conflict ? 0.3F : -0.4F, conflict ? -0.1F : 0.4F, Level::conflict);
        between(planes, z, warning ? 0.5F : -0.3F, warning ? -0.5F : 0.3F, Level::warning);
        const Solution solution = levels_solved(planes, {2, 2, 2});
        const std::uint32_t said =
            (obstacles ? kRelaxedObstacle : 0U) | (conflict ? kRelaxedConflict : 0U) | (warning ? kRelaxedWarning : 0U);
        EXPECT_EQ(solution.status, said) << broken;
        EXPECT_NEAR(solution.broken[1], obstacles ? 0.1F : 0.0F, 1e-4F) << broken;
        EXPECT_NEAR(solution.broken[2], conflict ? 0.2F : 0.0F, 1e-4F) << broken;
        EXPECT_NEAR(solution.broken[3], warning ? 0.5F : 0.0F, 1e-4F) << broken;
        if (said != 0) {
            EXPECT_EQ(solution.level, obstacles ? Level::obstacles : conflict ? Level::conflict : Level::warning);
        }
        const Vec3 wanted(obstacles ? 0.0F : 0.5F, conflict ? 0.1F : 0.4F, warning ? 0.0F : 0.3F);
        EXPECT_LT((solution.velocity - wanted).norm(), 4e-4F) << broken;
    }
}

/// A level that contradicts a stronger one yields alone, even if the stronger one would need to yield only little.
TEST(LevelsGiveWay, NoneIsBrokenForTheSakeOfAWeakerOne)
{
    const Vec3 x = Vec3::UnitX();
    for (const Level strong : {Level::limits, Level::obstacles, Level::conflict}) {
        const std::vector<HalfSpace> planes{{x, 0.5F, strong, 0, 1.0F}, {-x, 2.0F, Level::warning, 0, 1.0F}};
        const Solution solution = levels_solved(planes, {-1, 0.25F, 0});
        EXPECT_EQ(solution.status, kRelaxedWarning);
        EXPECT_NEAR(solution.broken[3], 2.5F, 2e-4F);
        EXPECT_LT((solution.velocity - Vec3(0.5F, 0.25F, 0)).norm(), 4e-4F);
        EXPECT_GE(solution.velocity.x(), 0.5F - 1e-5F);
    }
}

TEST(LevelsGiveWay, ByTheirYields)
{
    std::vector<HalfSpace> planes;
    between(planes, Vec3::UnitY(), 0.3F, -0.1F, Level::warning, 3.0F);
    const Solution solution = levels_solved(planes, {0.25F, 1, 0});
    EXPECT_NEAR(solution.broken[3], 0.1F, 1e-4F) << "0.3 less three parts is -0.1 and one part";
    EXPECT_LT((solution.velocity - Vec3(0.25F, 0, 0)).norm(), 6e-4F);
}

TEST(LevelsGiveWay, WhatHoldsAVelocityIsNamed)
{
    std::vector<HalfSpace> planes;
    between(planes, Vec3::UnitX(), -1.0F, 0.5F, Level::obstacles);
    between(planes, Vec3::UnitY(), -1.0F, 0.25F, Level::conflict);
    between(planes, Vec3::UnitZ(), -1.0F, 0.125F, Level::warning);
    const auto held_by = [&](const Vec3& preferred) {
        const Solution solution = levels_solved(planes, preferred);
        EXPECT_EQ(solution.status, 0U);
        std::vector<std::uint16_t> out(solution.active.begin(), solution.active.begin() + solution.actives);
        std::sort(out.begin(), out.end());
        return out;
    };
    EXPECT_TRUE(held_by({0, 0, 0}).empty());
    EXPECT_EQ(held_by({0, 2, 0}), (std::vector<std::uint16_t>{3}));
    EXPECT_EQ(held_by({2, 0, 2}), (std::vector<std::uint16_t>{1, 5}));
    EXPECT_EQ(held_by({2, 2, 2}), (std::vector<std::uint16_t>{1, 3, 5}));
    EXPECT_EQ(held_by({-2, 0, 0}), (std::vector<std::uint16_t>{0}));
}

}  // namespace
}  // namespace jink::orca
