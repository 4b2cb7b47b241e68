// SPDX-License-Identifier: BSD-3-Clause
#include "toolchain/host/file_kind.hpp"

#include <algorithm>
#include <array>
#include <string>

#include "firmware/linux/param_file.hpp"
#include "firmware/linux/vehicle_file.hpp"
#include "toolchain/host/problem_file.hpp"
#include "toolchain/sim/scenario_file.hpp"

namespace jink::host {
namespace {

constexpr std::array<std::string_view, 4> kNames{"vehicle", "problem", "scenario", "params"};

/// Keys that only one kind has.
constexpr std::array<std::string_view, 10> kVehicleKeys{
    "kind",         "cruise_speed",     "max_climb", "max_descent", "mass", "half_extent_level",
    "velocity_lag", "drag_coefficient", "rotors",    "caps"};
constexpr std::array<std::string_view, 11> kProblemKeys{
    "leg",         "start",   "direction", "distance",           "settings",  "obstacles",
    "main_radius", "k_sigma", "airspace",  "collision_box_side", "flown_side"};
constexpr std::array<std::string_view, 9> kScenarioKeys{"mission", "expect", "stack",  "promise", "duration",
                                                        "traffic", "scan",   "faults", "seed"};

template <std::size_t N>
bool holds(const std::array<std::string_view, N>& keys, const std::string& key)
{
    return std::find(keys.begin(), keys.end(), key) != keys.end();
}

files::Complaints check_scenario(const std::filesystem::path& path)
{
    try {
        static_cast<void>(sim::load_scenario(path));
        return {};
    } catch (const sim::BadScenario& error) {
        return error.complaints();
    } catch (const std::exception& error) {
        return {{0, 0, error.what(), path.string()}};
    }
}

}  // namespace

std::string_view name_of(FileKind kind) { return kNames[static_cast<std::size_t>(kind)]; }

std::optional<FileKind> file_kind(std::string_view name)
{
    const auto* at = std::find(kNames.begin(), kNames.end(), name);
    return at == kNames.end() ? std::nullopt : std::optional<FileKind>(static_cast<FileKind>(at - kNames.begin()));
}

std::optional<FileKind> guess_kind(const std::filesystem::path& path, files::Complaints& complaints)
{
    const std::string extension = path.extension().string();
    if (extension != ".yaml" && extension != ".yml") {
        return FileKind::params;
    }
    const std::optional<YAML::Node> root = files::load_yaml(path, complaints);
    if (!root) {
        return std::nullopt;
    }
    std::array<int, 3> votes{};
    if (root->IsMap()) {
        for (const auto& pair : *root) {
            if (pair.first.IsScalar()) {
                const std::string& key = pair.first.Scalar();
                votes[0] += holds(kVehicleKeys, key) ? 1 : 0;
                votes[1] += holds(kProblemKeys, key) ? 1 : 0;
                votes[2] += holds(kScenarioKeys, key) ? 1 : 0;
            }
        }
    }
    const auto* best = std::max_element(votes.begin(), votes.end());
    if (*best == 0) {
        complaints.push_back({0, 0,
                              "is neither a vehicle nor a problem nor a scenario by its keys; say what it is with --as",
                              path.string()});
        return std::nullopt;
    }
    return static_cast<FileKind>(best - votes.begin());
}

files::Complaints check_file(const std::filesystem::path& path, FileKind kind)
{
    files::Complaints complaints;
    switch (kind) {
    case FileKind::vehicle: static_cast<void>(files::read_vehicle_file(path, complaints)); break;
    case FileKind::problem: {
        auto read = read_problem(path);
        if (auto* found = std::get_if<files::Complaints>(&read)) {
            complaints = std::move(*found);
        }
        break;
    }
    case FileKind::scenario: return check_scenario(path);
    case FileKind::params: {
        app::Parameters parameters;
        if (const auto values = files::apply_param_file(path, parameters.values(), complaints)) {
            files::apply_together(*values, path.string(), parameters, complaints);
        }
        break;
    }
    }
    return complaints;
}

}  // namespace jink::host
