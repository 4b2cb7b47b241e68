// SPDX-License-Identifier: BSD-3-Clause
// Levels of a tree made by hand, and the choice of a trajectory by every rule of the header.
#include "core/reach/evaluation.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "core/base/work_units.hpp"
#include "tests/unit/core/reach/choose.hpp"
#include "tests/unit/core/reach/small_tree.hpp"

namespace jink::reach {
namespace {

constexpr auto kObstacleRun = AvoidanceRun::obstacles;
constexpr auto kIntruderRun = AvoidanceRun::intruders;
constexpr auto kHardRun = AvoidanceRun::hard_constraints;
constexpr auto kSoftRun = AvoidanceRun::soft_constraints;

/// Three movements ahead, and three to the left.
class EvaluationTest : public ::testing::Test {
protected:
    test::SmallTree tree;
    NodeIndex one = tree.add(0, Movement::straight, 100);
    NodeIndex two = tree.add(one, Movement::straight, 200);
    NodeIndex three = tree.add(two, Movement::straight, 300);
    NodeIndex left = tree.add(0, Movement::left, 150);
    NodeIndex turned = tree.add(left, Movement::left, 250);
    NodeIndex farther_left = tree.add(turned, Movement::straight, 350);
    ReachSet set = tree.view();
    std::vector<Level> blocks = std::vector<Level>(set.grid.cells(), kFree);
    std::vector<Level> nodes = std::vector<Level>(set.nodes(), Level{99});
    std::vector<Level> cells = std::vector<Level>(set.grid.cells(), Level{99});

