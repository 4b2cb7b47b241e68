// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <memory>
#include <vector>

#include "core/avoid/final_check.hpp"
#include "core/base/random.hpp"
#include "core/geometric/planner.hpp"
#include "tests/oracle/planner_oracle.hpp"
#include "tests/oracle/random_situation.hpp"

// `Planner::plan` on random situations: its result must pass the supervisor's check, which measures by other means, and
// must never contact a track that grows by world::threat_radius.

namespace jink::geometric {
namespace {

using oracle::RandomSituation;

TEST(PlannerLaws, WhatIsFoundPassesTheFinalCheck)
{
    static Planner planner{Settings{}};
    Settings once;
    once.retries = 0;
    static Planner without_retries{once};
    std::size_t found = 0;
    std::size_t found_at_once = 0;
    std::size_t none = 0;
    std::size_t rejected = 0;
    for (std::uint64_t seed = 1; seed <= 5000; ++seed) {
        const RandomSituation s(seed);
        WorkBudget budget(1'000'000);
        world::Manoeuvre manoeuvre;
        const world::PlanStatus status = planner.plan(s.view(), budget, manoeuvre);
        none += status == world::PlanStatus::none_available ? 1U : 0U;
        world::Manoeuvre unused;
        const bool at_once = without_retries.plan(s.view(), budget, unused) == world::PlanStatus::found;
        found_at_once += at_once ? 1U : 0U;
        ASSERT_TRUE(!at_once || status == world::PlanStatus::found) << "seed " << seed;
        if (status != world::PlanStatus::found) {
            ASSERT_NE(status, world::PlanStatus::bad_input) << "seed " << seed;
            continue;
        }
        ++found;
        const float planned = world::least_separation(s.view(), manoeuvre.path, 100.0F, budget).margin;
        ASSERT_GE(planned, -0.06F) << "seed " << seed;  // distances of solids have a resolution of 0.05 m
        rejected += avoid::check_manoeuvre(s.view(), manoeuvre, avoid::Settings{}, budget).margin < 0.0F ? 1U : 0U;
    }
    EXPECT_GT(found, 4000U);
    // The final check steps and pads differently; a rejection costs a replan, not safety.
    EXPECT_LE(rejected * 50, found);
    std::printf("[ measured ] %zu plans, %zu of them at the first attempt; %zu rejected by the final check; %zu times "
                "nothing\n",
                found, found_at_once, rejected, none);
}

TEST(PlannerLaws, WhatEachAttemptAdds)
{
    static Planner planner{Settings{}};
    std::array<std::size_t, kAttempts.size()> solved{};
    for (std::uint64_t seed = 1; seed <= 5000; ++seed) {
        const RandomSituation s(seed);
        WorkBudget budget(1'000'000);
        world::Manoeuvre manoeuvre;
        if (planner.plan(s.view(), budget, manoeuvre) == world::PlanStatus::found) {
            ++solved[planner.last().attempt];
        }
    }
    std::printf("[ measured ] solved by attempt:");
    for (const std::size_t count : solved) {
        std::printf(" %zu", count);
    }
    std::printf("\n");
    EXPECT_GT(solved[0], 2000U);
    for (const std::size_t attempt : {1U, 2U, 3U, 4U, 5U, 7U, 9U}) {
        EXPECT_GT(solved[attempt], 0U) << "attempt " << attempt;
    }
}

/// Until the vehicle responds, the path is its present flight; threats are predicted to that time.
TEST(PlannerLaws, BeginsWithWhatIsFlownDuringTheLatency)
{
    static Planner planner{Settings{}};
    std::size_t moved = 0;
    for (std::uint64_t seed = 1; seed <= 1500; ++seed) {
        RandomSituation s(seed);
        const Settings settings;
        s.rules.latency = 0.05F + 0.3F * static_cast<float>(seed % 7) / 6.0F;
        ASSERT_TRUE(planner.configure(settings));
        WorkBudget budget(1'000'000);
        world::Manoeuvre manoeuvre;
        if (planner.plan(s.view(), budget, manoeuvre) != world::PlanStatus::found) {
            continue;
        }
        const path::TimedPath& path = manoeuvre.path;
        ASSERT_EQ(path.points.front().position, s.own.position) << "seed " << seed;
        ASSERT_EQ(path.points.front().time, 0.0F);
        if (path.points.size() == planner.last().path.points.size()) {
            continue;  // within a margin, or too near
        }
        ++moved;
        const bool in_a_row = kAttempts[planner.last().attempt].kind == Attempt::Kind::in_a_row;
        ASSERT_EQ(path.points.size(), settings.waypoints + 1U + (in_a_row ? settings.waypoints / 2U : 0U))
            << "seed " << seed;
        ASSERT_EQ(path.points.front().velocity, s.own.velocity) << "seed " << seed;
        ASSERT_NEAR(path.points[1].time, s.rules.latency, 1e-6F) << "seed " << seed;
        const Vec3 answered = s.own.position + s.rules.latency * s.own.velocity;
        ASSERT_LT((path.points[1].position - answered).norm(), 1e-4F) << "seed " << seed;
    }
    EXPECT_GT(moved, 1000U);
}

TEST(PlannerLaws, TracksAreNeverTouchedAsTheyGrow)
{
    static Planner planner{Settings{}};
    std::size_t samples = 0;
    for (std::uint64_t seed = 10001; seed <= 12000; ++seed) {
        const RandomSituation s(seed);
        WorkBudget budget(1'000'000);
        world::Manoeuvre manoeuvre;
        if (planner.plan(s.view(), budget, manoeuvre) != world::PlanStatus::found) {
            continue;
        }
        const oracle::Box box{oracle::to_double(s.limits.half_extents)};
        for (const world::Track& track : s.tracks) {
            // A start inside a margin is judged by the escape rule; its tracks are left out here.
            const double at_start = oracle::box_distance(box, oracle::to_double(Vec3(s.own.position - track.position)));
            if (at_start < static_cast<double>(world::threat_radius(s.view(), track, 0.0F))) {
                continue;
            }
            for (float t = 0.0F; t < manoeuvre.path.duration(); t += 0.02F) {
                const Vec3 own = path::sample(manoeuvre.path, t).position;
                const Vec3 apart = own - (track.position + track.velocity * t);
                const double distance = oracle::box_distance(box, oracle::to_double(apart));
                ASSERT_GT(distance, static_cast<double>(world::threat_radius(s.view(), track, t)) - 1e-3)
                    << "seed " << seed;
                ++samples;
            }
        }
    }
    EXPECT_GT(samples, 100000U);
}

}  // namespace
}  // namespace jink::geometric
