// SPDX-License-Identifier: BSD-3-Clause
// The grid is a partition (reach-set specification, section 16.2).
#include <gtest/gtest.h>

#include <cmath>

#include "core/base/random.hpp"
#include "core/reach/grid.hpp"

namespace jink::reach {
namespace {

/// How many of `count` equal parts of (-range, range] (from 0 when `one_sided`), the first with its start, hold
/// `value`.
template <class Wall>
std::size_t holders(std::size_t count, double value, const Wall& wall, std::size_t& which)
{
    std::size_t found = 0;
    for (std::size_t i = 0; i < count; ++i) {
        const bool above = i == 0 ? value >= wall(i) : value > wall(i);
        if (above && value <= wall(i + 1)) {
            ++found;
            which = i;
        }
    }
    return found;
}

/// 10^6 random points of the space that the grid covers: each is in exactly one cell, by the ranges of the cells
/// themselves (eq. 6.50), and that is the one `locate` names.
TEST(GridLaws, AMillionPointsBelongToExactlyOneCellEach)
{
    constexpr std::uint64_t kSeed = 20261123;
    Random random(kSeed);
    const Grid<double> grid;
    for (int i = 0; i < 1000000; ++i) {
        const Polar<double> p{10.0 * std::cbrt(static_cast<double>(random.uniform())),
                              static_cast<double>(random.uniform(-1.0F, 1.0F)) * grid.horizontal(),
                              static_cast<double>(random.uniform(-1.0F, 1.0F)) * grid.vertical()};
        std::size_t layer = 0;
        std::size_t column = 0;
        std::size_t row = 0;
        const std::size_t layers = holders(
            grid.layers(), p.distance, [&](std::size_t n) { return n == 0 ? 0.0 : grid.layer_end(n - 1); }, layer);
        const std::size_t columns = holders(
            grid.columns(), p.horizontal, [&](std::size_t n) { return grid.column_start(n); }, column);
        const std::size_t rows = holders(
            grid.rows(), p.vertical, [&](std::size_t n) { return grid.row_start(n); }, row);
        ASSERT_EQ(layers * columns * rows, 1U) << "seed " << kSeed << ", point " << i;
        const Located at = grid.locate(p);
        ASSERT_EQ(at.status, LocateStatus::inside) << "seed " << kSeed << ", point " << i;
        // Within 1e-9 of a wall the tolerance decides.
        const auto near = [](double x, double wall) { return std::abs(x - wall) < 1e-7; };
        if (!near(p.distance, grid.layer_start(layer)) && !near(p.horizontal, grid.column_start(column)) &&
            !near(p.vertical, grid.row_start(row))) {
            ASSERT_EQ(at.place, (CellPlace{static_cast<std::uint8_t>(layer), static_cast<std::uint8_t>(column),
                                           static_cast<std::uint8_t>(row)}))
                << "seed " << kSeed << ", point " << i;
        }
    }
}

}  // namespace
}  // namespace jink::reach
