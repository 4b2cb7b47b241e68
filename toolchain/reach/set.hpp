// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <set>

#include "toolchain/reach/wave_front.hpp"

// Reach sets: trees reduced to useful trajectories, merging, and measurement.

namespace jink::reach::build {

enum Origin : std::uint8_t { kFromChaotic = 1, kFromHarmonic = 2, kFromAcas = 4, kFromBest = 8 };

/// A reach set: breadth first, so that parents come before children and siblings are adjacent in the order of their
/// movements.
struct Set {
    struct Member {
        Node node;  ///< its parent is an index into this set
        std::uint8_t origins = 0;
        bool in_front = false;    ///< ends in the last layer
        bool is_lateral = false;  ///< ends at a side of the grid, without kept successors
    };
    std::vector<Member> members;

    [[nodiscard]] std::size_t trajectories() const;
};

/// The root, and all nodes on trajectories to the last layer, or to a side if the settings keep those.
[[nodiscard]] Set kept(const WaveFront& grown, std::uint8_t origin);

/// Outer join by movements (Gomola algorithm 6.4): each trajectory of `a` or `b` is in the result once. O((a + b) log
/// b).
[[nodiscard]] Set merged(const Set& a, const Set& b);

/// Metrics of a set by Gomola's definitions, over whole trajectories: those that end in the last layer or at a side.
struct Metrics {
    std::size_t nodes = 0;
    std::size_t trajectories = 0;  ///< whole trajectories that end in the last layer
    std::size_t laterals = 0;      ///< whole trajectories that end at a side
    std::size_t cells = 0;         ///< cells entered by at least one trajectory
    std::size_t footprints = 0;    ///< distinct footprints (Gomola definition 16)
    double mean_smoothness = 0.0;  ///< over trajectories that end in the last layer
    std::size_t most_depth = 0;
    std::size_t longest_footprint = 0;
    std::size_t most_entered = 0;  ///< largest number of cells that one movement adds
};
[[nodiscard]] Metrics measure(const Set& set);

/// All trajectories within the grid, complete. For grids of few layers.
[[nodiscard]] Set full_set(const Settings& settings);

}  // namespace jink::reach::build
