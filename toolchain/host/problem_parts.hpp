// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include "firmware/linux/yaml_map.hpp"
#include "toolchain/host/problem_file.hpp"

// The parts of a problem file, one reader each. Readers store valid values and add complaints about invalid ones.

namespace jink::host::detail {

/// Largest coordinate in files [m]: within it, positions in single precision are accurate to a millimetre.
inline constexpr files::Range kCoordinate{-10000.0F, 10000.0F};
inline constexpr files::Range kVelocity{-400.0F, 400.0F};
inline constexpr files::Range kSpeed{0.5F, 100.0F};
inline constexpr files::Range kSize{0.01F, 1000.0F};

void read_settings(files::YamlMap& root, const cost::Caps& caps, geometric::Settings& settings,
                   files::Complaints& complaints);
/// The obstacles that are marked as the main threat.
struct MainObstacles {
    std::vector<std::size_t> at_rest;
    std::vector<std::size_t> moving;
};
void read_obstacles(files::YamlMap& root, ProblemFile& out, MainObstacles& mains, files::Complaints& complaints);

/// `reference`: its start, speed and segments; the nominal path begins along the first segment.
void read_reference(files::YamlMap& root, ProblemFile& out, files::Complaints& complaints);
/// `frame_y`, perpendicular to a nominal path that has been read.
void read_frame(files::YamlMap& root, ProblemFile& out);
/// Arc length along the reference at the closest approach of a threat's centre, flown at the problem's speed; nothing
/// where that is the reference's start or end.
[[nodiscard]] std::optional<float> nearest_on_reference(const ProblemFile& file, const geometry::Motion& motion);

}  // namespace jink::host::detail
