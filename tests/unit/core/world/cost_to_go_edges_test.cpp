// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include "core/world/cost_to_go_field.hpp"
#include "tests/numbers.hpp"
#include "tests/unit/core/world/field_scene.hpp"

namespace jink::world {
namespace {

using test::field_of;
using test::FieldScene;
using test::finish;
using test::kOwn;
using test::lost;
using test::Scene;

TEST(CostToGoEdges, KnowsNothingWithoutWhatItNeeds)
{
    const auto nothing_known = [](CostToGoField& field) {
        EXPECT_TRUE(field.is_idle());
        return !field.lost_from(kOwn) && !field.way_around(kOwn, 5.0F);
    };
    CostToGoField fresh;
    EXPECT_TRUE(nothing_known(fresh));
    WorkBudget budget(100'000);
    EXPECT_EQ(fresh.advance(budget), Progress::running);
    EXPECT_EQ(budget.spent(), 0U) << "idle";
    fresh.show();
    EXPECT_TRUE(nothing_known(fresh));
    FieldScene scene;
    scene.pocket();
    const auto after = [&](const Situation& situation) {
        const auto field = field_of(scene);
        EXPECT_TRUE(field->lost_from(kOwn));
        field->begin(situation);
        EXPECT_FALSE(field->is_idle()) << "it waits to be shown";
        EXPECT_TRUE(field->lost_from(kOwn));
        WorkBudget none(0);
        EXPECT_EQ(field->advance(none), Progress::done) << "nothing is to be built";
        field->show();
        return nothing_known(*field);
    };
    const Situation whole = scene.situation();
    Situation uncollected = whole;
    uncollected.threats = {};
    EXPECT_TRUE(after(uncollected));
    EXPECT_TRUE(after(with_reference(whole, Reference())));
    EXPECT_TRUE(after(with_reference(whole, Reference({kOwn, kOwn, 5.0F})))) << "a route of length 0";
    const path::Route empty;
    EXPECT_TRUE(after(with_reference(whole, Reference(empty, 5.0F))));
    Scene far;
    far.own.position = kOwn;
    far.leg(kOwn, Vec3(200, 0, 30));
    far.obstacle(geometry::make_sphere(Vec3(50, 0, 30), 10.0F));
    far.airspace.has_ceiling = true;
    far.airspace.ceiling = 32.0F;
    EXPECT_TRUE(after(far.situation())) << "outside of the grid";
    far.track(Vec3(10, 0, 30), Vec3::Zero(), 5.0F);
    EXPECT_TRUE(after(far.situation())) << "traffic is no obstacle";
}

TEST(CostToGoEdges, ShowsOnlyWhatIsComplete)
{
    FieldScene scene;
    scene.pocket();
    CostToGoField field;
    field.begin(scene.situation());
    EXPECT_FALSE(field.lost_from(kOwn));
    WorkBudget too_little(CostToGoField::kPiece / 4);
    while (too_little.left() > 0) {
        const std::uint32_t before = too_little.spent();
        EXPECT_EQ(field.advance(too_little), Progress::running);
        if (too_little.spent() == before) {
            break;
        }
    }
    field.show();
    EXPECT_FALSE(field.lost_from(kOwn));
    EXPECT_FALSE(field.is_idle());
    finish(field);
    const Seconds known = lost(field, kOwn);
    EXPECT_GT(known, 4.0F);
    // Shown once: what is idle has nothing more to show.
    field.show();
    EXPECT_EQ(lost(field, kOwn), known);
    field.begin(scene.situation());
    field.forget();
    EXPECT_TRUE(field.is_idle());
    EXPECT_FALSE(field.lost_from(kOwn));
    EXPECT_FALSE(field.way_around(kOwn, 5.0F));
    field.show();
    EXPECT_FALSE(field.lost_from(kOwn)) << "what was being built is dropped";
    field.begin(scene.situation());
    finish(field);
    EXPECT_EQ(lost(field, kOwn), known);
}

/// The same answers after a field that was far away: nothing of it is left.
TEST(CostToGoEdges, DoesNotDependOnWhatWasBuiltBefore)
{
    FieldScene scene;
    scene.own.position += Vec3(0.1F, 0.7F, 0.3F);
    scene.pocket();
    FieldScene far;
    far.own.position = Vec3(90'000.3F, -70'000.7F, 1000.1F);
    far.leg(far.own.position, far.own.position + Vec3(100, 0, 0));
    far.obstacle(geometry::make_sphere(far.own.position, 3.0F));
    const auto fresh = field_of(scene);
    CostToGoField used;
    for (int i = 0; i < 2; ++i) {
        used.begin(far.situation());
        finish(used);
    }
    for (int i = 0; i < 2; ++i) {
        used.begin(scene.situation());
        finish(used);
        for (float x = -30.0F; x < 30.0F; x += 1.3F) {
            const Vec3 place = kOwn + Vec3(x, 0.4F * x, 0.1F * x);
            EXPECT_EQ(used.lost_from(place), fresh->lost_from(place)) << x;
            EXPECT_EQ(used.way_around(place, 6.0F), fresh->way_around(place, 6.0F)) << x;
        }
    }
}

TEST(CostToGoEdges, KnowsItsGridAndNoMore)
{
    FieldScene scene;
    scene.pocket();
    const auto field = field_of(scene);
    const Vec3 half(32.0F, 32.0F, 12.5F);
    for (int axis = 0; axis < 3; ++axis) {
        for (const float side : {-1.0F, 1.0F}) {
            const Vec3 edge = side * half[axis] * Vec3::Unit(axis);
            EXPECT_TRUE(field->lost_from(kOwn + edge)) << axis;
            EXPECT_FALSE(field->lost_from(kOwn + edge * 1.001F)) << axis;
            for (const float bad : {kNan, kInfinity, -kInfinity, 3e38F}) {
                Vec3 place = kOwn;
                place[axis] = bad;
                EXPECT_FALSE(field->lost_from(place)) << axis;
                EXPECT_FALSE(field->way_around(place, 5.0F)) << axis;
            }
        }
    }
    for (const float distance : {kNan, kInfinity, -1.0F, 0.0F, 1e30F}) {
        const std::optional<Vec3> way = field->way_around(kOwn, distance);
        ASSERT_TRUE(way) << distance;
        EXPECT_TRUE(((*way - kOwn).cwiseAbs().array() <= half.array()).all()) << distance;
    }
}

TEST(CostToGoEdges, AllCellsBlockedIsNoWay)
{
    FieldScene scene;
    scene.box(kOwn, Vec3(500, 500, 500));
    const auto field = field_of(scene);
    for (const Vec3& off : {Vec3(0, 0, 0), Vec3(20, -30, 5), Vec3(32, 32, 12.5F)}) {
        EXPECT_EQ(lost(*field, kOwn + off), CostToGoField::kNoWay);
        EXPECT_FALSE(field->way_around(kOwn + off, 5.0F));
    }
    FieldScene fenced;
    fenced.pocket();
    fenced.airspace.has_keep_in = true;
    fenced.airspace.keep_in_radius = 0.0F;
    EXPECT_EQ(lost(*field_of(fenced), kOwn), CostToGoField::kNoWay);
}

/// Nothing leads out of a closed yard; outside of it the ways are known.
TEST(CostToGoEdges, AClosedYardHasNoWay)
{
    FieldScene scene;
    scene.pocket();
    scene.box(Vec3(-10, 0, 30), Vec3(0.2F, 8, 40));
    const auto field = field_of(scene);
    EXPECT_EQ(lost(*field, kOwn), CostToGoField::kNoWay);
    EXPECT_FALSE(field->way_around(kOwn, 5.0F));
    EXPECT_GT(lost(*field, kOwn - Vec3(16, 0, 0)), 0.5F);
    EXPECT_LT(lost(*field, kOwn - Vec3(16, 0, 0)), 10.0F);
}

/// A vehicle within an obstacle's reach is led out over the free cells next to it, if any.
TEST(CostToGoEdges, LeadsOutOfAnObstaclesReach)
{
    FieldScene scene;
    scene.box(Vec3(1.6F, 0, 30), Vec3(0.5F, 12, 40));
    const auto field = field_of(scene);
    EXPECT_GT(lost(*field, kOwn), 1.0F);
    const std::optional<Vec3> way = field->way_around(kOwn, 3.0F);
    ASSERT_TRUE(way);
    EXPECT_LT(way->x(), -0.5F);
}

TEST(CostToGoEdges, ExtremeValuesGiveOrdinaryAnswers)
{
    FieldScene scene;
    scene.pocket();
    const auto answers = [&] {
        const auto field = field_of(scene);
        const std::optional<Seconds> known = field->lost_from(scene.own.position);
        const std::optional<Vec3> way = field->way_around(scene.own.position, 5.0F);
        EXPECT_TRUE(!known || (*known >= 0.0F && *known <= CostToGoField::kNoWay));
        EXPECT_TRUE(!way || way->allFinite());
        return known;
    };
    scene.reference.speed = 0.0F;
    EXPECT_GT(answers().value_or(0.0F), 15.0F) << "as at 1 m/s";
    scene.reference.speed = 1e6F;
    scene.limits.max_climb = 1e-6F;
    EXPECT_LT(answers().value_or(9.0F), 0.1F);
    scene.reference.speed = 5.0F;
    scene.limits.max_climb = 1e6F;
    scene.limits.max_descent = 1e6F;
    EXPECT_TRUE(answers());
    scene.limits = {};
    scene.limits.half_extents = Vec3(500, 500, 500);
    EXPECT_EQ(answers(), CostToGoField::kNoWay);
    scene.limits = {};
    scene.own.sigma_position = 1e6F;
    EXPECT_EQ(answers(), CostToGoField::kNoWay);
    scene.own.sigma_position = 0.0F;
    for (const float away : {1e5F, 1e6F, 1e9F}) {
        Scene far;
        far.own.position = Vec3(away, -away, away);
        far.leg(far.own.position, far.own.position + Vec3(0.01F * away, 0, 0));
        far.obstacle(geometry::make_sphere(far.own.position, 3.0F));
        const auto field = field_of(far);
        const std::optional<Seconds> known = field->lost_from(far.own.position);
        EXPECT_TRUE(!known || (*known >= 0.0F && *known <= CostToGoField::kNoWay)) << away;
    }
}

/// As many blocks as fit, each over all of the grid.
TEST(CostToGoEdges, TakesAllObstaclesThatThereAre)
{
    FieldScene scene;
    for (std::size_t i = 0; i < kMaxObstacles; ++i) {
        scene.box(Vec3(200, 0, 30), Vec3(170, 40, 40));
    }
    scene.obstacles.back().shape = geometry::make_sphere(Vec3(10, 0, 30), 5.0F);
    for (std::size_t i = 0; i < kMaxCylinders; ++i) {
        scene.cylinders.push_back({{Vec2(-20, 0), 3.0F}, Vec2::Zero(), 0.0F, 100.0F, 0.0F});
    }
    scene.airspace.cylinders = scene.cylinders;
    const auto field = field_of(scene);
    EXPECT_GT(lost(*field, kOwn), 0.1F) << "the last one counts";
    EXPECT_GT(lost(*field, Vec3(-26, 0, 30)), 0.1F);
}

}  // namespace
}  // namespace jink::world
