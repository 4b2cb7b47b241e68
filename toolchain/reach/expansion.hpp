// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <optional>
#include <span>
#include <vector>

#include "toolchain/reach/tree.hpp"

// Expansion by one movement, the common step of all generators.

namespace jink::reach::build {

/// The vehicle at the origin, with the settings' pitch.
[[nodiscard]] Node root_of(const Settings& settings);

/// The end of `movement` after `from`, whose number is `id`; nothing if a sample is outside the grid, or the pitch
/// exceeds the settings' limit.
[[nodiscard]] std::optional<Node> child_of(const Settings& settings, const Node& from, std::uint32_t id,
                                           Movement movement);

/// The end of a whole trajectory from the root, recomputed; nothing if the trajectory leaves the grid.
[[nodiscard]] std::optional<Node> replay(const Settings& settings, std::span<const Movement> movements);

/// True for an end in a cell at one of the grid's sides, where a trajectory may leave the grid.
[[nodiscard]] bool ends_at_side(const Settings& settings, const Node& node);

/// The part of its cell in which a node ends, of `parts` equal parts in distance, azimuth and elevation, counted from
/// 1.
[[nodiscard]] std::array<int, 3> part_of_cell(const Grid<double>& grid, const Node& node, int parts);

}  // namespace jink::reach::build
