// SPDX-License-Identifier: BSD-3-Clause
// Two-stage manoeuvres: both stages together, their cost, and attempts if one of them fails.
#include <gtest/gtest.h>

#include <algorithm>
#include <memory>

#include "core/base/work_units.hpp"
#include "core/geometric/flown.hpp"
#include "tests/unit/core/geometric/in_a_row.hpp"

namespace jink::geometric {
namespace {

using world::PlanStatus;

TEST(InARowWhole, TheFewestWaypointsAreEnough)
{
    for (const std::uint16_t waypoints : {std::uint16_t{8}, std::uint16_t{13}, std::uint16_t{16}}) {
        InARow scene;
        scene.settings.waypoints = waypoints;
        ASSERT_EQ(scene.run_in_a_row(), PlanStatus::found) << waypoints;
        // As many for the first part as half of them are, but no fewer than a curve has; one point is of both.
        EXPECT_EQ(scene.result.path.points.size(), std::max(waypoints / 2 + 1, 8) - 1U + waypoints);
    }
}

TEST(InARowWhole, AsManyPointsAsAPathHolds)
{
    InARow scene;
    scene.settings.waypoints = kMaxPathPoints;
    ASSERT_EQ(scene.run_in_a_row(), PlanStatus::found);
    EXPECT_EQ(scene.result.path.points.size(), kMaxPathPoints - 1);
}

TEST(InARowWhole, WithoutAFirstPartThereIsNoMoreToDo)
{
    InARow scene;
    scene.settings.escape_from_margin = false;
    scene.threats.push_back(Scene::still(Vec3(0.0F, 0.0F, 50.0F), 100.0F));
    EXPECT_EQ(scene.run_in_a_row(), PlanStatus::none_available);
    Problem part = scene.problem;
    part.ends_at_top = true;
    Settings with = scene.settings;
    with.waypoints = scene.first_points();
    auto first = std::make_unique<Result>();
    WorkBudget budget(1'000'000);
    ASSERT_EQ(solve(part, with, scene.limits, scene.airframe, budget, *first), PlanStatus::none_available);
    const auto threats = static_cast<std::uint32_t>(part.threats.size());
    EXPECT_EQ(scene.budget.spent(), budget.spent() - units::kThreatValid * threats) << "they are known to be valid";
}

TEST(InARowWhole, WithoutASecondPartThereIsNoPath)
{
    InARow scene;
    scene.obstacles = {{1, geometry::make_box(Vec3(30.0F, 0.0F, 50.0F), Vec3(0.5F, 60.0F, 60.0F))}};
    auto first = std::make_unique<Result>();
    ASSERT_EQ(scene.first_part(*first), PlanStatus::found);
    EXPECT_EQ(scene.run_in_a_row(), PlanStatus::none_available);
    EXPECT_TRUE(scene.result.path.points.empty());
}

Vec3 first_side(InARow& scene)
{
    auto first = std::make_unique<Result>();
    EXPECT_EQ(scene.first_part(*first), PlanStatus::found);
    return first->side;
}

/// A wall behind the main threat, to a side and a little to the other.
void wall_off(InARow& scene, const Vec3& side)
{
    scene.obstacles = {{1, geometry::make_box(Vec3(30.0F, 0.0F, 50.0F) + 28.5F * side, Vec3(0.5F, 30.0F, 60.0F))}};
}

TEST(InARowWhole, WhereOneSideLeadsNowhereAnotherIsTried)
{
    InARow scene;
    const Vec3 side = first_side(scene);
    ASSERT_EQ(std::abs(side.y()), 1.0F);
    wall_off(scene, side);
    ASSERT_EQ(first_side(scene), side) << "the first part is free";
    ASSERT_EQ(scene.run_in_a_row(), PlanStatus::found);
    EXPECT_LT(scene.result.side.dot(side), 0.1F);
}

TEST(InARowWhole, ItsCostIsThatOfTheDearerPart)
{
    // A threat that flies away from beside the first stage, or comes to beside the second stage.
    for (const bool comes : {false, true}) {
        InARow scene;
        scene.threats.push_back(comes ? Sphere{{Vec3(30.0F, 53.0F, 50.0F), Vec3(0.0F, -3.0F, 0.0F)}, 0.5F}
                                      : Sphere{{Vec3(2.0F, 6.0F, 50.0F), Vec3(0.0F, 1.0F, 0.0F)}, 0.5F});
        auto first = std::make_unique<Result>();
        ASSERT_EQ(scene.first_part(*first), PlanStatus::found);
        ASSERT_EQ(scene.run_in_a_row(), PlanStatus::found);
        ASSERT_EQ(scene.result.side, first->side);
        Problem second;
        ASSERT_TRUE(second_problem(scene, *first, second));
        Settings with = scene.settings;
        with.escape_from_margin = false;
        auto expected = std::make_unique<Result>();
        WorkBudget unlimited(100'000'000);
        ASSERT_EQ(solve(second, with, scene.limits, scene.airframe, unlimited, *expected), PlanStatus::found);
        const float of_first = first->candidates[first->chosen].total;
        const float of_second = expected->candidates[expected->chosen].total;
        ASSERT_EQ(of_second > of_first + 0.05F, comes);
        ASSERT_EQ(of_first > of_second + 0.05F, !comes);
        const Candidate& chosen = scene.result.candidates[scene.result.chosen];
        EXPECT_NEAR(chosen.total, std::max(of_first, of_second), 1e-3F);
        EXPECT_EQ(chosen.duration, scene.result.path.duration());
    }
}

/// A found manoeuvre is fully paid for; if the work units end before, this is reported.
void expect_true_to_every_budget(const InARow& what, std::uint32_t step)
{
    InARow whole = what;
    ASSERT_EQ(whole.run_in_a_row(), PlanStatus::found);
    const std::uint32_t needed = whole.budget.spent();
    for (std::uint32_t units = 0; units <= 2 * needed; units += step) {
        InARow scene = what;
        scene.budget = WorkBudget{units};
        const PlanStatus status = scene.run_in_a_row();
        ASSERT_TRUE(status == PlanStatus::found || status == PlanStatus::budget_spent) << units << " of " << needed;
        ASSERT_EQ(scene.result.path.points.empty(), status != PlanStatus::found) << units;
        ASSERT_TRUE(status != PlanStatus::found || !scene.budget.exhausted()) << units << " of " << needed;
        ASSERT_TRUE(status != PlanStatus::found || units >= needed) << units << " of " << needed;
        ASSERT_EQ(scene.result.cut_short, status != PlanStatus::found) << units << " of " << needed;
    }
}

TEST(InARowWhole, EveryBudgetGivesAnAnswerThatIsTrue)
{
    InARow scene;
    scene.settings.extra_planes = 0;
    scene.threats.push_back(Scene::still(on_way_back(scene, 0.6F), 0.5F));
    expect_true_to_every_budget(scene, 1);
}

TEST(InARowWhole, EveryBudgetGivesATrueAnswerOnTheOtherSideToo)
{
    InARow scene;
    scene.settings.extra_planes = 0;
    scene.settings.offsets = 4;
    wall_off(scene, first_side(scene));
    expect_true_to_every_budget(scene, 2);
}

/// Two answers are the same: found or not, and the same path.
bool same(PlanStatus status, const Result& result, PlanStatus other_status, const Result& other)
{
    return status == other_status && result.path.points.size() == other.path.points.size() &&
           std::equal(result.path.points.begin(), result.path.points.end(), other.path.points.begin(),
                      [](const path::PathPoint& a, const path::PathPoint& b) { return a.position == b.position; });
}

TEST(InARowWhole, AnAnswerThatMoreChecksWouldChangeIsCutShort)
{
    InARow unlimited;
    unlimited.settings.evaluate_all = false;
    unlimited.settings.extra_planes = 1;
    const Vec3 side = first_side(unlimited);
    // Beside the first stage on that side, and the second threat on it: a flight there needs a detailed check.
    unlimited.threats.push_back(Scene::still(Vec3(14.0F, 0.0F, 50.0F) + 6.0F * side, 1.0F));
    unlimited.threats.push_back(Scene::still(Vec3(26.0F, 0.0F, 50.0F) + 6.0F * side, 1.0F));
    const InARow scene = unlimited;
    const PlanStatus answer = unlimited.run_in_a_row();
    ASSERT_EQ(answer, PlanStatus::found);
    std::size_t others = 0;
    for (std::uint32_t units = 0; units < 1000; ++units) {
        InARow limited = scene;
        limited.settings.check_units = units;
        const PlanStatus status = limited.run_in_a_row();
        const bool is_same = same(status, limited.result, answer, unlimited.result);
        ASSERT_TRUE(is_same || limited.result.cut_short) << units << " for checks";
        others += !is_same && status == PlanStatus::found ? 1U : 0U;
    }
    EXPECT_GT(others, 0U) << "on another side, which takes less work to check";
}

/// Many candidates, of which a small budget leaves most unseen.
TEST(InARowWhole, WithLessThanAllWorkEveryAnswerIsCutShort)
{
    InARow scene;
    scene.settings.evaluate_all = false;
    scene.settings.offsets = 32;
    scene.settings.check_units = 3000;
    InARow unlimited = scene;
    ASSERT_EQ(unlimited.run_in_a_row(), PlanStatus::found);
    EXPECT_FALSE(unlimited.result.cut_short);
    std::size_t found = 0;
    for (std::uint32_t units = 0; units < unlimited.budget.spent(); units += 50) {
        InARow limited = scene;
        limited.budget = WorkBudget{units};
        found += limited.run_in_a_row() == PlanStatus::found ? 1U : 0U;
        ASSERT_TRUE(limited.result.cut_short) << units << " in all";
    }
    EXPECT_GT(found, 0U);
}

/// The whole is flown and checked within the work units of one attempt; otherwise it is not used.
TEST(InARowWhole, WhatCannotBeCheckedIsNotTaken)
{
    InARow whole;
    whole.settings.extra_planes = 0;
    whole.settings.offsets = 2;
    ASSERT_EQ(whole.run_in_a_row(), PlanStatus::found);
    path::TimedPath about = whole.result.path;
    for (path::PathPoint& point : about.points) {
        point.position -= whole.problem.frame.origin;
    }
    detail::Flown flown(whole.problem, whole.settings, whole.limits);
    WorkBudget needed(1'000'000);
    ASSERT_EQ(flown.judge(about, 0.0F, needed).status, CandidateStatus::available);
    for (const bool enough : {true, false}) {
        InARow scene;
        scene.settings = whole.settings;
        scene.settings.check_units = needed.spent() - (enough ? 0U : 1U);
        EXPECT_EQ(scene.run_in_a_row(), enough ? PlanStatus::found : PlanStatus::none_available);
        EXPECT_EQ(scene.result.cut_short, !enough);
        // On either side the same work is done except for that unit; a budget of exactly this size suffices.
        const std::uint32_t spent = enough ? whole.budget.spent() : 2U * (whole.budget.spent() - 1U);
        EXPECT_EQ(scene.budget.spent(), spent);
        scene.budget = WorkBudget{spent};
        EXPECT_EQ(scene.run_in_a_row(), enough ? PlanStatus::found : PlanStatus::none_available);
    }
}

}  // namespace
}  // namespace jink::geometric
