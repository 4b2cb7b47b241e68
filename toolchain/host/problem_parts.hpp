// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include "firmware/linux/yaml_map.hpp"
#include "toolchain/host/problem_file.hpp"

// The parts of a problem file, one reader each. They put what they find in place and complain of the rest.

namespace jink::host::detail {

/// Coordinates in files lie within this of the origin [m]: positions in single precision are good to a millimetre
/// there.
inline constexpr files::Range kCoordinate{-10000.0F, 10000.0F};
inline constexpr files::Range kVelocity{-400.0F, 400.0F};
inline constexpr files::Range kSpeed{0.5F, 100.0F};
inline constexpr files::Range kSize{0.01F, 1000.0F};

void read_settings(files::YamlMap& root, const cost::Caps& caps, geometric::Settings& settings,
                   files::Complaints& complaints);
/// Which of them say that they are the main threat.
struct MainObstacles {
    std::vector<std::size_t> at_rest;
    std::vector<std::size_t> moving;
};
void read_obstacles(files::YamlMap& root, ProblemFile& out, MainObstacles& mains, files::Complaints& complaints);

/// `reference`: its start, speed and segments; the way begins along the first one.
void read_reference(files::YamlMap& root, ProblemFile& out, files::Complaints& complaints);
/// `frame_y`, across a way that has been read.
void read_frame(files::YamlMap& root, ProblemFile& out);
/// Along the reference to where a threat's centre comes nearest while it is flown at the problem's speed; nothing where
/// that is its start or its end.
[[nodiscard]] std::optional<float> nearest_on_reference(const ProblemFile& file, const geometry::Motion& motion);

}  // namespace jink::host::detail
