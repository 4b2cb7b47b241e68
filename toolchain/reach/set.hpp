// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <set>

#include "toolchain/reach/wave_front.hpp"

// What is kept of a tree, merged with others, and measured.

namespace jink::reach::build {

enum Origin : std::uint8_t { kFromChaotic = 1, kFromHarmonic = 2, kFromAcas = 4, kFromBest = 8 };

/// A reach set: breadth first, so that parents come before children and siblings stand together in the order of their
/// movements.
struct Set {
    struct Member {
        Node node;  ///< its parent counts in this set
        std::uint8_t origins = 0;
        bool in_front = false;    ///< ends in the last layer
        bool is_lateral = false;  ///< ends at a side of the grid, and nothing follows that was kept
    };
    std::vector<Member> members;

    [[nodiscard]] std::size_t trajectories() const;
};

/// The root, and what lies on the way to the last layer, or to a side where the settings kept that.
[[nodiscard]] Set kept(const WaveFront& grown, std::uint8_t origin);

/// Outer join by movements (Gomola algorithm 6.4): a trajectory of either is one of the result, once. O((a + b) log b).
[[nodiscard]] Set merged(const Set& a, const Set& b);

/// Of a set, as the source measures it: of whole trajectories, those that end in the last layer or at a side.
struct Metrics {
    std::size_t nodes = 0;
    std::size_t trajectories = 0;  ///< that end in the last layer
    std::size_t laterals = 0;      ///< and at a side
    std::size_t cells = 0;         ///< touched by some trajectory
    std::size_t footprints = 0;    ///< different ones (Gomola definition 16)
    double mean_smoothness = 0.0;  ///< of those that end in the last layer
    std::size_t most_depth = 0;
    std::size_t longest_footprint = 0;
    std::size_t most_entered = 0;  ///< cells that one movement adds
};
[[nodiscard]] Metrics measure(const Set& set);

/// Every trajectory there is, as far as the grid goes: nothing is left out. For grids of few layers.
[[nodiscard]] Set full_set(const Settings& settings);

}  // namespace jink::reach::build
