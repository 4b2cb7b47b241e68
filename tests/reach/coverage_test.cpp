// SPDX-License-Identifier: BSD-3-Clause
// Cells and footprints of all trajectories, against the full trees of the specification, and the sets' coverage of
// them.
#include "toolchain/reach/coverage.hpp"

#include <gtest/gtest.h>

#include "toolchain/reach/generators.hpp"

namespace jink::reach::build {
namespace {

Settings with_layers(std::size_t layers, DisplacementModel model)
{
    Settings s;
    s.model = model;
    s.grid = Grid<double>(layers, 7, 5, static_cast<double>(layers), s.grid.horizontal(), s.grid.vertical());
    return s;
}

/// Specification 16.4: cells that the full tree enters.
TEST(Coverage, ReachableCellsAreThoseOfTheFullTree)
{
    EXPECT_EQ(count_reachable_cells(with_layers(4, DisplacementModel::arc)), 68U);
    EXPECT_EQ(count_reachable_cells(with_layers(4, DisplacementModel::end_heading)), 94U);
    EXPECT_EQ(count_reachable_cells(with_layers(6, DisplacementModel::arc)), 138U);
    EXPECT_EQ(count_reachable_cells(with_layers(6, DisplacementModel::end_heading)), 164U);
    EXPECT_EQ(count_reachable_cells(with_layers(10, DisplacementModel::arc)), 278U);
    EXPECT_EQ(count_reachable_cells(with_layers(10, DisplacementModel::end_heading)), 304U);
}

/// And for roots and limits that the specification has no figures of, against the full tree itself.
TEST(Coverage, ReachableCellsOfOtherRootsAndLimits)
{
    for (const std::int8_t root : {-1, 0, 1}) {
        for (const std::int8_t most : {1, 2, 9}) {
            Settings s = with_layers(4, DisplacementModel::arc);
            s.root_pitch = root;
            s.most_down = most;
            s.step.pitch = 0.1;
            s.grid = Grid<double>(4, 7, 5, 4.0, 3.0 * s.step.yaw, 0.2);
            EXPECT_EQ(count_reachable_cells(s), measure(full_set(s)).cells) << int{root} << " " << int{most};
        }
    }
}

/// Specification 16.4: cell coverage at least 0.85 (chaotic 9/3, arc) and 0.95 (chaotic 36/3, harmonic 9); footprints
/// on four layers 0.54 (9/3) and 0.96 (36).
TEST(Coverage, OfTheSourcesSets)
{
    const Settings s;
    const Whole whole = whole_of(s);
    EXPECT_EQ(whole.cells, 278U);
    EXPECT_EQ(whole.footprints, 253U);
    const auto coverage = [&](const auto& constraint) {
        const auto make = [&](const Settings& with) { return kept(grow(with, constraint(with)), 0); };
        return coverage_of(s, make(s), make, whole);
    };
    const Coverage nine = coverage([](const Settings& with) { return chaotic(with, 9, 3); });
    EXPECT_GE(nine.cells, 0.85);
    EXPECT_LT(nine.cells, 0.9);
    EXPECT_NEAR(nine.footprints, 0.54, 0.005);
    const Coverage many = coverage([](const Settings& with) { return chaotic(with, 36, 3); });
    EXPECT_GE(many.cells, 0.95);
    EXPECT_NEAR(many.footprints, 0.96, 0.005);
    EXPECT_GE(coverage([](const Settings& with) { return harmonic(with, 9); }).cells, 0.95);
    EXPECT_LT(coverage([](const Settings& with) { return harmonic(with, 1); }).cells, 0.5);
}

/// Specification 16.3: a set covers itself.
TEST(Coverage, EverythingCoversEverything)
{
    const Settings s = with_layers(4, DisplacementModel::arc);
    const Coverage all = coverage_of(s, full_set(s), full_set, whole_of(s));
    EXPECT_EQ(all.cells, 1.0);
    EXPECT_EQ(all.footprints, 1.0);
}

}  // namespace
}  // namespace jink::reach::build
