// SPDX-License-Identifier: BSD-3-Clause
// Every answer of the planner but a manoeuvre.
#include <gtest/gtest.h>

#include "tests/unit/core/geometric/flight.hpp"

namespace jink::geometric {
namespace {

using world::PlanStatus;

TEST(PlannerStatus, NoConflict)
{
    Flight flight;
    EXPECT_EQ(flight.plan(), PlanStatus::no_conflict);
    flight.add(Vec3(60.0F, 30.0F, 50.0F), Vec3(-5.0F, 0.0F, 0.0F), 1.0F);
    EXPECT_EQ(flight.plan(), PlanStatus::no_conflict);
    EXPECT_TRUE(flight.out.path.points.empty());  // untouched
}

TEST(PlannerStatus, NoConflictWithinTheLookahead)
{
    Flight flight;
    flight.add(Vec3(90.0F, 0.0F, 50.0F), Vec3::Zero(), 1.0F);
    EXPECT_EQ(flight.plan(), PlanStatus::no_conflict);
    flight.rules.lookahead = 20.0F;
    EXPECT_EQ(flight.plan(), PlanStatus::found);
}

TEST(PlannerStatus, TooClose)
{
    Flight flight;
    flight.add(Vec3(6.0F, 0.0F, 50.0F), Vec3::Zero(), 3.0F);
    EXPECT_EQ(flight.plan(), PlanStatus::too_close);
}

TEST(PlannerStatus, NoneAvailable)
{
    Flight flight;
    flight.obstacles = {{1, geometry::make_box(Vec3(40.0F, 0.0F, 50.0F), Vec3(0.5F, 500.0F, 500.0F))}};
    EXPECT_EQ(flight.plan(), PlanStatus::none_available);
    EXPECT_TRUE(flight.out.path.points.empty());
}

/// A closed area of 2 m radius on the leg, from the ground to 100 m.
world::Cylinder closed_area_ahead()
{
    world::Cylinder area;
    area.circle = {{30.0F, 0.5F}, 2.0F};
    area.top = 100.0F;
    return area;
}

/// Curves are as long as the distance to the area allows: one that reaches nearly up to the vehicle has no way round
/// it.
TEST(PlannerStatus, AClosedAreaThatIsTooLargeHasNoWayRoundIt)
{
    for (const float radius : {2.0F, 8.0F, 13.0F}) {
        Flight flight;
        world::Cylinder area = closed_area_ahead();
        area.circle.radius = radius;
        flight.airspace.cylinders = {&area, 1};
        EXPECT_EQ(flight.plan(), PlanStatus::found) << radius;
    }
    Flight flight;
    world::Cylinder area = closed_area_ahead();
    area.circle.radius = 28.0F;
    flight.airspace.cylinders = {&area, 1};
    EXPECT_EQ(flight.plan(), PlanStatus::none_available);
    EXPECT_TRUE(flight.out.path.points.empty());
}

TEST(PlannerStatus, BudgetSpentAtAClosedAreaIsSaid)
{
    const world::Cylinder area = closed_area_ahead();
    std::uint32_t spent = 0;
    PlanStatus status = PlanStatus::budget_spent;
    for (std::uint32_t units = 1; status == PlanStatus::budget_spent && units < 100000; units += 7) {
        Flight flight;
        flight.airspace.cylinders = {&area, 1};
        flight.budget = WorkBudget{units};
        status = flight.plan();
        spent += status == PlanStatus::budget_spent ? 1U : 0U;
    }
    EXPECT_EQ(status, PlanStatus::found);
    EXPECT_GE(spent, 1U);
}

TEST(PlannerStatus, BudgetSpent)
{
    Flight flight;
    flight.add(Vec3(60.0F, 0.0F, 50.0F), Vec3(-5.0F, 0.0F, 0.0F), 1.0F);
    flight.budget = WorkBudget{10};
    EXPECT_EQ(flight.plan(), PlanStatus::budget_spent);
    Flight blind;
    blind.obstacles = {{1, geometry::make_box(Vec3(40.0F, 0.0F, 40.0F), Vec3(0.5F, 40.0F, 12.0F))}};
    blind.budget = WorkBudget{3};
    EXPECT_EQ(blind.plan(), PlanStatus::budget_spent);
}

/// A search that finds no conflict is all that the plan spends: one unit less than it needs proves nothing.
TEST(PlannerStatus, BudgetThatEndsInTheSearchForConflictsIsSaid)
{
    const auto plan = [](Flight& flight, std::uint32_t units) {
        flight.add(Vec3(60.0F, 30.0F, 50.0F), Vec3(-5.0F, 0.0F, 0.0F), 1.0F);
        flight.budget = WorkBudget{units};
        return flight.plan();
    };
    Flight ample;
    ASSERT_EQ(plan(ample, 1'000'000), PlanStatus::no_conflict);
    const std::uint32_t needed = ample.budget.spent();
    ASSERT_GT(needed, 0U);
    for (std::uint32_t units = 0; units < needed; ++units) {
        Flight flight;
        ASSERT_EQ(plan(flight, units), PlanStatus::budget_spent) << units;
        ASSERT_TRUE(flight.planner.last().cut_short) << units;
        ASSERT_TRUE(flight.out.path.points.empty());
    }
    Flight enough;
    EXPECT_EQ(plan(enough, needed), PlanStatus::no_conflict);
    EXPECT_FALSE(enough.planner.last().cut_short);
}

/// A conflict that is found with the last unit is answered.
TEST(PlannerStatus, BudgetThatEndsWithTheSearchForConflictsIsEnough)
{
    Flight close;  // the answer follows from the conflict alone
    close.add(Vec3(6.0F, 0.0F, 50.0F), Vec3::Zero(), 3.0F);
    ASSERT_EQ(close.plan(), PlanStatus::too_close);
    const std::uint32_t needed = close.budget.spent();
    close.budget = WorkBudget{needed};
    EXPECT_EQ(close.plan(), PlanStatus::too_close);
    EXPECT_FALSE(close.planner.last().cut_short);
    close.budget = WorkBudget{needed - 1};
    EXPECT_EQ(close.plan(), PlanStatus::budget_spent);
    EXPECT_TRUE(close.planner.last().cut_short);
    close.budget = WorkBudget{needed};
    EXPECT_EQ(close.plan(), PlanStatus::too_close);
    EXPECT_FALSE(close.planner.last().cut_short) << "said of each plan anew";
}

TEST(PlannerStatus, BadInput)
{
    Flight flight;
    flight.add(Vec3(60.0F, 0.0F, 50.0F), Vec3(-5.0F, 0.0F, 0.0F), 1.0F);
    flight.reference.valid = false;
    EXPECT_EQ(flight.plan(), PlanStatus::bad_input);
    flight.reference.valid = true;
    Settings settings;
    settings.offsets = 3;
    flight.planner = Planner{settings};
    EXPECT_EQ(flight.plan(), PlanStatus::bad_input);
}

}  // namespace
}  // namespace jink::geometric
