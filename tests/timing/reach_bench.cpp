// SPDX-License-Identifier: BSD-3-Clause
// One decision with reach sets: 2000 points of a scan fused with 32 intruders over 350 cells, the combined set
// evaluated, a trajectory chosen. For comparison Gomola's four passes over the same cells, and the geometric planner in
// the same scene.
#include <array>
#include <cmath>
#include <memory>
#include <vector>

#include <benchmark/benchmark.h>

#include "core/base/random.hpp"
#include "core/geometric/planner.hpp"
#include "core/reach/planner.hpp"
#include "core/reach/scan_picture.hpp"
#include "core/world/threat_set.hpp"
#include "firmware/vehicles/default/reach_sets.hpp"

namespace {

using namespace jink;

constexpr std::size_t kIntruders = 32;
constexpr int kAcross = 50;
constexpr int kUp = 40;
constexpr std::size_t kPoints = kAcross * kUp;
constexpr float kSpeed = 5.0F;

/// The default vehicle's emergency sets alone: the sets with most nodes.
struct Emergencies {
    std::array<reach::SegmentSets, 6> segments{};
    reach::VehicleSets sets = reach::kDefaultSets;

    Emergencies()
    {
        for (std::size_t i = 0; i < segments.size(); ++i) {
            const reach::SegmentSets& of = reach::kDefaultSets.segments[i];
            segments[i] = {of.emergency, of.emergency, of.upside_down};
        }
        sets.segments = segments;
    }
};

/// 32 intruders that cross ahead, scanned trunks, and a vehicle on its leg.
struct Scene {
    TimePoint now{10'000'000};
    vehicle::VehicleState own;
    vehicle::VehicleLimits limits;
    vehicle::Airframe airframe;
    world::Reference reference;
    std::vector<world::Track> tracks;
    world::Airspace airspace;
    std::vector<Vec3> points;
    reach::ScanStart scan;

    explicit Scene(std::uint64_t seed, std::size_t intruders = kIntruders)
    {
        Random random(seed);
        own.position = Vec3(0.0F, 0.0F, 30.0F);
        own.velocity = Vec3(kSpeed, 0.0F, 0.0F);
        own.stamp = now;
        reference = world::Reference({Vec3(-10.0F, 0.0F, 30.0F), Vec3(400.0F, 0.0F, 30.0F), kSpeed});
        for (std::size_t i = 0; i < intruders; ++i) {
            world::Track track;
            track.id = static_cast<world::TrackId>(i);
            track.stamp = now;
            track.radius = random.uniform(0.3F, 1.0F);
            track.sigma_velocity = 0.1F;
            track.velocity =
                Vec3(random.uniform(-8.0F, 8.0F), random.uniform(-8.0F, 8.0F), random.uniform(-1.0F, 1.0F));
            const float t = random.uniform(1.5F, 5.0F);
            const Vec3 meeting(kSpeed * t, random.uniform(-8.0F, 8.0F), 30.0F + random.uniform(-6.0F, 6.0F));
            track.position = meeting - track.velocity * t;
            tracks.push_back(track);
        }
        scan.stamp = now;
        scan.position = own.position;
        scan.unit = kSpeed * reach::kDefaultSets.period;
        scan.horizontal_pitch = 2.2F / kAcross;
        scan.vertical_pitch = 1.1F / kUp;
        for (std::size_t i = 0; i < kPoints; ++i) {
            const float azimuth = scan.horizontal_pitch * (static_cast<float>(i % kAcross) - 0.5F * kAcross);
            const float elevation = scan.vertical_pitch * (static_cast<float>(i / kAcross) - 0.5F * kUp);
            // Most returns are behind the grid; trunks are inside.
            const float distance = std::abs(azimuth - 0.3F) < 0.05F ? 14.0F : 40.0F;
            points.push_back(distance * Vec3(std::cos(elevation) * std::cos(azimuth),
                                             std::cos(elevation) * std::sin(azimuth), std::sin(elevation)));
        }
    }

