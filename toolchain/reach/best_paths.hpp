// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>

#include "toolchain/reach/set.hpp"

// The trajectories with the fewest turns, by dynamic programming.
//
// A state is an attitude in steps and a part of a cell; of each, the few trajectories with the fewest turns are gone on
// from. Positions within a part are not told apart, so what is found is a real trajectory but not for certain the best
// one: tests compare it with all trajectories of up to three turns. Whole cells as states, four trajectories each, miss
// the best one in 10 of 35 columns.

namespace jink::reach::build {

/// What smooth trajectories are looked for.
enum class BestFor : std::uint8_t {
    columns,  ///< one to each column of the last layer
    cells,    ///< and one more through each cell that no one chosen so far ends a movement in; where that takes more
              ///< turns, to a cell at a side alone
};
struct BestRule {
    BestFor wanted = BestFor::columns;
    int parts = 3;              ///< of each range of a cell, that are states of their own,
    int fine_turns = 3;         ///< for trajectories with up to so many turns
    std::size_t positions = 2;  ///< trajectories that are gone on from, of each state
};

/// To each end the trajectory with the fewest movements that are not smooth; of equals the one that ends nearest to
/// the line from the vehicle through its column's centre. Unlike Gomola's algorithm 6.3, which weighs distance against
/// smoothness at every step, it never gives a turn away that costs smoothness later.
/// O(cells * attitudes * positions * movements).
[[nodiscard]] Set best_paths(const Settings& settings, const BestRule& rule = {});

}  // namespace jink::reach::build
