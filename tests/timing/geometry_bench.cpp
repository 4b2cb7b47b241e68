// SPDX-License-Identifier: BSD-3-Clause
// Contact tests of core/geometry beside FCL's conservative advancement on the same cases, in one run.
#include <benchmark/benchmark.h>

#include <fcl/geometry/shape/box.h>
#include <fcl/geometry/shape/sphere.h>
#include <fcl/narrowphase/continuous_collision.h>

#include "core/geometry/convex.hpp"
#include "core/geometry/sweep.hpp"
#include "tests/property/core/geometry/oracle.hpp"
#include "tests/timing/crossing_scene.hpp"

namespace {

using jink::Vec3;
using jink::WorkBudget;
using jink::timing::CrossingCase;
using jink::timing::CrossingScene;
namespace geometry = jink::geometry;

const CrossingScene& scene()
{
    static const CrossingScene made;
    return made;
}

/// First contact in double precision, negative for none.
double true_contact(const Vec3& half, const CrossingCase& c, float radius)
{
    const geometry::oracle::Passage passage(half, c.own, c.threat);
    const double closest = passage.closest(1.0);
    if (passage.distance(closest) > double(radius)) {
        return -1.0;
    }
    return passage.distance(0.0) <= double(radius) ? 0.0 : passage.crossing(0.0, closest, double(radius));
}

/// Runs `first_contact(case)`, negative for none, over the scene; reports hits, misses and the worst error of the
/// instant.
template <class FirstContact>
void run(benchmark::State& state, const Vec3& half, float radius, const FirstContact& first_contact)
{
    const auto& cases = scene().cases;
    std::size_t i = 0;
    for (auto _ : state) {
        benchmark::DoNotOptimize(first_contact(cases[i]));
        i = i + 1 < cases.size() ? i + 1 : 0;
    }
    double hits = 0, missed = 0, spurious = 0, worst = 0;
    for (const CrossingCase& c : cases) {
        const double expected = true_contact(half, c, radius);
        const double found = static_cast<double>(first_contact(c));
        hits += expected >= 0 ? 1 : 0;
        missed += expected >= 0 && found < 0 ? 1 : 0;
        spurious += expected < 0 && found >= 0 ? 1 : 0;
        worst = std::max(worst, expected >= 0 && found >= 0 ? std::abs(found - expected) : 0.0);
    }
    state.counters["hits"] = hits;
    state.counters["missed"] = missed;
    state.counters["spurious"] = spurious;
    state.counters["worst_toc"] = worst;
}

void box_sphere(benchmark::State& state)
{
    run(state, scene().half, scene().radius, [](const CrossingCase& c) {
        const auto contact = geometry::contact_interval(scene().half, c.own, c.threat, scene().radius, 1.0F);
        return contact ? contact->first : -1.0F;
    });
}

void sphere_sphere(benchmark::State& state)
{
    const float radius = scene().own_radius + scene().radius;
    run(state, Vec3::Zero(), radius, [radius](const CrossingCase& c) {
        const auto contact = geometry::contact_interval(c.own, c.threat, radius, 1.0F);
        return contact ? contact->first : -1.0F;
    });
}

fcl::Transform3d placed(const Vec3& at)
{
    fcl::Transform3d out = fcl::Transform3d::Identity();
    out.translation() = at.cast<double>();
    return out;
}

double fcl_first_contact(const fcl::CollisionGeometryd& own, const fcl::CollisionGeometryd& threat,
                         const CrossingCase& c)
{
    fcl::ContinuousCollisionRequestd request;
    request.ccd_motion_type = fcl::CCDM_TRANS;
    request.ccd_solver_type = fcl::CCDC_CONSERVATIVE_ADVANCEMENT;
    fcl::ContinuousCollisionResultd result;
    fcl::continuousCollide(&own, placed(c.own.position), placed(c.own.position + c.own.velocity), &threat,
                           placed(c.threat.position), placed(c.threat.position + c.threat.velocity), request, result);
    return result.is_collide ? result.time_of_contact : -1.0;
}

void fcl_box_sphere(benchmark::State& state)
{
    const fcl::Boxd box((2.0F * scene().half).cast<double>());
    const fcl::Sphered sphere(static_cast<double>(scene().radius));
    run(state, scene().half, scene().radius, [&](const CrossingCase& c) { return fcl_first_contact(box, sphere, c); });
}

void fcl_sphere_sphere(benchmark::State& state)
{
    const fcl::Sphered own(static_cast<double>(scene().own_radius));
    const fcl::Sphered threat(static_cast<double>(scene().radius));
    run(state, Vec3::Zero(), scene().own_radius + scene().radius,
        [&](const CrossingCase& c) { return fcl_first_contact(own, threat, c); });
}

/// Runs `test(case)` over the scene.
template <class Test>
void run_plain(benchmark::State& state, const Test& test)
{
    const auto& cases = scene().cases;
    std::size_t i = 0;
    for (auto _ : state) {
        benchmark::DoNotOptimize(test(cases[i]));
        i = i + 1 < cases.size() ? i + 1 : 0;
    }
}

void least_distance(benchmark::State& state)
{
    run_plain(state,
              [](const CrossingCase& c) { return geometry::least_distance(scene().half, c.own, c.threat, 1.0F); });
}

void swept_distance(benchmark::State& state)
{
    run_plain(state, [](const CrossingCase& c) {
        return geometry::swept_distance(scene().half, c.own.position, c.own.position + c.own.velocity,
                                        c.threat.position, c.threat.position + c.threat.velocity);
    });
}

/// The own box swept along its path against a box of 1 m half extents at the threat's half-way position.
geometry::Shape obstacle(const CrossingCase& c)
{
    return geometry::make_box(c.threat.position + 0.5F * c.threat.velocity, Vec3::Ones());
}

void convex_contact(benchmark::State& state)
{
    double most = 0;
    run_plain(state, [&](const CrossingCase& c) {
        WorkBudget budget(1000);
        const auto contact = geometry::swept_box_contact(scene().half, c.own.position, c.own.position + c.own.velocity,
                                                         obstacle(c), 0.0F, budget);
        most = std::max(most, static_cast<double>(budget.spent()));
        return contact;
    });
    state.counters["most_calls"] = most;
}

void convex_distance(benchmark::State& state)
{
    double most = 0;
    run_plain(state, [&](const CrossingCase& c) {
        WorkBudget budget(10'000);
        const auto distance = geometry::swept_box_distance(
            scene().half, c.own.position, c.own.position + c.own.velocity, obstacle(c), 10.0F, 0.01F, budget);
        most = std::max(most, static_cast<double>(budget.spent()));
        return distance;
    });
    state.counters["most_calls"] = most;
}

BENCHMARK(box_sphere);
BENCHMARK(fcl_box_sphere);
BENCHMARK(sphere_sphere);
BENCHMARK(fcl_sphere_sphere);
BENCHMARK(least_distance);
BENCHMARK(swept_distance);
BENCHMARK(convex_contact);
BENCHMARK(convex_distance);

}  // namespace

BENCHMARK_MAIN();
