// SPDX-License-Identifier: BSD-3-Clause
// Intruder models: the check values of the avoidance specification, sections 2.2 to 2.7.
#include "tests/reference/reach/intruder.hpp"

#include <vector>

#include <gtest/gtest.h>

namespace jink::reach {
namespace {

struct Crossing {
    int layer, column, row;  // counted from 1, as the specification does
    float to;
};

void expect_crossings(const Vec3& position, const Vec3& velocity, float from, const std::vector<Crossing>& expected)
{
    const Grid<float> grid;
    CrossedCells crossed;
    cross(grid, position, velocity, crossed);
    // The first line goes through the vehicle's own place, where all cells join: rounding may add a cell there.
    std::vector<CellStay> cells;
    for (const CellStay& c : crossed) {
        if (c.stay.to - c.stay.from > 1e-5F) {
            cells.push_back(c);
        }
    }
    ASSERT_EQ(cells.size(), expected.size());
    for (std::size_t i = 0; i < cells.size(); ++i) {
        const CellPlace place = grid.place(cells[i].cell);
        EXPECT_EQ(place.layer + 1, expected[i].layer) << i;
        EXPECT_EQ(place.column + 1, expected[i].column) << i;
        EXPECT_EQ(place.row + 1, expected[i].row) << i;
        EXPECT_NEAR(cells[i].stay.from, i == 0 ? from : expected[i - 1].to, 1e-3F) << i;
        EXPECT_NEAR(cells[i].stay.to, expected[i].to, 1e-3F) << i;
    }
}

TEST(Intruders, ALineCrossesTheCellsOfTheCheckValues)
{
    expect_crossings(Vec3(12, 3, 0), Vec3(-2, -0.5F, 0), 1.149F,
                     {{10, 5, 3, 1.634F},
                      {9, 5, 3, 2.119F},
                      {8, 5, 3, 2.605F},
                      {7, 5, 3, 3.090F},
                      {6, 5, 3, 3.575F},
                      {5, 5, 3, 4.060F},
                      {4, 5, 3, 4.545F},
                      {3, 5, 3, 5.030F},
                      {2, 5, 3, 5.515F},
                      {1, 5, 3, 6.000F}});
    expect_crossings(Vec3(6, -8, 1), Vec3(0, 2, 0), 1.000F,
                     {{9, 1, 4, 1.402F},
                      {8, 1, 4, 2.115F},
                      {8, 2, 4, 2.268F},
                      {7, 2, 4, 2.950F},
                      {7, 3, 4, 3.662F},
                      {7, 4, 4, 4.338F},
                      {7, 5, 4, 5.050F},
                      {7, 6, 4, 5.732F},
                      {8, 6, 4, 5.885F},
                      {8, 7, 4, 6.598F},
                      {9, 7, 4, 7.000F}});
}

TEST(Intruders, TheBodyTakesTheTimesOfTheCheckValues)
{
    const Grid<float> grid;
    const float radii[] = {0.512F, 0.566F, 0.882F, 1.574F};
    const std::uint8_t layers[] = {0, 1, 4, 9};
    for (std::size_t i = 0; i < 4; ++i) {
        EXPECT_NEAR(sphere_of(grid, {layers[i], 3, 2}).radius, radii[i], 1e-3F) << i;
    }
    const CellSphere cell = sphere_of(grid, {7, 4, 2});
    EXPECT_NEAR((cell.centre - Vec3(7.3120F, 1.6689F, 0.0F)).norm(), 0.0F, 1e-3F);
    EXPECT_NEAR(cell.radius, 1.2875F, 1e-3F);
    Intruder intruder;
    intruder.position = Vec3(12, 3, 0);
    intruder.velocity = Vec3(-2, -0.5F, 0);
    intruder.radius = 1.0F;
    const std::optional<Stay> stay = body_in(cell, intruder);
    ASSERT_TRUE(stay);
    EXPECT_NEAR(stay->from, 1.2556F, 1e-3F);
    EXPECT_NEAR(stay->to, 3.4698F, 1e-3F);
    intruder.velocity = -intruder.velocity;
    EXPECT_FALSE(body_in(cell, intruder)) << "it flies away";
    intruder.velocity = Vec3::Zero();
    EXPECT_FALSE(body_in(cell, intruder));
    intruder.position = cell.centre + Vec3(2.2F, 0, 0);
    ASSERT_TRUE(body_in(cell, intruder));
    EXPECT_TRUE(std::isinf(body_in(cell, intruder)->to)) << "it stands there for ever";
}

TEST(Intruders, TimesThatMeetAreRated)
{
    EXPECT_FLOAT_EQ(time_rate({2, 4}, {3, 7}), 0.5F);
    EXPECT_FLOAT_EQ(time_rate({2, 4}, {0, 10}), 1.0F);
    EXPECT_EQ(time_rate({2, 4}, {4.5F, 6}), 0.0F);
    EXPECT_FLOAT_EQ(time_rate({2, 6}, {2.75F, 3.25F}), 0.125F);
    EXPECT_GT(time_rate({2, 6}, {3, 3}), 1e-7F) << "an instant is not lost";
    EXPECT_GT(time_rate({2, 4}, {4, 6}), 1e-7F) << "nor one that touches";
    EXPECT_EQ(time_rate({3, 3}, {2, 4}), 1.0F);
    EXPECT_EQ(time_rate({3, 3}, {3, 3}), 1.0F);
    EXPECT_EQ(time_rate({3, 3}, {3.1F, 4}), 0.0F);
}

}  // namespace
}  // namespace jink::reach
