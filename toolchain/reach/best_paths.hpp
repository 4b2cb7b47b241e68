// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>

#include "toolchain/reach/set.hpp"

// The trajectories with the fewest turns, by dynamic programming.
//
// A state is a cell and an attitude in steps; of each, the few trajectories with the fewest turns are gone on from.
// Positions within a cell are not told apart, so what is found is a real trajectory but not for certain the best one:
// tests compare it with all trajectories of up to three turns.

namespace jink::reach::build {

/// What smooth trajectories are looked for.
enum class BestFor : std::uint8_t {
    columns,  ///< one to each column of the last layer
    cells,    ///< and one more through each cell that no one chosen so far ends a movement in
};
struct BestRule {
    BestFor wanted = BestFor::columns;
    int parts = 2;              ///< of each range of a cell, that are states of their own
    std::size_t positions = 4;  ///< trajectories that are gone on from, of each state
};

/// To each end the trajectory with the fewest movements that are not smooth; of equals the one that ends nearest to
/// the line from the vehicle through its column's centre. Unlike Gomola's algorithm 6.3, which weighs distance against
/// smoothness at every step, it never gives a turn away that costs smoothness later.
/// O(cells * attitudes * positions * movements).
[[nodiscard]] Set best_paths(const Settings& settings, const BestRule& rule = {});

}  // namespace jink::reach::build
