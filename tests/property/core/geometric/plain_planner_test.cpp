// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cstdio>

#include "tests/property/core/geometric/plain_planner.hpp"
#include "tests/property/core/geometric/random_problem.hpp"

// The planner's optimisations change no bit of a plan.

namespace jink::geometric {
namespace {

Settings any_settings(Random& random)
{
    Settings s;
    s.check_acceleration = false;
    s.offsets = static_cast<std::uint16_t>(2 * (1 + random.below(3)));
    s.extra_planes = static_cast<std::uint16_t>(random.below(5));
    s.waypoints = static_cast<std::uint16_t>(8 + random.below(kMaxPathPoints - 7));
    s.simple = random.uniform() < 0.7F;
    s.symmetric = !s.simple || random.uniform() < 0.7F;
    s.offset_rule = random.uniform() < 0.2F ? OffsetRule::source : OffsetRule::clearing;
    s.escape_from_margin = random.uniform() < 0.7F;
    s.verify_flight = random.uniform() < 0.9F;
    s.evaluate_all = true;
    s.check_units = 100'000'000;
    return s;
}

/// A random problem about the world's origin, most often with traffic in conflict with many candidates.
void make_harder(RandomProblem& p, Random& random)
{
    Problem& problem = p.problem;
    const Vec3 origin = problem.frame.origin;
    problem.frame.origin = Vec3::Zero();
    for (Sphere& t : p.threats) {
        t.motion.position -= origin;
        t.radius_rate = random.uniform() < 0.5F ? 0.0F : random.uniform(0.0F, 0.5F);
        t.radius_acceleration = random.uniform() < 0.8F ? 0.0F : random.uniform(0.0F, 0.4F);
        t.motion.velocity = random.uniform() < 0.2F ? Vec3(Vec3::Zero()) : t.motion.velocity;
    }
    std::rotate(p.threats.begin(), p.threats.begin() + static_cast<std::ptrdiff_t>(random.below(p.threats.size())),
                p.threats.end());
    problem.main = kNoThreat;
    problem.start_velocity = random.uniform() < 0.5F ? problem.start_velocity : RandomProblem::vector(random, 6.0F);
    problem.rules.gains.max_correction = random.uniform(0.0F, 4.0F);
    p.limits.velocity_lag = random.uniform() < 0.1F ? 0.0F : random.uniform(0.05F, 0.6F);
    p.limits.kind = random.uniform() < 0.1F ? vehicle::VehicleKind::fixed_wing : vehicle::VehicleKind::multirotor;
    if (random.uniform() < 0.4F) {
        p.airspace.has_floor = random.uniform() < 0.5F;
        p.airspace.floor = -random.uniform(0.5F, 8.0F);
        p.airspace.has_ceiling = random.uniform() < 0.5F;
        p.airspace.ceiling = random.uniform(0.5F, 8.0F);
        p.airspace.has_keep_in = random.uniform() < 0.5F;
        p.airspace.keep_in_radius = random.uniform(5.0F, 40.0F);
    }
    p.put_into(problem);
}

TEST(PlainPlanner, EveryAnswerIsTheSameToTheBit)
{
    static Result result;
    std::size_t found = 0;
    std::size_t refused_in_flight = 0;
    std::array<std::size_t, 7> seen{};
    const std::size_t cases = case_count(20000);
    for (std::uint64_t seed = 1; seed <= cases; ++seed) {
        RandomProblem p(seed);
        Random random(seed * 15485863);
        make_harder(p, random);
        const Settings settings = any_settings(random);
        WorkBudget budget(100'000'000);
        const world::PlanStatus status = solve(p.problem, settings, p.limits, p.airframe, budget, result);
        if (status == world::PlanStatus::too_close) {
            continue;
        }
        PlainPlanner plain(p, p.problem, settings, p.limits);
        const PlainPlanner::Answer answer = plain.solve({result.candidates.begin(), result.candidates.end()});
        ASSERT_EQ(status, answer.status) << "seed " << seed;
        for (std::size_t i = 0; i < result.candidates.size(); ++i) {
            const Candidate& fast = result.candidates[i];
            const Candidate& slow = answer.candidates[i];
            ASSERT_EQ(fast.status, slow.status) << "seed " << seed << " candidate " << i;
            ASSERT_EQ(fast.hit.kind, slow.hit.kind) << "seed " << seed << " candidate " << i;
            ASSERT_EQ(fast.hit.index, slow.hit.index) << "seed " << seed << " candidate " << i;
            if (fast.status == CandidateStatus::available || fast.status == CandidateStatus::chosen) {
                ASSERT_EQ(fast.total, slow.total) << "seed " << seed << " candidate " << i;
            } else if (fast.terms.time > 0.0F) {
                ++refused_in_flight;
            }
            ++seen[static_cast<std::size_t>(fast.status)];
        }
        if (status == world::PlanStatus::found) {
            ++found;
            ASSERT_EQ(result.chosen, answer.chosen) << "seed " << seed;
            ASSERT_EQ(result.path.points.size(), answer.path.points.size()) << "seed " << seed;
            for (std::size_t k = 0; k < result.path.points.size(); ++k) {
                ASSERT_EQ(result.path.points[k].position, answer.path.points[k].position) << "seed " << seed;
                ASSERT_EQ(result.path.points[k].velocity, answer.path.points[k].velocity) << "seed " << seed;
                ASSERT_EQ(result.path.points[k].time, answer.path.points[k].time) << "seed " << seed;
            }
        }
    }
    std::printf("[ measured ] %zu plans found; candidates: %zu available, %zu chosen, %zu hit static, %zu hit moving, "
                "%zu hit airspace, %zu of them in flight only\n",
                found, seen[0], seen[1], seen[2], seen[3], seen[4], refused_in_flight);
    EXPECT_GT(found, cases / 20);
    EXPECT_GT(refused_in_flight, cases / 4);
    for (const std::size_t status : {0U, 1U, 2U, 3U, 4U}) {
        EXPECT_GT(seen[status], cases / 20) << status;
    }
}

TEST(PlainPlanner, TheChoiceIsTheSameWhereDearerCandidatesAreNotLookedAt)
{
    static Result all;
    static Result few;
    std::size_t found = 0;
    std::size_t not_looked_at = 0;
    const std::size_t cases = case_count(20000);
    for (std::uint64_t seed = 1; seed <= cases; ++seed) {
        RandomProblem p(seed);
        Random random(seed * 15485863);
        make_harder(p, random);
        Settings settings = any_settings(random);
        settings.check_acceleration = random.uniform() < 0.2F;
        settings.all_terms = random.uniform() < 0.5F;
        settings.max_cost = random.uniform() < 0.2F ? random.uniform(0.3F, 1.0F) : 1.0F;
        WorkBudget ample(100'000'000);
        const world::PlanStatus status = solve(p.problem, settings, p.limits, p.airframe, ample, all);
        settings.evaluate_all = false;
        WorkBudget as_ample(100'000'000);
        ASSERT_EQ(solve(p.problem, settings, p.limits, p.airframe, as_ample, few), status) << "seed " << seed;
        if (status != world::PlanStatus::found) {
            continue;
        }
        ++found;
        ASSERT_EQ(few.chosen, all.chosen) << "seed " << seed;
        ASSERT_EQ(few.candidates[few.chosen].total, all.candidates[all.chosen].total) << "seed " << seed;
        ASSERT_EQ(few.side, all.side) << "seed " << seed;
        for (std::size_t k = 0; k < few.path.points.size(); ++k) {
            ASSERT_EQ(few.path.points[k].position, all.path.points[k].position) << "seed " << seed;
        }
        for (std::size_t i = 0; i < few.candidates.size(); ++i) {
            // Checked candidates have the same status as with all; no unchecked candidate is available.
            const CandidateStatus said = few.candidates[i].status;
            ASSERT_NE(said, CandidateStatus::available) << "seed " << seed;
            not_looked_at += said == CandidateStatus::not_evaluated ? 1U : 0U;
            if (said != CandidateStatus::not_evaluated) {
                ASSERT_EQ(said, all.candidates[i].status) << "seed " << seed << " candidate " << i;
            }
        }
    }
    EXPECT_GT(found, cases / 20);
    EXPECT_GT(not_looked_at, cases / 20);
}

}  // namespace
}  // namespace jink::geometric