    void SetUp() override { ASSERT_EQ(check(set), SetStatus::good); }
    void rate(std::span<const Level> intruder = {}) { evaluate(set, blocks, intruder, nodes, cells); }
    [[nodiscard]] Choice choose(const Vec3& goal, AvoidanceRun run, const ChoiceRule& rule = {}) const
    {
        return find_best_path(set, nodes, cells, goal, run, rule);
    }
    /// Levels as if they had been rated so: all nodes and the cells that they end in.
    void all_at(Level level)
    {
        std::ranges::fill(nodes, level);
        nodes[0] = kFree;
        std::ranges::fill(cells, Level{0});
        for (std::size_t i = 1; i < set.nodes(); ++i) {
            cells[set.end[i]] = level;
        }
    }
};

TEST(Levels, ALevelIsFreeInTheRunsBeforeIt)
{
    EXPECT_FALSE(is_free(Level{0}, kObstacleRun));
    EXPECT_TRUE(is_free(Level{1}, kObstacleRun));
    EXPECT_FALSE(is_free(Level{1}, kIntruderRun));
    EXPECT_TRUE(is_free(Level{3}, kHardRun));
    EXPECT_FALSE(is_free(Level{3}, kSoftRun));
    EXPECT_TRUE(is_free(kFree, kSoftRun));
}

TEST_F(EvaluationTest, WithoutThreatsAllThatIsEnteredIsFreeAndNothingElse)
{
    rate();
    for (const Level level : nodes) {
        EXPECT_EQ(level, kFree);
    }
    std::size_t free = 0;
    for (const Level level : cells) {
        free += level == kFree ? 1U : 0U;
        EXPECT_TRUE(level == kFree || level == 0) << "what stood there before is gone";
    }
    EXPECT_EQ(free, 6U);
}

TEST_F(EvaluationTest, ABlockedCellBlocksWhatEntersItAndAllThatFollows)
{
    blocks[tree.end(two)] = 1;
    rate();
    EXPECT_EQ(nodes[one], kFree);
    EXPECT_EQ(nodes[two], 1);
    EXPECT_EQ(nodes[three], 1);
    EXPECT_EQ(nodes[left], kFree);
    EXPECT_EQ(cells[tree.end(three)], 1);
    EXPECT_EQ(cells[tree.end(left)], kFree);
}

TEST_F(EvaluationTest, OfAllCellsOfAMovementTheWorstCounts)
{
    const CellIndex also = set.grid.index({9, 0, 0});
    const CellIndex last = set.grid.index({9, 0, 1});
    tree.enter(also);
    tree.enter(last);
    set = tree.view();
    for (const CellIndex worst : {tree.end(farther_left), also, last}) {
        std::ranges::fill(blocks, Level{3});
        blocks[worst] = 2;
        rate();
        EXPECT_EQ(nodes[farther_left], 2);
        EXPECT_EQ(nodes[left], 3);
        EXPECT_EQ(cells[also], 2) << "every cell that is entered is as good as the node";
        EXPECT_EQ(cells[last], 2);
    }
}

TEST_F(EvaluationTest, ACellIsAsGoodAsTheBestNodeThatEntersIt)
{
    tree.enter(tree.end(three));
    set = tree.view();
    std::vector<Level> intruder(set.nodes(), kFree);
    intruder[three] = 1;
    rate(intruder);
    EXPECT_EQ(cells[tree.end(three)], kFree) << "from the left it is free";
    intruder[three] = 3;
    intruder[farther_left] = 0;
    rate(intruder);
    EXPECT_EQ(cells[tree.end(three)], 3) << "the worse one comes last";
}

TEST_F(EvaluationTest, OwnLevelsAreAskedForOnceParentsFirstAndNotBehindWhatIsBlocked)
{
    blocks[tree.end(left)] = 0;
    std::vector<NodeIndex> asked;
    const auto own = [&](NodeIndex node) {
        asked.push_back(node);
        return node == two ? Level{1} : kFree;
    };
    evaluate_with(set, blocks, own, nodes, cells);
    EXPECT_EQ(asked, (std::vector<NodeIndex>{one, two, three}));
    EXPECT_EQ(nodes[three], 1);
    EXPECT_EQ(nodes[farther_left], 0);
    EXPECT_EQ(nodes[0], kFree);
}

TEST_F(EvaluationTest, TheGoalsCellIsTakenByTheCheapestThatEndsThere)
{
    const NodeIndex expensive = tree.add(two, Movement::straight, 500);
    const NodeIndex cheap = tree.add(two, Movement::straight, 280);
    const NodeIndex as_cheap = tree.add(two, Movement::straight, 280);
    static_cast<void>(expensive);
    static_cast<void>(as_cheap);
    set = tree.view();
    nodes.resize(set.nodes());
    rate();
    const Choice choice = choose(Vec3(2.6F, 0.0F, 0.0F), kSoftRun);
    EXPECT_EQ(choice.status, PathStatus::found);
    EXPECT_EQ(choice.cell, tree.end(three));
    EXPECT_EQ(choice.node, cheap) << "of two as cheap the lower index";
    EXPECT_EQ(choice.run, kSoftRun);
    nodes[cheap] = 3;
    EXPECT_EQ(choose(Vec3(2.6F, 0.0F, 0.0F), kSoftRun).node, as_cheap) << "what is not free is not taken";
    EXPECT_EQ(choose(Vec3(2.6F, 0.0F, 0.0F), kHardRun).node, cheap);
}

TEST_F(EvaluationTest, WhereNothingEndsWhatPassesThroughIsTaken)
{
    const CellIndex passed = set.grid.index({1, 2, 2});
    tree.enter(passed);  // the more expensive one, first
    const NodeIndex cheaper = tree.add(left, Movement::straight, 270);
    tree.enter(passed);
    set = tree.view();
    nodes.resize(set.nodes());
    rate();
    const Vec3 goal = set.grid.centre({1, 2, 2});
    EXPECT_EQ(choose(goal, kSoftRun).node, cheaper);
    nodes[cheaper] = 0;
    EXPECT_EQ(choose(goal, kSoftRun).node, farther_left);
    // A trajectory that ends there wins, at any cost and index.
    nodes[cheaper] = kFree;
    const NodeIndex ends = tree.add(0, Movement::straight, 60000);
    set = tree.view();
    std::vector<CellIndex> end(set.end.begin(), set.end.end());
    end[ends] = passed;
    set.end = end;
    nodes.push_back(kFree);
    EXPECT_EQ(choose(goal, kSoftRun).node, ends);
}

TEST_F(EvaluationTest, AGoalInACellThatIsNotFreeEndsTheSearchOnlyInNavigation)
{
    rate();
    cells[tree.end(two)] = 2;
    cells[set.grid.index({9, 3, 2})] = kFree;  // an exit
    nodes[three] = kFree;
    const Vec3 goal = tree.position(two);
    const Choice nothing = choose(goal, kSoftRun, {true, 0});
    EXPECT_EQ(nothing.status, PathStatus::goal_unreachable);
    EXPECT_EQ(nothing.node, kNoNode);
    EXPECT_EQ(nothing.cell, kNoCell);
    const Choice free = choose(goal, kIntruderRun, {true, 0});
    EXPECT_EQ(free.status, PathStatus::found);
    EXPECT_EQ(free.node, two);
    EXPECT_EQ(choose(goal, kSoftRun, {false, 0}).cell, set.grid.index({9, 3, 2}));
}

TEST_F(EvaluationTest, AGoalThatIsNotFreeIsReplacedByTheNearestExit)
{
    const NodeIndex right = tree.add(0, Movement::right, 100);
    set = tree.view();
    nodes.resize(set.nodes());
    all_at(kFree);
    // Let both ends be exits: at the right and at the left border.
    std::vector<CellIndex> end(set.end.begin(), set.end.end());
    end[farther_left] = set.grid.index({2, 6, 2});
    end[right] = set.grid.index({2, 0, 2});
    set.end = end;
    all_at(kFree);
    cells[tree.end(two)] = 0;
    const Choice choice = choose(Vec3(1.5F, 0.05F, 0), kSoftRun);
    EXPECT_EQ(choice.status, PathStatus::goal_unreachable);
    EXPECT_EQ(choice.node, farther_left);
    EXPECT_EQ(choose(Vec3(1.5F, -0.05F, 0), kSoftRun).node, right);
    // The same of a goal outside, which is no failure.
    const Choice outside = choose(Vec3(20, -3, 0), kSoftRun);
    EXPECT_EQ(outside.status, PathStatus::found);
    EXPECT_EQ(outside.node, right);
    cells[end[right]] = 3;
    EXPECT_EQ(choose(Vec3(20, -3, 0), kSoftRun).node, farther_left) << "an exit that is not free is none";
    EXPECT_EQ(choose(Vec3(20, -3, 0), kHardRun).node, right);
}

TEST(Exits, OfTwoThatAreEquallyNearTheLowerCellIsTaken)
{
    test::SmallTree two(Grid<float>(1, 2, 1, 2.0F, 0.8F, 0.5F));
    static_cast<void>(two.add(0, Movement::left, 100));
    const NodeIndex right = two.add(0, Movement::right, 900);
    const ReachSet set = two.view();
    const std::vector<Level> free(3, kFree);
    const std::span<const Level> cells(free.data(), 2);
    EXPECT_EQ(find_best_path(set, free, cells, Vec3(20, 0, 0), kSoftRun).node, right);
    EXPECT_NE(find_best_path(set, free, cells, Vec3(20, 1, 0), kSoftRun).node, right);
}

TEST_F(EvaluationTest, ExitsAtTheSidesBeginAtALayer)
{
    std::vector<CellIndex> end(set.end.begin(), set.end.end());
    end[left] = set.grid.index({4, 6, 2});
    end[three] = set.grid.index({9, 3, 2});
    set.end = end;
    all_at(kFree);
    const Vec3 aside = 20.0F * set.grid.centre({0, 6, 2});
    EXPECT_EQ(choose(aside, kSoftRun, {false, 0}).cell, end[left]);
    EXPECT_EQ(choose(aside, kSoftRun, {false, 4}).cell, end[left]) << "from this layer on";
    EXPECT_EQ(choose(aside, kSoftRun, {false, 5}).cell, end[three]);
}

TEST_F(EvaluationTest, WithoutAnExitTheFarthestFreeCellIsChosen)
{
    all_at(kFree);
    const Choice choice = choose(Vec3(50, 0, 0), kSoftRun);
    EXPECT_EQ(choice.status, PathStatus::no_outer_cell);
    EXPECT_EQ(choice.cell, std::min(tree.end(three), tree.end(farther_left)))
        << "both are in the third layer; the lower index";
    cells[choice.cell] = 2;
    const Choice other = choose(Vec3(50, 0, 0), kSoftRun);
    EXPECT_EQ(other.cell, std::max(tree.end(three), tree.end(farther_left)));
    cells[other.cell] = 2;
    EXPECT_EQ(set.grid.place(choose(Vec3(50, 0, 0), kSoftRun).cell).layer, 1);
    EXPECT_EQ(choose(Vec3(50, 0, 0), kIntruderRun).cell, choice.cell);
}

TEST_F(EvaluationTest, AGoalThatIsNotANumberChoosesNoExit)
{
    std::vector<CellIndex> end(set.end.begin(), set.end.end());
    end[two] = set.grid.index({9, 3, 2});
    set.end = end;
    all_at(kFree);
    const float nan = std::numeric_limits<float>::quiet_NaN();
    EXPECT_EQ(choose(Vec3(nan, 0, 0), kSoftRun).status, PathStatus::no_outer_cell);
}

TEST_F(EvaluationTest, WithoutAFreeNodeOrCellThereIsNoPath)
{
    all_at(2);
    const Choice choice = choose(Vec3(1, 0, 0), kHardRun);
    EXPECT_EQ(choice.status, PathStatus::no_path);
    EXPECT_EQ(choice.node, kNoNode);
    EXPECT_EQ(choice.cell, kNoCell);
    EXPECT_EQ(choice.run, kHardRun);
    EXPECT_EQ(choose(Vec3(1, 0, 0), kIntruderRun).status, PathStatus::found);
    // All ends are struck out.
    std::ranges::fill(cells, Level{0});
    const Choice struck = choose(Vec3(50, 0, 0), kIntruderRun);
    EXPECT_EQ(struck.status, PathStatus::no_path);
    EXPECT_EQ(struck.node, kNoNode);
}

TEST_F(EvaluationTest, TheStrictestRunThatLeavesAWayIsTakenDownToTheLoosest)
{
    const Vec3 goal(2.6F, 0.0F, 0.0F);
    for (const Level level : {Level{1}, Level{2}, Level{3}, Level{4}}) {
        all_at(level);
        const Choice best = find_best_path_of_all(set, nodes, cells, goal, kObstacleRun);
        EXPECT_EQ(best.status, PathStatus::found);
        EXPECT_EQ(best.node, three);
        EXPECT_EQ(static_cast<int>(best.run), level - 1);
    }
    all_at(3);
    EXPECT_EQ(find_best_path_of_all(set, nodes, cells, goal, kHardRun).node, three) << "the loosest counts";
    all_at(2);
    const Choice none = find_best_path_of_all(set, nodes, cells, goal, kHardRun);
    EXPECT_EQ(none.status, PathStatus::no_path);
    EXPECT_EQ(none.node, kNoNode);
    EXPECT_EQ(none.run, kHardRun);
    nodes[left] = nodes[one] = 3;
    cells[tree.end(left)] = cells[tree.end(one)] = 3;
    const Choice some = find_best_path_of_all(set, nodes, cells, goal, kObstacleRun, {true, 0});
    EXPECT_EQ(some.run, kIntruderRun) << "the goal or nothing, in each run";
    EXPECT_EQ(some.node, three);
    EXPECT_EQ(find_best_path_of_all(set, nodes, cells, goal, kObstacleRun).run, kHardRun);
}

TEST_F(EvaluationTest, ARunThatTheBudgetDoesNotReachForLeavesNoWay)
{
    const Vec3 goal(2.6F, 0.0F, 0.0F);
    all_at(3);
    const std::uint32_t each = units::reach_choice_units(set.entries.size(), set.grid.cells());
    const CellSpheres spheres(set.grid);
    WorkBudget both(2 * each);
    EXPECT_EQ(find_best_path_of_all(set, spheres, nodes, cells, goal, kHardRun, {}, both).node, three);
    EXPECT_EQ(both.left(), 0U) << "nothing is free in the first one";
    WorkBudget one(2 * each - 1);
    EXPECT_EQ(find_best_path_of_all(set, spheres, nodes, cells, goal, kHardRun, {}, one).node, kNoNode);
    EXPECT_TRUE(one.exhausted());
}

}  // namespace
}  // namespace jink::reach
