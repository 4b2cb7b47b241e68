// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>

#include "firmware/linux/yaml_map.hpp"
#include "toolchain/sim/scenario.hpp"

// Common parts of the scenario file readers. Private to the readers.

namespace jink::sim::detail {

using files::Complaints;
using files::kNeed;
using files::Range;
using files::YamlMap;

inline constexpr Range kAnyTime{0.0F, 1e4F};        // [s]
inline constexpr Range kPlace{-1e5F, 1e5F};         // [m]
inline constexpr Range kVelocity{-500.0F, 500.0F};  // [m/s]

// YamlMap checks numbers in float; the simulator reads valid numbers a second time in double.

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

/// The value named `text`. Unknown names give nothing and a complaint that lists all names.
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

/// All threats of a file, in order, with grids and scatters expanded.
/// @param seed  default seed of scatters
void read_threats(YamlMap& root, std::uint64_t seed, std::vector<Threat>& out, Complaints& complaints);
void read_areas(YamlMap& root, std::vector<ClosedArea>& out, Complaints& complaints);

}  // namespace jink::sim::detail
