// SPDX-License-Identifier: BSD-3-Clause
// One plan: Pinheiro's planner and the product's, with 16 candidates and 3 threats as in Pinheiro's run-time study
// (Pinheiro tab. 5.1), and with many. Then plans in which every attempt fails.
#include <memory>
#include <vector>

#include <benchmark/benchmark.h>

#include "core/base/random.hpp"
#include "core/geometric/planner.hpp"
#include "firmware/vehicles/default/cost_tables.hpp"

namespace {

using namespace jink;
using namespace jink::geometric;

/// Two seconds ahead at 5 m/s: as near as the supervisor's latest manoeuvre time. Five seconds: the first request.
constexpr float kNear = 10.0F;
constexpr float kFirst = 25.0F;

/// Static main threat on the leg 10 m ahead; the others pass such that some candidates stay free.
std::vector<world::Threat> threats(std::size_t count)
{
    std::vector<world::Threat> all{world::track_threat(0, {Vec3(kNear, 0.0F, 0.0F), Vec3::Zero()}, {1.0F})};
    for (std::size_t i = 1; i < count; ++i) {
        const float side = i % 2 == 0 ? 1.0F : -1.0F;
        const auto n = static_cast<float>(i);
        const Vec3 position(12.0F + 2.0F * n, side * (4.0F + n), 3.0F);
        all.push_back(world::track_threat(i, {position, Vec3(-3.0F, 0.5F * side, 0.0F)}, {1.0F, 0.1F}));
    }
    return all;
}

/// Static main threat on the leg `ahead` metres ahead; two more about the leg, 0.5 to `largest` m large and growing,
/// three in ten of them static.
std::vector<world::Threat> random_threats(std::uint64_t seed, float ahead = kNear, float largest = 8.0F)
{
    Random random(seed);
    const auto in = [&](float low, float high) { return random.uniform(low, high); };
    std::vector<world::Threat> all{world::track_threat(0, {Vec3(ahead, 0.0F, 0.0F), Vec3::Zero()}, {1.0F})};
    for (int i = 0; i < 2; ++i) {
        const float vx = in(-4.0F, 4.0F);
        const float vy = in(-4.0F, 4.0F);
        const float vz = in(-2.0F, 2.0F);
        const Vec3 velocity = in(0.0F, 1.0F) < 0.3F ? Vec3(Vec3::Zero()) : Vec3(vx, vy, vz);
        const float t = in(0.0F, ahead / 2.0F);
        const float x = in(2.0F, 2.4F * ahead);
        const float y = in(-4.0F, 4.0F);
        const float z = in(-4.0F, 4.0F);
        const float radius = in(0.5F, largest);
        all.push_back(
            world::track_threat(all.size(), {Vec3(x, y, z) - t * velocity, velocity}, {radius, in(0.0F, 0.5F)}));
    }
    return all;
}

Problem problem_with(const std::vector<world::Threat>& threats)
{
    Problem problem;
    problem.frame = make_path_frame(Vec3::Zero(), Vec3::UnitX());
    problem.distance = threats[0].position.x();
    problem.main_radius = 1.0F;
    problem.main = 0;
    problem.threats = threats;
    problem.start_velocity = Vec3(5.0F, 0.0F, 0.0F);
    return problem;
}

void plan(benchmark::State& state, Settings settings, std::size_t threat_count)
{
    const std::vector<world::Threat> all = threats(threat_count);
    const Problem problem = problem_with(all);
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

/// As in the co-processor: flyable means passing the predicted flight; smoothness is read from the tables.
Settings as_flown(Settings settings)
{
    settings.check_acceleration = false;
    settings.tables = &cost::tables::kDefault;
    return settings;
}

/// Both families, four planes, one offset a side: 16.
Settings sixteen(Settings settings)
{
    settings.offsets = 2;
    return as_flown(settings);
}

Settings one_attempt(Settings settings)
{
    settings.retries = 0;
    return settings;
}

Settings one_family(Settings settings)
{
    settings.symmetric = false;
    return settings;
}

Settings many(Settings settings)
{
    settings.offsets = 16;
    settings.extra_planes = 15;
    return as_flown(settings);
}

/// The first `count` random scenes, from `seed` on, in which all attempts fail; one plan after the other.
void refused(benchmark::State& state, std::uint64_t seed, std::size_t count)
{
    const Settings settings = sixteen(Settings{});
    const vehicle::VehicleLimits limits;
    const vehicle::Airframe airframe;
    const auto result = std::make_unique<Result>();
    const auto workspace = std::make_unique<Workspace>();
    std::size_t attempts = 0;
    const auto fails = [&](const std::vector<world::Threat>& all) {
        WorkBudget budget(1'000'000);
        return solve_with_retries(problem_with(all), settings, limits, airframe, budget, *workspace, *result,
                                  attempts) == world::PlanStatus::none_available &&
               attempts == kAttempts.size();
    };
    std::vector<std::vector<world::Threat>> scenes;
    for (; scenes.size() < count; ++seed) {
        if (std::vector<world::Threat> all = random_threats(seed); fails(all)) {
            scenes.push_back(std::move(all));
        }
    }
    std::size_t next = 0;
    std::size_t failed = 0;
    for (auto _ : state) {
        failed += fails(scenes[next]) ? 1U : 0U;
        next = next + 1 < scenes.size() ? next + 1 : 0;
    }
    state.counters["candidates"] = static_cast<double>(result->candidates.size());
    state.counters["attempts"] = static_cast<double>(attempts);
    state.counters["failed"] = benchmark::Counter(static_cast<double>(failed), benchmark::Counter::kAvgIterations);
}

/// Random scenes as they come, one plan after the other, with the further attempts that each needs.
void random_scenes(benchmark::State& state, Settings settings, std::size_t count, float ahead = kNear,
                   float largest = 8.0F)
{
    const vehicle::VehicleLimits limits;
    const vehicle::Airframe airframe;
    const auto result = std::make_unique<Result>();
    const auto workspace = std::make_unique<Workspace>();
    std::vector<std::vector<world::Threat>> scenes;
    for (std::size_t i = 0; i < count; ++i) {
        scenes.push_back(random_threats(i + 1, ahead, largest));
    }
    std::size_t next = 0;
    std::size_t found = 0;
    std::size_t attempts_of_all = 0;
    for (auto _ : state) {
        WorkBudget budget(1'000'000);
        std::size_t attempts = 0;
        const world::PlanStatus status = solve_with_retries(problem_with(scenes[next]), settings, limits, airframe,
                                                            budget, *workspace, *result, attempts);
        found += status == world::PlanStatus::found ? 1U : 0U;
        attempts_of_all += attempts;
        next = next + 1 < scenes.size() ? next + 1 : 0;
    }
    const auto mean = [](std::size_t n) {
        return benchmark::Counter(static_cast<double>(n), benchmark::Counter::kAvgIterations);
    };
    state.counters["found"] = mean(found);
    state.counters["attempts"] = mean(attempts_of_all);
}

/// Every candidate against every threat, none skipped because of a cheaper available one.
void all_checks(benchmark::State& state)
{
    Settings settings = many(Settings{});
    settings.evaluate_all = true;
    const std::vector<world::Threat> all = threats(9);
    const Problem problem = problem_with(all);
    const vehicle::VehicleLimits limits;
    const vehicle::Airframe airframe;
    const auto result = std::make_unique<Result>();
    for (auto _ : state) {
        WorkBudget budget(10'000'000);
        benchmark::DoNotOptimize(solve(problem, settings, limits, airframe, budget, *result));
    }
    std::size_t clear = 0;
    for (const Candidate& candidate : result->candidates) {
        clear += candidate.status == CandidateStatus::available ? 1U : 0U;
    }
    const auto candidates = static_cast<double>(result->candidates.size());
    state.counters["candidates"] = candidates;
    state.counters["clear"] = static_cast<double>(clear);
    // Clear candidates are checked against every threat; the others up to the threat in contact.
    state.counters["checks"] = benchmark::Counter(static_cast<double>(clear) * static_cast<double>(all.size()),
                                                  benchmark::Counter::kIsIterationInvariantRate);
}

BENCHMARK_CAPTURE(plan, source_16_candidates_1_threat, one_family(source_settings()), 1)->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(plan, source_16_candidates_2_threats, one_family(source_settings()), 2)
    ->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(plan, source_16_candidates_3_threats, one_family(source_settings()), 3)
    ->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(plan, product_16_candidates_3_threats, sixteen(Settings{}), 3)->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(plan, product_32_candidates_3_threats, as_flown(Settings{}), 3)->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(plan, product_512_candidates_9_threats, many(Settings{}), 9)->Unit(benchmark::kMicrosecond);

BENCHMARK_CAPTURE(random_scenes, product_16_candidates_3_threats, one_attempt(sixteen(Settings{})), 1000)
    ->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(random_scenes, product_all_attempts, sixteen(Settings{}), 1000)->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(random_scenes, source_16_candidates_3_threats, one_family(source_settings()), 1000)
    ->Unit(benchmark::kMicrosecond);
/// Two intruders of up to 2 m about a leg that is blocked 25 m ahead.
BENCHMARK_CAPTURE(random_scenes, product_16_candidates_3_threats_25_m, one_attempt(sixteen(Settings{})), 1000, kFirst,
                  2.0F)
    ->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(random_scenes, product_all_attempts_25_m, sixteen(Settings{}), 1000, kFirst, 2.0F)
    ->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(random_scenes, source_16_candidates_3_threats_25_m, one_family(source_settings()), 1000, kFirst, 2.0F)
    ->Unit(benchmark::kMicrosecond);
BENCHMARK(all_checks)->Unit(benchmark::kMicrosecond);

BENCHMARK_CAPTURE(refused, all_attempts_200_random_scenes, 1, 200)->Unit(benchmark::kMicrosecond);
/// The most expensive of the first 20 000 scenes.
BENCHMARK_CAPTURE(refused, all_attempts_costliest_scene, 10013, 1)->Unit(benchmark::kMicrosecond);

}  // namespace

BENCHMARK_MAIN();
