// SPDX-License-Identifier: BSD-3-Clause
#include "core/world/cylinder.hpp"

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

TEST(CylinderValidity, RefusesWhatIsNone)
{
    const Cylinder good{{{1, 2}, 3.0F}, {4, 5}, 6.0F, 6.0F, 0.0F};
    ASSERT_TRUE(is_valid(good));
    constexpr float kNone = std::numeric_limits<float>::quiet_NaN();
    constexpr float kEndless = std::numeric_limits<float>::infinity();
    for (const float bad : {kNone, kEndless, -kEndless, 1e6F}) {
        for (float Cylinder::*field : {&Cylinder::bottom, &Cylinder::top, &Cylinder::margin}) {
            Cylinder cylinder = good;
            cylinder.*field = bad;
            EXPECT_FALSE(is_valid(cylinder)) << bad;
        }
        for (int axis = 0; axis < 2; ++axis) {
            Cylinder moved = good;
            moved.circle.centre[axis] = bad;
            EXPECT_FALSE(is_valid(moved)) << bad;
            Cylinder fast = good;
            fast.velocity[axis] = bad;
            EXPECT_FALSE(is_valid(fast)) << bad;
        }
        Cylinder wide = good;
        wide.circle.radius = bad;
        EXPECT_FALSE(is_valid(wide)) << bad;
    }
    for (const float radius : {0.0F, -1.0F}) {
        Cylinder cylinder = good;
        cylinder.circle.radius = radius;
        EXPECT_FALSE(is_valid(cylinder));
    }
    Cylinder upside_down = good;
    upside_down.top = 5.9F;
    EXPECT_FALSE(is_valid(upside_down));
    Cylinder shrinking = good;
    shrinking.margin = -0.1F;
    EXPECT_FALSE(is_valid(shrinking));
}

TEST(CylinderDistance, SidewaysAboveAndAcrossTheRim)
{
    const Cylinder cylinder{{{10, 0}, 4.0F}, {0, 0}, -2.0F, 2.0F, 9.0F};
    const Vec3 half(1, 1, 1);
    EXPECT_NEAR(cylinder_distance(half, {0, 0, 0}, cylinder, 0.0F), 5.0F, 1e-4F) << "the margin does not count";
    EXPECT_NEAR(cylinder_distance(half, {10, 0, 8}, cylinder, 0.0F), 5.0F, 1e-4F);
    EXPECT_NEAR(cylinder_distance(half, {10, 0, -8}, cylinder, 0.0F), 5.0F, 1e-4F);
    EXPECT_NEAR(cylinder_distance(half, {2, 0, 7}, cylinder, 0.0F), 5.0F, 1e-4F) << "3 m beside, 4 m above";
    EXPECT_NEAR(cylinder_distance(half, {6, 4, 0}, cylinder, 0.0F), std::sqrt(18.0F) - 4.0F, 1e-4F) << "corner first";
    EXPECT_LE(cylinder_distance(half, {5, 0, 0}, cylinder, 0.0F), 0.0F) << "touching is contact";
}

TEST(CylinderDistance, InsideTheLeastWayOut)
{
    const Cylinder cylinder{{{0, 0}, 10.0F}, {0, 0}, -5.0F, 20.0F, 0.0F};
    const Vec3 half(1, 1, 1);
    EXPECT_NEAR(cylinder_distance(half, {0, 0, 0}, cylinder, 0.0F), -6.0F, 1e-4F) << "down";
    EXPECT_NEAR(cylinder_distance(half, {9, 0, 7}, cylinder, 0.0F), -2.0F, 1e-4F) << "sideways";
    EXPECT_NEAR(cylinder_distance(half, {0, 0, 19}, cylinder, 0.0F), -2.0F, 1e-4F) << "up";
}

/// The check value of the avoidance specification, section 3: centre (100, 50), velocity (-5, 2), 13 s.
TEST(CylinderDistance, CheckValueOfTheShiftedCentre)
{
    const Cylinder cylinder{{{100, 50}, 20.0F}, {-5, 2}, 0.0F, 100.0F, 10.0F};
    EXPECT_NEAR(cylinder_distance(Vec3::Zero(), {35, 76, 50}, cylinder, 13.0F), -20.0F, 1e-3F);
    EXPECT_NEAR(cylinder_distance(Vec3::Zero(), {35, 106, 50}, cylinder, 13.0F), 10.0F, 1e-3F);
}

