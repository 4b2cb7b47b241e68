// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <span>

#include "toolchain/reach/tree.hpp"

// Constrained expansion of trajectories, layer by layer (Gomola 6.4.2, algorithm 6.1).

namespace jink::reach::build {

using NodeId = std::uint32_t;

/// What a generator decides.
struct Constraint {
    /// Of two trajectories with one key the one with the smaller measure stays; of equals the older one.
    std::function<double(const Node&)> measure;
    /// Which of the trajectories that end in one cell are expanded, in the order of their ids.
    std::function<std::vector<NodeId>(const std::vector<Node>& all, std::span<const NodeId> passing)> select;
    /// Of two trajectories with one key both stay.
    bool keeps_equals = false;
    /// Whether a child is made at all.
    std::function<bool(const Node&)> allows = [](const Node&) { return true; };
};

struct WaveFront {
    std::vector<Node> nodes;    ///< root first, parents before children; all that were made
    std::vector<NodeId> front;  ///< that end in the last layer
    /// That lead to none of these and end in a cell at a side, with Settings::keep_lateral.
    std::vector<NodeId> lateral;
    std::uint32_t extra_dropped = 0;
    bool truncated = false;  ///< Settings::most_nodes was reached
};

[[nodiscard]] WaveFront grow(const Settings& settings, const Constraint& constraint);

/// What is told apart: the last `tail` cells of the footprint, or all (0), and the attitude where the settings say so.
[[nodiscard]] std::vector<std::uint16_t> key_of(const Node& node, std::size_t tail, bool attitude);

}  // namespace jink::reach::build
