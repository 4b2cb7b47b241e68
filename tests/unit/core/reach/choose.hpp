// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>

#include "core/reach/evaluation.hpp"

// Evaluation and choice with a test's data: levels in a table, cells' centres computed on the fly.

namespace jink::reach {

/// @param own  level of each node by itself, or empty: all free
inline void evaluate(const ReachSet& set, std::span<const Level> blocks, std::span<const Level> own,
                     std::span<Level> nodes, std::span<Level> cells)
{
    evaluate_with(
        set, blocks, [&](NodeIndex node) { return own.empty() ? kFree : own[node]; }, nodes, cells);
}

inline Choice find_best_path(const ReachSet& set, std::span<const Level> nodes, std::span<const Level> cells,
                             const Vec3& goal, AvoidanceRun run, const ChoiceRule& rule = {})
{
    return find_best_path(set, CellSpheres(set.grid), nodes, cells, goal, run, rule);
}

inline Choice find_best_path_of_all(const ReachSet& set, std::span<const Level> nodes, std::span<const Level> cells,
                                    const Vec3& goal, AvoidanceRun loosest, const ChoiceRule& rule = {})
{
    WorkBudget budget(1'000'000);
    return find_best_path_of_all(set, CellSpheres(set.grid), nodes, cells, goal, loosest, rule, budget);
}

}  // namespace jink::reach
