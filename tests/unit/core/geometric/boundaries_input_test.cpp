// SPDX-License-Identifier: BSD-3-Clause
// Unconditional refusals, and the limits of "too close" and "too curved".
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "tests/oracle/collected.hpp"
#include "tests/unit/core/geometric/scene.hpp"

namespace jink::geometric {
namespace {

using world::PlanStatus;

TEST(InputBorder, CountsAreRefusedWhateverElseThereIsToTry)
{
    Settings settings;
    settings.wait = true;
    EXPECT_TRUE(is_valid(settings));
    settings.offsets = 0;
    EXPECT_FALSE(is_valid(settings)) << "the waits alone would be candidates enough";
}

TEST(InputBorder, TheApexLiesAheadAndSomewhere)
{
    constexpr float kInfinity = std::numeric_limits<float>::infinity();
    for (const float share : {0.0F, -1.0F, kInfinity, std::numeric_limits<float>::quiet_NaN()}) {
        Scene scene;
        scene.problem.apex_share = share;
        path::TimedPath path;
        EXPECT_FALSE(make_candidate_path(scene.problem, {Family::simple, 0.0F, 3.0F}, 25, scene.limits, path)) << share;
        EXPECT_EQ(scene.run(), PlanStatus::bad_input) << share;
    }
}

TEST(InputBorder, AWaitHasNoCurve)
{
    const Scene scene;
    path::TimedPath path;
    EXPECT_FALSE(make_candidate_path(scene.problem, {Family::wait, 0.0F, 3.0F}, 25, scene.limits, path));
    EXPECT_TRUE(path.points.empty());
    EXPECT_TRUE(make_candidate_path(scene.problem, {Family::plateau, 0.0F, 3.0F}, 25, scene.limits, path));
}

TEST(InputBorder, ACurveIsFlyableWhereverItBends)
{
    // Smooth, level: no bend at the start, 10 / sqrt(3) w v^2 / D^2 farther on, at 9 m/s against 5 m/s2: w = 4.3 m.
    for (const float offset : {3.8F, 5.0F}) {
        Scene scene;
        scene.settings.simple = scene.settings.symmetric = false;
        scene.settings.smooth = true;
        scene.settings.extra_planes = 0;
        scene.settings.verify_flight = false;
        scene.settings.waypoints = 64;
        scene.settings.offsets = 2;
        scene.settings.offset_rule = OffsetRule::source;
        scene.problem.main_radius = offset / 3.2F;
        scene.problem.body_radius = 1.0F;
        scene.problem.speed = 9.0F;
        scene.problem.start_velocity = Vec3(9.0F, 0.0F, 0.0F);
        EXPECT_EQ(scene.run(), offset < 4.0F ? PlanStatus::found : PlanStatus::none_available) << offset;
    }
}

/// A leg eastwards at 5 m/s, and tracks.
PlanStatus plan(const std::vector<world::Track>& tracks, WorkBudget& budget, Planner& planner)
{
    const TimePoint now{1'000'000};
    vehicle::VehicleState own;
    own.stamp = now;
    own.position = Vec3(0.0F, 0.0F, 50.0F);
    own.velocity = Vec3(5.0F, 0.0F, 0.0F);
    world::Reference reference;
    reference = world::Reference({Vec3(0.0F, 0.0F, 50.0F), Vec3(200.0F, 0.0F, 50.0F), 5.0F});
    const vehicle::VehicleLimits limits;
    const vehicle::Airframe airframe;
    const world::Airspace airspace;
    const world::FlightRules rules;
    world::Manoeuvre out;
    const oracle::Collected situation(world::Situation{now, own, limits, airframe, reference, rules},
                                      {tracks, {}, airspace});
    return planner.plan(situation, budget, out);
}

world::Track standing(const Vec3& position, float radius)
{
    world::Track track;
    track.id = 1;
    track.stamp = TimePoint{1'000'000};
    track.position = position;
    track.radius = radius;
    return track;
}

TEST(InputBorder, TooCloseGoesByTheBodyAndOffsetsByAllOfIt)
{
    // Radius half a metre, position uncertain by 4 m: 2.5 radii are far away, 2.5 times the clearing radius are not.
    world::Track track = standing(Vec3(16.0F, 0.0F, 50.0F), 0.5F);
    track.sigma_position = 2.0F;
    Settings settings;
    settings.evaluate_all = true;
    settings.retries = 0;
    settings.check_acceleration = settings.verify_flight = false;
    Planner planner{settings};
    WorkBudget budget{1'000'000};
    EXPECT_EQ(plan({track}, budget, planner), PlanStatus::found);
    ASSERT_FALSE(planner.last().candidates.empty());
    for (const Candidate& c : planner.last().candidates) {
        EXPECT_GE(std::abs(c.shape.offset), 0.5F + 3.0F * 2.0F + 1.0F);
    }
}

TEST(InputBorder, WithoutWorkNobodyKnowsThatNothingIsInTheWay)
{
    Planner planner{Settings{}};
    std::vector<world::Track> far;
    for (int i = 0; i < 8; ++i) {
        far.push_back(standing(Vec3(30.0F, 40.0F + static_cast<float>(i), 50.0F), 1.0F));
    }
    WorkBudget ample{1'000'000};
    ASSERT_EQ(plan(far, ample, planner), PlanStatus::no_conflict);
    for (std::uint32_t units = 0; units < ample.spent(); ++units) {
        WorkBudget budget{units};
        ASSERT_EQ(plan(far, budget, planner), PlanStatus::budget_spent) << units;
    }
    WorkBudget exact{ample.spent()};
    EXPECT_EQ(plan(far, exact, planner), PlanStatus::no_conflict);
}

}  // namespace
}  // namespace jink::geometric
