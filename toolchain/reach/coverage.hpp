// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <functional>

#include "toolchain/reach/set.hpp"

// Coverage of a set relative to all trajectories.

namespace jink::reach::build {

/// Number of cells entered by trajectories that end in the last layer, or with Settings::keep_lateral at a side. Counts
/// the tree of all trajectories, which is too large for memory, over states: of the trajectories that end in one part
/// of a cell with one attitude, only the first is continued. O(cells * attitudes * movements).
[[nodiscard]] std::size_t count_reachable_cells(const Settings& settings);

/// Number of layers on which all footprints can be counted: the tree of all trajectories then has 7221 nodes; with five
/// layers nine times as many.
inline constexpr std::size_t kFootprintLayers = 4;

/// Totals of the tree of all trajectories with some settings.
struct Whole {
    std::size_t cells = 0;       ///< count_reachable_cells
    std::size_t footprints = 0;  ///< distinct footprints of all trajectories on the first kFootprintLayers
};
[[nodiscard]] Whole whole_of(const Settings& settings);

struct Coverage {
    double cells = 0.0;       ///< entered share of all cells; this definition reproduces Gomola's 0.9
    double footprints = 0.0;  ///< distinct footprints of a set built on the first kFootprintLayers, as a share of all
                              ///< (Gomola eq. 6.73)
};
/// Coverage of a set built by `make` with these settings.
[[nodiscard]] Coverage coverage_of(const Settings& settings, const Set& set,
                                   const std::function<Set(const Settings&)>& make, const Whole& whole);

}  // namespace jink::reach::build
