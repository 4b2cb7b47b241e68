// SPDX-License-Identifier: BSD-3-Clause
// A map of the 1000 triangles of fifty corner buildings about each of a swarm of 100: the choice of the obstacles near
// a vehicle, and what G-ORCA makes of them (half-spaces, the way ahead), for a soup of triangles and for the same mesh
// in convex pieces. And the whole step of the swarm on a flight through them: neighbours and their half-spaces, the
// choice of obstacles and their half-spaces, the program.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <chrono>
#include <ctime>
#include <vector>

#include "core/base/random.hpp"
#include "core/orca/obstacle_plane.hpp"
#include "core/orca/obstacle_way.hpp"
#include "tests/oracle/obstacle_threats.hpp"
#include "tests/timing/orca_swarm.hpp"
#include "toolchain/mesh/decompose.hpp"

namespace {

using jink::Vec3;
using jink::WorkBudget;
namespace mesh = jink::mesh;
namespace orca = jink::orca;

constexpr std::size_t kBuildings = 50;
constexpr std::size_t kAgents = 100;
constexpr float kTown = 100.0F;  ///< side [m]

/// An L of 20 triangles, 12 m by 12 m, turned by quarters.
void append_building(mesh::TriangleMesh& town, const mesh::Vec3d& at, double height, std::size_t quarters)
{
    const double outline[6][2] = {{0, 0}, {12, 0}, {12, 4}, {4, 4}, {4, 12}, {0, 12}};
    const std::size_t caps[4][3] = {{0, 1, 2}, {0, 2, 3}, {0, 3, 5}, {3, 4, 5}};
    const std::size_t first = town.vertices.size();
    for (const double z : {0.0, height}) {
        for (const auto& p : outline) {
            double x = p[0];
            double y = p[1];
            for (std::size_t i = 0; i < quarters; ++i) {
                std::swap(x, y);
                x = -x;
            }
            town.vertices.emplace_back(at + mesh::Vec3d(x, y, z));
        }
    }
    for (const auto& c : caps) {
        town.triangles.push_back({first + c[0], first + c[2], first + c[1]});
        town.triangles.push_back({first + c[0] + 6, first + c[1] + 6, first + c[2] + 6});
    }
    for (std::size_t i = 0; i < 6; ++i) {
        const std::size_t j = (i + 1) % 6;
        town.triangles.push_back({first + i, first + j, first + j + 6});
        town.triangles.push_back({first + i, first + j + 6, first + i + 6});
    }
}

struct Town {
    mesh::TriangleMesh town;
    std::vector<orca::OwnMotion> agents;

