// SPDX-License-Identifier: BSD-3-Clause
// The nominal path back to a leg and along it, and the leg that a reference holds.
#include "core/geometry/convex.hpp"

#include <gtest/gtest.h>

#include "tests/unit/core/world/scene.hpp"

namespace jink::world {
namespace {

using namespace test;

constexpr std::uint32_t kPlenty = 1'000'000;

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
