// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/geometric/planner.hpp"
#include "tests/property/core/geometric/random_problem.hpp"

// Invariance to the order of threats, place, heading, left and right.

namespace jink::geometric {
namespace {

Settings settings_for(Random& random)
{
    Settings settings;
    settings.security = random.uniform() < 0.3F ? SecurityMode::swept : SecurityMode::time_aware;
    settings.closeness = random.uniform() < 0.5F ? cost::ClosenessMethod::swept : cost::ClosenessMethod::time_aware;
    settings.offset_rule = random.uniform() < 0.5F ? OffsetRule::source : OffsetRule::clearing;
    settings.check_acceleration = random.uniform() < 0.5F;
    settings.verify_flight = settings.check_acceleration;
    settings.evaluate_all = true;
    settings.check_units = 100'000'000;  // unchecked candidates depend on the order
    return settings;
}

world::PlanStatus run_symmetric(RandomProblem& p, const Settings& settings, Result& result)
{
    p.put_into(p.problem);
    WorkBudget budget(10'000'000);
    return solve(p.problem, settings, p.limits, p.airframe, budget, result);
}

bool usable(const Candidate& c)
{
    return c.status == CandidateStatus::available || c.status == CandidateStatus::chosen;
}

/// Rounding may decide contact with the deciding threat; everything else must be equal.
void expect_same(const RandomProblem& p, const Settings& settings, const Candidate& a, const Candidate& b,
                 std::uint64_t seed)
{
    if (usable(a) && usable(b)) {
        ASSERT_NEAR(a.total, b.total, 1e-3F) << "seed " << seed;
    } else if (a.status != b.status && settings.security == SecurityMode::time_aware && !settings.check_acceleration) {
        const oracle::Flight flight = p.flight(a.shape, settings.waypoints);
        double nearest = 1e9;
        for (std::size_t i = 0; i < p.threats.size(); ++i) {
            nearest = std::min(nearest, std::abs(oracle::margin(flight, p.moving(i), p.box())));
        }
        ASSERT_LT(nearest, 3e-3) << "seed " << seed;
    }
}

TEST(PlanLaws, OrderOfThreatsDoesNotMatter)
{
    static Result first;
    static Result second;
    for (std::uint64_t seed = 1; seed <= 3000; ++seed) {
        RandomProblem p(seed);
        Random random(seed * 13);
        const Settings settings = settings_for(random);
        const world::PlanStatus status = run_symmetric(p, settings, first);
        for (std::size_t i = p.threats.size(); i > 1; --i) {
            const std::size_t j = random.below(i);
            std::swap(p.threats[i - 1], p.threats[j]);
            if (p.problem.main == i - 1) {
                p.problem.main = j;
            } else if (p.problem.main == j) {
                p.problem.main = i - 1;
            }
        }
        ASSERT_EQ(run_symmetric(p, settings, second), status) << "seed " << seed;
        ASSERT_EQ(first.chosen, second.chosen) << "seed " << seed;
        for (std::size_t i = 0; i < first.candidates.size(); ++i) {
            ASSERT_EQ(first.candidates[i].status, second.candidates[i].status) << "seed " << seed;
            ASSERT_NEAR(first.candidates[i].total, second.candidates[i].total, 1e-5F) << "seed " << seed;
        }
    }
}

TEST(PlanLaws, SameInputSameOutput)
{
    static Result first;
    static Result second;
    static Result other;
    for (std::uint64_t seed = 1; seed <= 500; ++seed) {
        RandomProblem p(seed);
        RandomProblem q(seed + 1);
        Random random(seed);
        const Settings settings = settings_for(random);
        const world::PlanStatus status = run_symmetric(p, settings, first);
        static_cast<void>(run_symmetric(q, settings, second));  // leaves its traces in `second`
        ASSERT_EQ(run_symmetric(p, settings, second), status);
        ASSERT_EQ(first.chosen, second.chosen);
        ASSERT_EQ(first.candidates.size(), second.candidates.size());
        for (std::size_t i = 0; i < first.candidates.size(); ++i) {
            ASSERT_EQ(first.candidates[i].total, second.candidates[i].total);
            ASSERT_EQ(first.candidates[i].status, second.candidates[i].status);
        }
    }
}

TEST(PlanLaws, PlaceDoesNotMatter)
{
    static Result first;
    static Result second;
    for (std::uint64_t seed = 1; seed <= 2000; ++seed) {
        RandomProblem p(seed);
        Random random(seed * 29);
        const Settings settings = settings_for(random);
        static_cast<void>(run_symmetric(p, settings, first));
        const Vec3 shift(random.uniform(-500.0F, 500.0F), random.uniform(-500.0F, 500.0F),
                         random.uniform(-100.0F, 100.0F));
        p.problem.frame.origin += shift;
        for (Sphere& threat : p.threats) {
            threat.motion.position += shift;
        }
        static_cast<void>(run_symmetric(p, settings, second));
        ASSERT_EQ(first.candidates.size(), second.candidates.size());
        for (std::size_t i = 0; i < first.candidates.size(); ++i) {
            expect_same(p, settings, first.candidates[i], second.candidates[i], seed);
        }
    }
}

TEST(PlanLaws, QuarterTurnsDoNotMatter)
{
    static Result first;
    static Result second;
    Mat3 turn;
    turn << 0.0F, -1.0F, 0.0F, 1.0F, 0.0F, 0.0F, 0.0F, 0.0F, 1.0F;
    for (std::uint64_t seed = 1; seed <= 2000; ++seed) {
        RandomProblem p(seed);
        if (p.problem.frame.axes.col(0).head<2>().norm() < 1e-3F) {
            continue;  // a vertical leg takes north for y
        }
        Random random(seed * 31);
        const Settings settings = settings_for(random);
        static_cast<void>(run_symmetric(p, settings, first));
        p.problem.frame = make_path_frame(turn * p.problem.frame.origin, turn * p.problem.frame.axes.col(0));
        p.problem.start_velocity = turn * p.problem.start_velocity;
        std::swap(p.limits.half_extents.x(), p.limits.half_extents.y());
        for (Sphere& threat : p.threats) {
            threat.motion.position = turn * threat.motion.position;
            threat.motion.velocity = turn * threat.motion.velocity;
        }
        static_cast<void>(run_symmetric(p, settings, second));
        ASSERT_EQ(first.candidates.size(), second.candidates.size());
        for (std::size_t i = 0; i < first.candidates.size(); ++i) {
            expect_same(p, settings, first.candidates[i], second.candidates[i], seed);
        }
    }
}

TEST(PlanLaws, LeftAndRightAreMirrorImages)
{
    static Result first;
    static Result second;
    const auto mirror = [](const Vec3& v) { return Vec3(v.x(), -v.y(), v.z()); };
    for (std::uint64_t seed = 1; seed <= 2000; ++seed) {
        RandomProblem p(seed);
        if (p.problem.frame.axes.col(0).head<2>().norm() < 1e-3F) {
            continue;
        }
        Random random(seed * 37);
        const Settings settings = settings_for(random);
        const world::PlanStatus status = run_symmetric(p, settings, first);
        p.problem.frame = make_path_frame(mirror(p.problem.frame.origin), mirror(p.problem.frame.axes.col(0)));
        p.problem.start_velocity = mirror(p.problem.start_velocity);
        for (Sphere& threat : p.threats) {
            threat.motion.position = mirror(threat.motion.position);
            threat.motion.velocity = mirror(threat.motion.velocity);
        }
        const world::PlanStatus mirrored = run_symmetric(p, settings, second);
        // Plane theta mirrors to pi - theta with the offset unchanged; plane 0 to itself with the offset negated.
        std::size_t differences = 0;
        for (const Candidate& a : first.candidates) {
            const bool level = a.shape.plane == 0.0F;
            const float plane = level ? 0.0F : kPi - a.shape.plane;
            const float offset = level ? -a.shape.offset : a.shape.offset;
            const auto b = std::find_if(second.candidates.begin(), second.candidates.end(), [&](const Candidate& c) {
                return c.shape.family == a.shape.family && std::abs(c.shape.plane - plane) < 1e-4F &&
                       std::abs(c.shape.offset - offset) < 1e-3F;
            });
            ASSERT_NE(b, second.candidates.end()) << "seed " << seed;
            expect_same(p, settings, *b, a, seed);
            differences += usable(a) == usable(*b) ? 0U : 1U;
        }
        if (differences == 0 && status == world::PlanStatus::found) {
            ASSERT_EQ(mirrored, status) << "seed " << seed;
            ASSERT_NEAR(first.candidates[first.chosen].total, second.candidates[second.chosen].total, 1e-3F)
                << "seed " << seed;
        }
    }
}

}  // namespace
}  // namespace jink::geometric
