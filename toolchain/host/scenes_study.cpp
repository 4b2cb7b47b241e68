// SPDX-License-Identifier: BSD-3-Clause
#include "toolchain/host/scenes_study.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

#include <nlohmann/json.hpp>

#include "toolchain/sim/in_process.hpp"

namespace jink::host {
namespace {

using Json = nlohmann::ordered_json;
using sim::Vec;

/// A command slower than this is a command to stop [m/s].
constexpr double kStill = 0.1;
/// Every fifth sample is drawn: 10 Hz.
constexpr std::size_t kStride = 5;
constexpr std::size_t kLine = 160;

/// Samples are equidistant in time.
double held(const sim::Record& record)
{
    const auto still = std::count_if(record.samples.begin(), record.samples.end(), [](const sim::Sample& sample) {
        return sample.mode == sim::Mode::external && sample.setpoint.norm() < kStill;
    });
    const std::size_t n = record.samples.size();
    return n < 2 ? 0.0 : static_cast<double>(still) * record.samples.back().time / static_cast<double>(n - 1);
}

double rounded(double value) { return std::round(value * 1e2) / 1e2 + 0.0; }

Json json(const Vec& v) { return Json::array({rounded(v.x()), rounded(v.y()), rounded(v.z())}); }

Json path_of(const sim::Record& record)
{
    Json path = Json::array();
    for (std::size_t i = 0; i < record.samples.size(); i += kStride) {
        path.push_back(json(record.samples[i].position));
    }
    return path;
}

Json body_of(const sim::Threat& threat, double end)
{
    return {{"form", sim::to_string(threat.form)}, {"radius", threat.radius},
            {"half_height", threat.half_height},   {"half_extents", json(threat.half_extents)},
            {"moves", !threat.at_rest()},          {"from", json(threat.position_at(0.0))},
            {"to", json(threat.position_at(end))}};
}

Json body_of(const sim::ClosedArea& area, double end)
{
    return {{"form", "area"},
            {"radius", area.radius},
            {"margin", area.margin},
            {"moves", false},
            {"from", json(area.centre_at(0.0))},
            {"to", json(area.centre_at(end))}};
}

/// Least distance to bodies and closed areas [m].
double least_of(const sim::Record& record) { return std::min(record.closest.surface, record.closest_area); }

/// The vehicle's position at the least distance.
sim::Vec place_of_least(const sim::Scenario& scenario, const sim::Record& record)
{
    if (record.closest.surface <= record.closest_area) {
        return record.closest.own;
    }
    sim::Vec at = record.closest.own;
    double least = std::numeric_limits<double>::infinity();
    for (const sim::Sample& sample : record.samples) {
        for (const sim::ClosedArea& area : scenario.areas) {
            const double distance = sim::surface_distance(area, sample.time, sample.position);
            if (distance < least) {
                least = distance;
                at = sample.position;
            }
        }
    }
    return at;
}

/// End of the drawn time: the last arrival at the goal.
double last_of(const Scene& scene)
{
    double last = 0.0;
    for (const SceneFlight& flight : scene.flights) {
        last = std::max(last, flight.record.goal_at);
    }
    return last > 0.0 ? last : scene.scenario.duration;
}

double median(std::vector<double> values)
{
    if (values.empty()) {
        return -1.0;
    }
    std::sort(values.begin(), values.end());
    return values[values.size() / 2];
}

std::string line(const char* format, const auto&... values)
{
    std::string text(kLine, '\0');
    const int n = std::snprintf(text.data(), text.size(), format, values...);
    text.resize(std::min(text.size() - 1, static_cast<std::size_t>(std::max(0, n))));
    return text.append("\n");
}

}  // namespace

std::vector<FlownBy> ways_to_fly()
{
    return {{"straight", true, {}},
            {"geometric", false, {{"JNK_METHODS", 1.0}}},
            {"reach sets", false, {{"JNK_METHODS", 2.0}}},
            {"reciprocal", false, {{"JNK_METHODS", 4.0}}},
            {"geometric and reach sets", false, {{"JNK_METHODS", 3.0}}},
            {"all", false, {{"JNK_METHODS", 7.0}}}};
}

Scene fly_scene(const sim::Scenario& scenario, const std::vector<FlownBy>& ways)
{
    Scene scene{scenario, {}};
    for (const FlownBy& by : ways) {
        sim::Scenario flown = scenario;
        for (const auto& [name, value] : by.parameters) {
            flown.parameters[name] = value;
        }
        SceneFlight flight{by, by.alone ? sim::fly_alone(flown) : sim::fly_in_process(flown), 0.0};
        flight.held = held(flight.record);
        scene.flights.push_back(std::move(flight));
    }
    return scene;
}

std::string table_of(const Scene& scene)
{
    const std::string head = scene.scenario.name + ", seed " + std::to_string(scene.scenario.seed);
    std::string text = line("%-34s %-10s %7s %8s %7s %6s %6s %6s", head.c_str(), "outcome", "goal s", "least m",
                            "held s", "brakes", "plans", "found");
    for (const SceneFlight& flight : scene.flights) {
        const sim::Record& r = flight.record;
        const sim::Inside inside = r.inside.value_or(sim::Inside{});
        const std::string goal = r.goal_at < 0.0 ? "-" : line("%.1f", r.goal_at);
        text += line("  %-32s %-10s %7s %8.2f %7.1f %6u %6u %6u", flight.by.name.c_str(),
                     std::string(sim::to_string(r.outcome)).c_str(), goal.substr(0, goal.find('\n')).c_str(),
                     least_of(r), flight.held, inside.brakes, inside.plans, inside.plans_found);
        for (const std::string& fault : r.faults) {
            text += "    " + fault + "\n";
        }
    }
    return text;
}

std::string summary_of(const std::vector<Scene>& scenes)
{
    if (scenes.empty()) {
        return {};
    }
    const std::string head = scenes.front().scenario.name + ", " + std::to_string(scenes.size()) + " seeds";
    std::string text = line("%-34s %7s %7s %9s %8s %8s %7s", head.c_str(), "touched", "at goal", "goal s", "least m",
                            "median m", "held s");
    for (std::size_t way = 0; way < scenes.front().flights.size(); ++way) {
        unsigned touched = 0;
        std::vector<double> goals;
        std::vector<double> separations;
        double still = 0.0;
        for (const Scene& scene : scenes) {
            const sim::Record& r = scene.flights[way].record;
            touched += least_of(r) < scene.scenario.body_radius ? 1U : 0U;
            separations.push_back(least_of(r));
            still += scene.flights[way].held / static_cast<double>(scenes.size());
            if (r.goal_at >= 0.0) {
                goals.push_back(r.goal_at);
            }
        }
        text += line("  %-32s %7u %7zu %9.1f %8.2f %8.2f %7.1f", scenes.front().flights[way].by.name.c_str(), touched,
                     goals.size(), median(goals), *std::min_element(separations.begin(), separations.end()),
                     median(separations), still);
    }
    return text;
}

std::string drawing_of(const std::vector<Scene>& scenes)
{
    Json all = Json::array();
    for (const Scene& scene : scenes) {
        Json bodies = Json::array();
        for (const sim::Threat& threat : scene.scenario.threats) {
            bodies.push_back(body_of(threat, last_of(scene)));
        }
        for (const sim::ClosedArea& area : scene.scenario.areas) {
            bodies.push_back(body_of(area, last_of(scene)));
        }
        Json mission = Json::array();
        for (const Vec& waypoint : scene.scenario.mission) {
            mission.push_back(json(waypoint));
        }
        Json flights = Json::array();
        for (const SceneFlight& flight : scene.flights) {
            flights.push_back({{"by", flight.by.name},
                               {"outcome", sim::to_string(flight.record.outcome)},
                               {"goal", flight.record.goal_at >= 0.0},
                               {"least", rounded(least_of(flight.record))},
                               {"at", json(place_of_least(scene.scenario, flight.record))},
                               {"end", rounded(flight.record.duration)},
                               {"path", path_of(flight.record)}});
        }
        all.push_back({{"name", scene.scenario.name},
                       {"title", scene.scenario.title},
                       {"mission", mission},
                       {"bodies", bodies},
                       {"flights", flights}});
    }
    return all.dump();
}

}  // namespace jink::host
