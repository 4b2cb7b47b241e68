// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/linux/vehicle_file.hpp"

#include <array>

#include "firmware/vehicles/uav2/vehicle.hpp"

namespace jink::files {
namespace {

using app::Param;

Range range_of(Param p)
{
    const app::ParamInfo& info = app::param_table()[static_cast<std::size_t>(p)];
    return {info.low, info.high};
}

void put(float& out, std::optional<float> value) { out = value.value_or(out); }

void read_limits(YamlMap& map, vehicle::VehicleLimits& limits)
{
    if (const auto kind = map.choice("kind", {"multirotor", "fixed_wing"}, kNeed)) {
        limits.kind = *kind == 0 ? vehicle::VehicleKind::multirotor : vehicle::VehicleKind::fixed_wing;
    }
    put(limits.cruise_speed, map.number("cruise_speed", range_of(Param::cruise), kNeed));
    put(limits.max_climb, map.number("max_climb", range_of(Param::climb), kNeed));
    put(limits.max_descent, map.number("max_descent", range_of(Param::descent), kNeed));
    put(limits.max_acceleration, map.number("max_acceleration", range_of(Param::acceleration), kNeed));
    put(limits.max_vertical_acceleration,
        map.number("max_vertical_acceleration", range_of(Param::vertical_acceleration), kNeed));
    put(limits.velocity_lag, map.number("velocity_lag", range_of(Param::lag), kNeed));
    float level = 1.0F;
    float vertical = 1.0F;
    put(level, map.number("half_extent_level", range_of(Param::half_xy), kNeed));
    put(vertical, map.number("half_extent_vertical", range_of(Param::half_z), kNeed));
    limits.half_extents = Vec3(level, level, vertical);
}

void read_airframe(YamlMap& map, vehicle::Airframe& airframe)
{
    put(airframe.mass, map.number("mass", range_of(Param::mass), kNeed));
    put(airframe.drag_coefficient, map.number("drag_coefficient", range_of(Param::drag), kNeed));
    put(airframe.effective_area, map.number("effective_area", range_of(Param::area), kNeed));
    put(airframe.air_density, map.number("air_density", {0.1F, 2.0F}));
    if (auto rotors = map.map("rotors")) {
        put(airframe.rotors, rotors->whole("count", {1.0F, 32.0F}));
        put(airframe.blades, rotors->whole("blades", {1.0F, 16.0F}));
        put(airframe.chord, rotors->number("chord", {0.001F, 5.0F}));
        put(airframe.rotor_radius, rotors->number("radius", {0.01F, 20.0F}));
        put(airframe.tip_speed, rotors->number("tip_speed", {1.0F, 340.0F}));
        put(airframe.blade_drag_coefficient, rotors->number("drag_coefficient", {0.0F, 5.0F}));
        rotors->finish();
    }
}

void read_caps(YamlMap& map, cost::Caps& caps)
{
    auto below = map.map("caps");
    if (!below) {
        return;
    }
    const auto time_low = below->number("time_low", range_of(Param::time_low), kNeed);
    const auto time_high = below->number("time_high", range_of(Param::time_high), kNeed);
    const auto energy_low = below->number("energy_low", {0.0F, 1e9F}, kNeed);
    const auto energy_high = below->number("energy_high", {0.0F, 1e9F}, kNeed);
    below->finish();
    if (time_low && time_high && energy_low && energy_high) {
        caps = {*time_low, *time_high, *energy_low, *energy_high};
        if (!cost::is_valid(caps)) {
            map.complain("caps", "energy_low must be less than energy_high, and time_low less than 1.15 time_high");
        }
    }
}

}  // namespace

std::optional<Vehicle> read_vehicle(const YAML::Node& node, const std::string& where, const std::string& file,
                                    Complaints& complaints)
{
    const std::size_t before = complaints.size();
    YamlMap map(node, where, file, complaints);
    if (!map.is_map()) {
        return std::nullopt;
    }
    Vehicle out;
    out.name = map.text("name").value_or(std::filesystem::path(file).stem().string());
    read_limits(map, out.limits);
    read_airframe(map, out.airframe);
    if (complaints.size() == before) {
        out.caps = cost::caps_for(out.limits, out.airframe);
    }
    read_caps(map, out.caps);
    map.finish();
    if (complaints.size() == before &&
        !(vehicle::is_valid(out.limits) && vehicle::is_valid(out.airframe) && cost::is_valid(out.caps))) {
        complaints.push_back(
            complaint_at(node.Mark(), file, where + (where.empty() ? "" : ": ") + "values do not make a vehicle"));
    }
    return complaints.size() == before ? std::optional<Vehicle>(std::move(out)) : std::nullopt;
}

std::optional<Vehicle> read_vehicle_file(const std::filesystem::path& path, Complaints& complaints)
{
    const std::optional<YAML::Node> root = load_yaml(path, complaints);
    return root ? read_vehicle(*root, "", path.string(), complaints) : std::nullopt;
}

std::optional<Vehicle> built_in_vehicle(std::string_view name)
{
    Vehicle out;
    out.name = std::string(name);
    if (name == "uav2") {
        out.limits = vehicle::uav2_limits();
        out.airframe = vehicle::uav2_airframe();
    } else if (name != "default") {
        return std::nullopt;
    }
    out.caps = cost::caps_for(out.limits, out.airframe);
    return out;
}

ParamValues apply_vehicle(const Vehicle& vehicle, const ParamValues& values)
{
    ParamValues out = values;
    const auto set = [&](Param p, float value) { out[static_cast<std::size_t>(p)] = value; };
    set(Param::fixed_wing, vehicle.limits.kind == vehicle::VehicleKind::fixed_wing ? 1.0F : 0.0F);
    set(Param::cruise, vehicle.limits.cruise_speed);
    set(Param::climb, vehicle.limits.max_climb);
    set(Param::descent, vehicle.limits.max_descent);
    set(Param::acceleration, vehicle.limits.max_acceleration);
    set(Param::vertical_acceleration, vehicle.limits.max_vertical_acceleration);
    set(Param::lag, vehicle.limits.velocity_lag);
    set(Param::half_xy, vehicle.limits.half_extents.x());
    set(Param::half_z, vehicle.limits.half_extents.z());
    set(Param::mass, vehicle.airframe.mass);
    set(Param::drag, vehicle.airframe.drag_coefficient);
    set(Param::area, vehicle.airframe.effective_area);
    set(Param::time_low, vehicle.caps.time_low);
    set(Param::time_high, vehicle.caps.time_high);
    return out;
}

std::optional<ParamValues> apply_vehicle_file(const std::filesystem::path& path, const ParamValues& values,
                                              Complaints& complaints)
{
    const std::optional<Vehicle> read = read_vehicle_file(path, complaints);
    return read ? std::optional<ParamValues>(apply_vehicle(*read, values)) : std::nullopt;
}

}  // namespace jink::files
