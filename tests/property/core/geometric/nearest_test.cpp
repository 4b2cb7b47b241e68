// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>

#include "tests/property/core/geometric/random_problem.hpp"

// Settings::moving_nearest: as if there were no such setting with as many as there are; clear of all with fewer.

namespace jink::geometric {
namespace {

/// With traffic all about, up to kMaxTracks of it.
void crowd(RandomProblem& p, Random& random)
{
    const float arrival = p.problem.distance / p.problem.speed;
    const std::size_t count = 3 + random.below(kMaxTracks - 8);
    while (p.threats.size() < count) {
        const Vec3 velocity = RandomProblem::vector(random, 6.0F);
        const Vec3 near = p.problem.frame.origin +
                          random.uniform(0.0F, 2.0F) * p.problem.distance * p.problem.frame.axes.col(0) +
                          RandomProblem::vector(random, 25.0F);
        p.threats.push_back({{near - random.uniform(0.0F, 2.0F) * arrival * velocity, velocity},
                             random.uniform(0.2F, 2.0F),
                             random.uniform() < 0.5F ? 0.0F : random.uniform(0.0F, 0.2F)});
    }
    p.put_into(p.problem);
}

world::PlanStatus solve_with(const RandomProblem& p, std::uint16_t nearest, Result& result, std::uint32_t& work,
                             float closeness = 0.5F)
{
    Settings settings;
    settings.check_acceleration = false;
    settings.check_units = 1'000'000;
    settings.moving_nearest = nearest;
    settings.weights = {0.8F - closeness, 0.2F, closeness};
    WorkBudget budget(10'000'000);
    const world::PlanStatus status = solve(p.problem, settings, p.limits, p.airframe, budget, result);
    work = budget.spent();
    return status;
}

void expect_same(const Result& a, const Result& b, std::uint64_t seed)
{
    ASSERT_EQ(a.candidates.size(), b.candidates.size()) << "seed " << seed;
    ASSERT_EQ(a.chosen, b.chosen) << "seed " << seed;
    ASSERT_EQ(a.candidates[a.chosen].total, b.candidates[b.chosen].total) << "seed " << seed;
    ASSERT_EQ(a.path.points.size(), b.path.points.size()) << "seed " << seed;
    for (std::size_t i = 0; i < a.path.points.size(); ++i) {
        ASSERT_EQ(a.path.points[i].position, b.path.points[i].position) << "seed " << seed;
    }
}

TEST(MovingNearest, AsManyAsThereAreIsAll)
{
    static Result all;
    static Result nearest;
    std::size_t found = 0;
    for (std::uint64_t seed = 1; seed <= 1500; ++seed) {
        RandomProblem p(seed);
        Random random(seed * 7001);
        crowd(p, random);
        std::uint32_t work_all = 0;
        std::uint32_t work_nearest = 0;
        const world::PlanStatus status = solve_with(p, 0, all, work_all);
        const auto count = static_cast<std::uint16_t>(p.threats.size() + random.below(3));
        ASSERT_EQ(solve_with(p, count, nearest, work_nearest), status) << "seed " << seed;
        for (std::size_t i = 0; i < all.candidates.size(); ++i) {
            ASSERT_EQ(all.candidates[i].status, nearest.candidates[i].status) << "seed " << seed;
        }
        if (status == world::PlanStatus::found) {
            ++found;
            expect_same(all, nearest, seed);
        }
    }
    EXPECT_GT(found, 300U);
}

TEST(MovingNearest, WhatIsFoundWithFewIsClearOfAllAndTakesLessWork)
{
    static Result all;
    static Result few;
    std::size_t found = 0;
    std::size_t hidden = 0;
    double work_all = 0.0;
    double work_few = 0.0;
    for (std::uint64_t seed = 1; seed <= 1500; ++seed) {
        RandomProblem p(seed);
        Random random(seed * 7001);
        crowd(p, random);
        std::uint32_t with_all = 0;
        std::uint32_t with_few = 0;
        const auto k = static_cast<std::uint16_t>(1 + random.below(3));
        const world::PlanStatus status = solve_with(p, k, few, with_few);
        // Where one threat's closeness weighs nothing, the choice is the same too.
        std::uint32_t unused = 0;
        ASSERT_EQ(solve_with(p, 0, all, with_all), status) << "seed " << seed;
        work_all += with_all;
        work_few += with_few;
        if (status != world::PlanStatus::found) {
            continue;
        }
        ++found;
        ASSERT_EQ(solve_with(p, k, few, unused, 0.0F), world::PlanStatus::found);
        ASSERT_EQ(solve_with(p, 0, all, unused, 0.0F), world::PlanStatus::found);
        expect_same(all, few, seed);
        ASSERT_EQ(solve_with(p, k, few, unused), world::PlanStatus::found);
        for (const Candidate& c : few.candidates) {
            hidden += c.status == CandidateStatus::hits_moving ? 1U : 0U;
        }
        const oracle::Box box = p.box();
        for (const Sphere& threat : p.threats) {
            const double start =
                oracle::box_distance(box, oracle::to_double(Vec3(threat.motion.position - p.problem.frame.origin)));
            if (start < static_cast<double>(threat.radius)) {
                continue;  // a start inside a margin is judged by the escape rule
            }
            for (float t = 0.0F; t < few.path.duration(); t += 0.05F) {
                const Vec3 apart =
                    path::sample(few.path, t).position - (threat.motion.position + t * threat.motion.velocity);
                ASSERT_GT(oracle::box_distance(box, oracle::to_double(apart)),
                          static_cast<double>(threat.radius + t * threat.radius_rate) - 2e-3)
                    << "seed " << seed;
            }
        }
    }
    EXPECT_GT(found, 300U);
    EXPECT_GT(hidden, 100U);
    EXPECT_LT(work_few, 0.8 * work_all);
    std::printf("[ measured ] %zu found; %.0f units of work with 1 to 3 of them, %.0f with all\n", found,
                work_few / 1500.0, work_all / 1500.0);
}

}  // namespace
}  // namespace jink::geometric
