// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <functional>

#include "toolchain/reach/set.hpp"

// What a set has of all there is.

namespace jink::reach::build {

/// Cells that trajectories touch which end in the last layer, or with Settings::keep_lateral at a side: those of the
/// tree of all trajectories, which itself would not fit into any memory. Found over states in place of trajectories:
/// of those that end in one part of a cell with one attitude, the first is gone on from.
/// O(cells * attitudes * movements).
[[nodiscard]] std::size_t count_reachable_cells(const Settings& settings);

/// Layers of the grid on which all footprints can be counted: the tree of all trajectories has 7221 nodes there, with
/// five layers nine times as many.
inline constexpr std::size_t kFootprintLayers = 4;

/// All there is with some settings.
struct Whole {
    std::size_t cells = 0;       ///< count_reachable_cells
    std::size_t footprints = 0;  ///< different ones of all trajectories on the first kFootprintLayers
};
[[nodiscard]] Whole whole_of(const Settings& settings);

struct Coverage {
    double cells = 0.0;       ///< touched, of all: with this one the source's 0.9 can be reproduced
    double footprints = 0.0;  ///< different ones of a set made on the first kFootprintLayers, of all (Gomola eq. 6.73)
};
/// Of a set that `make` made with these settings.
[[nodiscard]] Coverage coverage_of(const Settings& settings, const Set& set,
                                   const std::function<Set(const Settings&)>& make, const Whole& whole);

}  // namespace jink::reach::build
