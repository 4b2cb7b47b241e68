// SPDX-License-Identifier: BSD-3-Clause
#include "toolchain/sim/scenario_writer.hpp"

#include <array>
#include <charconv>
#include <optional>
#include <sstream>
#include <string_view>

#include <yaml-cpp/yaml.h>

namespace jink::sim {
namespace {

using YAML::BeginMap;
using YAML::BeginSeq;
using YAML::EndMap;
using YAML::EndSeq;
using YAML::Flow;
using YAML::Key;
using YAML::Value;

template <class Number>
std::string text_of(Number number)
{
    std::array<char, 32> buffer{};
    const auto end = std::to_chars(buffer.data(), buffer.data() + buffer.size(), number).ptr;
    return {buffer.data(), end};
}

std::string word(std::string_view name) { return std::string(name); }

void put(YAML::Emitter& out, const char* key, double value) { out << Key << key << Value << text_of(value); }
void put(YAML::Emitter& out, const char* key, const std::optional<double>& value)
{
    if (value) {
        put(out, key, *value);
    }
}
void put(YAML::Emitter& out, const char* key, const std::string& value) { out << Key << key << Value << value; }

void put_list(YAML::Emitter& out, const Vec& v)
{
    out << Flow << BeginSeq << text_of(v.x()) << text_of(v.y()) << text_of(v.z()) << EndSeq;
}
void put(YAML::Emitter& out, const char* key, const Vec& value)
{
    out << Key << key << Value;
    put_list(out, value);
}

void put_vehicle(YAML::Emitter& out, const TruthLimits& v)
{
    out << Key << "vehicle" << Value << BeginMap;
    put(out, "cruise", v.cruise);
    put(out, "omega", v.omega);
    put(out, "damping", v.damping);
    put(out, "max_acceleration", v.max_acceleration);
    put(out, "max_vertical_acceleration", v.max_vertical_acceleration);
    put(out, "max_climb", v.max_climb);
    put(out, "max_descent", v.max_descent);
    put(out, "max_yaw_rate", v.max_yaw_rate);
    put(out, "min_speed", v.min_speed);
    put(out, "max_course_rate", v.max_course_rate);
    put(out, "drag", v.drag);
    out << EndMap;
}

void put_threat(YAML::Emitter& out, const Threat& threat)
{
    out << BeginMap;
    put(out, "name", threat.name);
    put(out, "form", word(to_string(threat.form)));
    if (threat.form == Form::box) {
        put(out, "half_extents", threat.half_extents);
    } else {
        put(out, "radius", threat.radius);
        put(out, "half_height", threat.half_height);
    }
    put(out, "position", threat.position);
    put(out, "velocity", threat.velocity);
    if (!threat.turns.empty()) {
        out << Key << "turns" << Value << BeginSeq;
        for (const Turn& turn : threat.turns) {
            out << BeginMap;
            put(out, "at", turn.at);
            put(out, "velocity", turn.velocity);
            out << EndMap;
        }
        out << EndSeq;
    }
    put(out, "sensed_by", word(to_string(threat.sensed_by)));
    put(out, "appears_at", threat.appears_at);
    if (threat.appears_when_own_within) {
        put(out, "appears_when_own_within", threat.appears_when_own_within);
        put(out, "collision_point", threat.collision_point);
    }
    out << EndMap;
}

void put_areas(YAML::Emitter& out, const std::vector<ClosedArea>& areas)
{
    if (areas.empty()) {
        return;
    }
    out << Key << "closed_areas" << Value << BeginSeq;
    for (const ClosedArea& area : areas) {
        out << BeginMap;
        put(out, "name", area.name);
        put(out, "radius", area.radius);
        put(out, "bottom", area.bottom);
        put(out, "top", area.top);
        put(out, "margin", area.margin);
        put(out, "centre", area.centre);
        put(out, "velocity", area.velocity);
        out << EndMap;
    }
    out << EndSeq;
}

void put_sensors(YAML::Emitter& out, const Scenario& s)
{
    out << Key << "traffic" << Value << BeginMap;
    put(out, "rate", s.traffic.rate);
    put(out, "sigma_position", s.traffic.sigma_position);
    put(out, "sigma_velocity", s.traffic.sigma_velocity);
    put(out, "sigma_drift", s.traffic.sigma_drift);
    put(out, "drift_time", s.traffic.drift_time);
    put(out, "latency", s.traffic.latency);
    put(out, "jitter", s.traffic.jitter);
    put(out, "dropout", s.traffic.dropout);
    out << Key << "quantised" << Value << s.traffic.quantised;
    out << EndMap << Key << "scan" << Value << BeginMap;
    put(out, "rate", s.scan.rate);
    put(out, "range", s.scan.range);
    out << EndMap << Key << "own" << Value << BeginMap;
    put(out, "latency", s.own.latency);
    put(out, "bias", s.own.bias);
    put(out, "bias_vertical", s.own.bias_vertical);
    put(out, "bias_time", s.own.bias_time);
    out << EndMap << Key << "wind" << Value << BeginMap;
    put(out, "at_20_ft", s.wind.at_20_ft);
    out << EndMap;
    if (s.lidar) {
        out << Key << "lidar" << Value << BeginMap;
        put(out, "rate", s.lidar->rate);
        put(out, "range", s.lidar->range);
        put(out, "level", s.lidar->level);
        put(out, "up", s.lidar->up);
        put(out, "down", s.lidar->down);
        put(out, "pitch", s.lidar->pitch);
        put(out, "sigma", s.lidar->sigma);
        put(out, "latency", s.lidar->latency);
        out << EndMap;
    }
}

void put_faults(YAML::Emitter& out, const Faults& faults)
{
    out << Key << "faults" << Value << BeginMap;
    put(out, "pilot_takes_over", faults.pilot_takes_over);
    put(out, "pilot_mode", word(to_string(faults.pilot_mode)));
    put(out, "pilot_velocity", faults.pilot_velocity);
    out << Key << "refuse_external" << Value << faults.refuse_external;
    put(out, "offboard_proof", faults.offboard_proof);
    put(out, "reboot_at", faults.reboot_at);
    put(out, "reboot_lasts", faults.reboot_lasts);
    put(out, "clock_jump_at", faults.clock_jump_at);
    put(out, "clock_jump_by", faults.clock_jump_by);
    put(out, "cable_pulled_at", faults.cable_pulled_at);
    put(out, "cable_pulled_for", faults.cable_pulled_for);
    out << EndMap;
}

void put_expectation(YAML::Emitter& out, const Expectation& expect)
{
    out << Key << "expect" << Value << BeginMap << Key << "outcome" << Value << Flow << BeginSeq;
    for (const Outcome outcome : expect.outcomes) {
        out << word(to_string(outcome));
    }
    out << EndSeq;
    if (expect.given_back) {
        out << Key << "given_back" << Value << *expect.given_back;
    }
    if (expect.final_mode) {
        put(out, "final_mode", word(to_string(*expect.final_mode)));
    }
    if (expect.flips_at_most) {
        out << Key << "flips_at_most" << Value << *expect.flips_at_most;
    }
    if (expect.goal_reached) {
        out << Key << "goal_reached" << Value << *expect.goal_reached;
    }
    out << EndMap;
}

}  // namespace

std::string scenario_text(const Scenario& s, const std::string& remark)
{
    YAML::Emitter out;
    out << BeginMap;
    put(out, "title", s.title);
    put(out, "seed", text_of(s.seed));
    put(out, "stack", word(to_string(s.stack)));
    put(out, "planner", word(to_string(s.planner)));
    put(out, "duration", s.duration);
    put(out, "promise", s.promise);
    put(out, "body_radius", s.body_radius);
    put(out, "floor", s.floor);
    put(out, "ground", s.ground);
    out << Key << "to_goal" << Value << s.to_goal;
    put_vehicle(out, s.vehicle);
    out << Key << "mission" << Value << BeginSeq;
    for (const Vec& waypoint : s.mission) {
        put_list(out, waypoint);
    }
    out << EndSeq << Key << "start" << Value << BeginMap;
    put(out, "position", s.start_position);
    put(out, "velocity", s.start_velocity);
    out << EndMap << Key << "threats" << Value << BeginSeq;
    for (const Threat& threat : s.threats) {
        put_threat(out, threat);
    }
    out << EndSeq;
    put_areas(out, s.areas);
    put_sensors(out, s);
    out << Key << "parameters" << Value << BeginMap;
    for (const auto& [name, value] : s.parameters) {
        put(out, name.c_str(), value);
    }
    out << EndMap;
    put_faults(out, s.faults);
    put_expectation(out, s.expect);
    out << EndMap;
    std::string text;
    std::istringstream lines(remark);
    for (std::string line; std::getline(lines, line);) {
        text.append("# ").append(line).append("\n");
    }
    return text.append(out.c_str()).append("\n");
}

}  // namespace jink::sim
