// SPDX-License-Identifier: BSD-3-Clause
// Ratings from scans: figures of the reach-set specification, section 13.1.
#include "core/reach/lidar_scan.hpp"

#include <array>
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

namespace jink::reach {
namespace {

constexpr float kScanDegree = 0.0174532925F;

TEST(LidarScans, AreasAreThoseOfTheDerivedFigures)
{
    const Grid<float> grid;
    EXPECT_NEAR(area_of(grid, 0, 2, 5.0F), 1.1728066F, 1e-5F);
    EXPECT_NEAR(area_of(grid, 6, 2, 10.0F), 4.6912265F, 2e-5F);
    EXPECT_NEAR(area_of(grid, 3, 2, 9.5F), 4.2338319F, 2e-5F);
    const Grid<float> sphere(1, 1, 1, 1.0F, kPi, 0.5F * kPi);
    EXPECT_NEAR(area_of(sphere, 0, 0, 1.0F), 4.0F * kPi, 1e-4F);
}

/// Points in the middle of a cell.
void hit(LidarScan& scan, const Grid<float>& grid, const CellPlace& place, int count)
{
    for (int i = 0; i < count; ++i) {
        ASSERT_EQ(scan.add(Point<float>(grid.centre(place))), PointStatus::counted);
    }
}

/// Figure 6.12: rays stopped in a layer are missing in all layers behind.
TEST(LidarScans, VisibilityFallsBehindWhatStopsRays)
{
    const Grid<float> grid;
    LidarScan scan;
    // 20 rays in each direction: 4 across 12.857 degrees, 5 up 12.
    ASSERT_TRUE(scan.configure(grid, 90.0F / 28.0F * kScanDegree, 2.4F * kScanDegree));
    ASSERT_EQ(scan.rays(3, 2), 20U);
    std::array<float, 10> v{};
    const auto expect = [&](std::initializer_list<float> steps, std::initializer_list<int> until) {
        scan.visibility(3, 2, v);
        int layer = 0;
        auto value = steps.begin();
        for (const int end : until) {
            for (; layer < end; ++layer) {
                EXPECT_NEAR(v[static_cast<std::size_t>(layer)], *value, 1e-6F) << "layer " << layer + 1;
            }
            ++value;
        }
    };
    expect({1.0F}, {10});
    hit(scan, grid, {2, 3, 2}, 5);
    expect({1.0F, 0.75F}, {3, 10});
    hit(scan, grid, {4, 3, 2}, 3);
    expect({1.0F, 0.75F, 0.60F}, {3, 5, 10});
    hit(scan, grid, {6, 3, 2}, 4);
    expect({1.0F, 0.75F, 0.60F, 0.40F}, {3, 5, 7, 10});
}

/// The same plate at 5 m and at 10 m: a quarter of the hits, the same rating but for whole rays.
TEST(LidarScans, APlateIsRatedAlikeNearAndFar)
{
    const Grid<float> grid(10, 7, 5, 12.0F, 45.0F * kScanDegree, 30.0F * kScanDegree);
    LidarScan scan;
    ASSERT_TRUE(scan.configure(grid, 0.2F * kScanDegree, 0.2F * kScanDegree));
    const auto rating = [&](float distance) {
        scan.begin();
        // A plate of 0.1 m2 across the middle direction.
        const float half = 0.5F * std::sqrt(0.1F) / distance;
        Located at;
        for (float h = -half; h <= half; h += 0.2F * kScanDegree) {
            for (float v = -half; v <= half; v += 0.2F * kScanDegree) {
                const Polar<float> point{distance, h, v};
                EXPECT_EQ(scan.add(point), PointStatus::counted);
                at = grid.locate(point);
            }
        }
        return scan.obstacle(at.place, 0.5F);
    };
    const float near = rating(5.0F);
    const float far = rating(10.0F);
    EXPECT_NEAR(near, 0.2F, 0.03F);
    EXPECT_NEAR(far, near, 0.03F);
}

TEST(LidarScans, EveryPointIsAnsweredFor)
{
    const Grid<float> grid;
    LidarScan scan;
    EXPECT_EQ(scan.add(Point<float>(1, 0, 0)), PointStatus::outside) << "not configured";
    EXPECT_FALSE(scan.configure(grid, 20.0F * kScanDegree, 2.0F * kScanDegree)) << "columns without a ray";
    EXPECT_FALSE(scan.configure(grid, 0.0F, 1.0F));
    EXPECT_FALSE(scan.configure(Grid<float>(16, 16, 16, 1.0F, 1.0F, 1.0F), 0.01F, 0.01F)) << "too large";
    ASSERT_TRUE(scan.configure(grid, 1.0F * kScanDegree, 1.0F * kScanDegree));
    EXPECT_EQ(scan.add(Point<float>(5, 0, 0)), PointStatus::counted);
    EXPECT_EQ(scan.add(Point<float>(11, 0, 0)), PointStatus::beyond);
    EXPECT_EQ(scan.add(Point<float>(-5, 0, 0)), PointStatus::outside);
    EXPECT_EQ(scan.add(Point<float>(5, 0, 9)), PointStatus::outside);
    EXPECT_EQ(scan.add(Point<float>(std::numeric_limits<float>::quiet_NaN(), 0, 0)), PointStatus::not_a_number);
    EXPECT_EQ(scan.points(), 1U);
    // More points than rays: no share above 1, and counters that do not wrap.
    for (int i = 0; i < 70000; ++i) {
        scan.add(Point<float>(5, 0, 0));
    }
    EXPECT_EQ(scan.hindrance({4, 3, 2}), 1.0F);
    EXPECT_EQ(scan.obstacle({4, 3, 2}, 0.1F), 1.0F);
}

}  // namespace
}  // namespace jink::reach