TEST(CylinderSeparation, OneThatPassesBeforeOrAfterIsClear)
{
    Scene scene;
    // It crosses the path at x = 20 at the same time as we do, 4 s.
    scene.cylinder({20, -40}, 5.0F, {0, 10});
    const Separation met = separation(scene, flight({{0, 0, 0}, {40, 0, 0}}, 8.0F));
    EXPECT_NEAR(met.margin, -5.0F, 1e-2F);
    EXPECT_EQ(met.against, (ThreatRef{ThreatKind::cylinder, 0}));
    EXPECT_NEAR(met.when, 4.0F, 0.3F);
    EXPECT_GT(separation(scene, flight({{0, 0, 0}, {40, 0, 0}}, 2.0F)).margin, 5.0F) << "gone before it comes";
    EXPECT_GT(separation(scene, flight({{0, 0, 0}, {40, 0, 0}}, 40.0F)).margin, 5.0F) << "long past";
}

TEST(CylinderSeparation, OverAndUnderIsClearByWhatIsBetween)
{
    Scene scene;
    scene.cylinder({20, 0}, 5.0F);
    EXPECT_NEAR(separation(scene, flight({{0, 0, 24}, {40, 0, 24}}, 8.0F)).margin, 3.0F, 1e-3F);
    EXPECT_NEAR(separation(scene, flight({{0, 0, -23}, {40, 0, -23}}, 8.0F)).margin, 2.0F, 1e-3F);
    scene.own.sigma_position = 0.5F;
    EXPECT_NEAR(separation(scene, flight({{0, 0, 24}, {40, 0, 24}}, 8.0F)).margin, 1.5F, 1e-3F) << "own place";
    EXPECT_LT(separation(scene, flight({{0, 0, 24}, {20, 0, 18}, {40, 0, 24}}, 4.0F)).margin, 0.0F);
}

TEST(CylinderSeparation, WhoLeavesIsClearAndWhoStaysIsNot)
{
    Scene scene;
    scene.cylinder({0, 0}, 10.0F);
    EXPECT_GE(separation(scene, flight({{8, 0, 0}, {28, 0, 0}}, 10.0F)).margin, 0.0F) << "out at 2 m/s";
    EXPECT_LT(separation(scene, flight({{8, 0, 0}, {8.5F, 0, 0}}, 10.0F)).margin, 0.0F) << "too slowly";
    EXPECT_LT(separation(scene, flight({{8, 0, 0}, {-28, 0, 0}}, 10.0F)).margin, 0.0F) << "across";
    EXPECT_LT(separation(scene, flight({{8, 0, 0}, {28, 0, 0}, {0, 0, 0}}, 10.0F)).margin, 0.0F) << "and back";
    EXPECT_GE(separation(scene, flight({{0, 0, 15}, {0, 0, 35}}, 10.0F)).margin, 0.0F) << "out over the top";
    EXPECT_GE(separation(scene, flight({{8, 0, 0}}, 1.0F)).margin, 0.0F) << "a start alone is shrunk around";
}

