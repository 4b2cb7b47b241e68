// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <span>

#include "toolchain/reach/tree.hpp"

// Constrained expansion of trajectories, layer by layer (Gomola 6.4.2, algorithm 6.1).

namespace jink::reach::build {

using NodeId = std::uint32_t;

/// Decisions of a generator.
struct Constraint {
    /// Of two trajectories with one key the one with the smaller measure is kept; of equals the older one.
    std::function<double(const Node&)> measure;
    /// Selects the trajectories of one end cell that are expanded, in the order of their ids.
    std::function<std::vector<NodeId>(const std::vector<Node>& all, std::span<const NodeId> passing)> select;
    /// Keeps both of two trajectories with one key.
    bool keeps_equals = false;
    /// Whether a child is created.
    std::function<bool(const Node&)> allows = [](const Node&) { return true; };
};

struct WaveFront {
    std::vector<Node> nodes;    ///< root first, parents before children; all created nodes
    std::vector<NodeId> front;  ///< nodes that end in the last layer
    /// With Settings::keep_lateral: nodes that end in a cell at a side and lead to no node of `front`.
    std::vector<NodeId> lateral;
    std::uint32_t extra_dropped = 0;
    bool truncated = false;  ///< Settings::most_nodes was reached
};

[[nodiscard]] WaveFront grow(const Settings& settings, const Constraint& constraint);

/// Key by which trajectories are distinguished: the last `tail` cells of the footprint, or all (0), and the attitude if
/// `attitude`.
[[nodiscard]] std::vector<std::uint16_t> key_of(const Node& node, std::size_t tail, bool attitude);

}  // namespace jink::reach::build
