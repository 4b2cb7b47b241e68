// SPDX-License-Identifier: BSD-3-Clause
// The antipodal sphere of the public ORCA-3D library's example, flown with core/orca: time of a vehicle's step, the
// least distance of two centres in continuous time (3.00 m required), and when the vehicles arrive. Beside it, in the
// same run, the published algorithm written anew (orca_published.hpp), and on the sphere of 100 m the library's own
// time and distance as published with its example; the library allocates heap memory in every step.
//
// Each swarm is flown 3 to 25 times with identical results, in turns with the published algorithm. The shortest time
// counts, to exclude other load; for each vehicle's longest step the shortest of three. Processor time, neighbour
// search included.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <ctime>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include <benchmark/benchmark.h>

#include "tests/timing/orca_published.hpp"
#include "tests/timing/orca_swarm.hpp"

namespace {

using namespace jink::orca;

/// Figures of the public library: mean time of a vehicle's step [us], least distance [m].
struct Rival {
    std::size_t count;
    double mean;
    double least;
};
constexpr std::array<Rival, 6> kSphere{
    {{10, 0.44, 3.00}, {20, 0.69, 3.00}, {50, 1.00, 2.97}, {100, 1.15, 2.96}, {500, 2.8, 2.79}, {812, 3.7, 2.81}}};
constexpr Rival kDense{100, 17.0, 0.0};  // 15 - 19 us
constexpr int kRuns = 3;
constexpr int kMaxRuns = 25;
constexpr double kEnough = 3.0;  // [s] for both, after which kRuns are enough
constexpr long kMaxSteps = 8000;

double processor_time()
{
    std::timespec now{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

/// Mean time of a vehicle's step [s], the least of all runs; all arrive, or kMaxSteps.
struct Mean {
    double time = 1e9;
    long steps = 0;
};

template <class Flown>
void run(std::size_t count, const SwarmSettings& settings, Mean& mean)
{
    Flown swarm(count, settings);
    mean.steps = 0;
    const double start = processor_time();
    while (!swarm.arrived() && mean.steps < kMaxSteps) {
        swarm.step();
        ++mean.steps;
    }
    mean.time = std::min(mean.time,
                         (processor_time() - start) / (static_cast<double>(mean.steps) * static_cast<double>(count)));
}

/// Both algorithms, in turns, so that what else the machine does meets both alike.
struct Both {
    Mean core;
    Mean published;
};
Both fly_in_turns(std::size_t count, const SwarmSettings& settings)
{
    Both both;
    const double start = processor_time();
    for (int k = 0; k < kRuns || (k < kMaxRuns && processor_time() - start < kEnough); ++k) {
        run<Swarm>(count, settings, both.core);
        run<PublishedSwarm>(count, settings, both.published);
    }
    return both;
}
/// The same, flown once for each number and sphere.
const Both& mean_times(std::size_t count, const SwarmSettings& settings)
{
    static std::map<std::pair<std::size_t, float>, Both> known;
    const auto place = known.find({count, settings.sphere});
    return place != known.end()
               ? place->second
               : known.emplace(std::pair(count, settings.sphere), fly_in_turns(count, settings)).first->second;
}

/// The longest step of one vehicle [s], of which the shortest of all runs counts, less the clock's own time.
double worst_time(std::size_t count, const SwarmSettings& settings, long steps)
{
    using Clock = std::chrono::steady_clock;
    std::vector<float> times(static_cast<std::size_t>(steps) * count, 1.0F);
    double clock = 1.0;
    for (int run = 0; run < kRuns; ++run) {
        Swarm swarm(count, settings);
        for (std::size_t k = 0; k < static_cast<std::size_t>(steps); ++k) {
            swarm.build();
            for (std::size_t i = 0; i < count; ++i) {
                const auto start = Clock::now();
                swarm.decide(i);
                const auto end = Clock::now();
                float& least = times[k * count + i];
                least = std::min(least, std::chrono::duration<float>(end - start).count());
            }
            clock = std::min(clock, -std::chrono::duration<double>(Clock::now() - Clock::now()).count());
            swarm.move();
        }
    }
    return static_cast<double>(*std::max_element(times.begin(), times.end())) - clock;
}

/// Flies again and counts the least distance, when the last one arrives, and when the vehicles do in the mean.
template <class Flown>
void watch(benchmark::State& state, Flown& swarm, long steps, float step)
{
    float least = 1e9F;
    std::size_t under_way = 0;
    for (long k = 0; k < steps; ++k) {
        swarm.step();
        least = std::min(least, swarm.least_distance());
        under_way += swarm.under_way();
    }
    const auto seconds = static_cast<double>(step);
    state.counters["least_m"] = static_cast<double>(least);
    state.counters["flown_s"] = static_cast<double>(steps) * seconds;
    state.counters["arrival_s"] = (1.0 + static_cast<double>(under_way) / static_cast<double>(swarm.size())) * seconds;
}

void fly_published(benchmark::State& state, std::size_t count, const SwarmSettings& settings)
{
    for (auto _ : state) {
        const Mean& mean = mean_times(count, settings).published;
        state.SetIterationTime(mean.time);
        PublishedSwarm swarm(count, settings);
        watch(state, swarm, mean.steps, settings.step);
        state.SetLabel(mean.steps < kMaxSteps ? "published algorithm" : "NOT ARRIVED");
    }
}

Mean alone(std::size_t count, const SwarmSettings& settings)
{
    Mean mean;
    for (int k = 0; k < kRuns; ++k) {
        run<Swarm>(count, settings, mean);
    }
    return mean;
}

void fly(benchmark::State& state, std::size_t count, const SwarmSettings& settings, const Rival& rival, bool is_beside)
{
    for (auto _ : state) {
        const Mean mean = is_beside ? mean_times(count, settings).core : alone(count, settings);
        state.SetIterationTime(mean.time);
        Swarm swarm(count, settings);
        watch(state, swarm, mean.steps, settings.step);
        const Swarm::Counts& counts = swarm.counts();
        const auto share = [&](std::uint64_t part) {
            return static_cast<double>(part) / static_cast<double>(counts.solved);
        };
        state.counters["worst_us"] = 1e6 * worst_time(count, settings, mean.steps);
        state.counters["warning"] = share(counts.warning);
        state.counters["conflict"] = share(counts.conflict);
        state.counters["capped"] = share(counts.truncated);
        char text[96];
        if (rival.least > 0.0) {
            std::snprintf(text, sizeof text, "public library: %.2f us, %.2f m", rival.mean, rival.least);
        } else if (rival.mean == 0.0) {
            std::snprintf(text, sizeof text, "no figure of the library");
        } else {
            std::snprintf(text, sizeof text, "public library: %.0f us", rival.mean);
        }
        state.SetLabel(mean.steps < kMaxSteps ? text : "NOT ARRIVED");
    }
}

template <class Run>
void report(const char* name, std::size_t count, Run run)
{
    benchmark::RegisterBenchmark((std::string(name) + "/" + std::to_string(count)).c_str(), run)
        ->UseManualTime()
        ->Iterations(1)
        ->Unit(benchmark::kMicrosecond);
}

void report(const char* name, std::size_t count, const SwarmSettings& settings, const Rival& rival,
            bool is_beside = true)
{
    report(name, count, [=](benchmark::State& state) { fly(state, count, settings, rival, is_beside); });
}

}  // namespace

int main(int argc, char** argv)
{
    const SwarmSettings sphere;
    SwarmSettings one_region = sphere;
    one_region.regions = false;
    SwarmSettings dense = sphere;
    dense.sphere = 20.0F;
    dense.range = 1000.0F;
    dense.most = NearestPoints::kMax - 1;
    for (const Rival& rival : kSphere) {
        report("sphere", rival.count, sphere, rival);
        report("published", rival.count, [=](auto& state) { fly_published(state, rival.count, sphere); });
    }
    SwarmSettings small = sphere;
    small.sphere = 60.0F;
    for (const std::size_t count : {37U, 200U, 1000U}) {
        report("sphere_60", count, small, {});
        report("published_60", count, [=](auto& state) { fly_published(state, count, small); });
    }
    report("dense", kDense.count, dense, kDense, false);
    // As in the public library: shows the effect of the two regions.
    report("sphere_one_region", 812, one_region, kSphere.back(), false);
    benchmark::Initialize(&argc, argv);
    benchmark::RunSpecifiedBenchmarks();
    benchmark::Shutdown();
    return 0;
}