TEST(CylinderSeparation, ASpentBudgetIsContact)
{
    Scene scene;
    scene.own.position = {0, 0, 0};
    scene.cylinder({30, 0}, 5.0F, {-1, 1});
    scene.cylinder({0, 30}, 5.0F, {1, 0.5F});
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

TEST(CylinderConflict, TellsWhenTheBodyIsEntered)
{
    Scene scene;
    scene.leg({0, 0, 0}, {100, 0, 0}, 5.0F);
    scene.cylinder({40, 0}, 9.0F).margin = 25.0F;
    Conflict conflict;
    WorkBudget budget(kPlenty);
    ASSERT_TRUE(main_conflict(scene.situation(), way_of(scene.situation()), 8.0F, budget, conflict));
    EXPECT_EQ(conflict.threat, (ThreatRef{ThreatKind::cylinder, 0}));
    EXPECT_NEAR(conflict.time_to_loss, 6.0F, 2e-3F);
    EXPECT_LE(conflict.time_to_loss, 6.0F);
    EXPECT_NEAR(conflict.radius_at_closest, 9.0F, 1e-4F);
    EXPECT_FALSE(main_conflict(scene.situation(), way_of(scene.situation()), 5.9F, budget, conflict))
        << "the margin is no conflict";
    scene.cylinders[0].bottom = 2.0F;
    EXPECT_FALSE(main_conflict(scene.situation(), way_of(scene.situation()), 8.0F, budget, conflict)) << "below it";
}

TEST(CylinderConflict, AStormComesToWhoHoversAtTheEnd)
{
    Scene scene;
    scene.leg({0, 0, 0}, {5, 0, 0}, 5.0F);
    scene.cylinder({5, 40}, 10.0F, {0, -6});
    Conflict conflict;
    WorkBudget budget(kPlenty);
    ASSERT_TRUE(main_conflict(scene.situation(), way_of(scene.situation()), 8.0F, budget, conflict));
    EXPECT_NEAR(conflict.time_to_loss, (40.0F - 10.0F - 1.0F) / 6.0F, 2e-3F);
}

TEST(CylinderConflict, LeavingOneForGoodIsNone)
{
    Scene scene;
    scene.own.position = {8, 0, 0};
    scene.leg({8, 0, 0}, {60, 0, 0}, 5.0F);
    scene.cylinder({0, 0}, 10.0F);
    Conflict conflict;
    WorkBudget budget(kPlenty);
    EXPECT_FALSE(main_conflict(scene.situation(), way_of(scene.situation()), 8.0F, budget, conflict));
    scene.leg({8, 0, 0}, {-60, 0, 0}, 5.0F);
    ASSERT_TRUE(main_conflict(scene.situation(), way_of(scene.situation()), 8.0F, budget, conflict));
    EXPECT_EQ(conflict.time_to_loss, 0.0F);
}

/// The first loss decides, for any kind of threat.
TEST(CylinderConflict, WhatComesFirstIsTheMainThreat)
{
    Scene scene;
    scene.leg({0, 0, 0}, {100, 0, 0}, 5.0F);
    scene.cylinder({30, 0}, 5.0F);
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
    EXPECT_EQ(main_of(), (ThreatRef{ThreatKind::cylinder, 0}));
    scene.airspace.cylinders = {};
    EXPECT_EQ(main_of(), (ThreatRef{ThreatKind::obstacle, 0}));
}

TEST(CylinderConflict, ASpentBudgetIsAConflictNow)
{
    Scene scene;
    scene.leg({0, 0, 0}, {100, 0, 0}, 5.0F);
    scene.cylinder({40, 12}, 9.0F, {0.1F, -0.2F});
    Conflict conflict;
    WorkBudget ample(kPlenty);
    ASSERT_FALSE(main_conflict(scene.situation(), way_of(scene.situation()), 8.0F, ample, conflict));
    for (std::uint32_t n = 0; n < ample.spent(); ++n) {
        WorkBudget budget(n);
        ASSERT_TRUE(main_conflict(scene.situation(), way_of(scene.situation()), 8.0F, budget, conflict)) << n;
        ASSERT_EQ(conflict.time_to_loss, 0.0F) << n;
        ASSERT_EQ(conflict.threat.kind, ThreatKind::cylinder) << n;
    }
}

/// Along a route: around a corner, with the rest of the path.
TEST(CylinderConflict, AlongARouteIsSeenBehindItsCorner)
{
    Scene scene;
    const std::array<Vec3, 3> corners{Vec3(0, 0, 0), Vec3(20, 0, 0), Vec3(20, 60, 0)};
    path::Route route;
    ASSERT_EQ(route.add_leg(corners[0], corners[1]), path::RouteStatus::ok);
    ASSERT_EQ(route.add_leg(corners[1], corners[2]), path::RouteStatus::ok);
    scene.leg(corners[0], corners[1], 5.0F);
    scene.reference = world::Reference(route, scene.reference.speed);
    scene.cylinder({20, 20}, 6.0F);
    Conflict conflict;
    WorkBudget budget(kPlenty);
    ASSERT_TRUE(main_conflict(scene.situation(), way_of(scene.situation()), 10.0F, budget, conflict));
    EXPECT_EQ(conflict.threat, (ThreatRef{ThreatKind::cylinder, 0}));
    EXPECT_NEAR(conflict.time_to_loss, (20.0F + 13.0F) / 5.0F, 0.1F);
    EXPECT_NEAR(conflict.way_at_closest, 5.0F * conflict.time_to_closest, 0.5F);
    scene.cylinders[0].circle.centre.x() = -20.0F;
    EXPECT_FALSE(main_conflict(scene.situation(), way_of(scene.situation()), 10.0F, budget, conflict));
}

}  // namespace
}  // namespace jink::world
