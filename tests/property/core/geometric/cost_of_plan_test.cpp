// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/geometric/planner.hpp"
#include "tests/property/core/geometric/random_problem.hpp"

// The whole cost computation of `solve` against the formulas in double.

namespace jink::geometric {
namespace {

double expected_sin_alpha(const RandomProblem& p, float plane)
{
    const oracle::P3 x = oracle::to_double(Vec3(p.problem.frame.axes.col(0)));
    const oracle::P3 y = oracle::to_double(Vec3(p.problem.frame.axes.col(1)));
    const oracle::P3 z = oracle::cross(x, y);
    const auto theta = static_cast<double>(plane);
    const oracle::P3 normal = oracle::cross(x, std::cos(theta) * y + std::sin(theta) * z);
    return std::sqrt(std::max(0.0, 1.0 - normal[2] * normal[2]));
}

void expect_close(float got, double expected, double tolerance, const char* what, std::uint64_t seed)
{
    EXPECT_NEAR(static_cast<double>(got), expected, tolerance) << what << ", seed " << seed;
}

TEST(CostOfPlan, EveryTermOfEveryAvailableCandidate)
{
    static Result result;
    std::size_t compared = 0;
    for (std::uint64_t seed = 1; seed <= 3000 && !::testing::Test::HasFailure(); ++seed) {
        const RandomProblem p(seed);
        Random random(seed * 6151);
        Settings settings;
        settings.check_acceleration = false;
        settings.verify_flight = false;
        settings.all_terms = true;
        settings.evaluate_all = true;
        settings.rotation_penalty = random.uniform(0.0F, 2.0F);
        settings.weights = cost::kTriedWeights[random.below(7)];
        settings.closeness = random.uniform() < 0.5F ? cost::ClosenessMethod::swept : cost::ClosenessMethod::time_aware;
        settings.main_swept_to_collision_point = false;
        WorkBudget budget(10'000'000);
        const world::PlanStatus status = solve(p.problem, settings, p.limits, p.airframe, budget, result);
        double longest = 0.0;
        for (const Candidate& c : result.candidates) {
            longest = std::max(longest, p.flight(c.shape, settings.waypoints).t.back());
        }
        double cheapest = 1e9;
        for (const Candidate& c : result.candidates) {
            const oracle::Flight flight = p.flight(c.shape, settings.waypoints);
            expect_close(c.duration, flight.t.back(), 1e-3, "duration", seed);
            expect_close(c.sin_alpha, expected_sin_alpha(p, c.shape.plane), 2e-4, "sin alpha", seed);
            if (c.status != CandidateStatus::available && c.status != CandidateStatus::chosen) {
                continue;
            }
            ++compared;
            std::vector<double> x;
            std::vector<double> y;
            const bool symmetric = c.shape.family == Family::symmetric;
            const auto distance = static_cast<double>(p.problem.distance);
            for (int i = 0; i < settings.waypoints; ++i) {
                x.push_back((symmetric ? 2.0 : 1.5) * distance * i / (settings.waypoints - 1));
                y.push_back(oracle::curve(symmetric, static_cast<double>(c.shape.offset), distance, x.back()));
            }
            const double s = oracle::smoothness(x, y);
            const double s_rp =
                s * (1.0 + static_cast<double>(settings.rotation_penalty) * expected_sin_alpha(p, c.shape.plane));
            std::vector<double> f;
            for (std::size_t i = 0; i < p.threats.size(); ++i) {
                if (p.threats[i].motion.velocity.squaredNorm() > 0.0F) {
                    f.push_back(oracle::closeness(flight, p.moving(i),
                                                  settings.closeness == cost::ClosenessMethod::swept ? longest : -1.0));
                }
            }
            const double m = oracle::combine(f);
            const double energy = oracle::energy(flight, p.figures());
            const double power = oracle::hover_power(flight, p.figures());
            expect_close(c.terms.time, flight.t.back(), 1e-3, "time", seed);
            expect_close(c.terms.smoothness, s, 3e-3 * s, "smoothness", seed);
            expect_close(c.terms.smoothness_penalised, s_rp, 3e-3 * s_rp, "penalised smoothness", seed);
            expect_close(c.terms.energy, energy, 2e-3 * energy, "energy", seed);
            expect_close(c.terms.hover_power, power, 1e-3 * power, "hover power", seed);
            if (m < 20.0) {
                expect_close(c.terms.closeness, m, 5e-3 * m, "closeness", seed);
            }
            const double total =
                static_cast<double>(settings.weights.smoothness) * oracle::normalised_smoothness_penalised(s_rp) +
                static_cast<double>(settings.weights.time) * oracle::normalised_time(flight.t.back()) +
                static_cast<double>(settings.weights.closeness) * oracle::normalised_closeness(m);
            expect_close(c.total, total, 2e-3, "total", seed);
            expect_close(cost::normalise(c.terms, settings.caps).energy, oracle::normalised_energy(energy), 3e-3,
                         "normalised energy", seed);
            cheapest = std::min(cheapest, total);
            for (const float value : {c.total, c.terms.time, c.terms.smoothness, c.terms.energy, c.terms.hover_power}) {
                EXPECT_TRUE(std::isfinite(value)) << "seed " << seed;
            }
        }
        if (status == world::PlanStatus::found) {
            expect_close(result.candidates[result.chosen].total, cheapest, 4e-3, "the cheapest is chosen", seed);
        }
    }
    EXPECT_GT(compared, 10000U);
}

}  // namespace
}  // namespace jink::geometric
