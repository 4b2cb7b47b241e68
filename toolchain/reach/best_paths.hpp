// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>

#include "toolchain/reach/set.hpp"

// The trajectories with the fewest turns, by dynamic programming.
//
// A state is an attitude in steps and a part of a cell; from each state, the few trajectories with the fewest turns are
// continued. Positions within a part count as equal, so a result is a real trajectory but not guaranteed to be the
// best: tests compare it with all trajectories of up to three turns. Whole cells as states, four trajectories each,
// miss the best trajectory in 10 of 35 columns.

namespace jink::reach::build {

/// Ends for which smooth trajectories are searched.
enum class BestFor : std::uint8_t {
    columns,  ///< one trajectory to each column of the last layer
    cells,    ///< in addition one through each cell in which no chosen trajectory ends a movement; if that needs more
              ///< turns, only for cells at a side
};
struct BestRule {
    BestFor wanted = BestFor::columns;
    int parts = 3;              ///< of each range of a cell, as separate states,
    int fine_turns = 3;         ///< for trajectories with up to this many turns
    std::size_t positions = 2;  ///< continued trajectories per state
};

/// To each end the trajectory with the fewest non-smooth movements; among equals the one that ends nearest to the line
/// from the vehicle through its column's centre. Gomola's algorithm 6.3 weighs distance against smoothness at every
/// step and may trade smoothness of later steps; this search does not. O(cells * attitudes * positions * movements).
[[nodiscard]] Set best_paths(const Settings& settings, const BestRule& rule = {});

}  // namespace jink::reach::build
