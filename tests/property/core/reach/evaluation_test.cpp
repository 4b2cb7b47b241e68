// SPDX-License-Identifier: BSD-3-Clause
// One pass over a tree against four, with threats as numbers; the choice of a path against a search through all.
#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <vector>

#include "core/base/random.hpp"
#include "core/reach/evaluation.hpp"
#include "tests/unit/core/reach/choose.hpp"

namespace jink::reach {
namespace {

/// A random tree of random footprints in a small grid. Not one that could be flown.
struct RandomTree {
    std::vector<NodeIndex> parent;
    std::vector<std::uint8_t> movement, depth;
    std::vector<CellIndex> end;
    std::vector<std::int16_t> position;
    std::vector<std::int8_t> attitude;
    std::vector<std::uint16_t> cost, first_entry;
    std::vector<FootprintEntry> entries;
    std::vector<std::vector<CellIndex>> footprint;
    ReachSet set;

    explicit RandomTree(Random& random)
    {
        set.grid = Grid<float>(2 + random.below(3), 3 + random.below(3), 3 + random.below(2), 4.0F, 0.8F, 0.5F);
        set.samples = 8;
        const std::size_t nodes = 1 + random.below(40);
        for (std::size_t i = 0; i < nodes; ++i) {
            add(random, i);
        }
        first_entry.push_back(static_cast<std::uint16_t>(entries.size()));
        set.parent = parent;
        set.movement = movement;
        set.depth = depth;
        set.end = end;
        set.position = position;
        set.attitude = attitude;
        set.cost = cost;
        set.first_entry = first_entry;
        set.entries = entries;
        set.checksum = checksum_of(set);
    }

