// SPDX-License-Identifier: BSD-3-Clause
// Cells and cylinders against samples of them.
#include <gtest/gtest.h>

#include <cmath>

#include "core/base/random.hpp"
#include "tests/reference/reach/cylinder_closure.hpp"

namespace jink::reach {
namespace {

/// No point of a cell is nearer than the level distance, and some point is as near.
TEST(CylinderClosureLaws, TheLevelDistanceIsThatOfTheNearestSample)
{
    constexpr std::uint64_t kSeed = 9;
    Random random(kSeed);
    const Grid<float> grids[] = {Grid<float>(), Grid<float>(4, 3, 4, 8.0F, 1.4F, 1.2F)};
    for (int i = 0; i < 2000; ++i) {
        const Grid<float>& grid = grids[random.below(2)];
        const CellPlace place = grid.place(static_cast<CellIndex>(random.below(grid.cells())));
        const Vec2 point(random.uniform(-12.0F, 12.0F), random.uniform(-12.0F, 12.0F));
        const float distance = level_distance(grid, place, point);
        const Heights heights = heights_of(grid, place);
        float nearest = 1e9F;
        constexpr int kSteps = 12;
        for (int a = 0; a <= kSteps; ++a) {
            for (int b = 0; b <= kSteps; ++b) {
                for (int c = 0; c <= kSteps; ++c) {
                    const auto between = [](float from, float to, int step) {
                        return from + (to - from) * static_cast<float>(step) / kSteps;
                    };
                    const Vec3 sample = from_polar(
                        Polar<float>{between(grid.layer_start(place.layer), grid.layer_end(place.layer), a),
                                     between(grid.column_start(place.column), grid.column_start(place.column + 1U), b),
                                     between(grid.row_start(place.row), grid.row_start(place.row + 1U), c)});
                    nearest = std::min(nearest, (sample.head<2>() - point).norm());
                    ASSERT_GE(sample.z(), heights.bottom - 1e-4F);
                    ASSERT_LE(sample.z(), heights.top + 1e-4F);
                }
            }
        }
        ASSERT_LE(distance, nearest + 1e-4F) << "seed " << kSeed << ", case " << i;
        const float spacing = grid.layer_end(place.layer) * 1.0F * 2.0F * grid.horizontal() /
                                  (static_cast<float>(grid.columns()) * kSteps) +
                              grid.distance() / (static_cast<float>(grid.layers()) * kSteps) + 0.6F;
        ASSERT_GE(distance, nearest - spacing) << "seed " << kSeed << ", case " << i;
    }
}

/// A point of a cell that is within a cylinder at some time of the stay makes the cell hard; within its margin, soft at
/// least.
TEST(CylinderClosureLaws, NothingWithinIsMissed)
{
    constexpr std::uint64_t kSeed = 10;
    Random random(kSeed);
    const Grid<float> grid;
    int hard = 0;
    for (int i = 0; i < 200000; ++i) {
        GridPose pose;
        pose.position =
            Vec3(random.uniform(-500.0F, 500.0F), random.uniform(-500.0F, 500.0F), random.uniform(20.0F, 100.0F));
        pose.yaw = random.uniform(-kPi, kPi);
        pose.unit = random.uniform(1.0F, 15.0F);
        const CellPlace place = grid.place(static_cast<CellIndex>(random.below(grid.cells())));
        const Polar<float> at{random.uniform(grid.layer_start(place.layer), grid.layer_end(place.layer)),
                              random.uniform(grid.column_start(place.column), grid.column_start(place.column + 1U)),
                              random.uniform(grid.row_start(place.row), grid.row_start(place.row + 1U))};
        const Vec3 in_grid = pose.unit * from_polar(at);
        const Vec3 point =
            pose.position + Vec3(std::cos(pose.yaw) * in_grid.x() - std::sin(pose.yaw) * in_grid.y(),
                                 std::sin(pose.yaw) * in_grid.x() + std::cos(pose.yaw) * in_grid.y(), in_grid.z());
        Cylinder cylinder;
        cylinder.velocity =
            i % 3 == 0 ? Vec2(Vec2::Zero()) : Vec2(random.uniform(-15.0F, 15.0F), random.uniform(-15.0F, 15.0F));
        cylinder.circle.radius = random.uniform(0.0F, 60.0F);
        cylinder.margin = random.uniform(0.0F, 30.0F);
        const float angle = random.uniform(-kPi, kPi);
        const float away = random.uniform(0.0F, 1.2F) * (cylinder.circle.radius + cylinder.margin);
        const float from = random.uniform(0.0F, 5.0F);
        const float to = from + random.uniform(0.0F, 3.0F);
        const float when = random.uniform(from, to);
        cylinder.circle.centre =
            point.head<2>() + away * Vec2(std::cos(angle), std::sin(angle)) - when * cylinder.velocity;
        cylinder.bottom = point.z() - random.uniform(0.0F, 40.0F);
        cylinder.top = point.z() + random.uniform(0.0F, 40.0F);
        const Closure closure = closure_of(grid, place, pose, cylinder, from, to);
        constexpr float kRounding = 2e-3F;
        if (away <= cylinder.circle.radius - kRounding) {
            ASSERT_EQ(closure, Closure::hard) << "seed " << kSeed << ", case " << i;
            ++hard;
        } else if (away <= cylinder.circle.radius + cylinder.margin - kRounding) {
            ASSERT_NE(closure, Closure::none) << "seed " << kSeed << ", case " << i;
        }
    }
    EXPECT_GT(hard, 50000);
}

}  // namespace
}  // namespace jink::reach
