// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>

#include "firmware/linux/yaml_map.hpp"
#include "toolchain/sim/scenario.hpp"

// What the readers of a scenario file's parts share. Private to them.

namespace jink::sim::detail {

using files::Complaints;
using files::kNeed;
using files::Range;
using files::YamlMap;

inline constexpr Range kAnyTime{0.0F, 1e4F};        // [s]
inline constexpr Range kPlace{-1e5F, 1e5F};         // [m]
inline constexpr Range kVelocity{-500.0F, 500.0F};  // [m/s]

// YamlMap judges numbers; the simulator wants them in double, so they are read once more where they are good.

inline void number(YamlMap& map, std::string_view key, double& value, Range range,
                   YamlMap::Need need = YamlMap::Need::optional)
{
    if (map.number(key, range, need)) {
        value = map.node(key)->as<double>();
    }
}

inline void number(YamlMap& map, std::string_view key, std::optional<double>& value, Range range)
{
    double read = 0.0;
    if (map.has(key)) {
        number(map, key, read, range);
        value = read;
    }
}

[[nodiscard]] inline Vec to_vec(const YAML::Node& node)
{
    return {node[0].as<double>(), node[1].as<double>(), node[2].as<double>()};
}

inline void vector(YamlMap& map, std::string_view key, Vec& value, Range range,
                   YamlMap::Need need = YamlMap::Need::optional)
{
    if (map.vector(key, range, need)) {
        value = to_vec(*map.node(key));
    }
}

[[nodiscard]] inline std::string item_name(const std::string& list, std::size_t i)
{
    return list + "[" + std::to_string(i) + "]";
}

/// The value whose name `text` is; complains with all names, and gives nothing, where it is none's.
template <class T, std::size_t N>
std::optional<T> one_of(YamlMap& map, std::string_view key, const std::string& text, const std::array<T, N>& values)
{
    std::string names;
    for (const T value : values) {
        if (to_string(value) == text) {
            return value;
        }
        names += names.empty() ? "" : ", ";
        names += to_string(value);
    }
    map.complain(key, files::in_quotes(text) + " is none of: " + names);
    return std::nullopt;
}

template <class T, std::size_t N>
std::optional<T> one_of(YamlMap& map, std::string_view key, const std::array<T, N>& values)
{
    const std::optional<std::string> text = map.text(key);
    return text ? one_of(map, key, *text, values) : std::nullopt;
}

/// All threats of a file, in order, grids and scatters spread out.
/// @param seed  of scatters that have none
void read_threats(YamlMap& root, std::uint64_t seed, std::vector<Threat>& out, Complaints& complaints);
void read_areas(YamlMap& root, std::vector<ClosedArea>& out, Complaints& complaints);

}  // namespace jink::sim::detail
