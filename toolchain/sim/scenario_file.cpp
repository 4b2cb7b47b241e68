// SPDX-License-Identifier: BSD-3-Clause
#include "toolchain/sim/scenario_file.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <tuple>

#include "firmware/app/parameters.hpp"
#include "firmware/linux/param_file.hpp"
#include "toolchain/sim/scenario_parts.hpp"

namespace jink::sim {
namespace {

using namespace detail;

constexpr std::array kModes{Mode::mission, Mode::external, Mode::hold, Mode::brake, Mode::home, Mode::pilot};
constexpr std::array kOutcomes{Outcome::clear,  Outcome::avoided,   Outcome::braked,
                               Outcome::breach, Outcome::collision, Outcome::failed};

void read_vehicle(YamlMap& root, TruthLimits& v)
{
    auto map = root.map("vehicle");
    if (!map) {
        return;
    }
    number(*map, "cruise", v.cruise, {0.5F, 100.0F});
    number(*map, "omega", v.omega, {0.5F, 50.0F});
    number(*map, "damping", v.damping, {0.3F, 3.0F});
    number(*map, "max_acceleration", v.max_acceleration, {0.2F, 50.0F});
    number(*map, "max_vertical_acceleration", v.max_vertical_acceleration, {0.2F, 50.0F});
    number(*map, "max_climb", v.max_climb, {0.1F, 50.0F});
    number(*map, "max_descent", v.max_descent, {0.1F, 50.0F});
    number(*map, "max_yaw_rate", v.max_yaw_rate, {0.05F, 20.0F});
    number(*map, "min_speed", v.min_speed, {0.0F, 100.0F});
    number(*map, "max_course_rate", v.max_course_rate, {0.0F, 20.0F});
    number(*map, "drag", v.drag, {0.0F, 5.0F});
    map->finish();
}

void read_sensors(YamlMap& root, Scenario& s)
{
    if (auto map = root.map("traffic")) {
        number(*map, "rate", s.traffic.rate, {0.1F, 200.0F});
        number(*map, "sigma_position", s.traffic.sigma_position, {0.0F, 100.0F});
        number(*map, "sigma_velocity", s.traffic.sigma_velocity, {0.0F, 100.0F});
        number(*map, "sigma_drift", s.traffic.sigma_drift, {0.0F, 100.0F});
        number(*map, "drift_time", s.traffic.drift_time, {0.01F, 1000.0F});
        number(*map, "latency", s.traffic.latency, {0.0F, 5.0F});
        number(*map, "jitter", s.traffic.jitter, {0.0F, 5.0F});
        number(*map, "dropout", s.traffic.dropout, {0.0F, 1.0F});
        s.traffic.quantised = map->boolean("quantised").value_or(false);
        map->finish();
    }
    if (auto map = root.map("scan")) {
        number(*map, "rate", s.scan.rate, {1.0F, 50.0F});
        number(*map, "range", s.scan.range, {1.0F, 600.0F});
        map->finish();
    }
    if (auto map = root.map("own")) {
        number(*map, "latency", s.own.latency, {0.0F, 5.0F});
        number(*map, "bias", s.own.bias, {0.0F, 100.0F});
        number(*map, "bias_vertical", s.own.bias_vertical, {0.0F, 100.0F});
        number(*map, "bias_time", s.own.bias_time, {0.1F, 1e4F});
        map->finish();
    }
    if (auto map = root.map("wind")) {
        number(*map, "at_20_ft", s.wind.at_20_ft, {0.0F, 50.0F});
        map->finish();
    }
    if (auto map = root.map("lidar")) {
        LidarSensor& lidar = s.lidar.emplace();
        number(*map, "rate", lidar.rate, {1.0F, 50.0F});
        number(*map, "range", lidar.range, {1.0F, 600.0F});
        number(*map, "level", lidar.level, {10.0F, 360.0F});
        number(*map, "up", lidar.up, {-45.0F, 85.0F});
        number(*map, "down", lidar.down, {-45.0F, 85.0F});
        number(*map, "pitch", lidar.pitch, {0.25F, 10.0F});
        number(*map, "sigma", lidar.sigma, {0.0F, 5.0F});
        number(*map, "latency", lidar.latency, {0.0F, 1.0F});
        if (lidar.up + lidar.down < lidar.pitch) {
            map->complain("up", "leaves no two rows between 'down' and 'up'");
        }
        map->finish();
    }
}

void read_faults(YamlMap& root, Faults& faults)
{
    auto map = root.map("faults");
    if (!map) {
        return;
    }
    number(*map, "pilot_takes_over", faults.pilot_takes_over, kAnyTime);
    faults.pilot_mode =
        one_of(*map, "pilot_mode", std::array{Mode::hold, Mode::home, Mode::pilot}).value_or(faults.pilot_mode);
    vector(*map, "pilot_velocity", faults.pilot_velocity, kVelocity);
    faults.refuse_external = map->boolean("refuse_external").value_or(false);
    number(*map, "offboard_proof", faults.offboard_proof, {0.0F, 10.0F});
    number(*map, "reboot_at", faults.reboot_at, kAnyTime);
    number(*map, "reboot_lasts", faults.reboot_lasts, {0.0F, 60.0F});
    number(*map, "clock_jump_at", faults.clock_jump_at, kAnyTime);
    number(*map, "clock_jump_by", faults.clock_jump_by, {-50.0F, 1e4F});
    number(*map, "cable_pulled_at", faults.cable_pulled_at, kAnyTime);
    number(*map, "cable_pulled_for", faults.cable_pulled_for, kAnyTime);
    map->finish();
}

void read_outcomes(YamlMap& map, Expectation& expect)
{
    const auto node = map.node("outcome", kNeed);
    if (!node) {
        return;
    }
    const std::vector<YAML::Node> given =
        node->IsSequence() ? std::vector<YAML::Node>(node->begin(), node->end()) : std::vector<YAML::Node>{*node};
    for (const YAML::Node& one : given) {
        if (const auto outcome = one_of(map, "outcome", one.IsScalar() ? one.Scalar() : "a list", kOutcomes)) {
            expect.outcomes.push_back(*outcome);
        }
    }
    if (given.empty()) {
        map.complain("outcome", "is empty");
    }
}

void read_expectation(YamlMap& root, Expectation& expect)
{
    auto map = root.map("expect", kNeed);
    if (!map) {
        return;
    }
    read_outcomes(*map, expect);
    expect.given_back = map->boolean("given_back");
    if (const auto flips = map->whole("flips_at_most", {0.0F, 1000.0F})) {
        expect.flips_at_most = static_cast<int>(*flips);
    }
    expect.final_mode = one_of(*map, "final_mode", kModes);
    expect.goal_reached = map->boolean("goal_reached");
    map->finish();
}

void read_mission(YamlMap& map, Scenario& s, Complaints& complaints)
{
    if (const auto list = map.list("mission", kNeed)) {
        for (std::size_t i = 0; i < list->size(); ++i) {
            const YAML::Node& node = (*list)[i];
            if (files::vector_of(node, kPlace, item_name("mission", i), map.file(), complaints)) {
                s.mission.push_back(to_vec(node));
            }
        }
        if (list->size() < 2) {
            map.complain("mission", "a mission has at least two waypoints");
        }
    }
    if (s.mission.size() >= 2) {
        s.start_position = s.mission[0];
        s.start_velocity = along(s.mission[1] - s.mission[0], s.vehicle.cruise, s.vehicle);
    }
    if (auto start = map.map("start")) {
        vector(*start, "position", s.start_position, kPlace);
        vector(*start, "velocity", s.start_velocity, kVelocity);
        start->finish();
    }
}

void read_parameters(YamlMap& root, Scenario& s, Complaints& complaints)
{
    const auto node = root.node("parameters");
    if (!node) {
        return;
    }
    const std::size_t before = complaints.size();
    YamlMap map(*node, "parameters", root.file(), complaints);
    app::Parameters parameters;
    files::ParamValues values = parameters.values();
    for (std::size_t i = 0; i < values.size(); ++i) {
        const app::ParamInfo& info = app::param_table()[i];
        const std::string name(info.name);
        if (!map.has(name)) {
            continue;
        }
        const Range range{info.low, info.high};
        if (const auto value = info.integer ? map.whole(name, range) : map.number(name, range)) {
            values[i] = *value;
            s.parameters[name] = map.node(name)->as<double>();
        }
    }
    map.finish();
    Complaints unfit;
    if (complaints.size() == before && !files::apply_together(values, root.file(), parameters, unfit)) {
        for (const files::Complaint& complaint : unfit) {
            root.complain("parameters", complaint.text);
        }
    }
}

void read_seed(YamlMap& map, Scenario& s)
{
    if (const auto text = map.text("seed")) {
        const auto [end, bad] = std::from_chars(text->data(), text->data() + text->size(), s.seed);
        if (bad != std::errc{} || end != text->data() + text->size()) {
            map.complain("seed", files::in_quotes(*text) + " is not a whole number from 0 to 18446744073709551615");
        }
    }
}

Scenario read_scenario(const YAML::Node& node, const std::filesystem::path& name, Complaints& complaints,
                       std::optional<std::uint64_t> seed)
{
    Scenario s;
    s.name = name.stem().string();
    YamlMap map(node, "", name.string(), complaints);
    if (!map.is_map()) {
        return s;
    }
    s.title = map.text("title").value_or("");
    read_seed(map, s);
    s.seed = seed.value_or(s.seed);
    s.stack = one_of(map, "stack", std::array{Stack::ardupilot, Stack::px4}).value_or(s.stack);
    s.planner = one_of(map, "planner", std::array{PlannerKind::product, PlannerKind::source}).value_or(s.planner);
    number(map, "duration", s.duration, {1.0F, 600.0F});
    number(map, "promise", s.promise, {0.0F, 100.0F});
    number(map, "body_radius", s.body_radius, {0.0F, 100.0F});
    number(map, "floor", s.floor, kPlace);
    number(map, "ground", s.ground, kPlace);
    s.to_goal = map.boolean("to_goal").value_or(false);
    read_vehicle(map, s.vehicle);
    read_mission(map, s, complaints);
    read_threats(map, s.seed, s.threats, complaints);
    read_areas(map, s.areas, complaints);
    read_sensors(map, s);
    if (!s.lidar && std::any_of(s.threats.begin(), s.threats.end(),
                                [](const Threat& threat) { return threat.sensed_by == SensedBy::lidar; })) {
        map.complain("threats", "nothing sees them: there is no 'lidar'");
    }
    read_parameters(map, s, complaints);
    read_faults(map, s.faults);
    read_expectation(map, s.expect);
    map.finish();
    default_radii(s);
    default_noise(s);
    return s;
}

std::string all_of(const Complaints& complaints)
{
    std::string text;
    for (const files::Complaint& complaint : complaints) {
        text += text.empty() ? "" : "\n";
        text += files::to_string(complaint);
    }
    return text;
}

Scenario checked(const std::optional<YAML::Node>& node, const std::filesystem::path& name, Complaints& complaints,
                 std::optional<std::uint64_t> seed = std::nullopt)
{
    Scenario scenario = node ? read_scenario(*node, name, complaints, seed) : Scenario{};
    std::stable_sort(complaints.begin(), complaints.end(), [](const files::Complaint& a, const files::Complaint& b) {
        return std::tie(a.line, a.column) < std::tie(b.line, b.column);
    });
    if (!complaints.empty()) {
        throw BadScenario(std::move(complaints));
    }
    return scenario;
}

}  // namespace

void default_radii(Scenario& scenario)
{
    const auto at_least = [&](const std::string& name, double radius) {
        auto& value = scenario.parameters[name];
        value = std::max(value, radius);
    };
    const bool has_traffic = scenario.parameters.count("TRK_RADIUS") > 0;
    const bool has_point = scenario.parameters.count("TRK_RADIUS_PT") > 0;
    for (const Threat& threat : scenario.threats) {
        if (threat.sensed_by == SensedBy::traffic && !has_traffic) {
            at_least("TRK_RADIUS", threat.radius);
        } else if (threat.sensed_by == SensedBy::point && !has_point) {
            at_least("TRK_RADIUS_PT", threat.radius);
        }
    }
}

void default_noise(Scenario& scenario)
{
    constexpr double kSigma = 0.5;  // [m]
    scenario.parameters.try_emplace("TRK_SIGMA_P", kSigma);
}

BadScenario::BadScenario(files::Complaints complaints)
    : std::runtime_error(all_of(complaints)), complaints_(std::move(complaints))
{
}

Scenario parse_scenario(const std::string& text, const std::filesystem::path& name)
{
    Complaints complaints;
    return checked(files::parse_yaml(text, name.string(), complaints), name, complaints);
}

Scenario load_scenario(const std::filesystem::path& file, std::optional<std::uint64_t> seed)
{
    Complaints complaints;
    return checked(files::load_yaml(file, complaints), file, complaints, seed);
}

std::vector<std::filesystem::path> scenario_files(const std::filesystem::path& folder)
{
    std::vector<std::filesystem::path> files;
    for (const auto& entry : std::filesystem::directory_iterator(folder)) {
        if (entry.path().extension() == ".yaml") {
            files.push_back(entry.path());
        }
    }
    std::sort(files.begin(), files.end());
    return files;
}

}  // namespace jink::sim
