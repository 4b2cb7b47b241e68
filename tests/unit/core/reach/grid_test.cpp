// SPDX-License-Identifier: BSD-3-Clause
// The avoidance grid: the derived figures of the reach-set specification, sections 8.3, 8.4 and 16.2.
#include "core/reach/grid.hpp"

#include <limits>

#include <gtest/gtest.h>

namespace jink::reach {
namespace {

constexpr double kDegree = 0.017453292519943295;

TEST(AvoidanceGrid, IsTheSources)
{
    const Grid<double> grid;
    EXPECT_EQ(grid.cells(), 350U);
    EXPECT_EQ(grid.cells() / grid.layers(), 35U);
    EXPECT_NEAR((grid.column_start(1) - grid.column_start(0)) / kDegree, 12.857, 1e-3);
    EXPECT_NEAR((grid.row_start(1) - grid.row_start(0)) / kDegree, 12.0, 1e-9);
    EXPECT_NEAR(grid.volume({0, 3, 2}), 0.0156374, 1e-7);
    EXPECT_NEAR(grid.volume({9, 3, 2}), 4.2377414, 1e-6);
    EXPECT_NEAR(grid.volume({9, 3, 4}), 3.8713693, 1e-6);
    double sum = 0.0;
    std::size_t outer = 0;
    for (CellIndex cell = 0; cell < grid.cells(); ++cell) {
        EXPECT_EQ(grid.index(grid.place(cell)), cell);
        sum += grid.volume(grid.place(cell));
        outer += grid.is_outer(grid.place(cell)) ? 1U : 0U;
    }
    EXPECT_NEAR(sum, 523.5988, 1e-4);
    EXPECT_EQ(outer, 215U);
}

/// A point on a face is in the cell before it; the first cell of each range includes its start.
TEST(AvoidanceGrid, FacesBelongToTheCellBefore)
{
    const Grid<double> grid;
    const auto place = [&](double distance, double horizontal, double vertical) {
        const Located at = grid.locate(from_polar(Polar<double>{distance, horizontal * kDegree, vertical * kDegree}));
        EXPECT_EQ(at.status, LocateStatus::inside) << distance << " " << horizontal << " " << vertical;
        return at.place;
    };
    for (int i = 1; i <= 10; ++i) {
        EXPECT_EQ(place(i, 0.0, 0.0), (CellPlace{static_cast<std::uint8_t>(i - 1), 3, 2}));
    }
    EXPECT_EQ(place(5.4, 45.0, 0.0).column, 6);
    EXPECT_EQ(place(5.4, -45.0, 0.0).column, 0);
    EXPECT_EQ(place(5.4, -45.0 + 90.0 / 7.0, 0.0).column, 0);
    EXPECT_EQ(place(5.4, 0.0, -30.0).row, 0);
    EXPECT_EQ(place(5.4, 0.0, 30.0).row, 4);
    EXPECT_EQ(place(5.4, 0.0, -18.0).row, 0);
    EXPECT_EQ(place(5.4, 0.0, -17.999).row, 1);
    EXPECT_EQ(grid.locate(Point<double>::Zero()).place, (CellPlace{0, 3, 2})) << "the vehicle's own place";
    const auto outside = [&](double distance, double horizontal, double vertical) {
        return grid.locate(from_polar(Polar<double>{distance, horizontal * kDegree, vertical * kDegree})).status ==
               LocateStatus::outside;
    };
    EXPECT_TRUE(outside(10.0001, 0.0, 0.0));
    EXPECT_TRUE(outside(5.0, 45.001, 0.0));
    EXPECT_TRUE(outside(5.0, -45.001, 0.0));
    EXPECT_TRUE(outside(5.0, 180.0, 0.0));
    EXPECT_TRUE(outside(5.0, 0.0, 30.001));
    EXPECT_TRUE(outside(5.0, 0.0, -30.001));
}

TEST(AvoidanceGrid, WhatIsNoNumberIsSaidSo)
{
    const Grid<float> grid;
    constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
    constexpr float kInfinity = std::numeric_limits<float>::infinity();
    EXPECT_EQ(grid.locate(Point<float>(kNaN, 0, 0)).status, LocateStatus::not_a_number);
    EXPECT_EQ(grid.locate(Point<float>(1, kNaN, 0)).status, LocateStatus::not_a_number);
    EXPECT_EQ(grid.locate(Point<float>(1, 0, kNaN)).status, LocateStatus::not_a_number);
    EXPECT_EQ(grid.locate(Point<float>(kInfinity, 0, 0)).status, LocateStatus::not_a_number);
}

}  // namespace
}  // namespace jink::reach
