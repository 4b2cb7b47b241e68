// SPDX-License-Identifier: BSD-3-Clause
// Static and moving constraints: the tests of the reach-set specification, section 13.3, and the check values of the
// avoidance specification, section 3.
#include "tests/reference/reach/barrel_closure.hpp"

#include <gtest/gtest.h>

#include "core/reach/barrel_table.hpp"

namespace jink::reach {
namespace {

/// Straight ahead, level, in the last layer: its far border is an arc of radius 10 about the vehicle.
constexpr CellPlace kLast{9, 3, 2};

/// Section 3, CHECK VALUES: centre (100, 50), velocity (-5, 2), known since 1000 s; at 1010 s the vehicle needs 3 s to
/// leave the cell: 13 s, centre (35, 76); radius 20, margin 10.
class MovingConstraint : public ::testing::Test {
protected:
    Grid<float> grid;
    Barrel barrel;
    static constexpr float kSince = (1010.0F + 3.0F) - 1000.0F;

    void SetUp() override
    {
        barrel.circle = {Vec2(100, 50), 20.0F};
        barrel.velocity = Vec2(-5, 2);
        barrel.margin = 10.0F;
        barrel.bottom = 0.0F;
        barrel.top = 100.0F;
    }
    /// With the cell's border at this distance from the centre's position at that time.
    Closure at_distance(float distance) const
    {
        GridPose pose;
        pose.position = Vec3(35.0F - (10.0F + distance), 76.0F, 50.0F);
        return closure_of(grid, kLast, pose, barrel, kSince, kSince);
    }
};

TEST_F(MovingConstraint, CheckValueOfTheShiftedCentre)
{
    EXPECT_EQ(kSince, 13.0F);
    // Only around the shifted body: a table of one constraint that has become static.
    const Barrel still = merged(barrel, barrel, kSince, kSince);
    EXPECT_NEAR(still.circle.centre.x(), 35.0F, 1e-3F);
    EXPECT_NEAR(still.circle.centre.y(), 76.0F, 1e-3F);
    EXPECT_NEAR(still.circle.radius, 20.0F, 1e-2F);
}

TEST_F(MovingConstraint, CheckValuesOfTheDistances)
{
    EXPECT_EQ(at_distance(20.0F), Closure::hard);
    EXPECT_EQ(at_distance(20.001F), Closure::soft);
    EXPECT_EQ(at_distance(30.0F), Closure::soft);
    EXPECT_EQ(at_distance(30.001F), Closure::none);
}

/// A stay's rating is never below the rating at any of its instants.
TEST_F(MovingConstraint, AStayIsNoLessThanItsInstants)
{
    GridPose pose;
    pose.position = Vec3(35.0F - 30.0F, 76.0F, 50.0F);
    EXPECT_EQ(closure_of(grid, kLast, pose, barrel, 10.0F, 13.0F), Closure::hard);
    EXPECT_EQ(closure_of(grid, kLast, pose, barrel, 13.0F, 16.0F), Closure::hard);
    EXPECT_EQ(closure_of(grid, kLast, pose, barrel, 0.0F, 1.0F), Closure::none);
}

/// Section 13.3: distance = radius is hard, radius + margin soft.
TEST(StandingConstraint, OnTheBorderItCounts)
{
    const Grid<float> grid;
    Barrel barrel;
    barrel.circle.radius = 5.0F;
    barrel.margin = 2.0F;
    barrel.top = 10.0F;
    GridPose pose;
    pose.position.z() = 5.0F;
    const auto at = [&](float x) {
        barrel.circle.centre = Vec2(x, 0);
        return closure_of(grid, kLast, pose, barrel, 0.0F, 1.0F);
    };
    EXPECT_EQ(at(15.0F), Closure::hard);
    EXPECT_EQ(at(15.001F), Closure::soft);
    EXPECT_EQ(at(17.0F), Closure::soft);
    EXPECT_EQ(at(17.001F), Closure::none);
}

/// Section 13.3: with the vehicle inside, every cell within the radius whose heights overlap is hard.
TEST(StandingConstraint, FromInsideAllIsHard)
{
    const Grid<float> grid;
    Barrel barrel;
    barrel.circle.radius = 12.0F;  // every cell's nearest point is within 9 + sqrt(5)
    barrel.bottom = 40.0F;
    barrel.top = 60.0F;
    GridPose pose;
    pose.position = Vec3(1.0F, 2.0F, 50.0F);
    pose.yaw = 1.0F;
    int hard = 0;
    for (CellIndex cell = 0; cell < grid.cells(); ++cell) {
        hard += closure_of(grid, grid.place(cell), pose, barrel, 0.0F, 1.0F) == Closure::hard ? 1 : 0;
    }
    EXPECT_EQ(hard, 350);
    // Heights in contact overlap; a band above does not affect the lower cells.
    barrel.bottom = 50.0F;
    EXPECT_EQ(closure_of(grid, {5, 3, 0}, pose, barrel, 0.0F, 1.0F), Closure::none);
    EXPECT_EQ(closure_of(grid, {5, 3, 4}, pose, barrel, 0.0F, 1.0F), Closure::hard);
    EXPECT_EQ(closure_of(grid, {5, 3, 2}, pose, barrel, 0.0F, 1.0F), Closure::hard);
    barrel.top = 50.0F;
    EXPECT_EQ(closure_of(grid, {5, 3, 2}, pose, barrel, 0.0F, 1.0F), Closure::hard);
    EXPECT_EQ(closure_of(grid, {0, 3, 2}, pose, barrel, 0.0F, 1.0F), Closure::hard);
}

}  // namespace
}  // namespace jink::reach
