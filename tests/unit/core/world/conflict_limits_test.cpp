// SPDX-License-Identifier: BSD-3-Clause
// Conflicts at the limits of their contract: own uncertainty, ties, paths that end, and budgets that run out.
#include <cmath>

#include <gtest/gtest.h>

#include "core/base/work_units.hpp"
#include "core/world/conflict_parts.hpp"
#include "tests/numbers.hpp"
#include "tests/unit/core/world/scene.hpp"

namespace jink::world {
namespace {

using namespace test;

/// Eastwards from the origin at 5 m/s, as a leg or as a route of one leg. A box of 3 x 2 x 1 m half extents, uncertain
/// by half a metre (two deviations of 0.25 m).
struct ConflictLimits : testing::TestWithParam<bool> {
    ConflictLimits()
    {
        scene.limits.half_extents = Vec3(3, 2, 1);
        scene.own.sigma_position = 0.25F;
        scene.rules.k_sigma = 2.0F;
        way_to(Vec3(100, 0, 0));
    }
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
    path::Route route;
    Scene scene;
    Conflict found;
    std::uint32_t spent = 0;
};

INSTANTIATE_TEST_SUITE_P(LegAndRoute, ConflictLimits, testing::Bool());

TEST_P(ConflictLimits, ATrackIsMetByTheUncertainBoxAndAtItsAge)
{
    // Two seconds old: 1 m of body, 0.5 m of either place, 0.2 m/s for its age, 0.2 m/s2 from its stamp on.
    Track& track = scene.track(Vec3(60, 0, 0), Vec3(-5, 0, 0), 1.0F);
    track.stamp = scene.now - 2.0F;
    track.sigma_position = 0.25F;
    track.sigma_velocity = 0.1F;
    track.max_acceleration = 0.2F;
    ASSERT_TRUE(meets());
    const auto radius = [](float t) {
        return 1.0F + std::sqrt(0.5F) + 0.2F * (t + 2.0F) + 0.1F * (t + 2.0F) * (t + 2.0F);
    };
    // Contact at t with 60 - 10 t = 3 + radius(t): a little before 4.6 s.
    const float loss = found.time_to_loss;
    EXPECT_LE(60.0F - 10.0F * loss, 3.0F + radius(loss + 0.5F) + 1e-3F);
    EXPECT_GE(60.0F - 10.0F * loss, 3.0F + radius(loss) - 1e-3F);
    EXPECT_NEAR(found.time_to_closest, 6.0F, 1e-4F);
    EXPECT_NEAR(found.radius_at_closest, radius(6.0F), 1e-4F);
    EXPECT_NEAR(found.margin, -radius(6.0F), 1e-3F);
    EXPECT_NEAR((found.own_at_closest - Vec3(30, 0, 0)).norm(), 0.0F, 1e-3F);
    EXPECT_NEAR((found.threat_at_closest - Vec3(30, 0, 0)).norm(), 0.0F, 1e-3F);
}

/// Beside the path: the box's own side and its uncertainty; a centimetre farther is no conflict.
TEST_P(ConflictLimits, WhatIsJustBesideTheUncertainBoxIsNone)
{
    const auto beside = [&](float y, float z) {
        scene.tracks.clear();
        scene.obstacles.clear();
        scene.cylinders.clear();
        scene.track(Vec3(30, y, z), Vec3::Zero(), 1.0F);
        const bool track = meets();
        scene.tracks.clear();
        scene.obstacle(geometry::make_sphere(Vec3(30, y, z), 1.0F));
        EXPECT_EQ(meets(), track) << y << ' ' << z;
        scene.obstacles.clear();
        scene.obstacle(geometry::make_box(Vec3(30, y, z), Vec3(1, 1, 1)));
        EXPECT_EQ(meets(), track) << y << ' ' << z;
        scene.obstacles.clear();
        if (z == 0.0F) {
            scene.cylinder(Vec2(30, y), 1.0F);
            EXPECT_EQ(meets(), track) << y << ' ' << z;
            scene.airspace.cylinders = {};
        }
        return track;
    };
    EXPECT_TRUE(beside(3.49F, 0));
    EXPECT_FALSE(beside(3.51F, 0));
    EXPECT_TRUE(beside(-3.49F, 0));
    EXPECT_FALSE(beside(-3.51F, 0));
    EXPECT_TRUE(beside(0, 2.49F));
    EXPECT_FALSE(beside(0, 2.51F));
    EXPECT_TRUE(beside(0, -2.49F));
    EXPECT_FALSE(beside(0, -2.51F));
    scene.rules.k_sigma = 4.0F;
    EXPECT_TRUE(beside(3.99F, 0));
    EXPECT_FALSE(beside(4.01F, 0));
}

/// Inside the margin of the uncertainty: "drawing apart" is relative to that margin.
TEST_P(ConflictLimits, DrawingApartIsJudgedWithTheSameUncertainty)
{
    // Half a metre inside of 1 + 6 * 0.25 m, and 1.75 m outside of the body alone.
    scene.rules.k_sigma = 6.0F;
    const auto starts = [&](float gap, const Vec3& velocity) {
        scene.tracks.clear();
        scene.track(Vec3(-3.0F - gap, 0, 0), velocity, 1.0F);
        return meets();
    };
    EXPECT_FALSE(starts(2.0F, Vec3(4, 0, 0))) << "1 m/s faster than it";
    EXPECT_TRUE(starts(2.0F, Vec3(5, 0, 0))) << "as fast as it";
    EXPECT_EQ(found.time_to_loss, 0.0F);
    EXPECT_TRUE(starts(2.0F, Vec3(5.2F, 0, 0)));
    EXPECT_FALSE(starts(2.6F, Vec3(5, 0, 0))) << "outside";
    scene.rules.k_sigma = 1.0F;
    EXPECT_FALSE(starts(2.0F, Vec3(5, 0, 0))) << "outside of a smaller margin";
    EXPECT_TRUE(starts(1.0F, Vec3(5, 0, 0)));
}

/// Each threat is judged separately, independent of the others.
TEST_P(ConflictLimits, DrawingApartIsJudgedForEachByItself)
{
    scene.track(Vec3(-4.4F, 0, 0), Vec3(-5, 0, 0), 1.0F);
    scene.airspace.has_floor = true;
    scene.airspace.floor = 10.0F;
    EXPECT_FALSE(meets());
    scene.track(Vec3(40, 0, 0), Vec3::Zero(), 1.0F);
    ASSERT_TRUE(meets());
    EXPECT_EQ(found.threat.index, 1U);
    EXPECT_GT(found.time_to_loss, 6.0F);
}

/// Tracks, cylinders, obstacles: of two conflicts at the same time with the same margin the first in that order.
TEST_P(ConflictLimits, TiesGoByKindAndIndex)
{
    scene.own.sigma_position = 0.0F;
    scene.obstacle(geometry::make_sphere(Vec3(40, 0, 0), 1.0F));
    scene.obstacle(geometry::make_sphere(Vec3(40, 0, 0), 1.0F));
    ASSERT_TRUE(meets());
    EXPECT_EQ(found.threat, (ThreatRef{ThreatKind::obstacle, 0}));
    scene.track(Vec3(40, 0, 0), Vec3::Zero(), 1.0F);
    scene.track(Vec3(40, 0, 0), Vec3::Zero(), 1.0F);
    ASSERT_TRUE(meets());
    EXPECT_EQ(found.threat, (ThreatRef{ThreatKind::track, 0}));
    scene.tracks[1].radius = 1.5F;
    scene.tracks[1].position.x() = 40.5F;  // contact at the same time, deeper
    ASSERT_TRUE(meets());
    EXPECT_EQ(found.threat, (ThreatRef{ThreatKind::track, 1}));
    scene.tracks.clear();
    scene.obstacles[1].shape = geometry::make_sphere(Vec3(40.5F, 0, 0), 1.5F);
    ASSERT_TRUE(meets());
    EXPECT_EQ(found.threat, (ThreatRef{ThreatKind::obstacle, 1}));
    scene.obstacles.clear();
    scene.cylinders.assign(2, {{{40, 0}, 3.0F}, Vec2::Zero(), -20.0F, 20.0F, 0.0F});
    scene.airspace.cylinders = scene.cylinders;
    ASSERT_TRUE(meets());
    EXPECT_EQ(found.threat, (ThreatRef{ThreatKind::cylinder, 0}));
}

/// Of equally near instants the first is reported: without relative motion, now.
TEST_P(ConflictLimits, OfEquallyNearInstantsTheFirstIsReported)
{
    scene.own.sigma_position = 0.0F;
    scene.track(Vec3(0, 2.5F, 0), Vec3(5, 0, 0), 1.0F);
    ASSERT_TRUE(meets());
    EXPECT_EQ(found.time_to_loss, 0.0F);
    EXPECT_EQ(found.time_to_closest, 0.0F);
    EXPECT_NEAR(found.miss_distance, 2.5F, 1e-5F);
}

/// Beyond the path's end static threats give no contact; moving threats do.
TEST_P(ConflictLimits, WhoHoversMeetsWhatComes)
{
    way_to(Vec3(10, 0, 0));
    scene.obstacle(geometry::make_box(Vec3(30, 0, 0), Vec3(1, 1, 1)));
    scene.obstacle(geometry::make_sphere(Vec3(30, 0, 0), 1.0F));
    EXPECT_FALSE(meets());
    scene.own.position = Vec3(10, 0, 0);
    EXPECT_FALSE(meets()) << "at its end";
    scene.track(Vec3(10, 40, 0), Vec3(0, -5, 0), 1.0F);
    ASSERT_TRUE(meets());
    EXPECT_EQ(found.threat.kind, ThreatKind::track);
    EXPECT_NEAR(found.time_to_loss, (40.0F - 2.0F - 0.5F - 1.0F) / 5.0F, 1e-3F);
    EXPECT_NEAR(found.time_to_closest, 8.0F, 1e-3F);
}

/// The centre lies beyond the end: nearest when the end is reached, not later.
TEST_P(ConflictLimits, AnObstacleBeyondTheEndIsNearestOnArrival)
{
    way_to(Vec3(10, 0, 0));
    scene.obstacle(geometry::make_sphere(Vec3(16, 0, 0), 4.0F));
    ASSERT_TRUE(meets());
    EXPECT_NEAR(found.time_to_closest, 2.0F, 1e-3F);
    EXPECT_NEAR(found.miss_distance, 6.0F, 1e-3F);
    EXPECT_NEAR(found.time_to_loss, (16.0F - 4.0F - 0.5F - 3.0F) / 5.0F, 1e-3F);
}

/// For any remaining budget, a static vehicle has a conflict now with every unchecked threat.
TEST_P(ConflictLimits, AtItsEndASpentBudgetIsAConflictNow)
{
    way_to(Vec3(10, 0, 0));
    scene.own.position = Vec3(10, 0, 0);
    scene.obstacle(geometry::make_box(Vec3(10, 0, 0), Vec3(1, 1, 1)));
    ASSERT_FALSE(meets()) << "no way could mend it";
    const std::uint32_t all = spent;
    for (std::uint32_t n = 0; n < all; ++n) {
        ASSERT_TRUE(meets(10.0F, n)) << n;
        ASSERT_EQ(found.time_to_loss, 0.0F) << n;
        ASSERT_EQ(found.time_to_closest, 0.0F) << n;
        ASSERT_EQ(found.margin, -kSeparationCap) << n;
    }
}

/// The threat at which the budget ran out is reported, not a later one.
TEST_P(ConflictLimits, ASpentBudgetNamesTheThreatThatItRanOutAt)
{
    const auto cost_until = [&](const auto& add) {
        add();
        EXPECT_FALSE(meets());
        return spent;
    };
    const std::uint32_t none = cost_until([] {});
    const std::uint32_t track = cost_until([&] { scene.track(Vec3(20, 60, 0), Vec3::Zero(), 1.0F); });
    const std::uint32_t cylinder = cost_until([&] { scene.cylinder(Vec2(20, 60), 1.0F); });
    const std::uint32_t obstacle = cost_until([&] { scene.obstacle(geometry::make_sphere(Vec3(20, 60, 0), 1.0F)); });
    for (std::uint32_t n = none; n < obstacle; ++n) {
        ASSERT_TRUE(meets(10.0F, n)) << n;
        const ThreatKind expected = n < track      ? ThreatKind::track
                                    : n < cylinder ? ThreatKind::cylinder
                                                   : ThreatKind::obstacle;
        ASSERT_EQ(found.threat, (ThreatRef{expected, 0})) << n;
        ASSERT_EQ(found.time_to_loss, 0.0F) << n;
    }
}

/// Drawing apart from a growing threat is followed for a minute, in quarters of a second; a case that takes twice that
/// is not followed to its end.
TEST_P(ConflictLimits, DrawingApartIsFollowedForAMinute)
{
    way_to(Vec3(2000, 0, 0));
    scene.track(Vec3(-4.4F, 0, 0), Vec3(-5, 0, 0), 1.0F).sigma_velocity = 1e-3F;
    EXPECT_FALSE(meets(60.0F));
    EXPECT_TRUE(meets(150.0F));
    EXPECT_EQ(found.time_to_loss, 0.0F);
}

/// A path that ends soon is judged to its end: within a second nothing has grown back yet.
TEST_P(ConflictLimits, InsideAMarginAShortWayIsJudgedToItsEnd)
{
    scene.own.sigma_position = 0.0F;
    scene.obstacle(geometry::make_sphere(Vec3(0, 101.9F, 0), 100.0F));  // 0.1 m of the box's side inside
    way_to(Vec3(2.5F, 0, 0));                                           // half a second
    EXPECT_FALSE(meets());
    way_to(Vec3(100, 0, 0));
    scene.reference.speed = 1.0F;
    EXPECT_TRUE(meets());
    EXPECT_EQ(found.time_to_loss, 0.0F);
}

/// Around two corners: the first approach counts, also where a later one would be nearer.
TEST(ConflictAroundCorners, TheFirstApproachToAnObstacleIsReported)
{
    Scene scene;
    path::Route route;
    ASSERT_EQ(route.add_leg(Vec3(0, 0, 0), Vec3(30, 0, 0)), path::RouteStatus::ok);
    ASSERT_EQ(route.add_leg(Vec3(30, 0, 0), Vec3(30, 1, 0)), path::RouteStatus::ok);
    ASSERT_EQ(route.add_leg(Vec3(30, 1, 0), Vec3(60, 1, 0)), path::RouteStatus::ok);
    scene.leg(Vec3::Zero(), Vec3::Zero(), 5.0F);
    scene.reference = world::Reference(route, scene.reference.speed);
    scene.obstacle(geometry::make_sphere(Vec3(36, -1, 0), 5.5F));
    Conflict found;
    WorkBudget budget(kPlenty);
    ASSERT_TRUE(main_conflict(scene.situation(), way_of(scene.situation()), 10.0F, budget, found));
    EXPECT_LT(found.time_to_loss, 6.0F);
    EXPECT_NEAR(found.time_to_closest, 6.0F, 1e-3F);
    EXPECT_NEAR(found.miss_distance, std::hypot(6.0F, 1.0F), 1e-3F);
}

}  // namespace
}  // namespace jink::world