    [[nodiscard]] world::Situation view() const
    {
        world::Situation s{now, own, limits, airframe, reference, rules};
        static_cast<void>(threats.collect(s, {tracks, {}, airspace}));
        s.threats = threats.all();
        return s;
    }
    world::FlightRules rules;
    mutable world::ThreatSet threats;  ///< of the newest view
};

/// Enough scenes in rotation to avoid unrealistic cache hits.
const std::vector<Scene>& scenes()
{
    static const std::vector<Scene> all = [] {
        std::vector<Scene> made;
        for (std::uint64_t seed = 1; seed <= 32; ++seed) {
            made.emplace_back(seed);
        }
        return made;
    }();
    return all;
}

std::unique_ptr<reach::Planner> planner_of(const reach::VehicleSets& sets)
{
    reach::Settings settings;
    settings.sets = &sets;
    return std::make_unique<reach::Planner>(settings);
}

void scan(reach::ScanPicture& picture, const Scene& scene)
{
    static_cast<void>(picture.begin(scene.scan));
    for (const Vec3& point : scene.points) {
        picture.add(point);
    }
    picture.end();
}

std::unique_ptr<reach::ScanPicture> picture_of(const reach::VehicleSets& sets)
{
    auto picture = std::make_unique<reach::ScanPicture>();
    static_cast<void>(picture->configure(sets.segments.front().emergency->grid));
    return picture;
}

void decide(benchmark::State& state, const reach::VehicleSets& sets, bool with_scan)
{
    const std::unique_ptr<reach::Planner> planner = planner_of(sets);
    const std::unique_ptr<reach::ScanPicture> picture = picture_of(sets);
    if (with_scan) {
        planner->look_at(picture.get());
    }
    world::Manoeuvre out;
    std::size_t i = 0;
    std::size_t found = 0;
    double work = 0.0;
    for ([[maybe_unused]] const auto& _ : state) {
        const Scene& scene = scenes()[i++ % scenes().size()];
        if (with_scan) {
            scan(*picture, scene);
        }
        WorkBudget budget(1'000'000);
        found += planner->plan(scene.view(), budget, out) == world::PlanStatus::found ? 1U : 0U;
        work += budget.spent();
        benchmark::DoNotOptimize(out);
    }
    const auto n = static_cast<double>(std::max<std::size_t>(i, 1));
    state.counters["found"] = static_cast<double>(found) / n;
    state.counters["work"] = work / n;
}

void decision(benchmark::State& state)
{
    static const Emergencies emergencies;
    decide(state, emergencies.sets, true);
}
BENCHMARK(decision)->Name("decision/2000 points, 32 intruders, emergency set")->Unit(benchmark::kMicrosecond);

void decision_without_scan(benchmark::State& state)
{
    static const Emergencies emergencies;
    decide(state, emergencies.sets, false);
}
BENCHMARK(decision_without_scan)->Name("decision/32 intruders, emergency set")->Unit(benchmark::kMicrosecond);

void decision_as_flown(benchmark::State& state) { decide(state, reach::kDefaultSets, true); }
BENCHMARK(decision_as_flown)
    ->Name("decision/2000 points, 32 intruders, navigation set first")
    ->Unit(benchmark::kMicrosecond);

void scan_alone(benchmark::State& state)
{
    const std::unique_ptr<reach::ScanPicture> picture = picture_of(reach::kDefaultSets);
    std::size_t i = 0;
    for ([[maybe_unused]] const auto& _ : state) {
        scan(*picture, scenes()[i++ % scenes().size()]);
    }
}
BENCHMARK(scan_alone)->Name("part/2000 points counted")->Unit(benchmark::kMicrosecond);

/// Levels of cells as one pass, and as Gomola's four.
struct Cells {
    const reach::ReachSet& set = *reach::kDefaultSets.segments[4].emergency;
    std::vector<reach::Level> blocks;
    std::vector<reach::Level> nodes = std::vector<reach::Level>(set.nodes());
    std::vector<reach::Level> cells = std::vector<reach::Level>(set.grid.cells());

    Cells()
    {
        Random random(7);
        for (std::size_t i = 0; i < set.grid.cells(); ++i) {
            const bool threatened = random.below(20) == 0;
            blocks.push_back(threatened ? static_cast<reach::Level>(random.below(4)) : reach::kFree);
        }
    }
};

void one_pass(benchmark::State& state)
{
    Cells c;
    for ([[maybe_unused]] const auto& _ : state) {
        reach::evaluate_with(
            c.set, c.blocks, [](reach::NodeIndex) { return reach::kFree; }, c.nodes, c.cells);
        benchmark::DoNotOptimize(c.cells.data());
    }
}
BENCHMARK(one_pass)->Name("part/four levels in one pass")->Unit(benchmark::kMicrosecond);

/// Gomola eq. 6.162, 6.163: the reachability of nodes and cells as products, once for each of the four runs.
void four_passes(benchmark::State& state)
{
    Cells c;
    std::vector<float> reach_of_node(c.set.nodes());
    std::vector<float> reach_of_cell(c.set.grid.cells());
    for ([[maybe_unused]] const auto& _ : state) {
        for (reach::Level run = 0; run < reach::kRuns; ++run) {
            std::fill(reach_of_cell.begin(), reach_of_cell.end(), 0.0F);
            reach_of_node[0] = 1.0F;
            for (std::size_t node = 1; node < c.set.nodes(); ++node) {
                float reach = reach_of_node[c.set.parent[node]];
                for (const reach::FootprintEntry& entry : c.set.entered(node)) {
                    reach *= c.blocks[entry.cell] <= run ? 0.0F : 1.0F;
                    reach_of_cell[entry.cell] = std::max(reach_of_cell[entry.cell], reach);
                }
                reach_of_node[node] = reach;
            }
        }
        benchmark::DoNotOptimize(reach_of_cell.data());
    }
}
BENCHMARK(four_passes)->Name("part/the source's four passes")->Unit(benchmark::kMicrosecond);

void geometric_planner(benchmark::State& state)
{
    const auto planner = std::make_unique<geometric::Planner>(geometric::Settings{});
    world::Manoeuvre out;
    std::size_t i = 0;
    std::size_t found = 0;
    for ([[maybe_unused]] const auto& _ : state) {
        WorkBudget budget(1'000'000);
        found +=
            planner->plan(scenes()[i++ % scenes().size()].view(), budget, out) == world::PlanStatus::found ? 1U : 0U;
        benchmark::DoNotOptimize(out);
    }
    state.counters["found"] = static_cast<double>(found) / static_cast<double>(std::max<std::size_t>(i, 1));
}
BENCHMARK(geometric_planner)
    ->Name("beside it/geometric planner with its retries, 32 intruders")
    ->Unit(benchmark::kMicrosecond);

}  // namespace

BENCHMARK_MAIN();
