// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <limits>
#include <optional>
#include <span>

#include "core/reach/intruder.hpp"
#include "core/reach/reach_set.hpp"

// Do the vehicle and an intruder meet: in the same cell at the same time, or come as near (Gomola 6.6.1, and two
// checks that are finer than the source's: node by node instead of by the hull of all trajectories' times).

namespace jink::reach {

/// Nobody is there: later than any time, and before it.
inline constexpr Stay kNever{std::numeric_limits<float>::infinity(), -std::numeric_limits<float>::infinity()};
[[nodiscard]] constexpr bool is_never(const Stay& stay) noexcept { return stay.from > stay.to; }
/// The two have an instant in common; one that only touches counts.
[[nodiscard]] constexpr bool meet(const Stay& a, const Stay& b) noexcept { return a.from <= b.to && b.from <= a.to; }

/// The cell of sample `sample` (1 to ReachSet::samples) of a node's movement and when the vehicle may be there: one
/// sample before to one after. Flown again from the parent, since the tables name a cell for the movement that enters
/// it, not for the next ones that are still in it. Nothing where the grid ends.
/// @param period  of one movement [s]
/// O(1): one movement, one `locate`.
[[nodiscard]] std::optional<CellStay> stay_of(const ReachSet& set, std::size_t node, std::size_t sample,
                                              float period) noexcept;

/// When the vehicle may be in each cell, on any trajectory: hull of all stays (Gomola eq. 6.117 and 6.118, where the
/// source has a 0 in the minimum, which would always win). kNever where no trajectory passes.
/// @param out  of each cell
/// O(nodes samples): for each set once, times scale with the period.
void cell_times(const ReachSet& set, float period, std::span<Stay> out) noexcept;

/// An intruder's stays in all cells by a model, kNever where it is not: one column of the table for `meets_in_cells`.
/// @param balls  of each cell
/// @param out    of each cell
/// O(cells kMostCrossings).
void fill_meetings(const CombinedModel& model, std::span<const CellBall> balls, std::span<Stay> out) noexcept;

/// A node's movement is in some cell at a time when some intruder is (both as stays above). Finer than the hull of all
/// trajectories' times, coarser than `meets`. What of it is outside the grid has no cell and is not looked at.
/// @param table  of each intruder, each cell: intruders times cells
/// O(samples intruders).
[[nodiscard]] bool meets_in_cells(const ReachSet& set, std::size_t node, float period,
                                  std::span<const Stay> table) noexcept;

/// A node's straight line and an intruder come within the intruder's radius and `margin` of each other, which touching
/// is: closest approach in closed form. The intruder is as large all the while as its spread and the error of its speed
/// make it at the line's end: its radius and (tan(spread) + share) speed t_to more. Never says no where they meet; says
/// yes without a meeting only by that growth, and by rounding: 2e-6 of the distances.
/// @param from, to    [grid's unit]; a movement's arc is as far from the line as `chord_deviation` says: in `margin`
/// @param t_from, t_to  [s], 0 <= t_from <= t_to, from when the intruder was where it is
/// O(1).
[[nodiscard]] bool meets(const Vec3& from, const Vec3& to, float t_from, float t_to, const Intruder& intruder,
                         float margin) noexcept;

/// The same of a node's movement, along its arc: `margin` is taken larger by how far an arc is from its chord, and by
/// what the tables round. The root meets nobody. In the grid's unit.
/// @param period  of one movement [s]
/// O(1).
[[nodiscard]] bool meets(const ReachSet& set, std::size_t node, float period, const Intruder& intruder,
                         float margin) noexcept;

/// What `meets` adds to the intruder's radius at a time. O(1).
[[nodiscard]] float growth_of(const Intruder& intruder, float t) noexcept;

}  // namespace jink::reach
