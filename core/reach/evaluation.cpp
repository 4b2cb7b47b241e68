// SPDX-License-Identifier: BSD-3-Clause
#include "core/reach/evaluation.hpp"

#include <algorithm>
#include <limits>

#include "core/base/work_units.hpp"

namespace jink::reach {
namespace {

bool any_node_is_free(std::span<const Level> nodes, AvoidanceRun run) noexcept
{
    return std::any_of(nodes.begin() + 1, nodes.end(), [&](Level level) { return is_free(level, run); });
}

CellIndex nearest_outer(const ReachSet& set, const CellSpheres& spheres, std::span<const Level> cells, const Vec3& goal,
                        AvoidanceRun run, const ChoiceRule& rule) noexcept
{
    CellIndex best = kNoCell;
    float least = std::numeric_limits<float>::infinity();
    for (std::size_t i = 0; i < set.grid.cells(); ++i) {
        const auto cell = static_cast<CellIndex>(i);
        if (!is_free(cells[i], run)) {
            continue;
        }
        const CellPlace place = set.grid.place(cell);
        if (!set.grid.is_outer(place) || place.layer < rule.least_outer_layer) {
            continue;
        }
        const float distance = (spheres.centre(place) - goal).squaredNorm();
        if (distance < least) {
            least = distance;
            best = cell;
        }
    }
    return best;
}

CellIndex farthest_free(const ReachSet& set, std::span<const Level> cells, AvoidanceRun run) noexcept
{
    const std::size_t in_layer = set.grid.columns() * set.grid.rows();
    for (std::size_t layer = set.grid.layers(); layer > 0; --layer) {
        for (std::size_t i = (layer - 1) * in_layer; i < layer * in_layer; ++i) {
            if (is_free(cells[i], run)) {
                return static_cast<CellIndex>(i);
            }
        }
    }
    return kNoCell;
}

/// The cheapest node that ends in the cell; if there is none, the cheapest that passes through the cell.
NodeIndex cheapest_in(const ReachSet& set, std::span<const Level> nodes, CellIndex cell, AvoidanceRun run) noexcept
{
    NodeIndex ending = kNoNode;
    NodeIndex passing = kNoNode;
    const auto keep_cheaper = [&](NodeIndex& best, std::size_t node) {
        if (best == kNoNode || set.cost[node] < set.cost[best]) {
            best = static_cast<NodeIndex>(node);
        }
    };
    for (std::size_t node = 1; node < set.nodes(); ++node) {
        if (!is_free(nodes[node], run)) {
            continue;
        }
        if (set.end[node] == cell) {
            keep_cheaper(ending, node);
        } else if (ending == kNoNode && std::ranges::any_of(set.entered(node), [&](const FootprintEntry& entry) {
                       return entry.cell == cell;
                   })) {
            keep_cheaper(passing, node);
        }
    }
    return ending != kNoNode ? ending : passing;
}

}  // namespace

Choice find_best_path(const ReachSet& set, const CellSpheres& spheres, std::span<const Level> nodes,
                      std::span<const Level> cells, const Vec3& goal, AvoidanceRun run, const ChoiceRule& rule) noexcept
{
    Choice choice;
    choice.run = run;
    if (!any_node_is_free(nodes, run)) {
        return choice;
    }
    choice.status = PathStatus::found;
    const Located at = set.grid.locate(goal);
    if (at.status == LocateStatus::inside) {
        const CellIndex cell = set.grid.index(at.place);
        if (is_free(cells[cell], run)) {
            choice.cell = cell;
        } else {
            choice.status = PathStatus::goal_unreachable;
            if (rule.goal_or_nothing) {
                return choice;
            }
        }
    }
    if (choice.cell == kNoCell) {
        choice.cell = nearest_outer(set, spheres, cells, goal, run, rule);
    }
    if (choice.cell == kNoCell) {
        choice.status = PathStatus::no_outer_cell;
        choice.cell = farthest_free(set, cells, run);
    }
    choice.node = cheapest_in(set, nodes, choice.cell, run);
    choice.status = choice.node == kNoNode ? PathStatus::no_path : choice.status;
    return choice;
}

Choice find_best_path_of_all(const ReachSet& set, const CellSpheres& spheres, std::span<const Level> nodes,
                             std::span<const Level> cells, const Vec3& goal, AvoidanceRun loosest,
                             const ChoiceRule& rule, WorkBudget& budget) noexcept
{
    Choice choice;
    const std::uint32_t each = units::reach_choice_units(set.entries.size(), cells.size());
    for (int run = static_cast<int>(AvoidanceRun::soft_constraints); run >= static_cast<int>(loosest); --run) {
        if (!budget.spend(each)) {
            return {};
        }
        choice = find_best_path(set, spheres, nodes, cells, goal, static_cast<AvoidanceRun>(run), rule);
        if (choice.node != kNoNode) {
            return choice;
        }
    }
    return choice;
}

}  // namespace jink::reach
