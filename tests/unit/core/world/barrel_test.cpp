// SPDX-License-Identifier: BSD-3-Clause
#include "core/world/barrel.hpp"

#include <array>
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "core/base/work_units.hpp"
#include "core/world/conflict.hpp"
#include "tests/unit/core/world/scene.hpp"

namespace jink::world {
namespace {

using namespace test;

TEST(BarrelValidity, RefusesWhatIsNone)
{
    const Barrel good{{{1, 2}, 3.0F}, {4, 5}, 6.0F, 6.0F, 0.0F};
    ASSERT_TRUE(is_valid(good));
    constexpr float kNone = std::numeric_limits<float>::quiet_NaN();
    constexpr float kEndless = std::numeric_limits<float>::infinity();
    for (const float bad : {kNone, kEndless, -kEndless, 1e6F}) {
        for (float Barrel::*field : {&Barrel::bottom, &Barrel::top, &Barrel::margin}) {
            Barrel barrel = good;
            barrel.*field = bad;
            EXPECT_FALSE(is_valid(barrel)) << bad;
        }
        for (int axis = 0; axis < 2; ++axis) {
            Barrel moved = good;
            moved.circle.centre[axis] = bad;
            EXPECT_FALSE(is_valid(moved)) << bad;
            Barrel fast = good;
            fast.velocity[axis] = bad;
            EXPECT_FALSE(is_valid(fast)) << bad;
        }
        Barrel wide = good;
        wide.circle.radius = bad;
        EXPECT_FALSE(is_valid(wide)) << bad;
    }
    for (const float radius : {0.0F, -1.0F}) {
        Barrel barrel = good;
        barrel.circle.radius = radius;
        EXPECT_FALSE(is_valid(barrel));
    }
    Barrel upside_down = good;
    upside_down.top = 5.9F;
    EXPECT_FALSE(is_valid(upside_down));
    Barrel shrinking = good;
    shrinking.margin = -0.1F;
    EXPECT_FALSE(is_valid(shrinking));
}

TEST(BarrelDistance, SidewaysAboveAndAcrossTheRim)
{
    const Barrel barrel{{{10, 0}, 4.0F}, {0, 0}, -2.0F, 2.0F, 9.0F};
    const Vec3 half(1, 1, 1);
    EXPECT_NEAR(barrel_distance(half, {0, 0, 0}, barrel, 0.0F), 5.0F, 1e-4F) << "the margin does not count";
    EXPECT_NEAR(barrel_distance(half, {10, 0, 8}, barrel, 0.0F), 5.0F, 1e-4F);
    EXPECT_NEAR(barrel_distance(half, {10, 0, -8}, barrel, 0.0F), 5.0F, 1e-4F);
    EXPECT_NEAR(barrel_distance(half, {2, 0, 7}, barrel, 0.0F), 5.0F, 1e-4F) << "3 m beside, 4 m above";
    EXPECT_NEAR(barrel_distance(half, {6, 4, 0}, barrel, 0.0F), std::sqrt(18.0F) - 4.0F, 1e-4F) << "corner first";
    EXPECT_LE(barrel_distance(half, {5, 0, 0}, barrel, 0.0F), 0.0F) << "touching is contact";
}

TEST(BarrelDistance, InsideTheLeastWayOut)
{
    const Barrel barrel{{{0, 0}, 10.0F}, {0, 0}, -5.0F, 20.0F, 0.0F};
    const Vec3 half(1, 1, 1);
    EXPECT_NEAR(barrel_distance(half, {0, 0, 0}, barrel, 0.0F), -6.0F, 1e-4F) << "down";
    EXPECT_NEAR(barrel_distance(half, {9, 0, 7}, barrel, 0.0F), -2.0F, 1e-4F) << "sideways";
    EXPECT_NEAR(barrel_distance(half, {0, 0, 19}, barrel, 0.0F), -2.0F, 1e-4F) << "up";
}

/// The check value of the avoidance specification, section 3: centre (100, 50), velocity (-5, 2), 13 s.
TEST(BarrelDistance, CheckValueOfTheShiftedCentre)
{
    const Barrel barrel{{{100, 50}, 20.0F}, {-5, 2}, 0.0F, 100.0F, 10.0F};
    EXPECT_NEAR(barrel_distance(Vec3::Zero(), {35, 76, 50}, barrel, 13.0F), -20.0F, 1e-3F);
    EXPECT_NEAR(barrel_distance(Vec3::Zero(), {35, 106, 50}, barrel, 13.0F), 10.0F, 1e-3F);
}

TEST(BarrelSeparation, OneThatPassesBeforeOrAfterIsClear)
{
    Scene scene;
    // It crosses the path at x = 20 at the same time as we do, 4 s.
    scene.barrel({20, -40}, 5.0F, {0, 10});
    const Separation met = separation(scene, flight({{0, 0, 0}, {40, 0, 0}}, 8.0F));
    EXPECT_NEAR(met.margin, -5.0F, 1e-2F);
    EXPECT_EQ(met.against, (ThreatRef{ThreatKind::barrel, 0}));
    EXPECT_NEAR(met.when, 4.0F, 0.3F);
    EXPECT_GT(separation(scene, flight({{0, 0, 0}, {40, 0, 0}}, 2.0F)).margin, 5.0F) << "gone before it comes";
    EXPECT_GT(separation(scene, flight({{0, 0, 0}, {40, 0, 0}}, 40.0F)).margin, 5.0F) << "long past";
}

TEST(BarrelSeparation, OverAndUnderIsClearByWhatIsBetween)
{
    Scene scene;
    scene.barrel({20, 0}, 5.0F);
    EXPECT_NEAR(separation(scene, flight({{0, 0, 24}, {40, 0, 24}}, 8.0F)).margin, 3.0F, 1e-3F);
    EXPECT_NEAR(separation(scene, flight({{0, 0, -23}, {40, 0, -23}}, 8.0F)).margin, 2.0F, 1e-3F);
    scene.own.sigma_position = 0.5F;
    EXPECT_NEAR(separation(scene, flight({{0, 0, 24}, {40, 0, 24}}, 8.0F)).margin, 1.5F, 1e-3F) << "own place";
    EXPECT_LT(separation(scene, flight({{0, 0, 24}, {20, 0, 18}, {40, 0, 24}}, 4.0F)).margin, 0.0F);
}

TEST(BarrelSeparation, WhoLeavesIsClearAndWhoStaysIsNot)
{
    Scene scene;
    scene.barrel({0, 0}, 10.0F);
    EXPECT_GE(separation(scene, flight({{8, 0, 0}, {28, 0, 0}}, 10.0F)).margin, 0.0F) << "out at 2 m/s";
    EXPECT_LT(separation(scene, flight({{8, 0, 0}, {8.5F, 0, 0}}, 10.0F)).margin, 0.0F) << "too slowly";
    EXPECT_LT(separation(scene, flight({{8, 0, 0}, {-28, 0, 0}}, 10.0F)).margin, 0.0F) << "across";
    EXPECT_LT(separation(scene, flight({{8, 0, 0}, {28, 0, 0}, {0, 0, 0}}, 10.0F)).margin, 0.0F) << "and back";
    EXPECT_GE(separation(scene, flight({{0, 0, 15}, {0, 0, 35}}, 10.0F)).margin, 0.0F) << "out over the top";
    EXPECT_GE(separation(scene, flight({{8, 0, 0}}, 1.0F)).margin, 0.0F) << "a start alone is shrunk around";
}

TEST(BarrelSeparation, ASpentBudgetIsContact)
{
    Scene scene;
    scene.own.position = {0, 0, 0};
    scene.barrel({30, 0}, 5.0F, {-1, 1});
    scene.barrel({0, 30}, 5.0F, {1, 0.5F});
    const path::TimedPath path = flight({{0, 0, 0}, {10, 3, 16}, {15, 10, 24}}, 3.0F);
    WorkBudget ample(kPlenty);
    ASSERT_GT(least_separation(scene.situation(), path, 100.0F, ample).margin, 0.0F);
    for (std::uint32_t n = 0; n < ample.spent(); ++n) {
        WorkBudget budget(n);
        ASSERT_LT(least_separation(scene.situation(), path, 100.0F, budget).margin, 0.0F) << n;
        ASSERT_TRUE(budget.exhausted());
    }
    WorkBudget little(2 * units::kThreat - 1);
    EXPECT_LT(separation_at(scene.situation(), Vec3::Zero(), 0.0F, little).margin, 0.0F);
}

TEST(BarrelConflict, TellsWhenTheBodyIsEntered)
{
    Scene scene;
    scene.leg({0, 0, 0}, {100, 0, 0}, 5.0F);
    scene.barrel({40, 0}, 9.0F).margin = 25.0F;
    Conflict conflict;
    WorkBudget budget(kPlenty);
    ASSERT_TRUE(main_conflict(scene.situation(), way_of(scene.situation()), 8.0F, budget, conflict));
    EXPECT_EQ(conflict.threat, (ThreatRef{ThreatKind::barrel, 0}));
    EXPECT_NEAR(conflict.time_to_loss, 6.0F, 2e-3F);
    EXPECT_LE(conflict.time_to_loss, 6.0F);
    EXPECT_NEAR(conflict.radius_at_closest, 9.0F, 1e-4F);
    EXPECT_FALSE(main_conflict(scene.situation(), way_of(scene.situation()), 5.9F, budget, conflict))
        << "the margin is no conflict";
    scene.barrels[0].bottom = 2.0F;
    EXPECT_FALSE(main_conflict(scene.situation(), way_of(scene.situation()), 8.0F, budget, conflict)) << "below it";
}

TEST(BarrelConflict, AStormComesToWhoHoversAtTheEnd)
{
    Scene scene;
    scene.leg({0, 0, 0}, {5, 0, 0}, 5.0F);
    scene.barrel({5, 40}, 10.0F, {0, -6});
    Conflict conflict;
    WorkBudget budget(kPlenty);
    ASSERT_TRUE(main_conflict(scene.situation(), way_of(scene.situation()), 8.0F, budget, conflict));
    EXPECT_NEAR(conflict.time_to_loss, (40.0F - 10.0F - 1.0F) / 6.0F, 2e-3F);
}

TEST(BarrelConflict, LeavingOneForGoodIsNone)
{
    Scene scene;
    scene.own.position = {8, 0, 0};
    scene.leg({8, 0, 0}, {60, 0, 0}, 5.0F);
    scene.barrel({0, 0}, 10.0F);
    Conflict conflict;
    WorkBudget budget(kPlenty);
    EXPECT_FALSE(main_conflict(scene.situation(), way_of(scene.situation()), 8.0F, budget, conflict));
    scene.leg({8, 0, 0}, {-60, 0, 0}, 5.0F);
    ASSERT_TRUE(main_conflict(scene.situation(), way_of(scene.situation()), 8.0F, budget, conflict));
    EXPECT_EQ(conflict.time_to_loss, 0.0F);
}

/// The first loss decides, for any kind of threat.
TEST(BarrelConflict, WhatComesFirstIsTheMainThreat)
{
    Scene scene;
    scene.leg({0, 0, 0}, {100, 0, 0}, 5.0F);
    scene.barrel({30, 0}, 5.0F);
    scene.track({20, 0, 0}, Vec3::Zero());
    scene.obstacle(geometry::make_sphere({38, 0, 0}, 1.0F));
    Conflict conflict;
    WorkBudget budget(kPlenty);
    const auto main_of = [&] {
        EXPECT_TRUE(main_conflict(scene.situation(), way_of(scene.situation()), 8.0F, budget, conflict));
        return conflict.threat;
    };
    EXPECT_EQ(main_of(), (ThreatRef{ThreatKind::track, 0}));
    scene.tracks.clear();
    EXPECT_EQ(main_of(), (ThreatRef{ThreatKind::barrel, 0}));
    scene.airspace.barrels = {};
    EXPECT_EQ(main_of(), (ThreatRef{ThreatKind::obstacle, 0}));
}

TEST(BarrelConflict, ASpentBudgetIsAConflictNow)
{
    Scene scene;
    scene.leg({0, 0, 0}, {100, 0, 0}, 5.0F);
    scene.barrel({40, 12}, 9.0F, {0.1F, -0.2F});
    Conflict conflict;
    WorkBudget ample(kPlenty);
    ASSERT_FALSE(main_conflict(scene.situation(), way_of(scene.situation()), 8.0F, ample, conflict));
    for (std::uint32_t n = 0; n < ample.spent(); ++n) {
        WorkBudget budget(n);
        ASSERT_TRUE(main_conflict(scene.situation(), way_of(scene.situation()), 8.0F, budget, conflict)) << n;
        ASSERT_EQ(conflict.time_to_loss, 0.0F) << n;
        ASSERT_EQ(conflict.threat.kind, ThreatKind::barrel) << n;
    }
}

/// Along a route: around a corner, with the rest of the path.
TEST(BarrelConflict, AlongARouteIsSeenBehindItsCorner)
{
    Scene scene;
    const std::array<Vec3, 3> corners{Vec3(0, 0, 0), Vec3(20, 0, 0), Vec3(20, 60, 0)};
    path::Route route;
    ASSERT_EQ(route.add_leg(corners[0], corners[1]), path::RouteStatus::ok);
    ASSERT_EQ(route.add_leg(corners[1], corners[2]), path::RouteStatus::ok);
    scene.leg(corners[0], corners[1], 5.0F);
    scene.reference = world::Reference(route, scene.reference.speed);
    scene.barrel({20, 20}, 6.0F);
    Conflict conflict;
    WorkBudget budget(kPlenty);
    ASSERT_TRUE(main_conflict(scene.situation(), way_of(scene.situation()), 10.0F, budget, conflict));
    EXPECT_EQ(conflict.threat, (ThreatRef{ThreatKind::barrel, 0}));
    EXPECT_NEAR(conflict.time_to_loss, (20.0F + 13.0F) / 5.0F, 0.1F);
    EXPECT_NEAR(conflict.way_at_closest, 5.0F * conflict.time_to_closest, 0.5F);
    scene.barrels[0].circle.centre.x() = -20.0F;
    EXPECT_FALSE(main_conflict(scene.situation(), way_of(scene.situation()), 10.0F, budget, conflict));
}

}  // namespace
}  // namespace jink::world
