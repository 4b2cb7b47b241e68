// SPDX-License-Identifier: BSD-3-Clause
// Conflicts at the end of the look-ahead or of the path, threats in exact contact, and the cost of a check without a
// result.
#include <cmath>

#include <gtest/gtest.h>

#include "core/base/work_units.hpp"
#include "core/geometry/convex.hpp"
#include "core/world/conflict_parts.hpp"
#include "core/world/obstacle_distance.hpp"
#include "tests/unit/core/world/scene.hpp"

namespace jink::world {
namespace {

using namespace test;

/// Eastwards from the origin at 5 m/s, as a leg or as a route of one leg.
struct ConflictTies : testing::TestWithParam<bool> {
    ConflictTies() { way_to(Vec3(100, 0, 0)); }
    void way_to(const Vec3& end)
    {
        scene.leg(Vec3::Zero(), end, 5.0F);
        route = path::Route();
        EXPECT_EQ(route.add_leg(Vec3::Zero(), end), path::RouteStatus::ok);
        if (GetParam()) {
            scene.reference = Reference(route, scene.reference.speed);
        }
    }
    bool meets(Seconds lookahead = 10.0F, std::uint32_t units = kPlenty)
    {
        WorkBudget budget(units);
        const Situation s = scene.situation();
        const bool met = main_conflict(s, way_of(s), lookahead, budget, found);
        spent = budget.spent();
        return met;
    }
    /// Cost of a route before any check.
    [[nodiscard]] std::uint32_t before() const
    {
        Scene empty;
        empty.reference = scene.reference;
        empty.own = scene.own;
        WorkBudget budget(kPlenty);
        Conflict none;
        const Situation s = empty.situation();
        EXPECT_FALSE(main_conflict(s, way_of(s), 10.0F, budget, none));
        return budget.spent();
    }
    path::Route route;
    Scene scene;
    Conflict found;
    std::uint32_t spent = 0;
};

INSTANTIATE_TEST_SUITE_P(LegAndRoute, ConflictTies, testing::Bool());

/// A track without conflict costs one check per two phases, growing or not.
TEST_P(ConflictTies, ATrackThatIsNotMetIsNotLookedAtInParts)
{
    scene.track(Vec3(20, 60, 0), Vec3::Zero(), 1.0F);
    EXPECT_FALSE(meets());
    EXPECT_EQ(spent, before() + units::kConflict);
    scene.tracks[0].max_acceleration = 0.1F;
    EXPECT_FALSE(meets());
    EXPECT_EQ(spent, before() + units::kConflict);
}

/// Without look-ahead there is no conflict, and no part of the path is checked.
TEST_P(ConflictTies, WithoutTimeAheadNothingIsMet)
{
    scene.track(Vec3(1, 0, 0), Vec3(-5, 0, 0), 1.0F);
    EXPECT_FALSE(meets(0.0F));
    EXPECT_EQ(spent, before() + units::kConflict);
    scene.tracks.clear();
    scene.cylinder(Vec2(1, 0), 4.0F);
    EXPECT_FALSE(meets(0.0F));
    EXPECT_EQ(spent, before());
    scene.airspace.cylinders = {};
    scene.obstacle(geometry::make_sphere(Vec3(1, 0, 0), 1.0F));
    EXPECT_FALSE(meets(0.0F));
    EXPECT_EQ(spent, before());
}

/// At the end of its path a vehicle inside a sphere has no conflict that a path could resolve.
TEST_P(ConflictTies, AtItsEndInsideASphereThereIsNoConflict)
{
    way_to(Vec3(10, 0, 0));
    scene.own.position = Vec3(10, 0, 0);
    scene.obstacle(geometry::make_sphere(Vec3(11, 0, 0), 1.0F));
    EXPECT_FALSE(meets());
    EXPECT_EQ(spent, before());
}

/// Beside the path a cylinder in exact contact with the box counts, like an entered one.
TEST_P(ConflictTies, ACylinderThatTouchesExactlyIsMet)
{
    scene.cylinder(Vec2(30, 6), 4.5F);
    scene.rules.k_sigma = 1.0F;
    float& clearance = scene.own.sigma_position;
    const auto distance = [&] {
        WorkBudget budget(kPlenty);
        const geometry::Motion own{Vec3::Zero(), Vec3(5, 0, 0)};
        const detail::CylinderApproach approach(Vec3::Ones(), own, scene.cylinders[0], 0.0F, clearance, 0.0F);
        return approach.least(10.0F, 0.0F, budget).distance;
    };
    clearance = 0.4999F;
    EXPECT_FALSE(meets());
    while (distance() > 0.0F) {
        clearance = std::nextafter(clearance, 1.0F);
    }
    ASSERT_EQ(distance(), 0.0F);
    EXPECT_TRUE(meets());
    EXPECT_EQ(found.threat.kind, ThreatKind::cylinder);
    EXPECT_GT(found.time_to_loss, 0.0F);
}

/// Where the budget runs out before the way is known, all that is said is which obstacle it was, met now.
TEST_P(ConflictTies, BeforeAnythingIsLookedAtTheConflictIsNow)
{
    scene.obstacle(geometry::make_sphere(Vec3(40, 0, 0), 1.0F));
    scene.obstacle(geometry::make_box(Vec3(50, 0, 0), Vec3::Ones()));
    for (std::uint32_t n = 0; n < before() + units::kConflictSphere; ++n) {
        ASSERT_TRUE(meets(10.0F, n)) << n;
        ASSERT_EQ(found.time_to_loss, 0.0F) << n;
        ASSERT_EQ(found.margin, -kSeparationCap) << n;
        ASSERT_EQ(found.threat, (ThreatRef{ThreatKind::obstacle, 0})) << n;
        ASSERT_EQ(found.time_to_closest, 0.0F) << n;
    }
}

/// If the budget runs out during a cylinder's check, only the cylinder is reported, without a place.
TEST_P(ConflictTies, ACylinderThatIsNotPaidForHasNoPlace)
{
    scene.cylinder(Vec2(30, 0), 4.0F);
    for (std::uint32_t n = before(); n < before() + units::kConflictCylinder + units::kCylinderPart; ++n) {
        ASSERT_TRUE(meets(10.0F, n)) << n;
        ASSERT_EQ(found.threat, (ThreatRef{ThreatKind::cylinder, 0})) << n;
        ASSERT_EQ(found.time_to_loss, 0.0F) << n;
        ASSERT_EQ(found.miss_distance, 0.0F) << n;
        ASSERT_EQ(found.radius_at_closest, 0.0F) << n;
    }
}

/// For a hovering vehicle a nearly static track counts as static; a slightly faster one approaches until the end of the
/// look-ahead.
TEST_P(ConflictTies, WhatHardlyMovesIsNearestNow)
{
    way_to(Vec3(10, 0, 0));
    scene.own.position = Vec3(10, 0, 0);
    const float speed = 3.162e-5F;
    float aside = 0.0F;
    while (speed * speed + aside * aside < 1e-9F) {
        aside += 1e-11F;
    }
    ASSERT_EQ(Vec3(-speed, aside, 0).squaredNorm(), 1e-9F);
    scene.track(Vec3(12, 0, 0), Vec3(-speed, aside, 0), 2.0F);
    ASSERT_TRUE(meets());
    EXPECT_EQ(found.time_to_closest, 0.0F);
    scene.tracks[0].velocity.x() = -1.01F * speed;
    ASSERT_TRUE(meets());
    EXPECT_EQ(found.time_to_closest, 10.0F);
}

/// For any remaining budget, a track's conflict is now if the budget runs out, also while receding.
TEST_P(ConflictTies, ABudgetThatRunsOutWhileATrackDrawsApartIsAConflictNow)
{
    scene.track(Vec3(-2.5F, 0, 0), Vec3(-1, 0, 0), 1.0F).sigma_position = 0.3F;
    const auto predict = [&](std::uint32_t units) {
        WorkBudget budget(units);
        const Situation s = scene.situation();
        const bool met = test::predict_conflict(s, way_of(s), 0, 10.0F, budget, found);
        spent = budget.spent();
        return met;
    };
    ASSERT_FALSE(predict(kPlenty));
    const std::uint32_t all = spent;
    for (std::uint32_t n = 0; n < all; ++n) {
        ASSERT_TRUE(predict(n)) << n;
        ASSERT_EQ(found.time_to_loss, 0.0F) << n;
        ASSERT_LE(spent, n);
    }
    EXPECT_FALSE(predict(all));
}

/// A hovering vehicle is one piece: one check of its path, of the track, and of its two seconds.
TEST_P(ConflictTies, WhoHoversIsFollowedAsOnePiece)
{
    way_to(Vec3(10, 0, 0));
    scene.own.position = Vec3(10, 0, 0);
    scene.track(Vec3(12, 0, 0), Vec3(0.3F, 0, 0), 1.5F);
    EXPECT_FALSE(meets(2.0F)) << "it leaves at 0.3 m/s";
    WorkBudget budget(kPlenty);
    const path::PathPoint points[] = {{Vec3(10, 0, 0), Vec3::Zero(), 0.0F}, {Vec3(10, 0, 0), Vec3::Zero(), 2.0F}};
    static_cast<void>(least_separation(scene.situation(), points, 2.0F, budget, kDrawingApart, Cutoff{0.0F, 0.0F, {}}));
    EXPECT_EQ(spent, before() + units::kConflict + units::kConflictPart + budget.spent());
}

/// A wall inclined over the path ahead is reached after its centre was abeam: the reported closest approach is not
/// earlier than the loss.
TEST_P(ConflictTies, TheClosestApproachIsNoSoonerThanTheLoss)
{
    scene.obstacle(geometry::make_capsule(Vec3(-10, 40, 0), Vec3(30, 0, 0), 0.5F));
    ASSERT_TRUE(meets());
    EXPECT_GT(found.time_to_loss, 5.0F);
    EXPECT_EQ(found.time_to_closest, found.time_to_loss);
    scene.obstacles.clear();
    // Beside the path, equally fast: the centres' distance is constant, and the track grows to the box after more than
    // 2 s.
    scene.track(Vec3(0, 3, 0), Vec3(5, 0, 0), 1.0F).max_acceleration = 0.5F;
    ASSERT_TRUE(meets());
    EXPECT_GT(found.time_to_loss, 1.0F);
    EXPECT_EQ(found.time_to_closest, found.time_to_loss);
}

/// A track that reaches the box's size only when the box is far is no conflict.
TEST_P(ConflictTies, WhatGrowsBehindIsNotMet)
{
    scene.track(Vec3(0, 4, 0), Vec3::Zero(), 1.0F).max_acceleration = 0.1F;  // 6 m after 10 s
    EXPECT_FALSE(meets());
}

/// The path ends after 2 s. The flight counts until then, hovering afterwards.
TEST_P(ConflictTies, TheClosestApproachIsOnTheWayThatIsFlown)
{
    way_to(Vec3(10, 0, 0));
    // Over the path's end after a second, when the vehicle is half-way; closest approach half a second later.
    scene.track(Vec3(10, 5, 0), Vec3(0, -5, 0), 3.0F);
    ASSERT_TRUE(meets());
    EXPECT_NEAR(found.time_to_closest, 1.5F, 1e-3F);
    EXPECT_NEAR(found.miss_distance, 2.5F * std::sqrt(2.0F), 1e-3F);
    scene.tracks.clear();
    scene.track(Vec3(13, 0, 0), Vec3::Zero(), 3.0F);
    ASSERT_TRUE(meets());
    EXPECT_NEAR(found.time_to_closest, 2.0F, 1e-3F) << "on arrival, not beyond the end";
    scene.tracks[0].position = Vec3(16, 0, 0);
    scene.tracks[0].velocity = Vec3(-0.3F, 0, 0);
    ASSERT_TRUE(meets());
    EXPECT_EQ(found.time_to_closest, 10.0F) << "it comes nearer until the time is over";
}

/// Flown through at 1 s, and again while hovering, a metre less deep: the first time is reported, at its cost.
TEST_P(ConflictTies, ACylinderIsReportedWhereItIsDeepest)
{
    way_to(Vec3(10, 0, 0));
    scene.cylinder(Vec2(4, 1.5F), 6.0F, Vec2(1, 0.2F));
    scene.cylinders[0].bottom = -100.0F;
    scene.cylinders[0].top = 100.0F;
    scene.airspace.cylinders = scene.cylinders;
    scene.own.position = Vec3(-20, 0, 0);
    scene.leg(Vec3(-20, 0, 0), Vec3(10, 0, 0), 30.0F);
    route = path::Route();
    ASSERT_EQ(route.add_leg(Vec3(-20, 0, 0), Vec3(10, 0, 0)), path::RouteStatus::ok);
    if (GetParam()) {
        scene.reference = Reference(route, scene.reference.speed);
    }
    ASSERT_TRUE(meets());
    EXPECT_GT(found.time_to_loss, 0.0F);
    EXPECT_LT(found.time_to_closest, 1.0F);
    EXPECT_NEAR(found.margin, 0.7F - 6.0F, 0.2F);
    WorkBudget budget(kPlenty);
    const detail::CylinderApproach flown(Vec3::Ones(), {Vec3(-20, 0, 0), Vec3(30, 0, 0)}, scene.cylinders[0], 0.0F,
                                         0.0F, 0.0F);
    const geometry::Approach near = flown.least(1.0F, 0.0F, budget);
    static_cast<void>(flown.first_contact(near.when, budget));
    const detail::CylinderApproach hovered(Vec3::Ones(), {Vec3(10, 0, 0), Vec3::Zero()}, scene.cylinders[0], 1.0F, 0.0F,
                                           0.0F);
    static_cast<void>(hovered.least(9.0F, near.distance, budget));
    EXPECT_EQ(spent, before() + budget.spent() + 2 * units::kConflictCylinder);
}

/// Beyond the second corner nothing is nearer: an obstacle in conflict before it is nearest at the corner.
TEST(ConflictBehindCorners, AnObstacleBeyondACornerIsNearestAtTheCorner)
{
    Scene scene;
    path::Route route;
    ASSERT_EQ(route.add_leg(Vec3(0, 0, 0), Vec3(20, 0, 0)), path::RouteStatus::ok);
    ASSERT_EQ(route.add_leg(Vec3(20, 0, 0), Vec3(20, 20, 0)), path::RouteStatus::ok);
    ASSERT_EQ(route.add_leg(Vec3(20, 20, 0), Vec3(-20, 20, 0)), path::RouteStatus::ok);
    scene.leg(Vec3::Zero(), Vec3::Zero(), 5.0F);
    scene.reference = world::Reference(route, scene.reference.speed);
    scene.obstacle(geometry::make_sphere(Vec3(20, 24, 0), 3.5F));
    const Situation s = scene.situation();
    WorkBudget budget(kPlenty);
    Conflict found;
    ASSERT_TRUE(main_conflict(s, way_of(s), 12.0F, budget, found));
    EXPECT_NEAR(found.time_to_loss, 39.5F / 5.0F, 1e-3F);
    EXPECT_NEAR(found.time_to_closest, 8.0F, 1e-3F);
    EXPECT_NEAR(found.miss_distance, 4.0F, 1e-3F);
    // The same if the path ends at that corner: on arrival, not while hovering.
    path::Route shorter;
    ASSERT_EQ(shorter.add_leg(Vec3(0, 0, 0), Vec3(20, 0, 0)), path::RouteStatus::ok);
    ASSERT_EQ(shorter.add_leg(Vec3(20, 0, 0), Vec3(20, 20, 0)), path::RouteStatus::ok);
    scene.reference = world::Reference(shorter, scene.reference.speed);
    ASSERT_TRUE(main_conflict(scene.situation(), way_of(scene.situation()), 12.0F, budget, found));
    EXPECT_NEAR(found.time_to_closest, 8.0F, 1e-3F);
    scene.reference = world::Reference(route, scene.reference.speed);
    // The same of a track, also for that one alone: behind the first corner.
    scene.obstacles.clear();
    scene.track(Vec3(20, 10, 0), Vec3::Zero(), 1.0F);
    ASSERT_TRUE(test::predict_conflict(scene.situation(), way_of(s), 0, 12.0F, budget, found));
    EXPECT_NEAR(found.time_to_loss, 28.0F / 5.0F, 1e-3F);
    EXPECT_NEAR(found.way_at_closest, 30.0F, 1e-2F);
}

/// A nominal path without a speed is a place: nothing on it could mend what is there, and nothing is checked.
TEST(PlaceAsAWay, HasNoConflictWithWhatItIsInside)
{
    Scene scene;
    const Way place{Vec3(1, 2, 3), Vec3::UnitX(), 0.0F, 0.0F, {}};
    scene.obstacle(geometry::make_box(Vec3(1, 2, 3), Vec3::Ones()));
    Conflict found;
    WorkBudget no_more(units::kConflictLook);  // nothing for any threat
    const Situation s = scene.situation();
    EXPECT_FALSE(main_conflict(s, place, 10.0F, no_more, found));
    EXPECT_FALSE(conflict_with(s, place, s.threats.front(), 10.0F, no_more, found));
    EXPECT_FALSE(no_more.exhausted());
}

/// Of a box with unequal sides the share that overlaps a solid that is no box is one of the largest half extent.
TEST(ObstacleMarginTies, AnOverlapIsAShareOfTheLargestSide)
{
    const geometry::Shape wall = geometry::make_cylinder(Vec3(1, 0.75F, 0), Vec3(1, 9.75F, 0), 30.0F);
    WorkBudget budget(kPlenty);
    // A quarter of the side of a metre; the same share of three metres.
    const float margin = obstacle_margin(Vec3(0.5F, 1, 3), Vec3::Zero(), Vec3(2, 0, 0), wall, budget);
    EXPECT_LE(margin, -0.75F);
    EXPECT_GE(margin, -0.75F - 3.0F * kOverlapResolution);
}

/// Without a clearance there is one question less.
TEST(ObstacleMarginTies, AnOverlapWithoutAClearanceIsAskedForOnce)
{
    const geometry::Shape wall = geometry::make_cylinder(Vec3(1, 0.75F, 0), Vec3(1, 9.75F, 0), 30.0F);
    const auto cost = [&](float extra) {
        WorkBudget budget(kPlenty);
        EXPECT_LT(obstacle_margin(Vec3::Ones(), Vec3::Zero(), Vec3(2, 0, 0), wall, budget, extra), 0.0F);
        return budget.spent();
    };
    EXPECT_GE(cost(1e-6F), cost(0.0F) + units::kSolidQuery);
}

/// Within the clearance the distance is known already: one question whether the clearance is kept, and no more.
TEST(ObstacleMarginTies, WithinTheClearanceOneQuestionIsEnough)
{
    const geometry::Shape wall = geometry::make_box(Vec3(1, 6.5F, 0), Vec3(30, 5, 30));
    WorkBudget whole(kPlenty);
    EXPECT_LT(obstacle_margin(Vec3::Ones(), Vec3::Zero(), Vec3(2, 0, 0), wall, whole, 0.9F), 0.0F);
    WorkBudget parts(kPlenty);
    static_cast<void>(geometry::swept_box_distance(Vec3::Ones(), Vec3::Zero(), Vec3(2, 0, 0), wall, kObstacleReach,
                                                   kObstacleResolution, parts));
    static_cast<void>(geometry::swept_box_contact(Vec3::Ones(), Vec3::Zero(), Vec3(2, 0, 0), wall, 0.9F, parts));
    EXPECT_EQ(whole.spent(), parts.spent() + units::kBoxDepth);
}

}  // namespace
}  // namespace jink::world