    Town()
    {
        jink::Random random(1);
        for (std::size_t i = 0; i < kBuildings; ++i) {
            append_building(town, {double(random.uniform(0.0F, kTown)), double(random.uniform(0.0F, kTown)), 0.0},
                            double(random.uniform(5.0F, 30.0F)), random.below(4));
        }
        for (std::size_t i = 0; i < kAgents; ++i) {
            orca::OwnMotion own;
            own.position = {random.uniform(0.0F, kTown), random.uniform(0.0F, kTown), random.uniform(2.0F, 30.0F)};
            own.velocity = {random.uniform(-2.0F, 2.0F), random.uniform(-2.0F, 2.0F), 0.0F};
            own.reach_speed = 3.0F;
            agents.push_back(own);
        }
    }
};

const Town& swarm()
{
    static const Town made;
    return made;
}

jink::files::MapTables made_by(mesh::Method method)
{
    mesh::Recipe recipe;
    recipe.method = method;
    return mesh::stored_map("town", mesh::pieces_of(swarm().town, recipe));
}

const jink::files::MapTables& map_of(mesh::Method method)
{
    if (method == mesh::Method::soup) {
        static const jink::files::MapTables soup = made_by(mesh::Method::soup);
        return soup;
    }
    static const jink::files::MapTables decomposed = made_by(mesh::Method::decompose);
    return decomposed;
}

/// What is about each agent, chosen beforehand.
std::vector<jink::world::ObstacleTable> obstacles_of(const jink::geometry::MeshMap& map)
{
    std::vector<jink::world::ObstacleTable> tables(kAgents);
    for (std::size_t i = 0; i < kAgents; ++i) {
        WorkBudget budget(1'000'000);
        tables[i].keep_places_for_map();
        static_cast<void>(orca::choose_obstacles(map, swarm().agents[i], {}, budget, tables[i]));
    }
    return tables;
}

std::vector<std::vector<jink::world::Threat>> threats_of(const std::vector<jink::world::ObstacleTable>& tables)
{
    std::vector<std::vector<jink::world::Threat>> threats;
    for (const jink::world::ObstacleTable& table : tables) {
        threats.push_back(jink::oracle::threats_of(table.obstacles()));
    }
    return threats;
}

/// All agents in each turn; `work(agent's number, budget)` of each alone is timed for the worst of them, the least time
/// of all turns standing for an agent.
template <class Work>
void run(benchmark::State& state, mesh::Method method, const Work& work)
{
    using Clock = std::chrono::steady_clock;
    const jink::geometry::MeshMap map = map_of(method).view();
    std::vector<double> least(kAgents, 1e9);
    std::uint32_t most_units = 0;
    for (auto _ : state) {
        for (std::size_t i = 0; i < kAgents; ++i) {
            WorkBudget budget(1'000'000);
            const auto start = Clock::now();
            work(i, budget);
            least[i] = std::min(least[i], std::chrono::duration<double, std::nano>(Clock::now() - start).count());
            most_units = std::max(most_units, budget.spent());
        }
    }
    double sum = 0;
    for (const double time : least) {
        sum += time;
    }
    state.counters["triangles"] = double(swarm().town.triangles.size());
    state.counters["pieces"] = double(map.pieces.size());
    state.counters["ns_per_agent"] = sum / double(kAgents);
    state.counters["worst_ns"] = *std::max_element(least.begin(), least.end());
    state.counters["most_units"] = most_units;
}

void select(benchmark::State& state, mesh::Method method)
{
    const jink::geometry::MeshMap map = map_of(method).view();
    const orca::ObstacleSettings settings;
    std::size_t boxes = 0;
    float exact = 1e9F;
    jink::world::ObstacleTable table;
    table.keep_places_for_map();
    run(state, method, [&](std::size_t i, WorkBudget& budget) {
        const auto found = orca::choose_obstacles(map, swarm().agents[i], settings, budget, table);
        boxes += found.boxes;
        exact = std::min(exact, found.exact_within);
    });
    state.counters["boxes_per_agent"] = double(boxes) / double(kAgents) / double(state.iterations());
    state.counters["least_exact_m"] = double(exact);
}

void planes(benchmark::State& state, mesh::Method method)
{
    const orca::ObstacleSettings settings;
    const auto tables = obstacles_of(map_of(method).view());
    const auto threats = threats_of(tables);
    std::size_t most = 0;
    std::size_t truncated = 0;
    run(state, method, [&](std::size_t i, WorkBudget& budget) {
        const orca::ObstaclePlanes found = orca::obstacle_planes(threats[i], swarm().agents[i], settings, budget);
        most = std::max(most, found.planes.size());
        truncated += found.truncated ? 1 : 0;
        benchmark::DoNotOptimize(found.margin);
    });
    state.counters["most_planes"] = double(most);
    state.counters["truncated"] = double(truncated) / double(state.iterations());
}

void way(benchmark::State& state, mesh::Method method)
{
    const orca::ObstacleSettings settings;
    const auto tables = obstacles_of(map_of(method).view());
    const auto threats = threats_of(tables);
    run(state, method, [&](std::size_t i, WorkBudget& budget) {
        const orca::OwnMotion& own = swarm().agents[i];
        const orca::WayClearance found =
            orca::clearance_along(threats[i], own.position, own.velocity, settings.horizon, settings, budget);
        benchmark::DoNotOptimize(found.clear_until);
    });
}

/// Free places for vehicles: outside all buildings, and away from earlier vehicles.
std::vector<Vec3> free_places()
{
    const jink::geometry::MeshMap map = map_of(mesh::Method::decompose).view();
    jink::Random random(2);
    std::vector<Vec3> out;
    jink::world::ObstacleTable table;
    table.keep_places_for_map();
    while (out.size() < kAgents) {
        const Vec3 at(random.uniform(-6.0F, kTown + 6.0F), random.uniform(-6.0F, kTown + 6.0F),
                      random.uniform(2.0F, 30.0F));
        const orca::OwnMotion own{at, Vec3::Zero(), 3.0F};
        WorkBudget budget(1'000'000);
        const bool is_near = std::any_of(out.begin(), out.end(), [&](const Vec3& p) { return (p - at).norm() < 3.0F; });
        static_cast<void>(orca::choose_obstacles(map, own, {}, budget, table));
        if (!is_near &&
            orca::obstacle_planes(jink::oracle::threats_of(table.obstacles()), own, {}, budget).margin > 0.5F) {
            out.push_back(at);
        }
    }
    return out;
}

/// Every vehicle flies to another vehicle's place, at 50 Hz for 10 s; a step's time is its least over all flights.
void step(benchmark::State& state, mesh::Method method)
{
    constexpr std::size_t kSteps = 500;
    orca::SwarmSettings settings;
    settings.radius = 0.6F;
    settings.warning = 1.5F;
    settings.max_speed = 3.0F;
    settings.cruise = 2.0F;
    settings.step = 0.02F;
    const std::vector<Vec3> places = free_places();
    std::vector<Vec3> goals = places;
    std::rotate(goals.begin(), goals.begin() + kAgents / 2, goals.end());
    const jink::geometry::MeshMap map = map_of(method).view();
    std::vector<double> least(kSteps, 1e9);
    orca::Swarm::Counts counts;
    float apart = 1e9F;
    for (auto _ : state) {
        orca::Swarm flying(places, goals, settings);
        flying.set_map(map, {});
        for (double& time : least) {
            std::timespec start{};
            std::timespec end{};
            clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &start);
            flying.step();
            clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &end);
            time = std::min(time, 1e6 * double(end.tv_sec - start.tv_sec) + 1e-3 * double(end.tv_nsec - start.tv_nsec));
            apart = std::min(apart, flying.least_distance());
        }
        counts = flying.counts();
    }
    double sum = 0.0;
    for (const double time : least) {
        sum += time;
    }
    state.counters["swarm_us"] = sum / double(kSteps);
    state.counters["worst_us"] = *std::max_element(least.begin(), least.end());
    state.counters["planes"] = double(counts.planes) / double(counts.solved);
    state.counters["of_obstacles"] = double(counts.beside_obstacles) / double(counts.solved);
    state.counters["relaxed"] = double(counts.warning + counts.conflict + counts.other) / double(counts.solved);
    state.counters["penetrating"] = double(counts.penetrating);
    state.counters["least_m"] = double(apart);
}

}  // namespace

BENCHMARK_CAPTURE(step, soup, mesh::Method::soup)->Unit(benchmark::kMillisecond)->Iterations(5);
BENCHMARK_CAPTURE(step, decomposed, mesh::Method::decompose)->Unit(benchmark::kMillisecond)->Iterations(5);
BENCHMARK_CAPTURE(select, soup, mesh::Method::soup)->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(select, decomposed, mesh::Method::decompose)->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(planes, soup, mesh::Method::soup)->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(planes, decomposed, mesh::Method::decompose)->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(way, soup, mesh::Method::soup)->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(way, decomposed, mesh::Method::decompose)->Unit(benchmark::kMicrosecond);
BENCHMARK_MAIN();
