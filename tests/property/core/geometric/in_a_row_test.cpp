// SPDX-License-Identifier: BSD-3-Clause
// Two-stage manoeuvres along random legs and through random traffic: clear of everything in double precision, beside
// the main threat half-way, back on the leg at the end, and around the first threat on the path back.
#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "core/geometric/flown.hpp"
#include "tests/property/core/geometric/random_problem.hpp"
#include "tests/unit/core/geometric/in_a_row.hpp"

namespace jink::geometric {
namespace {

using geometry::oracle::seed_of;
using world::PlanStatus;

/// Up to four spheres near the leg behind the main threat, some of which move or grow.
void fill(InARow& scene, Random& random)
{
    const Vec3 direction(random.uniform(-1.0F, 1.0F), random.uniform(-1.0F, 1.0F), random.uniform(-0.5F, 0.5F));
    scene.problem.frame = make_path_frame(RandomProblem::vector(random, 100.0F), direction);
    const Vec3 along = scene.problem.frame.axes.col(0);
    scene.problem.speed = random.uniform(1.5F, 4.0F);
    scene.problem.start_velocity = vehicle::clamped_velocity(along, scene.problem.speed, scene.limits);
    scene.limits.half_extents =
        Vec3(random.uniform(0.3F, 1.0F), random.uniform(0.3F, 1.0F), random.uniform(0.3F, 1.0F));
    scene.settings.check_acceleration = random.below(2) == 0;
    scene.settings.evaluate_all = random.below(2) == 0;
    scene.settings.extra_planes = static_cast<std::uint16_t>(random.below(4));
    scene.threats = {Scene::still(collision_point(scene.problem), 1.0F)};
    for (std::uint64_t i = 0, n = random.below(5); i < n; ++i) {
        const float ahead = random.uniform(22.0F, 45.0F);
        const Vec3 velocity = random.below(2) == 0 ? Vec3(Vec3::Zero()) : RandomProblem::vector(random, 1.5F);
        const Vec3 there = scene.problem.frame.origin + ahead * along + RandomProblem::vector(random, 4.0F);
        const float growth = random.below(2) == 0 ? 0.0F : random.uniform(0.0F, 0.05F);
        scene.threats.push_back({{there - (ahead / scene.problem.speed) * velocity, velocity},
                                 random.uniform(0.1F, 1.5F),
                                 growth,
                                 0.1F * growth});
    }
}

void expect_clear(const InARow& scene, std::size_t i)
{
    const path::TimedPath& path = scene.result.path;
    const Vec3d half = scene.limits.half_extents.cast<double>();
    for (const Sphere& threat : scene.threats) {
        const auto margin = [&](const Vec3& own, double t) {
            const Vec3d apart =
                own.cast<double>() - threat.motion.position.cast<double>() - t * threat.motion.velocity.cast<double>();
            return gap(half, apart) - double(threat.radius) -
                   t * (double(threat.radius_rate) + 0.5 * double(threat.radius_acceleration) * t);
        };
        if (margin(scene.problem.frame.origin, 0.0) < 0.0) {
            continue;  // a start inside a margin is judged by the escape rule
        }
        for (float t = 0.0F; t <= path.duration(); t += 0.02F) {
            ASSERT_GT(margin(path::sample(path, t).position, double(t)), -2e-3) << "case " << i << " at " << t;
        }
    }
}

void expect_shape(const InARow& scene, std::size_t i)
{
    const auto& points = scene.result.path.points;
    const Vec3 along = scene.problem.frame.axes.col(0);
    const auto about = [&](std::size_t k) { return Vec3(points[k].position - scene.problem.frame.origin); };
    ASSERT_LT(about(0).norm(), 1e-4F);
    for (std::size_t k = 1; k < points.size(); ++k) {
        ASSERT_GT(points[k].time, points[k - 1].time) << "case " << i;
    }
    const std::size_t top = scene.first_points() - 1U;
    ASSERT_NEAR(about(top).dot(along), 20.0F, 1e-3F) << "case " << i;
    ASSERT_NEAR(about(top).dot(scene.result.side), (about(top) - 20.0F * along).norm(), 1e-3F) << "case " << i;
    const Vec3 end = about(points.size() - 1);
    ASSERT_LT((end - end.dot(along) * along).norm(), 3e-3F) << "case " << i;
    ASSERT_GT(end.dot(along), 29.99F) << "case " << i;
}

TEST(InARowLaws, WhatIsFoundIsClearAndGoesRoundWhatComesNext)
{
    const std::uint64_t seed = seed_of(20261203);
    SCOPED_TRACE(seed);
    Random random(seed);
    std::size_t found = 0;
    std::size_t met = 0;
    auto first = std::make_unique<Result>();
    auto second = std::make_unique<Result>();
    const std::size_t cases = case_count(1000);
    for (std::size_t i = 0; i < cases; ++i) {
        InARow scene;
        fill(scene, random);
        const PlanStatus status = scene.run_in_a_row();
        ASSERT_EQ(scene.result.path.points.empty(), status != PlanStatus::found);
        if (status != PlanStatus::found) {
            ASSERT_EQ(status, PlanStatus::none_available);
            continue;
        }
        ++found;
        expect_clear(scene, i);
        expect_shape(scene, i);
        // As it would be flown too, and as one.
        path::TimedPath about = scene.result.path;
        for (path::PathPoint& point : about.points) {
            point.position -= scene.problem.frame.origin;
        }
        detail::Flown flown(scene.problem, scene.settings, scene.limits);
        WorkBudget unlimited(100'000'000);
        ASSERT_EQ(flown.judge(about, 0.0F, unlimited).status, CandidateStatus::available) << "case " << i;
        ASSERT_EQ(scene.first_part(*first), PlanStatus::found);
        if (first->side != scene.result.side) {
            ASSERT_EQ(scene.first_part(*first, first->side), PlanStatus::found);
        }
        Problem problem;
        ASSERT_TRUE(second_problem(scene, *first, problem)) << "case " << i;
        met += problem.body_radius > 0.0F ? 1U : 0U;
        Settings with = scene.settings;
        with.escape_from_margin = false;
        const PlanStatus again = solve(problem, with, scene.limits, scene.airframe, unlimited, *second);
        ASSERT_TRUE(again == PlanStatus::found || again == PlanStatus::none_available) << "case " << i;
        ASSERT_EQ(scene.result.candidates.size(), second->candidates.size()) << "case " << i;
        for (std::size_t k = 0; k < second->candidates.size(); ++k) {
            ASSERT_NEAR(scene.result.candidates[k].shape.offset, second->candidates[k].shape.offset, 5e-3F)
                << "case " << i;
        }
    }
    std::printf("[ measured ] %zu of %zu found, %zu of them met something on the way back\n", found, cases, met);
    EXPECT_GT(found, cases / 4);
    EXPECT_GT(met, cases / 10);
}

}  // namespace
}  // namespace jink::geometric
