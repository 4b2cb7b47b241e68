// SPDX-License-Identifier: BSD-3-Clause
// The chosen candidate, reports on the others, and their cost in work units, at the last number before each limit.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/work_units.hpp"
#include "tests/unit/core/geometric/scene.hpp"

namespace jink::geometric {
namespace {

using world::PlanStatus;

float below(float x) { return std::nextafter(x, -std::numeric_limits<float>::infinity()); }

TEST(ChoiceBorder, ALegAlmostVerticalHasItsNormalUpToTheLimit)
{
    // At 1e-4 from the vertical the horizontal normal is still the leg's; below it north takes its place.
    const auto normal_of = [](float aside) {
        return Vec3(make_path_frame(Vec3::Zero(), Vec3(0.0F, aside, 1.0F)).axes.col(1));
    };
    EXPECT_NEAR(normal_of(1e-4F).x(), -1.0F, 1e-5F);
    EXPECT_NEAR(normal_of(1e-4F).y(), 0.0F, 1e-5F);
    EXPECT_NEAR(normal_of(0.99e-4F).y(), 1.0F, 1e-3F);
}

TEST(ChoiceBorder, TheGreatestCostThatIsTakenIsTheLimitItself)
{
    for (const bool all : {false, true}) {
        Scene scene;
        scene.settings.evaluate_all = all;
        ASSERT_EQ(scene.run(), PlanStatus::found);
        const float cheapest = scene.result.candidates[scene.result.chosen].total;
        scene.settings.max_cost = cheapest;
        EXPECT_EQ(scene.run(), PlanStatus::found);
        scene.settings.max_cost = below(cheapest);
        EXPECT_EQ(scene.run(), PlanStatus::none_available);
    }
}

TEST(ChoiceBorder, APlaneAlmostSquareToWhatIsFlownIsOnNeitherSide)
{
    // As far as a thousandth towards the other side, and not a bit farther.
    const auto penalised = [](float aside) {
        Scene scene;
        scene.settings.check_acceleration = false;
        scene.problem.preferred_side = Vec3(0.0F, aside, 0.0F);
        EXPECT_EQ(scene.run(), PlanStatus::found);
        std::size_t count = 0;
        for (const Candidate& c : scene.result.candidates) {
            // In the level plane the side is y to the bit.
            count += c.shape.plane == 0.0F && c.shape.offset > 0.0F && c.flip_penalty > 0.0F ? 1U : 0U;
        }
        return count;
    };
    EXPECT_EQ(penalised(-1e-3F), 0U);
    EXPECT_GT(penalised(below(-1e-3F)), 0U);
    EXPECT_EQ(penalised(1.0F), 0U);
}

TEST(ChoiceBorder, EnergyIsReportedWhereItIsAskedFor)
{
    Scene scene;
    scene.settings.all_terms = false;
    ASSERT_EQ(scene.run(), PlanStatus::found);
    for (const Candidate& c : scene.result.candidates) {
        EXPECT_EQ(c.terms.energy, 0.0F);
        EXPECT_EQ(c.terms.hover_power, 0.0F);
    }
    scene.settings.all_terms = true;
    ASSERT_EQ(scene.run(), PlanStatus::found);
    EXPECT_GT(scene.result.candidates[scene.result.chosen].terms.energy, 0.0F);
    EXPECT_GT(scene.result.candidates[scene.result.chosen].terms.hover_power, 0.0F);
}

TEST(ChoiceBorder, WhatIsNotLookedAtIsNotCalledAvailable)
{
    // Without evaluate_all no candidate more expensive than the chosen one is checked: a sphere in contact only with
    // those stays unfound.
    Scene scene;
    scene.settings.evaluate_all = false;
    ASSERT_EQ(scene.run(), PlanStatus::found);
    const Candidate& chosen = scene.result.candidates[scene.result.chosen];
    EXPECT_EQ(scene.count(CandidateStatus::available), 0U);
    EXPECT_GT(scene.count(CandidateStatus::not_evaluated), 0U);
    scene.threats.push_back(Scene::still(Vec3(20.0F, chosen.shape.offset > 0.0F ? -5.0F : 5.0F, 50.0F), 0.5F));
    ASSERT_EQ(scene.run(), PlanStatus::found);
    EXPECT_EQ(scene.count(CandidateStatus::hits_static), 0U);
    scene.settings.evaluate_all = true;
    ASSERT_EQ(scene.run(), PlanStatus::found);
    EXPECT_GT(scene.count(CandidateStatus::hits_static), 0U);
    EXPECT_GT(scene.count(CandidateStatus::available), 0U);
    // Nor candidates beyond the checks' share of work.
    scene.settings.check_units = units::kCandidatePoint * scene.settings.waypoints;
    EXPECT_EQ(scene.run(), PlanStatus::none_available);
    EXPECT_EQ(scene.count(CandidateStatus::available), 0U);
    EXPECT_TRUE(scene.result.cut_short);
}

TEST(ChoiceBorder, ACurveThatIsKnownToBeClearIsMadeAgainAndNoMore)
{
    Scene scene;
    scene.settings.verify_flight = false;
    scene.settings.check_units = units::kCandidatePoint * scene.settings.waypoints;
    EXPECT_EQ(scene.run(), PlanStatus::found);
    EXPECT_FALSE(scene.result.cut_short);
    scene.settings.check_units -= 1;
    EXPECT_EQ(scene.run(), PlanStatus::none_available);
    EXPECT_TRUE(scene.result.cut_short);
}

TEST(ChoiceBorder, CostsArePaidForWhatIsClearAlone)
{
    // Moving threats far above: out of reach of all, but each counts for how close a candidate comes.
    const auto spent = [](std::size_t far, bool blocked) {
        Scene scene;
        scene.settings.verify_flight = false;
        if (blocked) {
            scene.threats.push_back(Scene::still(Vec3(25.0F, 0.0F, 50.0F), 20.0F));
        }
        for (std::size_t i = 0; i < far; ++i) {
            scene.threats.push_back({{Vec3(0.0F, 0.0F, 5000.0F), Vec3(1.0F, 0.0F, 0.0F)}, 1.0F});
        }
        EXPECT_EQ(scene.run(), blocked ? PlanStatus::none_available : PlanStatus::found);
        EXPECT_EQ(scene.result.candidates.size(), 32U);
        const std::size_t clear = scene.count(CandidateStatus::available) + scene.count(CandidateStatus::chosen);
        EXPECT_EQ(clear == 0, blocked);
        for (const Candidate& c : scene.result.candidates) {
            const bool is_clear = c.status == CandidateStatus::available || c.status == CandidateStatus::chosen;
            EXPECT_EQ(c.total > 0.0F, is_clear);
        }
        const std::uint32_t costs = static_cast<std::uint32_t>(clear) * units::closeness_units(25, far);
        return scene.budget.spent() - costs -
               (units::kThreatValid + units::kCollected) * static_cast<std::uint32_t>(far);
    };
    EXPECT_EQ(spent(0, false), spent(9, false));
    EXPECT_EQ(spent(0, true), spent(9, true));
}

/// Every budget up to slightly more than needed: the status is true.
void expect_true_to_every_budget(const Settings& settings)
{
    Scene whole;
    whole.settings = settings;
    ASSERT_EQ(whole.run(), PlanStatus::found);
    EXPECT_FALSE(whole.result.cut_short);
    const std::uint32_t needed = whole.budget.spent();
    std::size_t ended = 0;
    for (std::uint32_t units = 0; units <= 2 * needed; ++units) {
        Scene scene;
        scene.settings = settings;
        scene.budget = WorkBudget{units};
        const PlanStatus status = scene.run();
        ASSERT_TRUE(status == PlanStatus::found || status == PlanStatus::budget_spent) << units;
        ASSERT_LE(scene.budget.spent(), units);
        if (status == PlanStatus::found) {
            ASSERT_FALSE(scene.budget.exhausted()) << units << ": what is found has been paid for";
        } else {
            ASSERT_TRUE(scene.result.cut_short) << units;
            ++ended;
        }
        ASSERT_EQ(scene.count(CandidateStatus::chosen), status == PlanStatus::found ? 1U : 0U);
        // With every candidate checked, an unchecked one was cut off by the budget.
        if (settings.evaluate_all && scene.count(CandidateStatus::not_evaluated) > 0) {
            ASSERT_TRUE(scene.result.cut_short) << units;
        }
    }
    EXPECT_GT(ended, 0U);
}

TEST(ChoiceBorder, ABudgetThatEndsIsReportedAndNeverOverdrawn)
{
    Settings settings = every_candidate();
    expect_true_to_every_budget(settings);
    settings.evaluate_all = false;
    expect_true_to_every_budget(settings);
    // Two candidates, which cost less to make than the first of them to fly.
    settings.simple = false;
    settings.offsets = 2;
    settings.extra_planes = 0;
    expect_true_to_every_budget(settings);
}

TEST(ChoiceBorder, NoMoreIsKeptForCheckingThanItMayTake)
{
    Scene scene;
    scene.settings.check_units = 400;
    ASSERT_EQ(scene.run(), PlanStatus::found);
    const std::uint32_t spent = scene.budget.spent();
    ASSERT_GT(spent, 4 * scene.settings.check_units);
    // Enough for all work and the reserve, far less than twice that.
    scene.budget = WorkBudget{spent + scene.settings.check_units};
    EXPECT_EQ(scene.run(), PlanStatus::found);
    EXPECT_FALSE(scene.result.cut_short);
    EXPECT_EQ(scene.count(CandidateStatus::not_evaluated), 0U);
}

TEST(ChoiceBorder, TheLargestShareOfWorkIsNoLessThanASmallerOne)
{
    // One solid doubles the cost, beyond the range of its counter.
    Scene scene;
    scene.settings.evaluate_all = false;
    scene.settings.check_units = 0x80000000U;
    scene.obstacles = {{1, geometry::make_box(Vec3(20.0F, 6.0F, 50.0F), Vec3::Ones())}};
    EXPECT_EQ(scene.run(), PlanStatus::found);
    EXPECT_FALSE(scene.result.cut_short);
}

TEST(ChoiceBorder, NoTotalIsAboveOne)
{
    // Weights whose sum is above 1 by the rounding tolerance, every term at its largest.
    Scene scene;
    scene.settings.check_acceleration = scene.settings.verify_flight = false;
    scene.settings.weights = {0.40005F, 0.10F, 0.50F};
    scene.settings.caps.time_low = 1e-3F;
    scene.settings.caps.time_high = 2e-3F;
    scene.settings.rotation_penalty = 1e6F;
    scene.limits.half_extents = Vec3::Constant(0.05F);
    // Alongside the whole path, half a metre beside it, and the curves not much farther.
    scene.problem.main_radius = 0.3F;
    scene.threats = {Scene::still(Vec3(20.0F, 0.0F, 50.0F), 0.3F),
                     {{Vec3(0.0F, 0.0F, 49.0F), Vec3(5.0F, 0.0F, 0.0F)}, 0.2F}};
    ASSERT_EQ(scene.run(), PlanStatus::found);
    std::size_t worst = 0;
    for (const Candidate& c : scene.result.candidates) {
        EXPECT_LE(c.total, 1.0F);
        const cost::NormalisedTerms n = cost::normalise(c.terms, scene.settings.caps);
        worst += n.time == 1.0F && n.smoothness_penalised == 1.0F && n.closeness == 1.0F ? 1U : 0U;
    }
    EXPECT_GT(worst, 0U);
}

}  // namespace
}  // namespace jink::geometric
