// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <optional>
#include <span>
#include <vector>

#include "toolchain/reach/tree.hpp"

// One movement more: what every way to build a set is made of.

namespace jink::reach::build {

/// The vehicle at its place, pitched as the settings say.
[[nodiscard]] Node root_of(const Settings& settings);

/// The end of `movement` after `from`, which has the number `id`; nothing where one of its samples is outside the grid,
/// or it pitches more than the settings allow.
[[nodiscard]] std::optional<Node> child_of(const Settings& settings, const Node& from, std::uint32_t id,
                                           Movement movement);

/// The end of a whole trajectory from the root, flown anew; nothing where it leaves the grid.
[[nodiscard]] std::optional<Node> replay(const Settings& settings, std::span<const Movement> movements);

/// Ends in a cell at one of the grid's sides: where a trajectory may leave it.
[[nodiscard]] bool ends_at_side(const Settings& settings, const Node& node);

/// In which part of its cell a node ends, of `parts` equal ones in distance, azimuth and elevation, counted from 1.
[[nodiscard]] std::array<int, 3> part_of_cell(const Grid<double>& grid, const Node& node, int parts);

}  // namespace jink::reach::build
