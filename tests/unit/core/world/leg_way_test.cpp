// SPDX-License-Identifier: BSD-3-Clause
// The nominal path back to a leg and along it, and the leg that a reference holds.
#include "core/geometry/convex.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/unit/core/world/scene.hpp"

namespace jink::world {
namespace {

using namespace test;

constexpr std::uint32_t kPlenty = 1'000'000;

TEST(WayToALeg, OnTheLegAimsAtItsEnd)
{
    Scene scene;
    scene.leg(Vec3::Zero(), Vec3(100, 0, 0), 5.0F);
    scene.own.position = Vec3(20, 0.2F, 0);
    const Way way = way_of(scene.situation());
    EXPECT_EQ(way.origin, scene.own.position);
    EXPECT_NEAR(way.direction.x(), 1.0F, 1e-5F);
    EXPECT_NEAR(way.length, 80.0F, 1e-3F);
    EXPECT_FLOAT_EQ(way.speed, 5.0F);
}

TEST(WayToALeg, OffTheLegAimsAheadOnIt)
{
    Scene scene;
    scene.leg(Vec3::Zero(), Vec3(100, 0, 0), 5.0F);
    scene.own.position = Vec3(20, 12, 0);
    const Way way = way_of(scene.situation());
    EXPECT_NEAR((way.direction - Vec3(12, -12, 0).normalized()).norm(), 0.0F, 1e-5F);
    EXPECT_NEAR(way.length, 12.0F * std::sqrt(2.0F) + 68.0F, 1e-3F);
}

TEST(WayToALeg, AFixedWingComesBackGentlyAndWithinItsClimb)
{
    Scene scene;
    scene.limits.kind = vehicle::VehicleKind::fixed_wing;
    scene.limits.cruise_speed = 18.0F;
    scene.limits.max_climb = scene.limits.max_descent = 2.0F;
    scene.leg(Vec3::Zero(), Vec3(900, 0, 0), 18.0F);
    scene.own.position = Vec3(20, 20, 0);
    EXPECT_NEAR((way_of(scene.situation()).direction - Vec3(72, -20, 0).normalized()).norm(), 0.0F, 1e-5F)
        << "4 s of flight";
    for (const float height : {-20.0F, 20.0F}) {
        scene.own.position = Vec3(20, 0, height);
        const Way way = way_of(scene.situation());
        EXPECT_LE(std::abs(way.direction.z()) * 18.0F, 2.001F) << "as steep as it climbs";
        EXPECT_NEAR(way.speed, 18.0F, 0.1F) << "it does not fly slower";
    }
}

TEST(WayToALeg, NearItsEndAimsAtTheEndFromTheSide)
{
    Scene scene;
    scene.leg(Vec3::Zero(), Vec3(100, 0, 0), 5.0F);
    scene.own.position = Vec3(97, 4, 0);
    const Way way = way_of(scene.situation());
    EXPECT_NEAR((way.direction - Vec3(3, -4, 0) / 5.0F).norm(), 0.0F, 1e-5F);
    EXPECT_NEAR(way.length, 5.0F, 1e-4F);
}

TEST(WayToALeg, BehindItsStartAndBeyondItsEnd)
{
    Scene scene;
    scene.leg(Vec3::Zero(), Vec3(100, 0, 0), 5.0F);
    scene.own.position = Vec3(-30, 0, 0);
    EXPECT_NEAR(way_of(scene.situation()).direction.x(), 1.0F, 1e-6F);
    scene.own.position = Vec3(110, 0, 0);
    const Way back = way_of(scene.situation());
    EXPECT_NEAR(back.direction.x(), -1.0F, 1e-6F);
    EXPECT_NEAR(back.length, 10.0F, 1e-4F);
}

TEST(WayToALeg, AtTheEndKeepsTheLegsDirection)
{
    Scene scene;
    scene.leg(Vec3::Zero(), Vec3(0, 50, 0), 5.0F);
    scene.own.position = Vec3(0, 50, 0);
    const Way way = way_of(scene.situation());
    EXPECT_EQ(way.length, 0.0F);
    EXPECT_NEAR((way.direction - Vec3(0, 1, 0)).norm(), 0.0F, 1e-6F);
}

TEST(WayToALeg, AVerticalLegIsClimbedAtTheClimbLimit)
{
    Scene scene;
    scene.limits.max_climb = 2.0F;
    scene.limits.max_descent = 1.0F;
    scene.leg(Vec3::Zero(), Vec3(0, 0, 40), 5.0F);
    scene.own.position = Vec3(0, 0, 10);
    EXPECT_FLOAT_EQ(way_of(scene.situation()).speed, 2.0F);
    EXPECT_NEAR(way_of(scene.situation()).length, 30.0F, 1e-4F);
    scene.leg(Vec3(0, 0, 40), Vec3::Zero(), 5.0F);
    EXPECT_FLOAT_EQ(way_of(scene.situation()).speed, 1.0F);
    EXPECT_NEAR(way_of(scene.situation()).direction.z(), -1.0F, 1e-6F);
}

TEST(WayToALeg, ALegWithoutLengthIsAPlaceToGo)
{
    Scene scene;
    scene.leg(Vec3(5, 5, 5), Vec3(5, 5, 5), 5.0F);
    scene.own.position = Vec3(5, 5, 5);
    EXPECT_EQ(way_of(scene.situation()).length, 0.0F);
    EXPECT_NEAR(way_of(scene.situation()).direction.norm(), 1.0F, 1e-6F);
    scene.own.position = Vec3(5, 0, 5);
    const Way way = way_of(scene.situation());
    EXPECT_NEAR((way.direction - Vec3(0, 1, 0)).norm(), 0.0F, 1e-6F);
    EXPECT_NEAR(way.length, 5.0F, 1e-5F);
}

/// Before its start a leg is joined ahead of the start, not before it.
TEST(WayToALeg, BeforeItsStartAimsAheadOfTheStart)
{
    Scene scene;
    scene.leg(Vec3::Zero(), Vec3(100, 0, 0), 5.0F);
    scene.own.position = Vec3(-20, 10, 0);
    const Vec3 aim(kRejoinLookahead, 0, 0);
    EXPECT_NEAR((way_of(scene.situation()).direction - (aim - scene.own.position).normalized()).norm(), 0.0F, 1e-5F);
}

/// Off a leg the way meets the leg ahead and follows it from there: what is on the leg is met, what lies straight on
/// past the leg is not.
TEST(WayToALeg, BendsWhereItMeetsTheLeg)
{
    Scene scene;
    scene.leg(Vec3::Zero(), Vec3(200, 0, 0), 5.0F);
    scene.own.position = Vec3(50, 9, 0);
    const Way way = way_of(scene.situation());
    EXPECT_NEAR(way.ahead.straight, 15.0F, 1e-4F);
    EXPECT_NEAR(way.length, 15.0F + 138.0F, 1e-3F);
    Conflict found;
    WorkBudget budget(kPlenty);
    scene.obstacle(geometry::make_sphere(Vec3(74, -9, 0), 1.0F));
    EXPECT_FALSE(main_conflict(scene.situation(), way_of(scene.situation()), 10.0F, budget, found));
    scene.obstacle(geometry::make_sphere(Vec3(90, 0, 0), 1.0F));
    ASSERT_TRUE(main_conflict(scene.situation(), way_of(scene.situation()), 10.0F, budget, found));
    EXPECT_EQ(found.threat, (ThreatRef{ThreatKind::obstacle, 1}));
    EXPECT_NEAR(found.time_to_closest, (15.0F + 28.0F) / 5.0F, 1e-4F);
    EXPECT_NEAR(found.way_at_closest, 43.0F, 1e-3F);
    EXPECT_NEAR((found.own_at_closest - Vec3(90, 0, 0)).norm(), 0.0F, 1e-3F);
}

/// The nearest point to a large obstacle may lie beyond the time that is looked ahead.
TEST(WayToALeg, WhatIsMetInTimeMayBeNearestLater)
{
    Scene scene;
    scene.leg(Vec3::Zero(), Vec3(200, 0, 0), 5.0F);
    scene.obstacle(geometry::make_sphere(Vec3(60, 0, 0), 15.0F));
    Conflict found;
    WorkBudget budget(kPlenty);
    ASSERT_TRUE(main_conflict(scene.situation(), way_of(scene.situation()), 10.0F, budget, found));
    EXPECT_LT(found.time_to_loss, 10.0F);
    EXPECT_NEAR(found.time_to_closest, 12.0F, 1e-3F);
}

/// A reference holds its leg itself: a copy is flown whatever becomes of the first one.
TEST(ReferenceOfALeg, ACopyHoldsItsOwnLeg)
{
    Reference first({Vec3(1, 2, 3), Vec3(1, 12, 3), 4.0F});
    const Reference copy = first;
    first = Reference({Vec3::Zero(), Vec3(0, 0, 50), 1.0F});
    ASSERT_EQ(copy.route().segments().size(), 1U);
    EXPECT_EQ(copy.route().at(10.0F).position, Vec3(1, 12, 3));
    EXPECT_EQ(copy.route().length(), 10.0F);
    EXPECT_EQ(copy.speed, 4.0F);
    EXPECT_TRUE(copy.valid);
    EXPECT_FALSE(Reference().valid);
}

/// A leg of a millimetre gives no direction: the way points east. One that is a little longer does.
TEST(ShortLegs, AMillimetreGivesNoDirection)
{
    Scene scene;
    scene.leg(Vec3::Zero(), Vec3(0, 1e-3F, 0), 5.0F);
    scene.own.position = Vec3(0, 1e-3F, 0);
    EXPECT_EQ(way_of(scene.situation()).direction, Vec3(1, 0, 0));
    scene.leg(Vec3::Zero(), Vec3(0, 1.01e-3F, 0), 5.0F);
    EXPECT_EQ(way_of(scene.situation()).direction, Vec3(0, 1, 0));
}

/// What is shorter than a millimetre is the point where it ends.
TEST(ShortLegs, ArePlacesAtTheirEnd)
{
    const path::RouteSegment place = path::straight_segment(Vec3(1, 2, 3), Vec3(1, 2, 3.0005F));
    EXPECT_EQ(place.start, Vec3(1, 2, 3.0005F));
    EXPECT_EQ(place.length, 0.0F);
    EXPECT_EQ(place.along, Vec3(1, 0, 0));
    Scene scene;
    scene.leg(Vec3(8, 0, 0), Vec3(8, 0, 0), 5.0F);
    const Way way = way_of(scene.situation());
    EXPECT_EQ(way.direction, Vec3(1, 0, 0));
    EXPECT_EQ(way.length, 8.0F);
    Conflict found;
    WorkBudget budget(kPlenty);
    scene.track(Vec3(8, 30, 0), Vec3(0, -5, 0), 1.0F);
    ASSERT_TRUE(main_conflict(scene.situation(), way, 10.0F, budget, found));
    EXPECT_EQ(found.own_at_closest, Vec3(8, 0, 0)) << "it hovers there";
}

}  // namespace
}  // namespace jink::world
