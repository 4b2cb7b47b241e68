// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <vector>

#include "core/geometric/flown.hpp"
#include "core/path/flight.hpp"
#include "tests/property/core/geometric/random_problem.hpp"

// Difference between the planner's coarse flight of a candidate and the finer flight of predict_flight, in which the
// choice is checked.

namespace jink::geometric {
namespace {

std::vector<Vec3> fly(const path::TimedPath& path, const Vec3& velocity, const RandomProblem& p,
                      const path::detail::Fineness& fineness)
{
    vehicle::VehicleState state;
    state.velocity = velocity;
    const path::FollowerGains gains;
    const Seconds step = std::max(0.2F, path.duration() / 51.0F);
    path::detail::Flight flight(state, path, 0.0F, step, p.limits, gains, fineness);
    vehicle::detail::Fading fading(p.limits.velocity_lag);
    std::vector<Vec3> out;
    while (!flight.ended()) {
        for (int i = 0; i < flight.parts(); ++i) {
            flight.fly(i, fading);
        }
        flight.end_step();
        out.push_back(flight.position());
    }
    return out;
}

TEST(CoarseFlight, StaysNearTheFineOne)
{
    std::vector<float> farthest;
    std::size_t fine_parts = 0;
    std::size_t coarse_parts = 0;
    for (std::uint64_t seed = 1; seed <= 3000; ++seed) {
        const RandomProblem p(seed);
        Random random(seed * 40503);
        CandidateShape shape;
        shape.family = random.uniform() < 0.5F ? Family::simple : Family::symmetric;
        shape.plane = random.uniform(0.0F, kPi);
        shape.offset = random.uniform(-1.28F, 1.28F) * p.problem.distance;
        Problem problem = p.problem;
        problem.frame.origin = Vec3::Zero();
        path::TimedPath path;
        ASSERT_TRUE(make_candidate_path(problem, shape, 25, p.limits, path));
        const path::detail::Fineness coarse{detail::Flown::kSettled, detail::Flown::kSettledPart};
        const Vec3 velocity = p.problem.start_velocity;
        const std::vector<Vec3> a = fly(path, velocity, p, {});
        const std::vector<Vec3> b = fly(path, velocity, p, coarse);
        ASSERT_EQ(a.size(), b.size());
        float apart = 0.0F;
        for (std::size_t i = 0; i < a.size(); ++i) {
            apart = std::max(apart, (a[i] - b[i]).norm());
        }
        farthest.push_back(apart);
        vehicle::VehicleState state;
        const Seconds step = std::max(0.2F, path.duration() / 51.0F);
        const path::FollowerGains gains;
        fine_parts += path::detail::Flight(state, path, 0.0F, step, p.limits, gains).all_parts();
        coarse_parts += path::detail::Flight(state, path, 0.0F, step, p.limits, gains, coarse).all_parts();
    }
    std::sort(farthest.begin(), farthest.end());
    const auto at = [&](double share) {
        return farthest[static_cast<std::size_t>(share * static_cast<double>(farthest.size() - 1))];
    };
    std::printf("[ measured ] apart by %.3f m in the middle, %.3f m in 99 of 100, %.3f m at most; %zu parts for %zu\n",
                static_cast<double>(at(0.5)), static_cast<double>(at(0.99)), static_cast<double>(at(1.0)), coarse_parts,
                fine_parts);
    EXPECT_LT(at(0.5), 0.02F);
    EXPECT_LT(at(0.99), 0.35F);
    EXPECT_LT(at(1.0), 0.6F);
    EXPECT_LT(coarse_parts, fine_parts * 7 / 10);
}

}  // namespace
}  // namespace jink::geometric
