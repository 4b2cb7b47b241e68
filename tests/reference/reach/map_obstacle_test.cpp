// SPDX-License-Identifier: BSD-3-Clause
// Obstacles of a map, by the reach-set specification, section 13.2, and the three cases of Gomola's figure 6.13.
#include "tests/reference/reach/map_obstacle.hpp"

#include <limits>
#include <vector>

#include <gtest/gtest.h>

namespace jink::reach {
namespace {

constexpr float kRightHand = 0.5F * kPi;

Closure look(const Grid<float>& grid, const CellPlace& place, const MapObstacle& obstacle, const GridPose& pose = {})
{
    return closure_of(grid, place, box_of(grid, place), in_grid(obstacle, pose));
}

/// A pillar in the middle of the cell straight ahead, layer 6.
MapObstacle pillar()
{
    MapObstacle obstacle;
    obstacle.shape = MapShape::cuboid;
    obstacle.position = Vec3(5.5F, 0, 0);
    obstacle.length = 0.2F;
    obstacle.width = 0.2F;
    obstacle.depth = 0.5F;
    obstacle.margin = 0.1F;
    return obstacle;
}
constexpr CellPlace kAhead{5, 3, 2};

/// Figure 6.13, obstacle o1: on the chart, in view of the sensor, and not detected: absent.
TEST(MapObstacles, Figure613ChartedAndVisibleButNotDetected)
{
    CellRating cell;
    cell.add_sensor(0.0F, 0.0F);
    add_map_obstacle(cell, look(Grid<float>(), kAhead, pillar()));
    EXPECT_EQ(cell.map(), 0.0F);
    EXPECT_EQ(cell.threat(), 0.0F);
    EXPECT_EQ(cell.level(), kFree);
}

/// Figure 6.13, charted and detected: as the sensor has it, usually 1.
TEST(MapObstacles, Figure613ChartedAndDetected)
{
    for (const float detected : {1.0F, 0.7F}) {
        CellRating cell;
        cell.add_sensor(0.0F, detected);
        add_map_obstacle(cell, look(Grid<float>(), kAhead, pillar()));
        EXPECT_EQ(cell.threat(), detected);
        EXPECT_EQ(cell.level(), 0U);
    }
}

/// Figure 6.13, charted and hidden behind one that takes 60 % of the view: 0.6 of the map's rating.
TEST(MapObstacles, Figure613ChartedAndHidden)
{
    const Grid<float> grid;
    std::vector<float> bodies(grid.cells());
    std::vector<float> margins(grid.cells());
    // A threshold of twice the pillar's volume: it is rated a half.
    const float volume = 0.2F * 0.2F * 0.5F;
    rate_by_cloud(grid, in_grid(pillar(), {}), {0.02F, 2.0F * volume}, bodies, margins);
    const float map = bodies[grid.index(kAhead)];
    EXPECT_NEAR(map, 0.5F, 1e-4F);
    CellRating graded;
    graded.add_sensor(0.6F, 0.0F);
    graded.add_map(map);
    EXPECT_FLOAT_EQ(graded.visibility(), 0.4F);
    EXPECT_FLOAT_EQ(graded.map(), 0.6F * map);
    CellRating whole;
    whole.add_sensor(0.6F, 0.0F);
    add_map_obstacle(whole, look(grid, kAhead, pillar()));
    EXPECT_FLOAT_EQ(whole.map(), 0.6F);
    EXPECT_EQ(whole.level(true), 0U) << "even where what nobody sees is allowed";
}

/// Body hard, margin soft, each where the other is not.
TEST(MapObstacles, BodiesAreHardAndMarginsSoft)
{
    const Grid<float> grid;
    MapObstacle sphere;
    sphere.position = Vec3(5.5F, 0, 0);
    sphere.margin = 1.0F;
    sphere.radius = 0.2F;
    EXPECT_EQ(look(grid, {5, 3, 2}, sphere), Closure::hard);
    EXPECT_EQ(look(grid, {4, 3, 2}, sphere), Closure::soft) << "0.5 away, 0.2 of which are body";
    EXPECT_EQ(look(grid, {6, 3, 2}, sphere), Closure::soft);
    EXPECT_EQ(look(grid, {5, 4, 2}, sphere), Closure::soft);
    EXPECT_EQ(look(grid, {3, 3, 2}, sphere), Closure::none);
    EXPECT_EQ(look(grid, {7, 3, 2}, sphere), Closure::none);
    EXPECT_EQ(look(grid, {5, 6, 2}, sphere), Closure::none);
    std::vector<float> bodies(grid.cells());
    std::vector<float> margins(grid.cells());
    const CloudReport report = rate_by_cloud(grid, in_grid(sphere, {}), {0.2F, 0.0F}, bodies, margins);
    EXPECT_FALSE(report.coarsened);
    EXPECT_EQ(bodies[grid.index({5, 3, 2})], 1.0F);
    EXPECT_EQ(bodies[grid.index({4, 3, 2})], 0.0F);
    EXPECT_EQ(margins[grid.index({4, 3, 2})], 1.0F);
    EXPECT_EQ(margins[grid.index({3, 3, 2})], 0.0F);
    // A margin is a soft constraint where no sensor covers the cell.
    CellRating cell;
    cell.add_sensor(0.5F, 0.0F);
    add_map_obstacle(cell, Closure::soft);
    EXPECT_TRUE(cell.is_soft());
    EXPECT_FALSE(cell.is_mapped());
    EXPECT_EQ(cell.level(true), static_cast<Level>(AvoidanceRun::soft_constraints));
    CellRating seen;
    seen.add_sensor(0.0F, 0.0F);
    add_map_obstacle(seen, Closure::soft);
    EXPECT_EQ(seen.level(), kFree);
    CellRating nothing;
    nothing.add_sensor(0.5F, 0.0F);
    add_map_obstacle(nothing, Closure::none);
    EXPECT_EQ(nothing.threat(), 0.0F);
}

/// A line's main axis: ahead, turned to the side, nose down, and on a grid with another heading.
TEST(MapObstacles, TheMainAxisTurnsAsTheConventionsSay)
{
    const Grid<float> grid;
    MapObstacle line;
    line.shape = MapShape::line;
    line.position = Vec3(5, 0, 0);
    line.length = 4.0F;
    line.margin = 0.05F;
    EXPECT_EQ(look(grid, {3, 3, 2}, line), Closure::hard) << "from 3 to 7 ahead";
    EXPECT_EQ(look(grid, {4, 5, 2}, line), Closure::none);
    line.yaw = kRightHand;
    EXPECT_EQ(look(grid, {3, 3, 2}, line), Closure::none);
    EXPECT_EQ(look(grid, {5, 4, 2}, line), Closure::hard) << "from 2 right to 2 left";
    EXPECT_EQ(look(grid, {5, 2, 2}, line), Closure::hard);
    line.yaw = 0.0F;
    line.pitch = 0.25F * kPi;
    const MapBody body = in_grid(line, {});
    EXPECT_NEAR(body.axes(2, 0), -std::sqrt(0.5F), 1e-6F) << "nose down";
    GridPose pose;
    pose.position = Vec3(5, -5, 0);
    pose.yaw = kRightHand;
    line.pitch = 0.0F;
    EXPECT_EQ(look(grid, {5, 4, 2}, line, pose), Closure::hard) << "across, seen from the south";
    pose.unit = 10.0F;
    EXPECT_EQ(look(grid, {0, 3, 2}, line, pose), Closure::hard) << "half a layer ahead";
    EXPECT_EQ(look(grid, {1, 3, 2}, line, pose), Closure::none);
}

/// Equation 6.101: the body's half diagonal and the margin reach towards the vehicle.
TEST(MapObstacles, SelectionIsByTheOutermostPoint)
{
    MapObstacle box;
    box.shape = MapShape::cuboid;
    box.length = 6.0F;
    box.width = 4.0F;
    box.depth = 12.0F;
    box.margin = 2.0F;
    const float outer = 7.0F + 2.0F;
    box.position = Vec3(100.0F + outer, 0, 0);
    EXPECT_TRUE(is_near(box, Vec3::Zero(), 100.0F));
    box.position.x() += 1e-3F;
    EXPECT_FALSE(is_near(box, Vec3::Zero(), 100.0F));
    MapObstacle sphere;
    sphere.radius = 3.0F;
    sphere.margin = 1.0F;
    sphere.position = Vec3(0, 104.0F, 0);
    EXPECT_TRUE(is_near(sphere, Vec3::Zero(), 100.0F));
    sphere.position = Vec3(0, 104.01F, 0);
    EXPECT_FALSE(is_near(sphere, Vec3::Zero(), 100.0F));
}

TEST(MapObstacles, EntriesAreRefusedByTheirCause)
{
    constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
    MapObstacle o;
    EXPECT_EQ(check(o), MapStatus::good) << "a point with a margin";
    o.margin = 0.0F;
    EXPECT_EQ(check(o), MapStatus::bad_margin) << "the source's 'margin < 0' is a misprint";
    o.margin = 1.0F;
    o.radius = -1.0F;
    EXPECT_EQ(check(o), MapStatus::bad_size);
    o.radius = 0.0F;
    o.pitch = kNaN;
    EXPECT_EQ(check(o), MapStatus::not_a_number);
    o.pitch = 0.0F;
    o.position.z() = kNaN;
    EXPECT_EQ(check(o), MapStatus::not_a_number);
    o.position.z() = 0.0F;
    o.shape = MapShape::line;
    EXPECT_EQ(check(o), MapStatus::bad_size);
    o.length = 1.0F;
    EXPECT_EQ(check(o), MapStatus::good);
    o.shape = MapShape::plane;
    EXPECT_EQ(check(o), MapStatus::bad_size);
    o.width = INFINITY;
    EXPECT_EQ(check(o), MapStatus::bad_size);
    o.width = 1.0F;
    EXPECT_EQ(check(o), MapStatus::good);
    o.shape = MapShape::cuboid;
    EXPECT_EQ(check(o), MapStatus::bad_size);
    o.depth = 1.0F;
    EXPECT_EQ(check(o), MapStatus::good);
}

/// Equation 6.105 to 6.107: with the volume of one point as the threshold a cell is one or nothing; rates add up to 1
/// at most. A cloud that would be too large is coarser, and worth the same.
TEST(MapObstacles, CloudsAreGradedAndBounded)
{
    const Grid<float> grid;
    std::vector<float> bodies(grid.cells());
    std::vector<float> margins(grid.cells());
    MapObstacle box = pillar();
    box.position = Vec3(8.5F, 0, 0);
    box.length = box.width = box.depth = 0.8F;
    const MapBody body = in_grid(box, {});
    const CloudReport binary = rate_by_cloud(grid, body, {0.1F, 0.0F}, bodies, margins);
    EXPECT_FALSE(binary.coarsened);
    EXPECT_EQ(binary.points, 11U * 11U * 11U - 8U - 12U * 9U) << "9^3 of the body, and what is within 0.1 of it";
    for (const float rating : bodies) {
        EXPECT_TRUE(rating == 0.0F || rating == 1.0F) << rating;
    }
    const CloudReport graded = rate_by_cloud(grid, body, {0.1F, 2.0F * 0.512F}, bodies, margins);
    EXPECT_EQ(graded.points, binary.points);
    EXPECT_NEAR(bodies[grid.index({8, 3, 2})], 0.5F, 1e-4F) << "all of its volume, half of what is one for sure";
    const CloudReport coarse = rate_by_cloud(grid, body, {0.01F, 2.0F * 0.512F}, bodies, margins);
    EXPECT_TRUE(coarse.coarsened);
    EXPECT_LE(coarse.points, kMaxCloudPoints);
    EXPECT_GT(coarse.points, 1500U);
    EXPECT_NEAR(bodies[grid.index({8, 3, 2})], 0.5F, 1e-4F);
    MapObstacle line;
    line.shape = MapShape::line;
    line.position = Vec3(8.5F, 0, 0);
    line.length = 0.5F;
    line.margin = 0.2F;
    rate_by_cloud(grid, in_grid(line, {}), {0.05F, 100.0F}, bodies, margins);
    EXPECT_EQ(bodies[grid.index({8, 3, 2})], 1.0F) << "without volume, but there";
    // A capsule of radius 0.2 about a line of 0.5.
    EXPECT_NEAR(margins[grid.index({8, 3, 2})], (kPi * 0.04F * 0.5F + 4.0F / 3.0F * kPi * 0.008F) / 100.0F, 1e-5F);
}

}  // namespace
}  // namespace jink::reach
