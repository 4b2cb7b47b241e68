// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <functional>

#include "toolchain/reach/set.hpp"

// What a set has of all there is.

namespace jink::reach::build {

/// Cells that trajectories touch which end in the last layer, or with Settings::keep_lateral at a side: those of the
/// tree of all trajectories, which itself would not fit into any memory. Found over states in place of trajectories:
/// of those that end in one half of a cell's ranges with one attitude, the first is gone on from.
/// O(cells * attitudes * movements).
[[nodiscard]] std::size_t count_reachable_cells(const Settings& settings);

/// Layers of the grid on which all footprints can be counted: the tree of all trajectories has 7221 nodes there, with
/// five layers nine times as many.
inline constexpr std::size_t kFootprintLayers = 4;

struct Coverage {
    double cells = 0.0;       ///< touched, of count_reachable_cells (what the source's 0.9 can be reproduced with)
    double footprints = 0.0;  ///< different ones on the first kFootprintLayers, of all (Gomola eq. 6.73)
};
/// Of the sets that `make` makes.
[[nodiscard]] Coverage coverage_of(const Settings& settings, const std::function<Set(const Settings&)>& make);

}  // namespace jink::reach::build
