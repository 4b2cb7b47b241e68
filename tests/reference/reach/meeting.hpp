// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <limits>
#include <optional>
#include <span>

#include "core/reach/reach_set.hpp"
#include "tests/reference/reach/intruder.hpp"

// When the vehicle may be in a cell: the hull of the times of all trajectories (Gomola 6.6.1).

namespace jink::reach {

/// Empty interval: begins at infinity, ends at minus infinity.
inline constexpr Stay kNever{std::numeric_limits<float>::infinity(), -std::numeric_limits<float>::infinity()};
[[nodiscard]] constexpr bool is_never(const Stay& stay) noexcept { return stay.from > stay.to; }
/// True if the two intervals have a common instant, end points included.
[[nodiscard]] constexpr bool meet(const Stay& a, const Stay& b) noexcept { return a.from <= b.to && b.from <= a.to; }

/// The cell of sample `sample` (1 to ReachSet::samples) of a node's movement and when the vehicle may be there: one
/// sample before to one after. Recomputed from the parent: the tables name a cell only for the movement that enters it,
/// not for later movements in it. Nothing outside the grid.
/// @param period  of one movement [s]
/// O(1): one movement, one `locate`.
[[nodiscard]] std::optional<CellStay> stay_of(const ReachSet& set, std::size_t node, std::size_t sample,
                                              float period) noexcept;

/// When the vehicle may be in each cell, on any trajectory: hull of all stays (Gomola eq. 6.117 and 6.118 without
/// Gomola's 0 in the minimum, which would always be the result). kNever where no trajectory passes.
/// @param out  of each cell
/// O(nodes samples): for each set once, times scale with the period.
void cell_times(const ReachSet& set, float period, std::span<Stay> out) noexcept;

}  // namespace jink::reach
