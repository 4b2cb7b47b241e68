// SPDX-License-Identifier: BSD-3-Clause
// Trajectories with the fewest turns, against all trajectories of up to three turns.
#include "toolchain/reach/best_paths.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>

#include "toolchain/reach/expansion.hpp"
#include "toolchain/reach/generators.hpp"

namespace jink::reach::build {
namespace {

/// Column and row, of the last layer.
using Column = std::pair<int, int>;
constexpr int kNever = 99;

/// Fewest turns to each column, by flying every sequence of movements with up to `left` more turns.
void fly(const Settings& s, const Node& from, int turns, int most, std::map<Column, int>& fewest)
{
    for (const Movement movement : kAllMovements) {
        const int now = turns + (is_smooth(movement) ? 0 : 1);
        if (now > most) {
            continue;
        }
        const std::optional<Node> to = child_of(s, from, 0, movement);
        if (!to || to->depth > 14) {
            continue;
        }
        if (to->end.layer + 1U < s.grid.layers()) {
            fly(s, *to, now, most, fewest);
            continue;
        }
        int& known = fewest.try_emplace({to->end.column, to->end.row}, kNever).first->second;
        known = std::min(known, now);
    }
}

std::map<Column, Node> ends_of(const Set& set)
{
    std::map<Column, Node> best;
    for (const Set::Member& member : set.members) {
        if (member.in_front) {
            const auto [known, is_new] = best.try_emplace({member.node.end.column, member.node.end.row}, member.node);
            if (!is_new && member.node.smoothness() > known->second.smoothness()) {
                known->second = member.node;
            }
        }
    }
    return best;
}

std::vector<Movement> movements_of(const Set& set, std::size_t member)
{
    std::vector<Movement> out;
    for (std::size_t at = member; at != 0; at = set.members[at].node.parent) {
        out.push_back(set.members[at].node.movement);
    }
    std::reverse(out.begin(), out.end());
    return out;
}

Settings with_root(std::int8_t pitch)
{
    Settings s;
    s.root_pitch = pitch;
    return s;
}

void expect_fewest(const Settings& s)
{
    std::map<Column, int> fewest;
    fly(s, root_of(s), 0, 3, fewest);
    const auto ends = ends_of(best_paths(s));
    ASSERT_GE(fewest.size(), 20U);
    for (const auto& [column, turns] : fewest) {
        ASSERT_TRUE(ends.count(column)) << column.first << " " << column.second;
        const Node& node = ends.at(column);
        EXPECT_EQ(node.depth - node.smooth, turns) << column.first << " " << column.second;
    }
    for (const auto& [column, node] : ends) {
        if (!fewest.count(column)) {
            EXPECT_GE(node.depth - node.smooth, 4);
        }
    }
}

/// Specification 11.2: no trajectory reaches a column with fewer turns.
TEST(BestPaths, NoTrajectoryOfUpToThreeTurnsHasFewer)
{
    expect_fewest(with_root(0));
    expect_fewest(with_root(1));
    Settings fast;  // the larger vehicle's steps
    fast.step.yaw = 0.0972;
    fast.step.pitch = 0.0583;
    fast.grid = Grid<double>(10, 7, 5, 10.0, 3.0 * fast.step.yaw, 2.0 * fast.step.pitch);
    expect_fewest(fast);
}

/// Specification 11.2, acceptance for the improved generator: columns (4,4), (4,2), (3,3) and their like, counted from
/// 1, have a smoothness of 0.9 where one turn leads there.
TEST(BestPaths, OneTurnGivesNineTenths)
{
    const Settings s;
    std::map<Column, int> fewest;
    fly(s, root_of(s), 0, 1, fewest);
    const auto ends = ends_of(best_paths(s));
    std::size_t with_one = 0;
    for (const auto& [column, turns] : fewest) {
        EXPECT_GE(ends.at(column).smoothness(), turns == 0 ? 1.0 : 0.9);
        with_one += turns == 1 ? 1U : 0U;
    }
    EXPECT_EQ(with_one, 8U);
    for (const Column column : {Column{3, 3}, Column{3, 1}, Column{2, 2}, Column{4, 2}}) {
        EXPECT_GE(ends.at(column).smoothness(), 0.9) << column.first << " " << column.second;
    }
}

TEST(BestPaths, NeverWorseThanTheGreedySet)
{
    const Settings s;
    const auto ends = ends_of(best_paths(s));
    const auto greedy = ends_of(kept(grow(s, harmonic(s, 36)), kFromHarmonic));
    EXPECT_EQ(greedy.size(), 35U);
    std::size_t better = 0;
    for (const auto& [column, node] : greedy) {
        ASSERT_TRUE(ends.count(column));
        EXPECT_GE(ends.at(column).smoothness(), node.smoothness());
        better += ends.at(column).smoothness() > node.smoothness() + 0.05 ? 1U : 0U;
    }
    EXPECT_GE(better, 30U) << "what the improvement is for";
}

/// Every trajectory once more from the root, movement by movement.
TEST(BestPaths, WhatIsFoundIsFlownAnew)
{
    for (const BestFor wanted : {BestFor::columns, BestFor::cells}) {
        const Settings s = with_root(1);
        const Set set = best_paths(s, {wanted});
        for (std::size_t i = 1; i < set.members.size(); ++i) {
            const Node& node = set.members[i].node;
            const std::optional<Node> again = replay(s, movements_of(set, i));
            ASSERT_TRUE(again);
            EXPECT_EQ(again->depth, node.depth);
            EXPECT_TRUE(again->end == node.end);
            EXPECT_EQ(again->footprint, node.footprint);
            EXPECT_LT((again->pose.position - node.pose.position).norm(), 1e-12);
        }
    }
}

/// One trajectory to each column, or an end of a movement in each cell that all trajectories reach.
TEST(BestPaths, AsFewAsThereAreEnds)
{
    const Settings s;
    const Set columns = best_paths(s);
    EXPECT_EQ(columns.trajectories(), 35U);
    EXPECT_EQ(ends_of(columns).size(), 35U);
    const Set cells = best_paths(s, {BestFor::cells});
    std::set<CellIndex> ended;
    for (const Set::Member& member : cells.members) {
        if (member.node.depth > 0) {
            ended.insert(s.grid.index(member.node.end));
        }
    }
    EXPECT_GE(ended.size(), 270U) << "278 cells are touched by any trajectory at all";
    EXPECT_LT(cells.members.size(), kept(grow(s, harmonic(s, 9)), kFromHarmonic).members.size() / 2);
    EXPECT_GT(measure(cells).mean_smoothness, 0.7);
    for (const Set::Member& member : cells.members) {
        if (member.is_lateral) {
            EXPECT_TRUE(ends_at_side(s, member.node));
            EXPECT_GE(member.node.smoothness(), 0.2) << "no turning back to the front";
        }
    }
}

TEST(BestPaths, ColumnsOutOfReachStayEmpty)
{
    Settings s;
    s.most_up = 0;
    s.most_down = 0;
    const auto ends = ends_of(best_paths(s));
    EXPECT_EQ(ends.size(), 7U);
    for (const auto& [column, node] : ends) {
        EXPECT_EQ(column.second, 2);
        EXPECT_EQ(node.pitch_steps, 0);
    }
}

}  // namespace
}  // namespace jink::reach::build
