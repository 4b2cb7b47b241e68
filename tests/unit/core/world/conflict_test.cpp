// SPDX-License-Identifier: BSD-3-Clause
#include "core/world/conflict.hpp"

#include <gtest/gtest.h>

#include "core/base/work_units.hpp"
#include "tests/unit/core/world/scene.hpp"

namespace jink::world {
namespace {

using namespace test;

constexpr Seconds kAhead = 8.0F;

/// A vehicle at the origin that flies east with 5 m/s, 1 m box.
struct Conflicts : testing::Test {
    Conflicts()
    {
        scene.leg(Vec3::Zero(), Vec3(200, 0, 0), 5.0F);
        scene.own.velocity = Vec3(5, 0, 0);
    }
    bool predict(Seconds lookahead = kAhead, std::uint32_t units = kPlenty)
    {
        WorkBudget budget(units);
        return test::predict_conflict(scene.situation(), way_of(scene.situation()), 0, lookahead, budget, conflict);
    }
    bool find(std::uint32_t units = kPlenty)
    {
        WorkBudget budget(units);
        return main_conflict(scene.situation(), way_of(scene.situation()), kAhead, budget, conflict);
    }
    Scene scene;
    Conflict conflict;
};

TEST_F(Conflicts, HeadOn)
{
    scene.track(Vec3(40, 0, 0), Vec3(-5, 0, 0), 1.0F);
    ASSERT_TRUE(predict());
    EXPECT_NEAR(conflict.time_to_loss, 3.8F, 1e-3F);
    EXPECT_NEAR(conflict.time_to_closest, 4.0F, 1e-3F);
    EXPECT_NEAR(conflict.own_at_closest.x(), 20.0F, 0.01F);
    EXPECT_NEAR(conflict.miss_distance, 0.0F, 1e-3F);
    EXPECT_NEAR(conflict.margin, -1.0F, 1e-3F);
    EXPECT_EQ(conflict.radius_at_closest, 1.0F);
    EXPECT_EQ(conflict.threat, (ThreatRef{ThreatKind::track, 0}));
}

TEST_F(Conflicts, BeyondTheLookaheadIsNone)
{
    scene.track(Vec3(40, 0, 0), Vec3(-5, 0, 0), 1.0F);
    EXPECT_FALSE(predict(3.75F));
    EXPECT_TRUE(predict(3.85F));
}

TEST_F(Conflicts, OvertakingASlowOne)
{
    scene.track(Vec3(10, 0.5F, 0), Vec3(3, 0, 0), 1.0F);
    ASSERT_TRUE(predict());
    EXPECT_NEAR(conflict.time_to_loss, 4.0F, 1e-3F);
}

TEST_F(Conflicts, BeingOvertaken)
{
    scene.track(Vec3(-20, 0.5F, 0), Vec3(10, 0, 0), 1.0F);
    ASSERT_TRUE(predict());
    EXPECT_NEAR(conflict.time_to_loss, 3.6F, 1e-3F);
}

TEST_F(Conflicts, ParallelOutsideTheMarginIsNone)
{
    scene.track(Vec3(0, 2.1F, 0), Vec3(5, 0, 0), 1.0F);
    EXPECT_FALSE(predict());
}

TEST_F(Conflicts, ParallelInsideTheMarginIsOne)
{
    scene.track(Vec3(0, 1.8F, 0), Vec3(5, 0, 0), 1.0F);
    ASSERT_TRUE(predict()) << "it does not go away by itself";
    EXPECT_EQ(conflict.time_to_loss, 0.0F);
}

TEST_F(Conflicts, CrossingBehindIsNone)
{
    scene.track(Vec3(20, -30, 0), Vec3(0, 5, 0), 1.0F);
    EXPECT_FALSE(predict());
}

TEST_F(Conflicts, GrowthMakesAMissAConflict)
{
    scene.track(Vec3(40, 3, 0), Vec3(-5, 0, 0), 1.0F);
    EXPECT_FALSE(predict());
    scene.tracks[0].sigma_velocity = 0.2F;  // 3 * 0.2 * 4 s = 2.4 m more at the closest approach
    EXPECT_TRUE(predict());
    scene.tracks[0].sigma_velocity = 0.0F;
    scene.tracks[0].max_acceleration = 0.3F;
    EXPECT_TRUE(predict());
}

TEST_F(Conflicts, HoveringAtTheLegsEnd)
{
    scene.leg(Vec3::Zero(), Vec3(10, 0, 0), 5.0F);
    scene.track(Vec3(10, 30, 0), Vec3(0, -5, 0), 1.0F);
    ASSERT_TRUE(predict());
    EXPECT_NEAR(conflict.time_to_loss, 5.6F, 1e-3F);
    EXPECT_NEAR(conflict.own_at_closest.x(), 10.0F, 1e-3F);
    EXPECT_NEAR(conflict.time_to_closest, 6.0F, 1e-3F);
    scene.own.position = Vec3(10, 0, 0);
    EXPECT_TRUE(predict()) << "already there";
}

TEST_F(Conflicts, InsideAndDrawingApartIsNone)
{
    scene.track(Vec3(-1.5F, 0, 0), Vec3(-5, 0, 0), 1.0F);
    EXPECT_FALSE(predict());
    scene.tracks[0].velocity = Vec3(3, 0, 0);  // it follows, slower
    EXPECT_FALSE(predict());
    scene.tracks[0].velocity = Vec3(5.5F, 0, 0);  // it catches up
    EXPECT_TRUE(predict());
    EXPECT_EQ(conflict.time_to_loss, 0.0F);
}

TEST_F(Conflicts, InsideDrawingApartAndMetAgainIsOne)
{
    // Behind us and inside the margin; we fly off to the leg's end at 4 m and hover there, where it comes through.
    scene.leg(Vec3::Zero(), Vec3(4, 0, 0), 5.0F);
    scene.track(Vec3(-1.2F, 1.5F, 0), Vec3(1, 0.083F, 0), 1.0F);  // the centres are never nearer than now
    ASSERT_TRUE(predict());
}

/// With a large box the centres may draw apart while the box is about to be hit.
TEST_F(Conflicts, InsideWithTheCentresDrawingApartAndTheBoxComingNearerIsOne)
{
    scene.limits.half_extents = Vec3(20, 20, 1);
    scene.track(Vec3(5, 0, 3), Vec3(10, 0, -1), 2.5F);
    ASSERT_TRUE(predict());
}

TEST_F(Conflicts, SphereOnTheWay)
{
    scene.obstacle(geometry::make_sphere(Vec3(20, 1, 0), 2.0F));
    ASSERT_TRUE(find());
    EXPECT_EQ(conflict.threat, (ThreatRef{ThreatKind::obstacle, 0}));
    EXPECT_NEAR(conflict.time_to_loss, (20.0F - 1.0F - 2.0F) / 5.0F, 1e-2F);
    EXPECT_NEAR(conflict.margin, -2.0F, 1e-4F);
    EXPECT_NEAR(conflict.time_to_closest, 4.0F, 1e-3F);
    EXPECT_EQ(conflict.radius_at_closest, 2.0F);
    scene.obstacles.clear();
    scene.obstacle(geometry::make_sphere(Vec3(20, 3.1F, 0), 2.0F));
    EXPECT_FALSE(find());
    scene.own.sigma_position = 0.1F;  // counts against obstacles too
    EXPECT_TRUE(find());
}

TEST_F(Conflicts, MastOnTheWayWhateverItsHeight)
{
    scene.obstacle(geometry::make_capsule(Vec3(20, 0, -100), Vec3(20, 0, 100), 0.3F));
    ASSERT_TRUE(find());
    EXPECT_NEAR(conflict.time_to_loss, 18.7F / 5.0F, 1e-2F);
    EXPECT_NEAR(conflict.radius_at_closest, 0.3F, 1e-6F);
}

TEST_F(Conflicts, WallOnTheWay)
{
    scene.obstacle(geometry::make_box(Vec3(20, 0, 0), Vec3(0.5F, 30, 30)));
    ASSERT_TRUE(find());
    EXPECT_LE(conflict.time_to_loss, 18.5F / 5.0F);
    EXPECT_NEAR(conflict.time_to_loss, 18.5F / 5.0F, 8.0F / 256.0F + 1e-3F) << "eight halvings of 8 s";
    EXPECT_LT(conflict.margin, 0.0F);
}

TEST_F(Conflicts, ObstaclesBehindAreNone)
{
    scene.obstacle(geometry::make_sphere(Vec3(-5, 0, 0), 2.0F));
    scene.obstacle(geometry::make_box(Vec3(-5, 0, 0), Vec3(2, 2, 2)));
    EXPECT_FALSE(find());
}

TEST_F(Conflicts, InsideAnObstaclesMarginAndFlyingOffIsNone)
{
    scene.own.sigma_position = 0.5F;  // 1.5 m
    scene.obstacle(geometry::make_sphere(Vec3(-3, 0, 0), 1.0F));
    EXPECT_FALSE(find());
    scene.obstacles.clear();
    scene.obstacle(geometry::make_box(Vec3(-4, 0, 0), Vec3(2, 20, 20)));
    EXPECT_FALSE(find());
}

/// The middle of a long wall lies behind; the wall does not.
TEST_F(Conflicts, InsideALongWallsMarginAndFlyingIntoItIsOne)
{
    scene.own.sigma_position = 0.3F;  // 0.9 m
    scene.own.position = Vec3(40, 2.0F, 0);
    scene.obstacle(geometry::make_box(Vec3::Zero(), Vec3(100, 0.5F, 20)));
    scene.leg(scene.own.position, Vec3(80, -10, 0), 5.0F);
    ASSERT_TRUE(find());
    EXPECT_EQ(conflict.time_to_loss, 0.0F);
}

/// The path is bisected eight times to find the loss: a loss within the first 256th does not count as "already inside".
TEST_F(Conflicts, AWallMetAtOnceIsOneWhereverItsMiddleLies)
{
    scene.leg(Vec3(40, 1.51F, 0), Vec3(80, -10, 0), 5.0F);
    scene.own.position = Vec3(40, 1.51F, 0);
    scene.obstacle(geometry::make_box(Vec3::Zero(), Vec3(100, 0.5F, 20)));
    ASSERT_TRUE(find());
}

/// Every checked track and obstacle costs work units; an unfinished check is a conflict now.
TEST_F(Conflicts, WhereTheBudgetRunsOutThereIsOneNow)
{
    for (int i = 0; i < 4; ++i) {
        scene.track(Vec3(30.0F + static_cast<float>(i), 40, 0), Vec3(0, 1, 0), 1.0F).sigma_velocity = 0.1F;
        scene.obstacle(geometry::make_sphere(Vec3(10, -30, static_cast<float>(i)), 1.0F));
    }
    scene.obstacle(geometry::make_box(Vec3(-20, 3, 0), Vec3(40, 0.5F, 1)));
    WorkBudget ample(kPlenty);
    ASSERT_FALSE(main_conflict(scene.situation(), way_of(scene.situation()), kAhead, ample, conflict));
    ASSERT_GE(ample.spent(), 4 * (units::kConflict + units::kConflictSphere) + units::kConflictSolid);
    for (std::uint32_t n = 0; n < ample.spent(); ++n) {
        ASSERT_TRUE(find(n)) << n;
        ASSERT_EQ(conflict.time_to_loss, 0.0F) << n;
        ASSERT_LT(conflict.margin, 0.0F) << n;
        const std::uint32_t on_threats = n > units::kConflictLook ? n - units::kConflictLook : 0;
        if (on_threats < 4 * units::kConflict) {
            ASSERT_EQ(conflict.threat.index, on_threats / units::kConflict);
            ASSERT_EQ(conflict.threat.kind, ThreatKind::track);
        }
    }
    EXPECT_FALSE(find(ample.spent()));
}

TEST_F(Conflicts, ALaterConflictThatWasFoundHidesNothing)
{
    scene.track(Vec3(40, 0, 0), Vec3(-5, 0, 0), 1.0F);
    ASSERT_TRUE(find());
    ASSERT_GT(conflict.time_to_loss, 3.0F);
    scene.track(Vec3(200, 0, 0), Vec3::Zero(), 1.0F);
    WorkBudget first(kPlenty);
    ASSERT_TRUE(test::predict_conflict(scene.situation(), way_of(scene.situation()), 0, kAhead, first, conflict));
    const std::uint32_t until_second = units::kConflictLook + first.spent();
    ASSERT_TRUE(find(until_second + units::kConflict - 1));
    EXPECT_EQ(conflict.time_to_loss, 0.0F);
    EXPECT_EQ(conflict.threat.index, 1);
    ASSERT_TRUE(find(until_second + units::kConflict));
    EXPECT_EQ(conflict.threat.index, 0);
}

TEST_F(Conflicts, DrawingApartIsPaidForAndNotBelievedWithout)
{
    scene.track(Vec3(-1.5F, 0, 0), Vec3(-5, 0, 0), 1.0F);
    ASSERT_FALSE(predict());
    WorkBudget ample(kPlenty);
    static_cast<void>(test::predict_conflict(scene.situation(), way_of(scene.situation()), 0, kAhead, ample, conflict));
    ASSERT_GE(ample.spent(), units::kConflict + units::kConflictPart + units::kSpherePart);
    for (std::uint32_t n = 0; n < ample.spent(); ++n) {
        ASSERT_TRUE(predict(kAhead, n)) << n;
        ASSERT_EQ(conflict.time_to_loss, 0.0F);
    }
    EXPECT_FALSE(predict(kAhead, ample.spent()));
}

TEST_F(Conflicts, ASpentBudgetIsAConflict)
{
    scene.obstacle(geometry::make_box(Vec3(-20, 3, 0), Vec3(40, 0.5F, 1)));  // beside, its middle behind
    EXPECT_FALSE(find());
    EXPECT_TRUE(find(5)) << "no proof that it is clear";
}

TEST_F(Conflicts, TheFirstLossIsTheMainThreat)
{
    scene.track(Vec3(60, 0, 0), Vec3(-5, 0, 0), 1.0F);
    scene.track(Vec3(40, 0, 0), Vec3(-5, 0, 0), 1.0F);
    scene.track(Vec3(50, 0, 0), Vec3(-5, 0, 0), 1.0F);
    scene.obstacle(geometry::make_sphere(Vec3(30, 0, 0), 1.0F));
    ASSERT_TRUE(find());
    EXPECT_EQ(conflict.threat, (ThreatRef{ThreatKind::track, 1}));
    scene.obstacle(geometry::make_sphere(Vec3(15, 0, 0), 1.0F));
    ASSERT_TRUE(find());
    EXPECT_EQ(conflict.threat, (ThreatRef{ThreatKind::obstacle, 1}));
}

TEST_F(Conflicts, TiesGoToTheSmallerMarginThenToTheFirst)
{
    scene.track(Vec3(1.9F, 0, 0), Vec3::Zero(), 1.0F);
    scene.track(Vec3(1.9F, 0, 0), Vec3::Zero(), 1.5F);
    scene.track(Vec3(1.9F, 0, 0), Vec3::Zero(), 1.5F);
    ASSERT_TRUE(find());
    EXPECT_EQ(conflict.time_to_loss, 0.0F);
    EXPECT_EQ(conflict.threat.index, 1U);
}

TEST_F(Conflicts, BoundsAreNoThreats)
{
    scene.airspace = {true, true, true, 10.0F, -10.0F, Vec3::Zero(), 1.0F};
    EXPECT_FALSE(find());
}

TEST_F(Conflicts, NothingAtAll) { EXPECT_FALSE(find()); }

}  // namespace
}  // namespace jink::world
