// SPDX-License-Identifier: BSD-3-Clause
// Conflicts and margins of obstacles at the edges of their contracts.
#include <cmath>

#include <Eigen/Geometry>

#include <gtest/gtest.h>

#include "core/base/work_units.hpp"
#include "core/world/obstacle_distance.hpp"
#include "tests/numbers.hpp"
#include "tests/unit/core/world/scene.hpp"

namespace jink::world {
namespace {

using namespace test;

/// Eastwards from the origin at 5 m/s.
struct ConflictEdges : testing::Test {
    ConflictEdges()
    {
        scene.leg(Vec3(0, 0, 0), Vec3(100, 0, 0), 5.0F);
        scene.own.sigma_position = 0.1F;  // 0.3 m
    }
    bool meets(Seconds lookahead = 10.0F, std::uint32_t units = kPlenty)
    {
        WorkBudget budget(units);
        const Situation s = scene.situation();
        const bool met = main_conflict(s, way_of(s), lookahead, budget, found);
        spent = budget.spent();
        return met;
    }
    Scene scene;
    Conflict found;
    std::uint32_t spent = 0;
};

TEST_F(ConflictEdges, ASolidCountsAsASphereOfThreeMetresAtMost)
{
    scene.obstacle(geometry::make_box(Vec3(30, 0, 0), Vec3(1, 2, 2)));
    ASSERT_TRUE(meets());
    EXPECT_NEAR(found.radius_at_closest, 3.0F + 0.3F, 1e-5F) << "as much as about it";
    scene.obstacles[0].shape = geometry::make_box(Vec3(30, 0, 0), Vec3(1, 1, 0.5F));
    ASSERT_TRUE(meets());
    EXPECT_NEAR(found.radius_at_closest, 1.5F + 0.3F, 0.01F);
    scene.obstacles[0].shape = geometry::make_box(Vec3(30, 0, 0), Vec3(1, 40, 40));
    ASSERT_TRUE(meets());
    EXPECT_NEAR(found.radius_at_closest, 3.0F + 0.3F, 1e-5F);
    EXPECT_NEAR(found.time_to_loss, (29.0F - 1.3F) / 5.0F, 0.05F);
    EXPECT_NEAR(found.time_to_closest, 6.0F, 1e-3F);
}

/// A centre behind the path's end is nearest at the end.
TEST_F(ConflictEdges, AnObstacleBehindTheEndIsNearestAtTheEnd)
{
    scene.leg(Vec3(0, 0, 0), Vec3(10, 0, 0), 5.0F);
    scene.obstacle(geometry::make_sphere(Vec3(14, 0, 0), 4.0F));
    ASSERT_TRUE(meets());
    EXPECT_NEAR(found.time_to_closest, 2.0F, 1e-4F);
    EXPECT_NEAR((found.own_at_closest - Vec3(10, 0, 0)).norm(), 0.0F, 1e-4F);
    EXPECT_NEAR(found.miss_distance, 4.0F, 1e-4F);
    EXPECT_LT(found.time_to_loss, 2.0F);
}

/// A path without speed is a place.
TEST_F(ConflictEdges, AWayWithoutSpeedStands)
{
    scene.own.sigma_position = 0.0F;
    const Way place{Vec3(1, 2, 3), Vec3::UnitX(), 0.0F, 0.0F, {}};
    const auto meets_there = [&] {
        WorkBudget budget(kPlenty);
        return main_conflict(scene.situation(), place, 10.0F, budget, found);
    };
    scene.track(Vec3(21, 2, 3), Vec3(-5, 0, 0), 1.0F);
    ASSERT_TRUE(meets_there());
    EXPECT_NEAR(found.time_to_loss, 18.0F / 5.0F, 1e-4F);
    EXPECT_NEAR(found.time_to_closest, 4.0F, 1e-4F);
    EXPECT_EQ(found.own_at_closest, Vec3(1, 2, 3));
    scene.tracks.clear();
    EXPECT_FALSE(meets_there());
}

TEST_F(ConflictEdges, AQuarterOfAMetreIsOnTheLeg)
{
    scene.own.position = Vec3(40, 0.25F, 0);
    EXPECT_NEAR(way_of(scene.situation()).direction.y(), -0.25F / 60.0F, 1e-5F);
    scene.own.position = Vec3(40, 0.26F, 0);
    EXPECT_NEAR(way_of(scene.situation()).direction.y(), -0.26F / 12.0F, 1e-4F);
}

TEST_F(ConflictEdges, WhateverIsLeftOfTheBudgetWhatIsNotLookedAtIsMetNow)
{
    scene.track(Vec3(300, 0, 0), Vec3::Zero(), 1.0F);
    scene.cylinder(Vec2(300, 0), 3.0F);
    scene.obstacle(geometry::make_sphere(Vec3(300, 0, 0), 1.0F));
    scene.obstacle(geometry::make_box(Vec3(300, 0, 0), Vec3::Ones()));
    ASSERT_FALSE(meets());
    const std::uint32_t all = spent;
    for (std::uint32_t n = 0; n < all; ++n) {
        ASSERT_TRUE(meets(10.0F, n)) << n;
        ASSERT_EQ(found.time_to_loss, 0.0F) << n;
        ASSERT_EQ(found.margin, -kSeparationCap) << n;
    }
    EXPECT_FALSE(meets(10.0F, all));
}

/// A track of constant size is checked as a whole, for any look-ahead.
TEST_F(ConflictEdges, OnlyWhatGrowsIsLookedAtInHalfSeconds)
{
    scene.track(Vec3(30, 0, 0), Vec3::Zero(), 1.0F);
    ASSERT_TRUE(meets());
    EXPECT_EQ(spent, units::kConflictLook + units::kConflict + units::kConflictPart);
    EXPECT_NEAR(found.time_to_loss, (30.0F - 2.3F) / 5.0F, 1e-3F);
    for (float Track::*growth : {&Track::sigma_velocity, &Track::max_acceleration}) {
        scene.tracks[0] = scene.track(Vec3(30, 0, 0), Vec3::Zero(), 1.0F);
        scene.tracks.resize(1);
        scene.tracks[0].*growth = 1e-6F;
        ASSERT_TRUE(meets());
        EXPECT_EQ(spent, units::kConflictLook + units::kConflict + 12 * units::kConflictPart) << "met in the twelfth";
        EXPECT_NEAR(found.time_to_loss, (30.0F - 2.3F) / 5.0F, 1e-3F);
    }
}

// --- margins of obstacles ---

float margin_to(const geometry::Shape& shape, float extra, const Vec3& half = Vec3::Ones())
{
    WorkBudget budget(kPlenty);
    return obstacle_margin(half, Vec3::Zero(), Vec3(2, 0, 0), shape, budget, extra);
}

TEST(ObstacleMarginEdges, WithinItsClearanceItIsWhatIsLacking)
{
    const auto wall = [](float gap) { return geometry::make_box(Vec3(1, 6.0F + gap, 0), Vec3(30, 5, 30)); };
    EXPECT_NEAR(margin_to(wall(0.5F), 0.0F), 0.5F, kObstacleResolution + 1e-3F);
    EXPECT_NEAR(margin_to(wall(0.5F), 0.2F), 0.3F, kObstacleResolution + 1e-3F);
    EXPECT_NEAR(margin_to(wall(0.5F), 0.9F), -0.4F, kObstacleResolution + 1e-3F);
    EXPECT_NEAR(margin_to(wall(0.02F), 0.9F), -0.88F, kObstacleResolution + 1e-3F);
    EXPECT_GE(margin_to(wall(0.02F), 0.0F), 0.0F) << "nearer than the resolution is not yet contact";
    EXPECT_LE(margin_to(wall(0.02F), 0.0F), 0.02F + 1e-3F);
}

/// Overlapping by 0.25 m of the box's metre: so much has to be taken off, and the clearance with it.
TEST(ObstacleMarginEdges, OverlappingItIsTheShareOfTheBoxAndTheClearance)
{
    const geometry::Shape wall = geometry::make_cylinder(Vec3(1, 0.75F, 0), Vec3(1, 9.75F, 0), 30.0F);
    EXPECT_LE(margin_to(wall, 0.0F), -0.25F);
    EXPECT_GE(margin_to(wall, 0.0F), -0.25F - kOverlapResolution);
    EXPECT_LE(margin_to(wall, 0.6F), -0.85F);
    EXPECT_GE(margin_to(wall, 0.6F), -0.85F - kOverlapResolution);
}

/// In a box it is the way out, however deep.
TEST(ObstacleMarginEdges, OverlappingABoxItIsTheDepthAndTheClearance)
{
    for (const float depth : {0.25F, 1.5F, 4.0F, 6.0F}) {
        const geometry::Shape wall = geometry::make_box(Vec3(1, 6.0F - depth, 0), Vec3(30, 5, 30));
        EXPECT_NEAR(margin_to(wall, 0.0F), -depth, 1e-4F);
        EXPECT_NEAR(margin_to(wall, 0.6F), -depth - 0.6F, 1e-4F);
    }
    // Straight through: as deep as it is in the middle.
    EXPECT_NEAR(margin_to(geometry::make_box(Vec3(1, 0, 0), Vec3(0.1F, 50, 50)), 0.0F), -1.1F, 1e-4F);
}

TEST(ObstacleMarginEdges, TouchingABoxAtItsEdgeIsContact)
{
    const Mat3 turned = Eigen::AngleAxisf(0.25F * kPi, Vec3::UnitZ()).toRotationMatrix();
    const float reach = 1.0F + 2.0F * std::sqrt(2.0F);
    EXPECT_LT(margin_to(geometry::make_box(Vec3(2.0F + reach - 1e-3F, 0, 0), Vec3(2, 2, 2), turned), 0.0F), 0.0F);
    EXPECT_GE(margin_to(geometry::make_box(Vec3(2.0F + reach + 1e-3F, 0, 0), Vec3(2, 2, 2), turned), 0.0F), 0.0F);
}

TEST(ObstacleMarginEdges, WithoutABudgetASphereIsAsDeepAsCanBe)
{
    const auto margin = [](const Vec3& half, float radius) {
        WorkBudget none(units::kSphereQuery - 1);
        return obstacle_margin(half, Vec3::Zero(), Vec3(2, 0, 0), geometry::make_sphere(Vec3(9, 9, 9), radius), none);
    };
    EXPECT_EQ(margin(Vec3(1, 3, 2), 0.5F), -3.0F);
    EXPECT_EQ(margin(Vec3(1, 3, 2), 7.0F), -7.0F);
}

TEST(AsSphere, TakesCapsulesThatStandExactlyUpright)
{
    Vec3 half;
    float radius = 0.0F;
    const auto is = [&](const Vec3& from, const Vec3& to) {
        return as_sphere(geometry::make_capsule(from, to, 0.5F), Vec3(1, 2, 3), half, radius);
    };
    EXPECT_TRUE(is(Vec3(0, 0, -4), Vec3(0, 0, 4)));
    EXPECT_EQ(half, Vec3(1, 2, 7));
    EXPECT_EQ(radius, 0.5F);
    EXPECT_FALSE(is(Vec3(0, 0, -4), Vec3(0.01F, 0, 4)));
    EXPECT_FALSE(is(Vec3(0, 0, -4), Vec3(0, 0.01F, 4)));
    EXPECT_FALSE(is(Vec3(0, 0, -4), Vec3(0, 8, -4)));
    EXPECT_TRUE(as_sphere(geometry::make_sphere(Vec3(1, 1, 1), 2.5F), Vec3(1, 2, 3), half, radius));
    EXPECT_EQ(half, Vec3(1, 2, 3));
    EXPECT_EQ(radius, 2.5F);
    EXPECT_FALSE(as_sphere(geometry::make_box(Vec3::Zero(), Vec3::Ones()), Vec3(1, 2, 3), half, radius));
}

}  // namespace
}  // namespace jink::world
