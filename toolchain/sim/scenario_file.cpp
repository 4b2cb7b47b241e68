// SPDX-License-Identifier: BSD-3-Clause
#include "toolchain/sim/scenario_file.hpp"

#include <algorithm>
#include <array>
#include <fstream>
#include <sstream>

#include "firmware/app/parameters.hpp"
#include "toolchain/sim/yaml_reader.hpp"

namespace jink::sim {
namespace {

constexpr double kFar = 1e4;  // [m], [s]: beyond any scenario

template <class T, std::size_t N>
T one_of(YamlMap& map, const YAML::Node& node, const std::array<T, N>& values)
{
    const auto text = node.IsScalar() ? node.as<std::string>() : std::string();
    std::string allowed;
    for (const T value : values) {
        if (to_string(value) == text) {
            return value;
        }
        allowed += (allowed.empty() ? "" : ", ") + std::string(to_string(value));
    }
    map.fail(node, "expected one of: " + allowed);
}

void read_vehicle(YamlMap map, TruthLimits& v)
{
    map.number("cruise", v.cruise, 0.5, 100.0);
    map.number("omega", v.omega, 0.5, 50.0);
    map.number("damping", v.damping, 0.3, 3.0);
    map.number("max_acceleration", v.max_acceleration, 0.2, 50.0);
    map.number("max_vertical_acceleration", v.max_vertical_acceleration, 0.2, 50.0);
    map.number("max_climb", v.max_climb, 0.1, 50.0);
    map.number("max_descent", v.max_descent, 0.1, 50.0);
    map.number("max_yaw_rate", v.max_yaw_rate, 0.05, 20.0);
    map.number("max_course_rate", v.max_course_rate, 0.0, 20.0);
    map.finish();
}

void read_traffic(YamlMap map, TrafficSensor& t)
{
    map.number("rate", t.rate, 0.1, 200.0);
    map.number("sigma_position", t.sigma_position, 0.0, 100.0);
    map.number("sigma_velocity", t.sigma_velocity, 0.0, 100.0);
    map.number("latency", t.latency, 0.0, 5.0);
    map.number("jitter", t.jitter, 0.0, 5.0);
    map.number("dropout", t.dropout, 0.0, 1.0);
    map.finish();
}

void read_turns(YamlMap& map, Threat& threat)
{
    const YAML::Node list = map.at("turns");
    if (!list.IsSequence()) {
        map.fail(list, "expected a list of {at, velocity}");
    }
    double last = 0.0;
    for (const YAML::Node& node : list) {
        YamlMap item(node, map.file());
        Turn turn;
        turn.at = item.get<double>("at");
        turn.velocity = item.vector("velocity");
        if (turn.at <= last) {
            item.fail(node, "turns come in order of time, after 0");
        }
        last = turn.at;
        item.finish();
        threat.turns.push_back(turn);
    }
}

/// `position` at time 0, or the point that is passed at a time.
void read_place(YamlMap& map, Threat& threat)
{
    if (map.has("position") == map.has("passes")) {
        map.fail(map.node(), "a threat has either 'position' or 'passes'");
    }
    if (map.has("position")) {
        threat.position = map.vector("position");
        return;
    }
    YamlMap passes = map.map("passes");
    const Vec point = passes.vector("point");
    const auto at = passes.get<double>("at");
    passes.finish();
    threat.position = point - threat.velocity * at;
    if (!threat.turns.empty() && threat.turns.front().at < at) {
        map.fail(map.node(), "'passes' speaks of the time before the first turn");
    }
}

void read_grid(YamlMap& map, const Threat& first, std::vector<Threat>& threats)
{
    YamlMap grid = map.map("grid");
    const auto across = grid.get<int>("across");
    const auto up = grid.get<int>("up");
    const auto step = grid.get<double>("step");
    const Vec direction = grid.vector("direction");
    grid.finish();
    if (across < 1 || up < 1 || across * up > 64 || direction.norm() == 0.0) {
        map.fail(map.node(), "a grid has 1 to 64 threats and a direction");
    }
    for (int row = 0; row < up; ++row) {
        for (int column = 0; column < across; ++column) {
            Threat threat = first;
            threat.name = first.name + "_" + std::to_string(row) + "_" + std::to_string(column);
            threat.position += direction.normalized() * (step * (column - 0.5 * (across - 1))) +
                               Vec::UnitZ() * (step * (row - 0.5 * (up - 1)));
            threats.push_back(threat);
        }
    }
}

void read_threat(YamlMap map, Scenario& scenario)
{
    Threat threat;
    threat.name = "threat_" + std::to_string(scenario.threats.size() + 1);
    map.read("name", threat.name);
    map.number("radius", threat.radius, 0.05, 500.0);
    map.number("half_height", threat.half_height, 0.0, 500.0);
    if (map.has("velocity")) {
        threat.velocity = map.vector("velocity");
    }
    if (map.has("turns")) {
        read_turns(map, threat);
    }
    read_place(map, threat);
    threat.sensed_by = threat.at_rest() ? SensedBy::point : SensedBy::traffic;
    if (map.has("sensed_by")) {
        threat.sensed_by =
            one_of(map, map.at("sensed_by"), std::array{SensedBy::traffic, SensedBy::point, SensedBy::scan});
    }
    if (threat.sensed_by != SensedBy::traffic && !threat.at_rest()) {
        map.fail(map.node(), "what moves is sensed by traffic");
    }
    if (threat.half_height > 0.0 && threat.sensed_by != SensedBy::scan) {
        map.fail(map.node(), "only a scan sees something tall; traffic and points are spheres");
    }
    map.number("appears_at", threat.appears_at, 0.0, kFar);
    if (map.has("appears_when_own_within")) {
        threat.appears_when_own_within = map.get<double>("appears_when_own_within");
        threat.collision_point = map.vector("collision_point");
    }
    if (map.has("grid")) {
        read_grid(map, threat, scenario.threats);
    } else {
        scenario.threats.push_back(threat);
    }
    map.finish();
}

template <class T>
void optional_number(YamlMap& map, const std::string& key, std::optional<T>& value)
{
    if (map.has(key)) {
        value = map.get<T>(key);
    }
}

constexpr std::array kModes{Mode::mission, Mode::external, Mode::hold, Mode::brake, Mode::home, Mode::pilot};

void read_faults(YamlMap map, Faults& faults)
{
    optional_number(map, "pilot_takes_over", faults.pilot_takes_over);
    if (map.has("pilot_mode")) {
        faults.pilot_mode = one_of(map, map.at("pilot_mode"), std::array{Mode::hold, Mode::home, Mode::pilot});
    }
    if (map.has("pilot_velocity")) {
        faults.pilot_velocity = map.vector("pilot_velocity");
    }
    map.read("refuse_external", faults.refuse_external);
    optional_number(map, "reboot_at", faults.reboot_at);
    map.number("reboot_lasts", faults.reboot_lasts, 0.0, 60.0);
    optional_number(map, "clock_jump_at", faults.clock_jump_at);
    map.number("clock_jump_by", faults.clock_jump_by, -50.0, kFar);
    optional_number(map, "cable_pulled_at", faults.cable_pulled_at);
    map.number("cable_pulled_for", faults.cable_pulled_for, 0.0, kFar);
    map.finish();
}

void read_expectation(YamlMap map, Expectation& expect)
{
    constexpr std::array kOutcomes{Outcome::clear,  Outcome::avoided,   Outcome::braked,
                                   Outcome::breach, Outcome::collision, Outcome::failed};
    const YAML::Node outcome = map.at("outcome");
    if (outcome.IsSequence()) {
        for (const YAML::Node& node : outcome) {
            expect.outcomes.push_back(one_of(map, node, kOutcomes));
        }
    } else {
        expect.outcomes.push_back(one_of(map, outcome, kOutcomes));
    }
    optional_number(map, "given_back", expect.given_back);
    optional_number(map, "flips_at_most", expect.flips_at_most);
    if (map.has("final_mode")) {
        expect.final_mode = one_of(map, map.at("final_mode"), kModes);
    }
    map.finish();
}

void read_mission(YamlMap& map, Scenario& scenario)
{
    const YAML::Node list = map.at("mission");
    if (!list.IsSequence() || list.size() < 2) {
        map.fail(list, "a mission has at least two waypoints");
    }
    for (const YAML::Node& node : list) {
        scenario.mission.push_back(map.vector(node));
    }
    scenario.start_position = scenario.mission[0];
    scenario.start_velocity =
        along(scenario.mission[1] - scenario.mission[0], scenario.vehicle.cruise, scenario.vehicle);
    if (map.has("start")) {
        YamlMap start = map.map("start");
        if (start.has("position")) {
            scenario.start_position = start.vector("position");
        }
        if (start.has("velocity")) {
            scenario.start_velocity = start.vector("velocity");
        }
        start.finish();
    }
}

void read_parameters(YamlMap& map, Scenario& scenario)
{
    const YAML::Node list = map.at("parameters");
    for (const auto& entry : list) {
        const auto name = entry.first.as<std::string>();
        if (app::Parameters::find(name) == app::kParamCount) {
            map.fail(entry.first, "there is no parameter '" + name + "'");
        }
        try {
            scenario.parameters[name] = entry.second.as<double>();
        } catch (const YAML::Exception&) {
            map.fail(entry.second, "expected a number");
        }
    }
}

Scenario read_scenario(YamlMap map, const std::string& stem)
{
    Scenario s;
    s.name = stem;
    map.read("title", s.title);
    map.read("seed", s.seed);
    if (map.has("stack")) {
        s.stack = one_of(map, map.at("stack"), std::array{Stack::ardupilot, Stack::px4});
    }
    map.number("duration", s.duration, 1.0, 600.0);
    map.number("promise", s.promise, 0.0, 100.0);
    map.number("body_radius", s.body_radius, 0.0, 100.0);
    optional_number(map, "floor", s.floor);
    if (map.has("vehicle")) {
        read_vehicle(map.map("vehicle"), s.vehicle);
    }
    read_mission(map, s);
    if (map.has("threats")) {
        for (const YAML::Node& node : map.at("threats")) {
            read_threat({node, map.file()}, s);
        }
    }
    if (map.has("traffic")) {
        read_traffic(map.map("traffic"), s.traffic);
    }
    if (map.has("scan")) {
        YamlMap scan = map.map("scan");
        scan.number("rate", s.scan.rate, 1.0, 50.0);
        scan.number("range", s.scan.range, 1.0, 600.0);
        scan.finish();
    }
    if (map.has("parameters")) {
        read_parameters(map, s);
    }
    if (map.has("faults")) {
        read_faults(map.map("faults"), s.faults);
    }
    read_expectation(map.map("expect"), s.expect);
    map.finish();
    default_radii(s);
    return s;
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

Scenario parse_scenario(const std::string& text, const std::filesystem::path& name)
{
    try {
        return read_scenario({YAML::Load(text), name.string()}, name.stem().string());
    } catch (const YAML::Exception& e) {
        throw BadScenario(name.string() + ":" + std::to_string(e.mark.line + 1) + ": " + e.msg);
    }
}

Scenario load_scenario(const std::filesystem::path& file)
{
    std::ifstream in(file);
    if (!in) {
        throw BadScenario(file.string() + ": cannot be read");
    }
    std::ostringstream text;
    text << in.rdbuf();
    return parse_scenario(text.str(), file);
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
