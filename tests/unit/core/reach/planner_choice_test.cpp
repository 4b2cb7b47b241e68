// SPDX-License-Identifier: BSD-3-Clause
// Which trajectory the reach planner takes: towards the goal, clear of threats, where it can stop.
#include <gtest/gtest.h>

#include <cmath>

#include "core/reach/planner.hpp"
#include "tests/unit/core/reach/planner_bench.hpp"

namespace jink::reach {
namespace {

using test::PlannerChoice;
using world::PlanStatus;

TEST_F(PlannerChoice, TheGoalIsThePointOfTheLegAheadOfTheVehicle)
{
    EXPECT_EQ(way(), Way::straight);
    // Off the leg: the path back to it.
    leg(Vec3(-20.0F, 4.0F, 30.0F), Vec3(500.0F, 4.0F, 30.0F));
    EXPECT_EQ(way(), Way::left);
    leg(Vec3(-20.0F, -4.0F, 30.0F), Vec3(500.0F, -4.0F, 30.0F));
    EXPECT_EQ(way(), Way::right);
    // Of a leg that leads aside the point 10.2 m on, wherever it began.
    leg(Vec3::Zero() + 30.0F * Vec3::UnitZ(), Vec3(500.0F, 300.0F, 30.0F));
    EXPECT_EQ(way(), Way::left);
    leg(Vec3(-100.0F, 60.0F, 30.0F), Vec3(500.0F, -300.0F, 30.0F));
    EXPECT_EQ(way(), Way::right);
}

TEST_F(PlannerChoice, TheGoalLiesOnTheLegNotOnTheWayBackToIt)
{
    // 1.2 m off the leg: its point 10.2 m ahead is 7.1 degrees to the left, the path there 5.7.
    leg(Vec3(-20.0F, 1.2F, 30.0F), Vec3(500.0F, 1.2F, 30.0F));
    EXPECT_EQ(way(), Way::left);
}

TEST_F(PlannerChoice, ALegThatHasNotBegunIsFlownToFromItsStart)
{
    // Its point abeam would be beside the grid's left end, its start is far ahead.
    leg(Vec3(100.0F, 3.0F, 30.0F), Vec3(500.0F, 3.0F, 30.0F));
    EXPECT_EQ(way(), Way::straight);
    // Its start lies to the left at 20 m, so that the leg's point abeam is far behind it.
    leg(Vec3(30.0F, 20.0F, 30.0F), Vec3(30.0F, 200.0F, 30.0F));
    EXPECT_EQ(way(), Way::left);
    // Without the bound the goal would lie behind the start: at the right.
    leg(Vec3(12.0F, 6.0F, 30.0F), Vec3(12.0F, 200.0F, 30.0F));
    own.position = Vec3(0.0F, -30.0F, 30.0F);
    EXPECT_EQ(way(), Way::left);
}

TEST_F(PlannerChoice, ALegThatEndsWithinTheGridIsFlownToItsEnd)
{
    leg(Vec3(-20.0F, 0.0F, 30.0F), Vec3(0.5F + 6.0F, 0.0F, 30.0F));
    ASSERT_EQ(plan(), PlanStatus::found);
    EXPECT_NEAR(end().x(), 0.5F + 7.5F, 1e-3F) << "the third movement ends in the cell of the leg's end";
    EXPECT_EQ(report().path, PathStatus::found);
    leg(Vec3(-20.0F, 0.0F, 30.0F), Vec3(0.5F + 4.0F, 0.0F, 30.0F));
    ASSERT_EQ(plan(), PlanStatus::found);
    EXPECT_NEAR(end().x(), 0.5F + 5.0F, 1e-3F);
    // The goal is at most 1.02 of the grid's range away, and outside the grid if the leg continues.
    leg(Vec3(-20.0F, 0.0F, 30.0F), Vec3(0.5F + 10.05F, 0.0F, 30.0F));
    EXPECT_EQ(way(), Way::straight);
}

TEST_F(PlannerChoice, ALegOfNoLengthIsFlownTowards)
{
    leg(Vec3(0.0F, 100.0F, 30.0F), Vec3(0.0F, 100.0F, 30.0F));
    EXPECT_EQ(way(), Way::left) << "the way leads there";
    leg(Vec3(0.0F, -100.0F, 30.0F), Vec3(0.0F, -100.0F, 30.0F));
    EXPECT_EQ(way(), Way::right);
}

TEST_F(PlannerChoice, ARouteIsFollowedAlongItsWayToItsEnd)
{
    path::Route route;
    ASSERT_EQ(route.add_leg(Vec3(0, 0, 30), Vec3(500, 300, 30)), path::RouteStatus::ok);
    leg(Vec3(0, 0, 30), Vec3(500, -300, 30));
    reference = world::Reference(route, reference.speed);
    EXPECT_EQ(way(), Way::left) << "not along the leg";
    // 6.4 degrees to the left: from the position at which the vehicle responds, the point 10.2 m ahead is in the column
    // to the left (from 6.55 degrees on), a far point is not.
    path::Route long_one;
    ASSERT_EQ(long_one.add_leg(Vec3(0, 0, 30), Vec3(500.0F, 56.1F, 30)), path::RouteStatus::ok);
    reference = world::Reference(long_one, reference.speed);
    EXPECT_EQ(way(), Way::left);
    path::Route ends;
    ASSERT_EQ(ends.add_leg(Vec3(-20, 0, 30), Vec3(6.5F, 0, 30)), path::RouteStatus::ok);
    reference = world::Reference(ends, reference.speed);
    ASSERT_EQ(plan(), PlanStatus::found);
    EXPECT_NEAR(end().x(), 8.0F, 1e-3F);
}

TEST_F(PlannerChoice, CellsAtTheSidesNearerThanTheRuleSaysAreNoExits)
{
    // To the left it ends at the side in the third layer, straight on in the fourth.
    const Grid<float> narrow(4, 3, 3, 4.0F, 0.5F, 0.5F);
    test::SmallTree tree(narrow);
    NodeIndex at = tree.add(0, Movement::left, 100);
    at = tree.add(at, Movement::left, 200);
    at = tree.add(at, Movement::left, 300);
    tree.chain(Movement::straight, 4, 100);
    only(tree);
    ASSERT_TRUE(narrow.place(tree.end(at)) == (CellPlace{2, 2, 1}));
    leg(Vec3(0.0F, 0.0F, 30.0F), Vec3(0.0F, 500.0F, 30.0F));
    settings.least_outer_layer = 2;
    ASSERT_EQ(plan(), PlanStatus::found);
    EXPECT_GT(end().y(), 2.0F);
    settings.least_outer_layer = 3;
    ASSERT_EQ(plan(), PlanStatus::found);
    EXPECT_NEAR(end().y(), 0.0F, 1e-3F);
}

// --- threats ---

TEST_F(PlannerChoice, RoomToSpareComesFirstAndIsGivenUpForWantOfBetter)
{
    add_sphere(Vec3(8.0F, 0.0F, 30.0F + 0.5F + 0.3F + 0.45F), 0.3F);
    EXPECT_NE(way(), Way::straight) << "0.45 m above the way, which bends by up to 0.12 m";
    EXPECT_EQ(report().run, AvoidanceRun::soft_constraints);
    obstacles.clear();
    add_sphere(Vec3(8.0F, 0.0F, 30.0F + 0.5F + 0.3F + 1.5F), 0.3F);
    EXPECT_EQ(way(), Way::straight) << "1.5 m above it";
    rules.clearance = 2.0F;
    EXPECT_NE(way(), Way::straight);
    rules.clearance = 0.4F;
    test::SmallTree alone(kGrid);
    alone.chain(Movement::straight, 1, 1024);
    only(alone);
    obstacles.clear();
    add_sphere(Vec3(2.0F, 0.0F, 30.0F + 0.5F + 0.3F + 0.3F), 0.3F);
    ASSERT_EQ(plan(), PlanStatus::found);
    EXPECT_EQ(report().run, AvoidanceRun::hard_constraints);
    EXPECT_EQ(report().free_nodes, 1) << "free in the run of the answer";
}

TEST_F(PlannerChoice, NothingThatMeetsAnIntruderIsTakenForWantOfBetter)
{
    add_track(Vec3(3.0F, 0.0F, 30.0F), Vec3::Zero(), 0.4F);
    EXPECT_EQ(way(), Way::nothing) << "it stands on all first movements";
    tracks.clear();
    add_track(Vec3(0.5F + 5.0F, 0.0F, 30.0F), Vec3::Zero(), 0.1F);
    ASSERT_NE(way(), Way::straight);
    EXPECT_NE(way(), Way::nothing);
}

TEST_F(PlannerChoice, AnIntruderIsMetWhereItIsWhenTheVehicleIsThere)
{
    // Comes down through (8, 0): when the vehicle is there, at 1.6 s from now, or 1 s before or after that.
    const auto when = [&](float t) {
        tracks.clear();
        add_track(Vec3(8.0F, 0.0F, 30.0F + 10.0F * t), Vec3(0.0F, 0.0F, -10.0F), 0.3F);
        return way();
    };
    EXPECT_NE(when(1.6F), Way::straight);
    EXPECT_EQ(when(0.6F), Way::straight);
    EXPECT_EQ(when(2.6F), Way::straight);
}

TEST_F(PlannerChoice, AClosedVolumeIsNeverEnteredAndItsMarginLast)
{
    test::SmallTree alone(kGrid);
    alone.chain(Movement::straight, 1, 1024);
    only(alone);
    world::Cylinder cylinder;
    cylinder.circle = {world::Vec2(3.0F, 2.0F), 1.0F};
    cylinder.bottom = 0.0F;
    cylinder.top = 100.0F;
    cylinder.margin = 2.0F;
    airspace.cylinders = {&cylinder, 1};
    ASSERT_EQ(plan(), PlanStatus::found);
    EXPECT_EQ(report().run, AvoidanceRun::hard_constraints) << "through the margin";
    cylinder.circle.centre.y() = 1.4F;
    EXPECT_EQ(plan(), PlanStatus::none_available) << "its body";
    cylinder.circle.centre.y() = 5.0F;
    ASSERT_EQ(plan(), PlanStatus::found);
    EXPECT_EQ(report().run, AvoidanceRun::soft_constraints);
}

TEST_F(PlannerChoice, AStartThatTouchesMayBeLeftByTheEscapeRule)
{
    // 5 cm inside a static sphere behind.
    add_sphere(Vec3(-0.95F, 0.0F, 30.0F), 0.5F);
    rules.latency = 0.0F;
    rules.escape = {1.0F, 0.5F};
    EXPECT_EQ(way(), Way::straight);
    rules.escape.speed = 5.0F;
    EXPECT_EQ(way(), Way::nothing) << "a rule that asks to draw apart faster";
    rules.escape = {0.0F, 0.0F};
    EXPECT_EQ(way(), Way::nothing) << "a rule that asks not to come nearer by anything";
    obstacles.clear();
    add_sphere(Vec3(0.95F, 0.0F, 30.0F), 0.5F);
    rules.escape = {0.25F, 0.5F};
    EXPECT_EQ(way(), Way::nothing) << "deeper is no escape";
}

// --- the stop at the end ---

TEST_F(PlannerChoice, AMultirotorHasToStopAtTheEndOfItsPath)
{
    // The path ends at 10.5 m, the stop at 13.2; a wall from 12.5 on.
    add_box(Vec3(13.0F, 0.0F, 30.0F), Vec3(0.5F, 1.0F, 5.0F));
    const Way taken = way();
    EXPECT_TRUE(taken == Way::left || taken == Way::right);
    EXPECT_EQ(report().tries, 2);
    limits.kind = vehicle::VehicleKind::fixed_wing;
    EXPECT_EQ(way(), Way::straight) << "a wing flies on";
    EXPECT_EQ(report().tries, 1);
    limits.kind = vehicle::VehicleKind::multirotor;
    obstacles.clear();
    add_box(Vec3(14.8F, 0.0F, 30.0F), Vec3(0.5F, 1.0F, 5.0F));
    EXPECT_EQ(way(), Way::straight) << "beyond the stop";
}

TEST_F(PlannerChoice, EndsAreTriedAsOftenAsTheSettingsSay)
{
    add_box(Vec3(13.0F, 0.0F, 30.0F), Vec3(0.5F, 1.0F, 5.0F));
    settings.tries = 1;
    EXPECT_EQ(plan(), PlanStatus::none_available);
    EXPECT_EQ(report().tries, 1);
    EXPECT_TRUE(out.path.points.empty());
    settings.tries = 2;
    EXPECT_EQ(plan(), PlanStatus::found);
    EXPECT_EQ(report().tries, 2);
}

/// An end is excluded, not the trajectories through it.
TEST_F(PlannerChoice, WaysThroughAnEndThatDoesNotDoAreKept)
{
    test::SmallTree chain(kGrid);
    chain.chain(Movement::straight, 2, 1024);
    only(chain);
    leg(Vec3(-20.0F, 0.0F, 30.0F), Vec3(0.5F + 2.0F, 0.0F, 30.0F));
    // Falls through the place where the vehicle would stop after one movement, at the time of the stop.
    add_track(Vec3(5.5F, 0.0F, 30.0F + 20.0F * 1.7F), Vec3(0.0F, 0.0F, -20.0F), 0.3F);
    ASSERT_EQ(plan(), PlanStatus::found);
    EXPECT_EQ(report().tries, 2);
    EXPECT_NEAR(end().x(), 5.5F, 1e-3F) << "the second movement is by then past it";
}

/// The stop takes 1.555 s after the path's end, at 2.1 s from now; then the vehicle is static at 13.1 m.
TEST_F(PlannerChoice, WhatCrossesTheStopCountsWhileTheVehicleIsThere)
{
    const auto falling = [&](float x, float t) {
        tracks.clear();
        add_track(Vec3(x, 0.0F, 30.0F + 20.0F * t), Vec3(0.0F, 0.0F, -20.0F), 0.3F);
        return way();
    };
    EXPECT_NE(falling(12.5F, 2.6F), Way::straight);
    EXPECT_NE(falling(13.0F, 3.5F), Way::straight) << "at the end of the stop";
    EXPECT_EQ(falling(13.0F, 3.8F), Way::straight) << "after it";
    EXPECT_EQ(falling(13.0F, 1.9F), Way::straight) << "before the vehicle comes";
    EXPECT_EQ(falling(13.0F, 0.5F), Way::straight);
    EXPECT_NE(falling(11.5F, 2.3F), Way::straight);
    limits.kind = vehicle::VehicleKind::fixed_wing;
    EXPECT_EQ(falling(11.5F, 2.3F), Way::straight) << "a wing has no stop";
}

TEST_F(PlannerChoice, TheStopCountsFromThePathsEndNotFromTheLatency)
{
    rules.latency = 1.0F;
    ASSERT_EQ(plan(), PlanStatus::found);
    const Vec3 alone = end();
    ASSERT_NEAR(alone.x(), 12.5F, 1e-3F);
    const auto falling = [&](float t) {
        tracks.clear();
        add_track(Vec3(15.0F, 0.0F, 30.0F + 20.0F * t), Vec3(0.0F, 0.0F, -20.0F), 0.3F);
        return plan() == PlanStatus::found && end() == alone;
    };
    // The path ends after 2.5 s, the stop after 4.055 s at 15.16 m.
    EXPECT_FALSE(falling(3.9F));
    EXPECT_TRUE(falling(4.4F)) << "1 s more would be too much";
}

}  // namespace
}  // namespace jink::reach
