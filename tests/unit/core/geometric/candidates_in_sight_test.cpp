// SPDX-License-Identifier: BSD-3-Clause
// No threat within a candidate's reach is excluded as far: waits with a near apex, curves that outlast waits, threats
// behind a bend. And requested reports on candidates.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "firmware/vehicles/default/cost_tables.hpp"
#include "tests/unit/core/geometric/scene.hpp"

namespace jink::geometric {
namespace {

using world::PlanStatus;

/// Curves and waits checked as such; no threats.
struct Unhindered : Scene {
    Unhindered()
    {
        settings.check_acceleration = settings.verify_flight = false;
        threats.clear();
        problem.main = kNoThreat;
    }
    std::vector<float> offsets()
    {
        EXPECT_EQ(run(), PlanStatus::found);
        std::vector<float> all;
        for (const Candidate& c : result.candidates) {
            all.push_back(c.shape.offset);
        }
        return all;
    }
};

TEST(InSight, WaitsAreWatchedToTheirEndHoweverNearTheApexIs)
{
    Unhindered scene;
    scene.settings.simple = scene.settings.symmetric = false;
    scene.settings.wait = true;
    scene.problem.apex_share = 0.25F;
    // At 3 m/s for twice the 4 s to the collision point: past it by then, far past the end of any curve.
    scene.threats = {Scene::still(Vec3(22.0F, 0.0F, 50.0F), 0.5F)};
    static_cast<void>(scene.run());
    std::size_t longest = 0;
    for (const Candidate& c : scene.result.candidates) {
        if (c.shape.share == kWaitShares[0] && c.shape.until == 8.0F) {
            ++longest;
            EXPECT_EQ(c.status, CandidateStatus::hits_static);
        }
    }
    EXPECT_EQ(longest, 1U);
}

TEST(InSight, CurvesThatOutlastWaitsAreWatchedToTheirEnd)
{
    Unhindered scene;
    scene.settings.simple = false;
    scene.settings.wait = true;
    scene.limits.max_climb = scene.limits.max_descent = 0.2F;
    ASSERT_EQ(scene.run(), PlanStatus::found);
    std::vector<Candidate> curves(scene.result.candidates.begin(), scene.result.candidates.end() - kWaits);
    Seconds longest_wait = 0.0F;
    for (std::size_t i = curves.size(); i < scene.result.candidates.size(); ++i) {
        longest_wait = std::max(longest_wait, scene.result.candidates[i].duration);
    }
    std::size_t longer = 0;
    for (std::size_t i = 0; i < curves.size(); ++i) {
        path::TimedPath path;
        ASSERT_TRUE(make_candidate_path(scene.problem, curves[i].shape, scene.settings.waypoints, scene.limits, path));
        longer += path.duration() > longest_wait + 3.0F ? 1U : 0U;
        const Seconds then = path.duration() - 0.02F;
        const Vec3 velocity(0.0F, 6.0F, 0.0F);
        scene.threats = {{{path::sample(path, then).position - then * velocity, velocity}, 0.1F}};
        static_cast<void>(scene.run());
        EXPECT_EQ(scene.result.candidates[i].status, CandidateStatus::hits_moving) << curves[i].shape.offset;
    }
    EXPECT_GT(longer, 0U);
}

/// East for 10 m, a quarter turn to the left about (10, 10), then north.
path::Route bend()
{
    path::Route route;
    EXPECT_EQ(route.add_leg(Vec3(0.0F, 0.0F, 50.0F), Vec3(10.0F, 0.0F, 50.0F)), path::RouteStatus::ok);
    EXPECT_EQ(route.add_arc(Vec3(10.0F, 0.0F, 50.0F), Vec3(10.0F, 10.0F, 50.0F), Vec3::UnitZ(), 0.5F * kPi),
              path::RouteStatus::ok);
    EXPECT_EQ(route.add_leg(Vec3(20.0F, 10.0F, 50.0F), Vec3(20.0F, 90.0F, 50.0F)), path::RouteStatus::ok);
    return route;
}

TEST(InSight, WhatStandsBehindABendIsMet)
{
    const path::Route route = bend();
    Unhindered scene;
    scene.settings.simple = false;
    scene.problem.ahead.route = route;
    ASSERT_EQ(scene.run(), PlanStatus::found);
    // 2 m before the end of all of them, on the route and so blocking each.
    scene.threats = {Scene::still(Vec3(20.0F, 22.0F, 50.0F), 0.5F)};
    EXPECT_EQ(scene.run(), PlanStatus::none_available);
    EXPECT_EQ(scene.count(CandidateStatus::hits_static), scene.result.candidates.size());
}

/// A threat beside the collision point requires the same offsets to the left and right of the path there, for any
/// course of the vehicle at the start.
TEST(InSight, OffsetsAreToTheSidesOfTheCollisionPoint)
{
    const path::Route route = bend();
    for (const float left : {2.0F, -1.5F}) {
        Unhindered straight;
        straight.problem.distance = 30.0F;
        straight.problem.main_centre_offset = Vec3(0.0F, left, 0.5F);
        Unhindered bent;
        bent.problem.distance = 30.0F;
        bent.problem.ahead.route = route;
        bent.problem.main_centre_offset = Vec3(-left, 0.0F, 0.5F);
        const std::vector<float> expected = straight.offsets();
        const std::vector<float> offsets = bent.offsets();
        ASSERT_EQ(offsets.size(), expected.size());
        for (std::size_t i = 0; i < offsets.size(); ++i) {
            EXPECT_NEAR(offsets[i], expected[i], 0.01F) << i;
        }
    }
}

TEST(InSight, OfMovingSolidsTheNearestSurfaceCountsFirst)
{
    const Vec3 slow(0.01F, 0.0F, 0.0F);
    const auto solid = [&](const Vec3& centre, float half, float uncertainty) {
        MovingSolid s;
        s.shape = geometry::make_box(centre, Vec3::Constant(half));
        s.velocity = slow;
        s.uncertainty = uncertainty;
        return s;
    };
    const MovingSolid small = solid(Vec3(0.0F, 30.0F, 50.0F), 0.3F, 0.0F);
    // Farther away, but each within 20 m of the start with its bounding sphere, with its stated clearance.
    for (const MovingSolid& large :
         {solid(Vec3(0.0F, -40.0F, 50.0F), 11.5F, 0.0F), solid(Vec3(0.0F, -40.0F, 50.0F), 6.0F, 10.0F)}) {
        const auto closeness = [](const std::vector<MovingSolid>& solids) {
            Unhindered scene;
            scene.settings.closeness_nearest = 1;
            scene.solids = solids;
            EXPECT_EQ(scene.run(), PlanStatus::found);
            std::vector<float> all;
            for (const Candidate& c : scene.result.candidates) {
                all.push_back(c.terms.closeness);
            }
            return all;
        };
        ASSERT_NE(closeness({small}), closeness({large}));
        EXPECT_EQ(closeness({small, large}), closeness({large}));
        EXPECT_EQ(closeness({large, small}), closeness({large}));
    }
}

TEST(InSight, TermsAreReportedWhereTheyCountOrAreAskedFor)
{
    struct Case {
        bool all_terms;
        float passing;
        float beyond;
    };
    for (const Case& c : {Case{false, 0.0F, 0.0F}, {false, 0.1F, 0.0F}, {false, 0.0F, 0.1F}, {true, 0.0F, 0.0F}}) {
        Unhindered scene;
        scene.threats = {{{Vec3(30.0F, 25.0F, 50.0F), Vec3(0.0F, -2.0F, 0.0F)}, 1.0F}};
        scene.settings.all_terms = c.all_terms;
        scene.settings.weights = {0.3F, 0.2F, 0.5F - c.passing - c.beyond, c.passing, c.beyond};
        ASSERT_EQ(scene.run(), PlanStatus::found);
        std::size_t reported = 0;
        for (const Candidate& candidate : scene.result.candidates) {
            if (candidate.status != CandidateStatus::available && candidate.status != CandidateStatus::chosen) {
                continue;
            }
            ++reported;
            EXPECT_EQ(candidate.terms.passing > 0.0F, c.all_terms || c.passing > 0.0F);
            EXPECT_EQ(candidate.terms.beyond > 0.0F, c.all_terms || c.beyond > 0.0F);
        }
        EXPECT_GT(reported, 0U);
    }
}

/// A table with twice the true values is used as is.
TEST(InSight, SmoothnessIsWhatTheTableSays)
{
    cost::tables::Tables doubled = cost::tables::kDefault;
    std::vector<cost::tables::FamilyTable> families(doubled.families.begin(), doubled.families.end());
    std::vector<std::vector<float>> bends;
    for (cost::tables::FamilyTable& family : families) {
        bends.emplace_back(family.bend.begin(), family.bend.end());
        for (float& bend : bends.back()) {
            bend *= 2.0F;
        }
        family.bend = bends.back();
    }
    doubled.families = families;
    Unhindered scene;
    const auto smoothness = [&scene](const cost::tables::Tables* tables) {
        scene.settings.tables = tables;
        EXPECT_EQ(scene.run(), PlanStatus::found);
        std::vector<float> all;
        for (const Candidate& c : scene.result.candidates) {
            all.push_back(c.terms.smoothness);
        }
        return all;
    };
    const std::vector<float> read = smoothness(&cost::tables::kDefault);
    const std::vector<float> twice = smoothness(&doubled);
    ASSERT_FALSE(read.empty());
    ASSERT_EQ(twice.size(), read.size());
    for (std::size_t i = 0; i < read.size(); ++i) {
        EXPECT_GT(read[i], 0.0F);
        EXPECT_FLOAT_EQ(twice[i], 2.0F * read[i]);
    }
}

}  // namespace
}  // namespace jink::geometric