    void add(Random& random, std::size_t i)
    {
        std::size_t from = i == 0 ? 0 : random.below(i);
        while (i > 0 && depth[from] >= kMaxDepth) {
            from = depth[from] == 0 ? 0 : parent[from];
        }
        parent.push_back(static_cast<NodeIndex>(from));
        depth.push_back(static_cast<std::uint8_t>(i == 0 ? 0 : depth[from] + 1));
        movement.push_back(static_cast<std::uint8_t>(random.below(kMovements)));
        position.insert(position.end(), 3, 0);
        attitude.insert(attitude.end(), 2, 0);
        cost.push_back(static_cast<std::uint16_t>(random.below(6)));
        first_entry.push_back(static_cast<std::uint16_t>(entries.size()));
        footprint.push_back(i == 0 ? std::vector<CellIndex>{} : footprint[from]);
        end.push_back(i == 0 ? kNoCell : static_cast<CellIndex>(random.below(set.grid.cells())));
        for (std::size_t n = i == 0 ? 0 : random.below(4); n > 0; --n) {
            const auto cell = static_cast<CellIndex>(random.below(set.grid.cells()));
            if (std::ranges::find(footprint.back(), cell) == footprint.back().end()) {
                footprint.back().push_back(cell);
                entries.push_back({cell, 1, 8});
            }
        }
    }
};

/// Result of one of Gomola's four passes, for a node and for all cells.
struct Pass {
    std::vector<bool> node;
    std::vector<bool> cell;
};
Pass pass(const RandomTree& tree, const std::vector<Level>& blocks, const std::vector<Level>& intruder, int run)
{
    Pass p{std::vector<bool>(tree.set.nodes()), std::vector<bool>(tree.set.grid.cells(), false)};
    for (std::size_t i = 0; i < tree.set.nodes(); ++i) {
        bool reachable = true;
        for (std::size_t n = i; n != 0; n = tree.parent[n]) {
            reachable = reachable && (intruder.empty() || static_cast<int>(intruder[n]) > run);
        }
        double reachability = 1.0;
        for (const CellIndex cell : tree.footprint[i]) {
            reachability *= static_cast<int>(blocks[cell]) <= run ? 0.0 : 1.0;
        }
        p.node[i] = reachable && reachability > 0.0;
        // Of a cell: some node that enters it, with all that it enters.
        for (const FootprintEntry& entry : tree.set.entered(i)) {
            p.cell[entry.cell] = p.cell[entry.cell] || p.node[i];
        }
    }
    return p;
}

TEST(EvaluationLaws, OnePassIsFour)
{
    constexpr std::uint64_t kSeed = 20261123;
    Random random(kSeed);
    std::size_t free_nodes = 0;
    for (int i = 0; i < 10000; ++i) {
        const RandomTree tree(random);
        ASSERT_EQ(check(tree.set), SetStatus::good) << "case " << i;
        std::vector<Level> blocks(tree.set.grid.cells());
        for (Level& block : blocks) {
            block = random.below(3) == 0 ? static_cast<Level>(random.below(kRuns)) : kFree;
        }
        std::vector<Level> intruder;
        if (random.below(2) == 0) {
            for (std::size_t n = 0; n < tree.set.nodes(); ++n) {
                intruder.push_back(random.below(4) == 0 ? static_cast<Level>(random.below(kRuns + 1)) : kFree);
            }
        }
        std::vector<Level> nodes(tree.set.nodes());
        std::vector<Level> cells(tree.set.grid.cells());
        evaluate(tree.set, blocks, intruder, nodes, cells);
        for (int run = 0; run < static_cast<int>(kRuns); ++run) {
            const Pass alone = pass(tree, blocks, intruder, run);
            for (std::size_t n = 0; n < tree.set.nodes(); ++n) {
                ASSERT_EQ(is_free(nodes[n], static_cast<AvoidanceRun>(run)), alone.node[n])
                    << "seed " << kSeed << ", case " << i << ", run " << run << ", node " << n;
                free_nodes += alone.node[n] ? 1U : 0U;
            }
            for (std::size_t c = 0; c < tree.set.grid.cells(); ++c) {
                ASSERT_EQ(is_free(cells[c], static_cast<AvoidanceRun>(run)), alone.cell[c])
                    << "seed " << kSeed << ", case " << i << ", run " << run << ", cell " << c;
            }
        }
    }
    EXPECT_GT(free_nodes, 100000U);
}

/// The choice is free, ends (or passes) as the rule requires, and no cheaper trajectory does.
TEST(EvaluationLaws, TheChoiceIsTheCheapestOfTheBestCell)
{
    constexpr std::uint64_t kSeed = 5;
    Random random(kSeed);
    int of_status[4] = {};
    for (int i = 0; i < 10000; ++i) {
        const RandomTree tree(random);
        const ReachSet& set = tree.set;
        std::vector<Level> blocks(set.grid.cells());
        for (Level& block : blocks) {
            block = random.below(3) == 0 ? static_cast<Level>(random.below(kRuns)) : kFree;
        }
        std::vector<Level> nodes(set.nodes());
        std::vector<Level> cells(set.grid.cells());
        evaluate(set, blocks, {}, nodes, cells);
        const Vec3 goal(random.uniform(-6.0F, 6.0F), random.uniform(-6.0F, 6.0F), random.uniform(-3.0F, 3.0F));
        const auto run = static_cast<AvoidanceRun>(random.below(kRuns));
        const Choice choice = find_best_path(set, nodes, cells, goal, run);
        ++of_status[static_cast<std::size_t>(choice.status)];
        if (choice.status == PathStatus::no_path) {
            const bool none = std::none_of(nodes.begin() + 1, nodes.end(), [&](Level l) { return is_free(l, run); });
            const bool nowhere = std::ranges::none_of(cells, [&](Level l) { return is_free(l, run); });
            ASSERT_TRUE(none || nowhere) << "seed " << kSeed << ", case " << i;
            continue;
        }
        ASSERT_TRUE(is_free(nodes[choice.node], run));
        ASSERT_TRUE(is_free(cells[choice.cell], run));
        const Located at = set.grid.locate(goal);
        const bool goal_is_free = at.status == LocateStatus::inside && is_free(cells[set.grid.index(at.place)], run);
        ASSERT_EQ(choice.status == PathStatus::goal_unreachable,
                  at.status == LocateStatus::inside && !goal_is_free && set.grid.is_outer(set.grid.place(choice.cell)));
        if (goal_is_free) {
            ASSERT_EQ(choice.cell, set.grid.index(at.place));
        } else {
            for (std::size_t c = 0; c < set.grid.cells(); ++c) {
                const CellPlace place = set.grid.place(static_cast<CellIndex>(c));
                if (is_free(cells[c], run) && set.grid.is_outer(place)) {
                    ASSERT_NE(choice.status, PathStatus::no_outer_cell) << "seed " << kSeed << ", case " << i;
                    ASSERT_LE((set.grid.centre(set.grid.place(choice.cell)) - goal).squaredNorm(),
                              (set.grid.centre(place) - goal).squaredNorm())
                        << "seed " << kSeed << ", case " << i;
                }
            }
        }
        const auto ends_there = [&](std::size_t n) {
            return n > 0 && is_free(nodes[n], run) && set.end[n] == choice.cell;
        };
        bool any = false;
        for (std::size_t n = 1; n < set.nodes(); ++n) {
            any = any || ends_there(n);
        }
        for (std::size_t n = 1; n < set.nodes(); ++n) {
            const bool passes =
                is_free(nodes[n], run) &&
                std::ranges::any_of(set.entered(n), [&](const FootprintEntry& e) { return e.cell == choice.cell; });
            if (any ? ends_there(n) : passes) {
                ASSERT_LE(set.cost[choice.node], set.cost[n]) << "seed " << kSeed << ", case " << i;
                ASSERT_TRUE(set.cost[choice.node] < set.cost[n] || choice.node <= n) << "ties: lower index";
            }
        }
    }
    for (const int count : of_status) {
        EXPECT_GT(count, 20);
    }
}

TEST(EvaluationLaws, ASetThatWasChangedIsRefused)
{
    constexpr std::uint64_t kSeed = 17;
    Random random(kSeed);
    int refused = 0;
    for (int i = 0; i < 2000; ++i) {
        RandomTree tree(random);
        if (tree.set.nodes() < 3) {
            continue;
        }
        const std::size_t node = 1 + random.below(tree.set.nodes() - 1);
        switch (random.below(6)) {
        case 0: tree.parent[node] = static_cast<NodeIndex>(tree.parent[node] ^ (1U << random.below(16))); break;
        case 1: tree.movement[node] = static_cast<std::uint8_t>(tree.movement[node] ^ (1U << random.below(8))); break;
        case 2: tree.end[node] = static_cast<CellIndex>(tree.end[node] ^ (1U << random.below(16))); break;
        case 3:
            tree.position[3 * node] = static_cast<std::int16_t>(tree.position[3 * node] ^ (1 << random.below(15)));
            break;
        case 4: tree.cost[node] = static_cast<std::uint16_t>(tree.cost[node] ^ (1U << random.below(16))); break;
        default:
            tree.first_entry[node] = static_cast<std::uint16_t>(tree.first_entry[node] ^ (1U << random.below(16)));
            break;
        }
        ASSERT_NE(check(tree.set), SetStatus::good) << "seed " << kSeed << ", case " << i;
        ++refused;
    }
    EXPECT_GT(refused, 1000);
}

}  // namespace
}  // namespace jink::reach
