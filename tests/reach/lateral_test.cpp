// SPDX-License-Identifier: BSD-3-Clause
// Exits at the sides, climbing or sinking roots, and candidates counted by plane.
#include <gtest/gtest.h>

#include <map>

#include "toolchain/reach/best_paths.hpp"
#include "toolchain/reach/expansion.hpp"
#include "toolchain/reach/generators.hpp"
#include "toolchain/reach/set.hpp"

namespace jink::reach::build {
namespace {

Settings lateral(std::size_t most = kNoLimit)
{
    Settings s;
    s.keep_lateral = true;
    s.most_lateral = most;
    return s;
}

Set chaotic_set(const Settings& s) { return kept(grow(s, chaotic(s, 8, 3)), kFromChaotic); }

/// Of each member, whether another one follows it.
std::vector<bool> has_children(const Set& set)
{
    std::vector<bool> has(set.members.size(), false);
    for (std::size_t i = 1; i < set.members.size(); ++i) {
        has[set.members[i].node.parent] = true;
    }
    return has;
}

TEST(Lateral, NoneUnlessAskedFor)
{
    EXPECT_EQ(measure(chaotic_set(Settings{})).laterals, 0U);
    EXPECT_TRUE(grow(Settings{}, chaotic(Settings{}, 8, 3)).lateral.empty());
}

/// Every leaf of a set ends in the last layer or at a side, and the trajectories to the front are the same with and
/// without lateral ends.
TEST(Lateral, LeavesEndAtASideAndFrontsStay)
{
    const Settings s = lateral();
    const Set with = chaotic_set(s);
    const Metrics m = measure(with);
    EXPECT_EQ(m.trajectories, measure(chaotic_set(Settings{})).trajectories);
    EXPECT_GT(m.laterals, 100U);
    const std::vector<bool> inner = has_children(with);
    std::size_t out_of_columns = 0;
    std::size_t out_of_rows = 0;
    for (std::size_t i = 1; i < with.members.size(); ++i) {
        const Set::Member& member = with.members[i];
        ASSERT_EQ(inner[i], !member.in_front && !member.is_lateral) << i;
        if (member.is_lateral) {
            ASSERT_FALSE(member.in_front);
            const CellPlace end = member.node.end;
            const bool column = end.column == 0 || end.column == 6;
            const bool row = end.row == 0 || end.row == 4;
            ASSERT_TRUE(column || row) << i;
            ASSERT_LT(end.layer, 9);
            out_of_columns += column ? 1U : 0U;
            out_of_rows += row ? 1U : 0U;
        }
    }
    EXPECT_GT(out_of_columns, 20U);
    EXPECT_GT(out_of_rows, 20U);
}

TEST(Lateral, SoManyOfEachCellTheSmoothestFirst)
{
    const auto by_cell = [](const Set& set) {
        std::map<CellIndex, std::vector<double>> out;
        for (const Set::Member& member : set.members) {
            if (member.is_lateral) {
                out[Settings{}.grid.index(member.node.end)].push_back(member.node.smoothness());
            }
        }
        return out;
    };
    const auto all = by_cell(chaotic_set(lateral()));
    const auto two = by_cell(chaotic_set(lateral(2)));
    const auto one = by_cell(chaotic_set(lateral(1)));
    EXPECT_EQ(all.size(), two.size());
    EXPECT_EQ(all.size(), one.size());
    for (const auto& [cell, smoothness] : all) {
        EXPECT_EQ(two.at(cell).size(), std::min<std::size_t>(2, smoothness.size()));
        ASSERT_EQ(one.at(cell).size(), 1U);
        EXPECT_EQ(one.at(cell).front(), *std::max_element(smoothness.begin(), smoothness.end()));
    }
}

TEST(Lateral, MergingKeepsThem)
{
    const Set a = chaotic_set(lateral());
    const Set b = kept(grow(Settings{}, harmonic(Settings{}, 1)), kFromHarmonic);
    for (const Set& both : {merged(a, b), merged(b, a)}) {
        std::size_t lateral_or_front = 0;
        for (const Set::Member& member : both.members) {
            lateral_or_front += member.is_lateral ? 1U : 0U;
        }
        EXPECT_EQ(lateral_or_front, measure(a).laterals);
    }
}

/// Mirrored movements of a sinking root's trajectories are flown from the climbing root, to mirrored places: required
/// by stored tables that are read upside down.
TEST(Roots, SinkingAndClimbingMirrorEachOther)
{
    Settings sinking;
    sinking.root_pitch = 1;
    sinking.most_up = sinking.most_down = 3;
    sinking.step.pitch = 0.17;
    sinking.grid = Grid<double>(10, 7, 5, 10.0, sinking.grid.horizontal(), 0.34);
    Settings climbing = sinking;
    climbing.root_pitch = -1;
    const Set set = chaotic_set(sinking);
    ASSERT_GT(set.members.size(), 1000U);
    std::vector<Node> mirrored{root_of(climbing)};
    for (std::size_t i = 1; i < set.members.size(); ++i) {
        const Node& node = set.members[i].node;
        const Turn turn = turn_of(node.movement);
        const auto by = std::find_if(kAllMovements.begin(), kAllMovements.end(), [&](Movement m) {
            return turn_of(m).pitch == -turn.pitch && turn_of(m).yaw == turn.yaw;
        });
        const std::optional<Node> other = child_of(climbing, mirrored[node.parent], node.parent, *by);
        ASSERT_TRUE(other) << i;
        EXPECT_NEAR(other->pose.position.x(), node.pose.position.x(), 1e-9);
        EXPECT_NEAR(other->pose.position.y(), node.pose.position.y(), 1e-9);
        EXPECT_NEAR(other->pose.position.z(), -node.pose.position.z(), 1e-9);
        EXPECT_EQ(other->pitch_steps, -node.pitch_steps);
        mirrored.push_back(*other);
    }
}

TEST(Roots, PitchIsTheRootsOwnAndStaysWithinItsLimits)
{
    Settings s;
    s.root_pitch = 1;
    s.most_down = 1;
    s.most_up = 2;
    const std::vector<Movement> straight(5, Movement::straight);
    const std::optional<Node> end = replay(s, straight);
    ASSERT_TRUE(end);
    EXPECT_NEAR(end->pose.position.z(), -5.0 * std::sin(s.step.pitch), 1e-12);
    EXPECT_EQ(end->pitch_steps, 1);
    EXPECT_FALSE(child_of(s, *end, 0, Movement::down));
    const Set set = kept(grow(s, harmonic(s, 9)), kFromHarmonic);
    int least = 0;
    for (const Set::Member& member : set.members) {
        EXPECT_LE(member.node.pitch_steps, 1);
        least = std::min<int>(least, member.node.pitch_steps);
    }
    EXPECT_EQ(least, -2);
}

/// Specification 11.4: per plane each has its spread where planes cross; the cells are the same, the planes kept to.
TEST(Planes, CountedByPlaneNoneIsDisplaced)
{
    const Settings s;
    const std::uint8_t planes[] = {kHorizontal, kVertical, kSlash, kBackslash};
    const WaveFront together = grow(s, acas(s, kAllSeparations, 2));
    const WaveFront each = grow(s, acas(s, kAllSeparations, 2, SpreadOf::separation));
    std::size_t displaced = 0;
    for (const std::uint8_t plane : planes) {
        const auto in_plane = [&](const WaveFront& grown) {
            return std::count_if(grown.front.begin(), grown.front.end(),
                                 [&](NodeId id) { return (grown.nodes[id].separations & plane) != 0; });
        };
        // A plane alone has exactly the trajectories that it has among the others when each plane is counted
        // separately.
        const WaveFront alone = grow(s, acas(s, plane, 2));
        EXPECT_EQ(in_plane(each), static_cast<std::ptrdiff_t>(alone.front.size())) << int{plane};
        EXPECT_LE(in_plane(together), in_plane(each)) << int{plane};
        displaced += in_plane(together) < in_plane(each) ? 1U : 0U;
    }
    EXPECT_GE(displaced, 2U) << "what counting by plane is for";
}

/// Specification 11.4: UL^2 DR^4 UL^2 S^2 stays within 0.048 of its tilted plane, and within 0.1 by its tolerance;
/// level and upright planes are kept exactly. Constant turning deviates from a tilted plane by up to 0.79.
TEST(Planes, TrajectoriesStayNearTheirPlane)
{
    const Settings s;
    const auto farthest = [&](std::uint8_t plane, const Point<double>& normal) {
        double most = 0.0;
        for (const Set::Member& member : kept(grow(s, acas(s, plane, 9)), kFromAcas).members) {
            most = std::max(most, std::abs(normal.dot(member.node.pose.position)));
        }
        return most;
    };
    const double half = std::sqrt(0.5);
    EXPECT_LT(farthest(kHorizontal, {0.0, 0.0, 1.0}), 1e-12);
    EXPECT_LT(farthest(kVertical, {0.0, 1.0, 0.0}), 1e-12);
    EXPECT_NEAR(farthest(kSlash, {0.0, -half, half}), 0.789, 0.001);
    EXPECT_NEAR(farthest(kBackslash, {0.0, half, half}), 0.789, 0.001);
    const std::vector<Movement> m{
        Movement::up_left,    Movement::up_left, Movement::down_right, Movement::down_right, Movement::down_right,
        Movement::down_right, Movement::up_left, Movement::up_left,    Movement::straight,   Movement::straight};
    double most = 0.0;
    for (std::size_t n = 1; n <= m.size(); ++n) {
        const std::optional<Node> at = replay(s, std::span(m).first(n));
        ASSERT_TRUE(at);
        most = std::max(most, std::abs(at->pose.position.z() - at->pose.position.y()) * half);
    }
    EXPECT_NEAR(most, 0.048, 0.005);
}

}  // namespace
}  // namespace jink::reach::build
