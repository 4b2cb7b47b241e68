// SPDX-License-Identifier: BSD-3-Clause
// Map obstacles: the closed form against points of the obstacle in double; boxes of cells against points of them.
#include <gtest/gtest.h>

#include <cmath>
#include <tuple>
#include <utility>
#include <vector>

#include <Eigen/Geometry>

#include "core/base/random.hpp"
#include "tests/reference/reach/map_obstacle.hpp"

namespace jink::reach {
namespace {

using Place = Point<double>;

MapObstacle random_obstacle(Random& random)
{
    MapObstacle o;
    o.shape = static_cast<MapShape>(random.below(4));
    o.position = Vec3(random.uniform(-40.0F, 160.0F), random.uniform(-80.0F, 80.0F), random.uniform(0.0F, 120.0F));
    o.roll = random.uniform(-kPi, kPi);
    o.pitch = random.uniform(-1.5F, 1.5F);
    o.yaw = random.uniform(-kPi, kPi);
    o.margin = random.uniform(0.5F, 10.0F);
    o.length = random.uniform(0.5F, 60.0F);
    o.width = random.uniform(0.5F, 30.0F);
    o.depth = random.uniform(0.5F, 30.0F);
    o.radius = random.uniform(0.0F, 15.0F);
    return o;
}

/// A random point of the body or of its margin, in double and with explicit rotations.
Place random_point(Random& random, const MapObstacle& o, bool of_body)
{
    const auto within = [&](float size) { return 0.5 * static_cast<double>(size * random.uniform(-1.0F, 1.0F)); };
    Place p = Place::Zero();
    double about = of_body ? 0.0 : static_cast<double>(o.margin);
    switch (o.shape) {
    case MapShape::sphere: about += static_cast<double>(o.radius); break;
    case MapShape::line: p = Place(within(o.length), 0, 0); break;
    case MapShape::plane: p = Place(within(o.length), within(o.width), 0); break;
    case MapShape::cuboid: p = Place(within(o.length), within(o.width), within(o.depth)); break;
    }
    const double z = static_cast<double>(random.uniform(-1.0F, 1.0F));
    const double azimuth = static_cast<double>(random.uniform(-kPi, kPi));
    const double level = std::sqrt(1.0 - z * z);
    p += about * std::cbrt(static_cast<double>(random.uniform())) *
         Place(level * std::cos(azimuth), level * std::sin(azimuth), z);
    // Roll about x, then pitch about y (nose down), then yaw about z.
    const auto turned = [](double a, double b, double angle) {
        return std::pair(a * std::cos(angle) - b * std::sin(angle), a * std::sin(angle) + b * std::cos(angle));
    };
    std::tie(p.y(), p.z()) = turned(p.y(), p.z(), static_cast<double>(o.roll));
    std::tie(p.z(), p.x()) = turned(p.z(), p.x(), static_cast<double>(o.pitch));
    std::tie(p.x(), p.y()) = turned(p.x(), p.y(), static_cast<double>(o.yaw));
    return p + o.position.cast<double>();
}

/// Of a point in the world, seen from the grid.
Place seen_from(const GridPose& pose, const Place& p)
{
    const Place apart = (p - pose.position.cast<double>()) / static_cast<double>(pose.unit);
    const double c = std::cos(static_cast<double>(pose.yaw));
    const double s = std::sin(static_cast<double>(pose.yaw));
    return {c * apart.x() + s * apart.y(), -s * apart.x() + c * apart.y(), apart.z()};
}

/// 2000 obstacles, 2000 points each: a cell that a point of the body is in is hard, of the margin soft at least.
TEST(MapObstacleLaws, NoCellThatIsTouchedIsClear)
{
    constexpr std::uint64_t kSeed = 20261123;
    Random random(kSeed);
    const Grid<float> grids[] = {Grid<float>(), Grid<float>(4, 3, 3, 4.0F, 1.4F, 1.2F)};
    const Grid<double> exact[] = {Grid<double>(), Grid<double>(4, 3, 3, 4.0, 1.4, 1.2)};
    std::size_t inside = 0;
    std::size_t touched = 0;
    std::size_t said = 0;
    for (int i = 0; i < 2000; ++i) {
        const std::size_t g = random.below(2);
        const Grid<float>& grid = grids[g];
        const MapObstacle o = random_obstacle(random);
        ASSERT_EQ(check(o), MapStatus::good);
        GridPose pose;
        pose.position = Vec3(random.uniform(0.0F, 30.0F), random.uniform(-20.0F, 20.0F), random.uniform(30.0F, 90.0F));
        pose.yaw = random.uniform(-1.5F, 1.5F);
        pose.unit = random.uniform(1.0F, 20.0F);
        const MapBody body = in_grid(o, pose);
        std::vector<Closure> closures;
        for (CellIndex cell = 0; cell < grid.cells(); ++cell) {
            const CellPlace place = grid.place(cell);
            closures.push_back(closure_of(grid, place, box_of(grid, place), body));
        }
        std::vector<bool> hit(grid.cells(), false);
        for (int k = 0; k < 2000; ++k) {
            const bool of_body = k % 2 == 0;
            const Located at = exact[g].locate(seen_from(pose, random_point(random, o, of_body)));
            if (at.status != LocateStatus::inside) {
                continue;
            }
            ++inside;
            const CellIndex cell = grid.index(at.place);
            hit[cell] = true;
            ASSERT_NE(closures[cell], Closure::none) << "seed " << kSeed << ", case " << i << ", point " << k;
            if (of_body) {
                ASSERT_EQ(closures[cell], Closure::hard) << "seed " << kSeed << ", case " << i << ", point " << k;
            }
            ASSERT_TRUE(is_near(o, pose.position, pose.unit * grid.distance() * (1.0F + 1e-5F)));
        }
        for (std::size_t cell = 0; cell < grid.cells(); ++cell) {
            touched += hit[cell] ? 1U : 0U;
            said += closures[cell] == Closure::none ? 0U : 1U;
        }
    }
    EXPECT_GT(inside, 300000U);
    // Some cells without a sample are listed: corners of boxes, and cells missed by 2000 samples.
    EXPECT_LT(static_cast<double>(said), 2.0 * static_cast<double>(touched));
    RecordProperty("named_per_touched_percent", static_cast<int>(100 * said / touched));
}

/// The cloud computed on the fly overlaps no cell that the closed form calls clear, and its body no cell that it calls
/// soft.
TEST(MapObstacleLaws, TheCloudAgreesWithTheClosedForm)
{
    constexpr std::uint64_t kSeed = 12;
    Random random(kSeed);
    const Grid<float> grid;
    std::vector<float> bodies(grid.cells());
    std::vector<float> margins(grid.cells());
    std::size_t touched = 0;
    for (int i = 0; i < 3000; ++i) {
        GridPose pose;
        pose.position = Vec3(20.0F, 0.0F, 60.0F);
        pose.unit = 10.0F;
        const MapBody body = in_grid(random_obstacle(random), pose);
        const CloudReport report = rate_by_cloud(grid, body, {random.uniform(0.05F, 0.3F), 0.0F}, bodies, margins);
        ASSERT_LE(report.points, kMaxCloudPoints);
        for (CellIndex cell = 0; cell < grid.cells(); ++cell) {
            const CellPlace place = grid.place(cell);
            const Closure closure = closure_of(grid, place, box_of(grid, place), body);
            touched += bodies[cell] + margins[cell] > 0.0F ? 1U : 0U;
            ASSERT_TRUE(margins[cell] == 0.0F || closure != Closure::none) << "seed " << kSeed << ", case " << i;
            ASSERT_TRUE(bodies[cell] == 0.0F || closure == Closure::hard) << "seed " << kSeed << ", case " << i;
        }
    }
    EXPECT_GT(touched, 10000U);
}

/// The box of a cell contains the whole cell, and is tight along its own axis.
TEST(MapObstacleLaws, BoxesHoldTheirCells)
{
    constexpr std::uint64_t kSeed = 13;
    Random random(kSeed);
    const Grid<float> grids[] = {Grid<float>(), Grid<float>(4, 3, 3, 8.0F, 1.4F, 1.2F),
                                 Grid<float>(3, 1, 2, 6.0F, 3.0F, 1.5F), Grid<float>(2, 2, 1, 6.0F, 2.5F, 1.4F)};
    for (const Grid<float>& grid : grids) {
        for (CellIndex cell = 0; cell < grid.cells(); ++cell) {
            const CellPlace place = grid.place(cell);
            const CellBox box = box_of(grid, place);
            Vec3 most = Vec3::Zero();
            for (int k = 0; k < 1000; ++k) {
                const auto between = [&](float a, float b) {
                    const std::uint64_t pick = random.below(4);
                    return pick == 0 ? a : pick == 1 ? b : random.uniform(a, b);
                };
                const Vec3 p = from_polar(
                    Polar<float>{between(grid.layer_start(place.layer), grid.layer_end(place.layer)),
                                 between(grid.column_start(place.column), grid.column_start(place.column + 1U)),
                                 between(grid.row_start(place.row), grid.row_start(place.row + 1U))});
                const Vec3 local = (box.axes.transpose() * (p - box.centre)).cwiseAbs();
                most = most.cwiseMax(local);
                ASSERT_TRUE((local.array() <= box.half.array() + 1e-5F).all()) << "seed " << kSeed << ", cell " << cell;
            }
            ASSERT_GE(most.x(), 0.9F * box.half.x()) << "cell " << cell;
        }
    }
}

}  // namespace
}  // namespace jink::reach
