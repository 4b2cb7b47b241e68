// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>

#include "core/base/work_budget.hpp"
#include "core/reach/cell_spheres.hpp"
#include "core/reach/reach_set.hpp"

// Which trajectories are free, and of which threats; and the choice of the trajectory to fly (Gomola 6.7.1, 6.7.2).

namespace jink::reach {

/// A rating above this is a threat: the order of the failure rate of manned aviation (Gomola table 6.5).
inline constexpr float kThreshold = 1e-7F;

/// Gomola's runs, each with one kind of threat more. The strictest run that leaves a trajectory is used.
enum class AvoidanceRun : std::uint8_t { obstacles, intruders, hard_constraints, soft_constraints };
inline constexpr std::size_t kRuns = 4;

/// The first run in which a cell or node is not free: 0 blocked in all of them, up to kRuns free in all.
using Level = std::uint8_t;
inline constexpr Level kFree = kRuns;
[[nodiscard]] constexpr bool is_free(Level level, AvoidanceRun run) noexcept { return level > static_cast<Level>(run); }

/// Levels of all nodes and cells in one pass, in place of Gomola's four passes. A node's level is the least along its
/// trajectory; a cell's level is the greatest of the nodes that enter the cell.
///
/// @param blocks  of each cell of the grid: its own level
/// @param own     own(node), called once at most for each node, parents first: the node's own level by threats that are
///                checked node by node. Not called where the trajectory to the node is blocked in all runs.
/// @param nodes   out: level of each node; the root is free
/// @param cells   out: level of each cell; 0 where no node enters it
/// O(nodes + entries): one visit each.
template <class OwnLevel>
void evaluate_with(const ReachSet& set, std::span<const Level> blocks, const OwnLevel& own, std::span<Level> nodes,
                   std::span<Level> cells) noexcept
{
    std::fill(cells.begin(), cells.end(), Level{0});
    nodes[0] = kFree;
    for (std::size_t node = 1; node < set.nodes(); ++node) {
        Level level = nodes[set.parent[node]];
        const std::span<const FootprintEntry> entered = set.entered(node);
        for (const FootprintEntry& entry : entered) {
            level = std::min(level, blocks[entry.cell]);
        }
        if (level > 0) {
            level = std::min<Level>(level, own(static_cast<NodeIndex>(node)));
        }
        nodes[node] = level;
        for (const FootprintEntry& entry : entered) {
            cells[entry.cell] = std::max(cells[entry.cell], level);
        }
    }
}

enum class PathStatus : std::uint8_t {
    found,
    goal_unreachable,  ///< the goal's own cell is not free: the best trajectory towards it instead
    no_outer_cell,     ///< no cell at the grid's border is free: the farthest cell instead, which may be a trap
    no_path,           ///< no movement at all is free
};

struct Choice {
    PathStatus status = PathStatus::no_path;
    NodeIndex node = kNoNode;  ///< end of the trajectory
    CellIndex cell = kNoCell;  ///< for which the trajectory was chosen
    AvoidanceRun run = AvoidanceRun::soft_constraints;
};

/// How a trajectory is chosen.
struct ChoiceRule {
    /// If the goal's cell is not free, the search ends without a trajectory, as in navigation.
    bool goal_or_nothing = false;
    std::uint8_t least_outer_layer = 0;  ///< outer cells at the sides nearer than this are no exits
};

/// The cheapest trajectory that is free in `run` and ends in the goal's cell. For a goal outside the grid: the cheapest
/// that ends in the free outer cell nearest to the goal. Ties go to the lower index. `goal`: in the grid's frame
/// [movements' lengths]. O(nodes + cells).
[[nodiscard]] Choice find_best_path(const ReachSet& set, const CellSpheres& spheres, std::span<const Level> nodes,
                                    std::span<const Level> cells, const Vec3& goal, AvoidanceRun run,
                                    const ChoiceRule& rule) noexcept;

/// The same in the strictest run that leaves a trajectory, from soft constraints down to `loosest`. No trajectory where
/// the budget does not reach for a run.
[[nodiscard]] Choice find_best_path_of_all(const ReachSet& set, const CellSpheres& spheres,
                                           std::span<const Level> nodes, std::span<const Level> cells, const Vec3& goal,
                                           AvoidanceRun loosest, const ChoiceRule& rule, WorkBudget& budget) noexcept;

}  // namespace jink::reach
