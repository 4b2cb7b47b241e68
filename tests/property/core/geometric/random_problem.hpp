// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <vector>

#include "core/base/random.hpp"
#include "tests/oracle/planner_oracle.hpp"
#include "tests/oracle/problem_threats.hpp"
#include "tests/property/core/geometry/oracle.hpp"

namespace jink::geometric {

using geometry::oracle::case_count;
using oracle::operator+;
using oracle::operator-;
using oracle::operator*;

/// A leg in any direction with a main threat on it, and up to four others that cross near the candidates.
struct RandomProblem : ProblemThreats {
    Problem problem;
    vehicle::VehicleLimits limits;
    vehicle::Airframe airframe;

    static Vec3 vector(Random& random, float size)
    {
        return {random.uniform(-size, size), random.uniform(-size, size), random.uniform(-size, size)};
    }

    explicit RandomProblem(std::uint64_t seed)
    {
        Random random(seed);
        const Vec3 direction = random.uniform() < 0.05F ? Vec3(0.0F, 0.0F, random.uniform() < 0.5F ? 1.0F : -1.0F)
                                                        : Vec3(random.uniform(-1.0F, 1.0F), random.uniform(-1.0F, 1.0F),
                                                               random.uniform(-0.7F, 0.7F));
        problem.frame = make_path_frame(vector(random, 300.0F), direction);
        problem.main_radius = random.uniform(0.5F, 3.0F);
        problem.distance = random.uniform(2.5F * problem.main_radius, 30.0F);
        problem.speed = random.uniform(2.0F, 8.0F);
        problem.start_velocity = problem.speed * problem.frame.axes.col(0);
        problem.main = 0;
        limits.half_extents = Vec3(random.uniform(0.2F, 1.2F), random.uniform(0.2F, 1.2F), random.uniform(0.2F, 1.2F));
        limits.cruise_speed = problem.speed;
        limits.max_climb = random.uniform(1.0F, 6.0F);
        limits.max_descent = random.uniform(1.0F, 6.0F);
        const Vec3 point = problem.frame.origin + problem.distance * problem.frame.axes.col(0);
        const float arrival = problem.distance / problem.speed;
        const Vec3 main_velocity = random.uniform() < 0.5F ? Vec3(Vec3::Zero()) : vector(random, 4.0F);
        threats.push_back({{point - arrival * main_velocity, main_velocity}, problem.main_radius});
        for (std::uint64_t i = 0, n = random.below(5); i < n; ++i) {
            const Vec3 velocity = random.uniform() < 0.3F ? Vec3(Vec3::Zero()) : vector(random, 5.0F);
            const Vec3 near = problem.frame.origin +
                              random.uniform(0.0F, 2.0F) * problem.distance * problem.frame.axes.col(0) +
                              vector(random, 8.0F);
            threats.push_back(
                {{near - random.uniform(0.0F, 2.0F) * arrival * velocity, velocity}, random.uniform(0.0F, 3.0F)});
        }
        put_into(problem);
    }
    RandomProblem(const RandomProblem&) = delete;
    RandomProblem& operator=(const RandomProblem&) = delete;

    [[nodiscard]] oracle::Vehicle figures() const
    {
        oracle::Vehicle v;
        v.speed = static_cast<double>(problem.speed);
        v.climb = static_cast<double>(limits.max_climb);
        v.descent = static_cast<double>(limits.max_descent);
        return v;
    }
    [[nodiscard]] oracle::Box box() const { return {oracle::to_double(limits.half_extents)}; }
    [[nodiscard]] oracle::Moving moving(std::size_t i) const
    {
        return {oracle::to_double(threats[i].motion.position), oracle::to_double(threats[i].motion.velocity),
                static_cast<double>(threats[i].radius)};
    }
    [[nodiscard]] oracle::Flight flight(const CandidateShape& shape, std::uint16_t waypoints) const
    {
        return oracle::fly(oracle::candidate(oracle::to_double(problem.frame.origin),
                                             oracle::to_double(Vec3(problem.frame.axes.col(0))),
                                             static_cast<double>(problem.distance), shape.family == Family::symmetric,
                                             static_cast<double>(shape.plane), static_cast<double>(shape.offset),
                                             waypoints),
                           figures());
    }
};

}  // namespace jink::geometric
