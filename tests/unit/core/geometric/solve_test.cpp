// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "core/geometric/planner.hpp"
#include "tests/numbers.hpp"
#include "tests/unit/core/geometric/scene.hpp"

namespace jink::geometric {
namespace {

using world::PlanStatus;

TEST(Solve, FindsAWayRoundOneStaticThreat)
{
    Scene scene;
    ASSERT_EQ(scene.run(), PlanStatus::found);
    EXPECT_EQ(scene.result.candidates.size(), 32U);
    EXPECT_EQ(scene.count(CandidateStatus::chosen), 1U);
    const Candidate& chosen = scene.result.candidates[scene.result.chosen];
    EXPECT_EQ(chosen.status, CandidateStatus::chosen);
    EXPECT_EQ(chosen.shape.plane, 0.0F);  // level costs least
    EXPECT_EQ(cost::normalise(chosen.terms, scene.settings.caps).closeness, 0.0F);
    EXPECT_EQ(scene.result.path.points.size(), 25U);
    EXPECT_EQ(scene.result.path.points.front().position, Vec3(0.0F, 0.0F, 50.0F));
    EXPECT_FLOAT_EQ(scene.result.path.duration(), chosen.duration);
    EXPECT_NEAR(scene.result.side.norm(), 1.0F, 1e-5F);
    EXPECT_LT(scene.result.side.y(), 0.0F);  // of two equal candidates the first generated: to the right
}

TEST(Solve, OrderOfGeneration)
{
    Scene scene;
    ASSERT_EQ(scene.run(), PlanStatus::found);
    const auto& c = scene.result.candidates;
    for (std::size_t i = 0; i < c.size(); ++i) {
        EXPECT_EQ(c[i].shape.family, i < 16 ? Family::simple : Family::symmetric);
        EXPECT_FLOAT_EQ(c[i].shape.plane, kPi * static_cast<float>((i / 4) % 4) / 4.0F);
        if (i % 4 != 0) {
            EXPECT_GT(c[i].shape.offset, c[i - 1].shape.offset);
        }
    }
}

TEST(Solve, SourceOffsetsAreThoseOfTheText)
{
    Scene scene;
    scene.settings = source_settings();
    ASSERT_EQ(scene.run(), PlanStatus::found);
    ASSERT_EQ(scene.result.candidates.size(), 32U);
    const std::array<float, 4> expected{-3.2F, -1.6F, 1.6F, 3.2F};
    for (std::size_t i = 0; i < 32; ++i) {
        EXPECT_FLOAT_EQ(scene.result.candidates[i].shape.offset, expected[i % 4]);
    }
    scene.settings.source_drop_margin = 1.0F;
    ASSERT_EQ(scene.run(), PlanStatus::found);
    EXPECT_EQ(scene.result.candidates.size(), 16U);  // 1.6 R < R + 1 m
    scene.settings.offsets = 12;
    ASSERT_EQ(scene.run(), PlanStatus::found);
    EXPECT_EQ(scene.result.candidates.size(), 48U);  // 2.1333, 2.6667, 3.2
    EXPECT_NEAR(scene.result.candidates[3].shape.offset, 2.1333F, 1e-4F);
}

TEST(Solve, ClearingOffsetsAllClearTheMainThreatAtRest)
{
    for (const float radius : {0.5F, 1.0F, 2.0F, 3.0F}) {
        for (const float factor : {2.5F, 3.0F, 4.0F, 6.0F, 12.0F, 40.0F}) {
            const float distance = factor * radius;
            if (distance < radius + 2.5F) {
                continue;  // the start is inside the margin
            }
            Scene scene;
            scene.settings.check_acceleration = false;
            scene.settings.verify_flight = false;
            scene.settings.offsets = 8;
            scene.settings.simple = distance > 4.0F * (radius + 1.0F);  // nearer, it comes back upon the threat
            scene.problem.main_radius = radius;
            scene.problem.distance = distance;
            scene.threats = {Scene::still(Vec3(distance, 0.0F, 50.0F), radius)};
            ASSERT_EQ(scene.run(), PlanStatus::found);
            EXPECT_EQ(scene.count(CandidateStatus::available) + 1, scene.result.candidates.size())
                << "R " << radius << " D " << distance;
        }
    }
}

TEST(Solve, ClearingOffsetsFollowAnOffCentreThreat)
{
    Scene scene;
    scene.threats = {Scene::still(Vec3(20.0F, 1.2F, 50.0F), 1.0F)};
    scene.problem.main_centre_offset = Vec3(0.0F, 1.2F, 0.0F);
    ASSERT_EQ(scene.run(), PlanStatus::found);
    const Candidate& chosen = scene.result.candidates[scene.result.chosen];
    EXPECT_LT(chosen.shape.offset, 0.0F);
    EXPECT_NEAR(chosen.shape.offset, -0.85F, 0.1F);  // R + 1 m - 1.2 m + slack
}

TEST(Solve, ClearingOffsetsOfABox)
{
    Scene scene;
    scene.threats.clear();
    scene.problem.main = kNoThreat;
    scene.obstacles = {{1, geometry::make_box(Vec3(20.0F, 2.0F, 50.0F), Vec3(1.0F, 4.0F, 10.0F))}};
    scene.problem.main_shape = &scene.obstacles[0].shape;
    scene.problem.main_radius = 3.0F;
    ASSERT_EQ(scene.run(), PlanStatus::found);
    const Candidate& chosen = scene.result.candidates[scene.result.chosen];
    EXPECT_EQ(chosen.shape.plane, 0.0F);
    EXPECT_LT(chosen.shape.offset, -3.05F);  // 2 m of box on the right, 1 m of vehicle
    EXPECT_GT(chosen.shape.offset, -3.5F);
}

TEST(Solve, WidenedSpanContinuesWhereTheFirstEnded)
{
    Scene scene;
    scene.settings.check_acceleration = false;
    ASSERT_EQ(scene.run(), PlanStatus::found);
    const float widest = scene.result.candidates[3].shape.offset;
    const float narrowest = scene.result.candidates[2].shape.offset;
    scene.problem.span_from = 1.0F;
    scene.problem.span_to = 2.0F;
    ASSERT_EQ(scene.run(), PlanStatus::found);
    EXPECT_GT(scene.result.candidates[2].shape.offset, widest);
    EXPECT_NEAR(scene.result.candidates[3].shape.offset, narrowest + 2.0F * (widest - narrowest), 1e-4F);
}

TEST(SolveStatus, TooClose)
{
    Scene scene;
    scene.problem.distance = 2.49F;
    EXPECT_EQ(scene.run(), PlanStatus::too_close);
    EXPECT_TRUE(scene.result.candidates.empty());
}

TEST(SolveStatus, NoneAvailableInASphereTooLarge)
{
    Scene scene;
    scene.threats.push_back(Scene::still(Vec3(25.0F, 0.0F, 50.0F), 20.0F));
    EXPECT_EQ(scene.run(), PlanStatus::none_available);
    EXPECT_EQ(scene.count(CandidateStatus::available), 0U);
    EXPECT_TRUE(scene.result.path.points.empty());
}

TEST(SolveStatus, NoneCheapEnough)
{
    Scene scene;
    scene.settings.max_cost = 0.01F;
    EXPECT_EQ(scene.run(), PlanStatus::none_available);
    EXPECT_GT(scene.count(CandidateStatus::available), 0U);
}

TEST(SolveStatus, BudgetSpentLeavesTheRestNotEvaluated)
{
    std::size_t begun = 0;
    for (std::uint32_t units = 0; units <= 400; ++units) {
        Scene scene;
        scene.budget = WorkBudget{units};
        EXPECT_EQ(scene.run(), PlanStatus::budget_spent) << units;
        EXPECT_TRUE(scene.result.cut_short) << units;
        EXPECT_EQ(scene.count(CandidateStatus::chosen), 0U) << units;
        // Before the candidates can be listed there are none.
        begun += scene.result.candidates.empty() ? 0U : 1U;
        EXPECT_EQ(scene.count(CandidateStatus::not_evaluated) > 0U, !scene.result.candidates.empty()) << units;
    }
    EXPECT_GT(begun, 0U);
    EXPECT_LT(begun, 400U);
}

TEST(SolveStatus, WhatWasFoundBeforeTheBudgetEndedMayBeChosen)
{
    Scene scene;
    scene.settings.verify_flight = false;
    ASSERT_EQ(scene.run(), PlanStatus::found);
    scene.budget = WorkBudget{scene.budget.spent()};  // half of it is kept
    ASSERT_EQ(scene.run(), PlanStatus::found);
    EXPECT_GT(scene.count(CandidateStatus::not_evaluated), 0U);
}

TEST(SolveStatus, WhatIsKeptForCheckingIsEnoughForTheBestSoFar)
{
    // However early the budget ends among the candidates: once one of them is known to be clear it can still be flown.
    Scene whole;
    ASSERT_EQ(whole.run(), PlanStatus::found);
    const std::uint32_t all = whole.budget.spent();
    std::size_t chosen = 0;
    for (std::uint32_t units = all / 2; units < all; units += 17) {
        Scene scene;
        scene.budget = WorkBudget{units};
        const PlanStatus status = scene.run();
        EXPECT_TRUE(status == PlanStatus::found || status == PlanStatus::budget_spent);
        EXPECT_LE(scene.budget.spent(), units);
        chosen += status == PlanStatus::found ? 1U : 0U;
    }
    EXPECT_GT(chosen, 0U);
}

TEST(CheckUnits, OneThatIsTooSmallTakesNothing)
{
    Scene scene;
    scene.settings.check_units = 100;
    EXPECT_EQ(scene.run(), PlanStatus::none_available);
    EXPECT_GT(scene.count(CandidateStatus::not_evaluated), 0U);
    EXPECT_EQ(scene.count(CandidateStatus::chosen), 0U);
    EXPECT_TRUE(scene.result.cut_short);
    scene.settings.check_units = 1000;
    EXPECT_EQ(scene.run(), PlanStatus::found);
    EXPECT_FALSE(scene.result.cut_short);
}

TEST(CheckUnits, BoundTheWorkOfCheckingWhateverIsInTheWay)
{
    Scene scene;
    scene.settings.evaluate_all = scene.settings.all_terms = false;
    scene.settings.simple = false;
    scene.obstacles = {{1, geometry::make_box(Vec3(43.0F, 0.0F, 50.0F), Vec3(1.0F, 60.0F, 60.0F))}};
    std::uint32_t before = 0;
    for (const std::uint32_t units : {0U, 300U, 1000U, 3000U}) {
        scene.settings.check_units = units;
        scene.budget = WorkBudget{1'000'000};
        EXPECT_EQ(scene.run(), PlanStatus::none_available) << units;
        const std::uint32_t spent = scene.budget.spent();
        EXPECT_GE(spent, before);
        before = units == 0 ? spent : before;  // the cost before the checks
        EXPECT_LE(spent, before + 2 * units);  // twice for one solid
    }
}

TEST(SolveStatus, EveryBudgetGivesAnAnswerThatIsSafe)
{
    for (std::uint32_t units = 0; units < 3000; units += 37) {
        Scene scene;
        scene.threats.push_back({{Vec3(20.0F, 12.0F, 50.0F), Vec3(0.0F, -3.0F, 0.0F)}, 1.0F});
        scene.budget = WorkBudget{units};
        const PlanStatus status = scene.run();
        ASSERT_TRUE(status == PlanStatus::found || status == PlanStatus::budget_spent) << units;
        if (status == PlanStatus::found) {
            ASSERT_EQ(scene.result.candidates[scene.result.chosen].status, CandidateStatus::chosen);
        }
        ASSERT_LE(scene.budget.spent(), units);
    }
}

TEST(SolveStatus, BadInput)
{
    const auto refused = [](auto change) {
        Scene scene;
        change(scene);
        const PlanStatus status = scene.run();
        return status == PlanStatus::bad_input && scene.result.candidates.empty();
    };
    EXPECT_TRUE(refused([](Scene& s) { s.problem.distance = kNan; }));
    EXPECT_TRUE(refused([](Scene& s) { s.problem.distance = 0.0F; }));
    EXPECT_TRUE(refused([](Scene& s) { s.problem.main_radius = 0.0F; }));
    EXPECT_TRUE(refused([](Scene& s) { s.problem.speed = -1.0F; }));
    EXPECT_TRUE(refused([](Scene& s) { s.problem.body_radius = -1.0F; }));
    EXPECT_TRUE(refused([](Scene& s) { s.problem.main = 1; }));
    EXPECT_TRUE(refused([](Scene& s) { s.uncertainty = -1.0F; }));
    EXPECT_TRUE(refused([](Scene& s) { s.problem.span_from = kNan; }));
    EXPECT_TRUE(refused([](Scene& s) { s.problem.span_to = -1.0F; }));
    EXPECT_TRUE(refused([](Scene& s) { s.problem.start_velocity.x() = kNan; }));
    EXPECT_TRUE(refused([](Scene& s) { s.problem.preferred_side.x() = kNan; }));
    EXPECT_TRUE(refused([](Scene& s) { s.problem.main_centre_offset.x() = kNan; }));
    EXPECT_TRUE(refused([](Scene& s) { s.problem.frame.origin.x() = kNan; }));
    EXPECT_TRUE(refused([](Scene& s) { s.problem.frame.axes *= 2.0F; }));
    EXPECT_TRUE(refused([](Scene& s) { s.threats[0].motion.position.y() = kNan; }));
    EXPECT_TRUE(refused([](Scene& s) { s.threats[0].motion.velocity.y() = kNan; }));
    EXPECT_TRUE(refused([](Scene& s) { s.threats[0].radius = -1.0F; }));
    EXPECT_TRUE(refused([](Scene& s) { s.threats[0].radius_rate = kNan; }));
    EXPECT_TRUE(refused([](Scene& s) { s.threats[0].radius_acceleration = -1.0F; }));
    EXPECT_TRUE(refused([](Scene& s) { s.threats.resize(kMaxTracks + 1, s.threats[0]); }));
    EXPECT_TRUE(refused([](Scene& s) { s.obstacles = {{1, geometry::make_sphere(Vec3::Zero(), -1.0F)}}; }));
    EXPECT_TRUE(refused([](Scene& s) { s.obstacles.resize(kMaxObstacles + 1); }));
    EXPECT_TRUE(refused([](Scene& s) { s.limits.max_climb = 0.0F; }));
    EXPECT_TRUE(refused([](Scene& s) { s.airframe.mass = 0.0F; }));
    EXPECT_TRUE(refused([](Scene& s) { s.settings.offsets = 3; }));
}

TEST(SettingsValid, EachRange)
{
    EXPECT_TRUE(is_valid(Settings{}));
    EXPECT_TRUE(is_valid(source_settings()));
    const auto invalid = [](auto change) {
        Settings settings;
        change(settings);
        return !is_valid(settings);
    };
    EXPECT_TRUE(invalid([](Settings& s) { s.offsets = 0; }));
    EXPECT_TRUE(invalid([](Settings& s) { s.offsets = 5; }));
    EXPECT_TRUE(invalid([](Settings& s) { s.offsets = 66; }));
    EXPECT_TRUE(invalid([](Settings& s) { s.extra_planes = 32; }));
    EXPECT_TRUE(invalid([](Settings& s) { s.simple = s.symmetric = false; }));
    EXPECT_TRUE(invalid([](Settings& s) { s.waypoints = 7; }));
    EXPECT_TRUE(invalid([](Settings& s) { s.waypoints = kMaxPathPoints + 1; }));
    EXPECT_TRUE(invalid([](Settings& s) {
        s.offsets = 64;
        s.extra_planes = 31;
    }));  // more than kMaxCandidates
    EXPECT_TRUE(invalid([](Settings& s) { s.source_drop_margin = -1.0F; }));
    EXPECT_TRUE(invalid([](Settings& s) { s.rotation_penalty = kNan; }));
    EXPECT_TRUE(invalid([](Settings& s) { s.flip_penalty = -0.1F; }));
    EXPECT_TRUE(invalid([](Settings& s) { s.weights.time = 0.0F; }));
    EXPECT_TRUE(invalid([](Settings& s) { s.caps.energy_low = kNan; }));
    EXPECT_TRUE(invalid([](Settings& s) { s.max_cost = 0.0F; }));
    EXPECT_TRUE(invalid([](Settings& s) { s.max_cost = 1.1F; }));
    EXPECT_TRUE(invalid([](Settings& s) { s.retries = 10; }));
}

TEST(Solve, SettingsThatTakeTimeAwareAndSweptApart)
{
    Scene scene;
    scene.settings.simple = false;
    // It will cross the leg's far end long before the vehicle is there.
    scene.threats.push_back({{Vec3(33.0F, -6.0F, 50.0F), Vec3(0.0F, 4.0F, 0.0F)}, 1.0F});
    ASSERT_EQ(scene.run(), PlanStatus::found);
    const std::size_t time_aware = scene.count(CandidateStatus::hits_moving);
    scene.settings.security = SecurityMode::swept;
    static_cast<void>(scene.run());
    EXPECT_GT(scene.count(CandidateStatus::hits_moving), time_aware);
}

}  // namespace
}  // namespace jink::geometric
