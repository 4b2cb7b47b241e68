// SPDX-License-Identifier: BSD-3-Clause
// One plan: the source's planner and the product's, 16 candidates and 3 threats as in the source's run-time study
// (Pinheiro tab. 5.1), and many.
#include <memory>
#include <vector>

#include <benchmark/benchmark.h>

#include "core/geometric/planner.hpp"

namespace {

using namespace jink;
using namespace jink::geometric;

/// Main threat standing on the leg 10 m ahead, the others flying past it where they leave some candidates free.
std::vector<Threat> threats(std::size_t count)
{
    std::vector<Threat> all{{{Vec3(10.0F, 0.0F, 0.0F), Vec3::Zero()}, 1.0F}};
    for (std::size_t i = 1; i < count; ++i) {
        const float side = i % 2 == 0 ? 1.0F : -1.0F;
        const auto n = static_cast<float>(i);
        all.push_back({{Vec3(12.0F + 2.0F * n, side * (4.0F + n), 3.0F), Vec3(-3.0F, 0.5F * side, 0.0F)}, 1.0F, 0.1F});
    }
    return all;
}

void plan(benchmark::State& state, Settings settings, std::size_t threat_count)
{
    const std::vector<Threat> all = threats(threat_count);
    Problem problem;
    problem.frame = make_path_frame(Vec3::Zero(), Vec3::UnitX());
    problem.distance = 10.0F;
    problem.main_radius = 1.0F;
    problem.main = 0;
    problem.threats = all;
    problem.start_velocity = Vec3(5.0F, 0.0F, 0.0F);
    const vehicle::VehicleLimits limits;
    const vehicle::Airframe airframe;
    const auto result = std::make_unique<Result>();
    world::PlanStatus status = world::PlanStatus::bad_input;
    for (auto _ : state) {
        WorkBudget budget(1'000'000);
        status = solve(problem, settings, limits, airframe, budget, *result);
        benchmark::DoNotOptimize(result->chosen);
    }
    state.counters["candidates"] = static_cast<double>(result->candidates.size());
    state.counters["found"] = status == world::PlanStatus::found ? 1.0 : 0.0;
}

/// Both families, four planes, one offset a side: 16. As the co-processor has it: flyable is what passes the predicted
/// flight.
Settings sixteen(Settings settings)
{
    settings.offsets = 2;
    settings.check_acceleration = false;
    return settings;
}

Settings one_family(Settings settings)
{
    settings.symmetric = false;
    return settings;
}

Settings thirty_two(Settings settings)
{
    settings.check_acceleration = false;
    return settings;
}

Settings many(Settings settings)
{
    settings.offsets = 16;
    settings.extra_planes = 15;
    settings.check_acceleration = false;
    return settings;
}

BENCHMARK_CAPTURE(plan, source_16_candidates_3_threats, one_family(source_settings()), 3)
    ->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(plan, product_16_candidates_3_threats, sixteen(Settings{}), 3)->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(plan, product_32_candidates_3_threats, thirty_two(Settings{}), 3)->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(plan, product_512_candidates_9_threats, many(Settings{}), 9)->Unit(benchmark::kMicrosecond);

}  // namespace

BENCHMARK_MAIN();
