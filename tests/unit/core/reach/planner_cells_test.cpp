// SPDX-License-Identifier: BSD-3-Clause
// The supplier of the reach planner's cell ratings: times of its calls, and effects of its answers.
#include <gtest/gtest.h>

#include "core/reach/planner.hpp"
#include "tests/unit/core/reach/planner_bench.hpp"

namespace jink::reach {
namespace {

using test::FakeSource;
using test::PlannerChoice;
using world::PlanStatus;

TEST_F(PlannerChoice, ASourceRatesTheCellsOfACourseOnce)
{
    FakeSource picture;
    planner.look_at(&picture);
    EXPECT_EQ(way(), Way::straight);
    EXPECT_EQ(picture.calls, 1U);
    EXPECT_EQ(picture.lead, rules.latency);
    EXPECT_EQ(picture.cells, kGrid.cells());
    EXPECT_EQ(picture.free, kGrid.cells()) << "all are free before";
    EXPECT_NEAR((picture.origin - Vec3(0.5F, 0.0F, 30.0F)).norm(), 0.0F, 1e-5F);
    picture.blocked = {kGrid.index({3, 3, 1})};
    EXPECT_NE(way(), Way::straight);
    EXPECT_EQ(picture.calls, 2U) << "a plan anew, a look anew";
    EXPECT_EQ(picture.free, kGrid.cells()) << "nothing is left of the plan before";
    picture.blocked = {kGrid.index({0, 3, 1}), kGrid.index({0, 4, 1}), kGrid.index({0, 2, 1})};
    EXPECT_EQ(way(), Way::nothing);
    planner.look_at(nullptr);
    EXPECT_EQ(way(), Way::straight);
    EXPECT_EQ(picture.calls, 3U);
}

TEST_F(PlannerChoice, ACellThatIsSeenHardlyFreeIsTakenOnlyForWantOfBetter)
{
    FakeSource picture;
    planner.look_at(&picture);
    picture.blocked = {kGrid.index({3, 3, 1})};
    picture.level = 3;
    EXPECT_NE(way(), Way::straight);
    EXPECT_EQ(report().run, AvoidanceRun::soft_constraints);
    picture.blocked = {kGrid.index({0, 3, 1}), kGrid.index({0, 4, 1}), kGrid.index({0, 2, 1})};
    EXPECT_EQ(way(), Way::straight);
    EXPECT_EQ(report().run, AvoidanceRun::hard_constraints);
    picture.level = 2;
    EXPECT_EQ(way(), Way::nothing);
}

TEST_F(PlannerChoice, ABlindOrTiredSourceEndsThePlan)
{
    FakeSource picture;
    planner.look_at(&picture);
    picture.status = RateStatus::blind;
    EXPECT_EQ(plan(), PlanStatus::none_available);
    picture.status = RateStatus::budget_spent;
    EXPECT_EQ(plan(), PlanStatus::budget_spent);
    picture.status = RateStatus::nothing_known;
    EXPECT_EQ(plan(), PlanStatus::found);
    picture.status = RateStatus::rated;
    FakeSource fusion;
    planner.rate_cells_by(&fusion);
    fusion.status = RateStatus::blind;
    EXPECT_EQ(plan(), PlanStatus::none_available);
    EXPECT_TRUE(out.path.points.empty());
}

TEST_F(PlannerChoice, BothSetsOfACourseShareTheRatingWhereTheirCellsAreTheSame)
{
    FakeSource picture;
    planner.look_at(&picture);
    test::SmallTree straight(kGrid);
    straight.chain(Movement::straight, 4, 1024);
    test::SmallTree left(kGrid);
    left.chain(Movement::left, 4, 1024);
    const ReachSet* const first = keep(straight);
    only(first, keep(left));
    picture.blocked = {kGrid.index({0, 3, 1})};
    EXPECT_EQ(way(), Way::left);
    EXPECT_TRUE(report().emergency);
    EXPECT_EQ(picture.calls, 1U);
    const Grid<float> finer(4, 7, 5, 4.0F, 0.8F, 0.5F);
    test::SmallTree other(finer);
    other.chain(Movement::left, 4, 1024);
    only(first, keep(other));
    EXPECT_EQ(way(), Way::left);
    EXPECT_EQ(picture.calls, 3U) << "cells that are others are rated by themselves";
    EXPECT_EQ(picture.cells, finer.cells());
    EXPECT_EQ(picture.free, finer.cells());
    // A new course, a new rating.
    own.velocity = Vec3::Zero();
    only(first, first);
    picture.blocked = {kGrid.index({0, 3, 1})};
    EXPECT_EQ(plan(), PlanStatus::none_available);
    EXPECT_EQ(picture.calls, 3U + Planner::kHeadings);
}

TEST_F(PlannerChoice, FusionRatesInsteadOfNodesAndForEachSet)
{
    FakeSource picture;
    FakeSource fusion;
    planner.look_at(&picture);
    planner.rate_cells_by(&fusion);
    add_sphere(Vec3(8.0F, 0.0F, 30.0F), 1.0F);
    EXPECT_EQ(way(), Way::straight) << "its cells have said nothing of what is in the way";
    EXPECT_EQ(fusion.calls, 1U);
    EXPECT_EQ(picture.calls, 1U) << "both say what they know";
    EXPECT_EQ(fusion.lead, rules.latency);
    fusion.blocked = {kGrid.index({3, 3, 1})};
    picture.blocked = {kGrid.index({3, 4, 1})};
    EXPECT_EQ(way(), Way::right);
    test::SmallTree straight(kGrid);
    straight.chain(Movement::straight, 4, 1024);
    test::SmallTree right(kGrid);
    right.chain(Movement::right, 4, 1024);
    const ReachSet* const first = keep(straight);
    only(first, keep(right));
    fusion.blocked = {kGrid.index({0, 3, 1})};
    fusion.calls = picture.calls = 0;
    EXPECT_EQ(way(), Way::right);
    EXPECT_EQ(fusion.calls, 2U) << "times of cells are a set's own";
    planner.rate_cells_by(nullptr);
    EXPECT_NE(way(), Way::straight) << "the sphere is in the way again";
}

}  // namespace
}  // namespace jink::reach
