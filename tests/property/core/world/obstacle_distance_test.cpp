// SPDX-License-Identifier: BSD-3-Clause
#include "core/world/obstacle_distance.hpp"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "tests/property/core/world/separation_oracle.hpp"

namespace jink::world {
namespace {

using geometry::oracle::any_shape;
using geometry::oracle::case_count;
using geometry::oracle::in_cube;
using geometry::oracle::seed_of;
using geometry::oracle::swept_box_bounds;
using test::kPlenty;

/// Two-sided: obstacle_margin of solids is never above the true value, and below it by at most its stated accuracy.
TEST(ObstacleMargin, OfSolidsIsWithinItsFiguresOfTheTruth)
{
    const std::uint64_t seed = seed_of(20261124);
    Random random(seed);
    std::size_t clear = 0;
    std::size_t near_miss = 0;
    std::size_t overlapping = 0;
    double most_below = 0.0;
    const std::size_t cases = case_count(30000);
    for (std::size_t i = 0; i < cases; ++i) {
        std::vector<Point3> vertices;
        constexpr geometry::ShapeKind kKinds[] = {geometry::ShapeKind::box, geometry::ShapeKind::capsule,
                                                  geometry::ShapeKind::cylinder, geometry::ShapeKind::hull};
        const geometry::Shape shape =
            any_shape(random, kKinds[random.below(4)], in_cube(random, 20.0F), random.uniform(0.3F, 4.0F), vertices);
        Vec3 unused;
        float radius = 0.0F;
        const Vec3 half(random.uniform(0.3F, 1.5F), random.uniform(0.3F, 1.5F), random.uniform(0.3F, 1.5F));
        if (as_sphere(shape, half, unused, radius)) {
            continue;
        }
        Vec3 from = shape.centre + in_cube(random, 5.0F);
        const Vec3 way = random.below(3) == 0 ? Vec3(Vec3::Zero()) : in_cube(random, 4.0F);
        const double first = swept_box_bounds(half, from, from + way, shape, 1e-5).lower;
        if (first > 0.0 && random.below(2) == 0) {
            // Up to near contact.
            const Vec3 towards = (shape.centre - (from + 0.5F * way)).normalized();
            from += towards * (static_cast<float>(first) - random.uniform(0.0F, 0.08F));
        }
        const Vec3 to = from + way;
        const auto truth = swept_box_bounds(half, from, to, shape, 1e-5);
        const double sizes =
            double((from - shape.centre).norm() + way.norm() + half.norm()) + double(geometry::bounding_radius(shape));
        const double rounding = 3e-5 * sizes;
        WorkBudget budget(kPlenty);
        const double margin = double(obstacle_margin(half, from, to, shape, budget));
        const double reached = std::min(truth.lower, double(kObstacleReach));
        if (truth.lower > rounding) {
            ASSERT_LE(margin, truth.upper + 1e-4) << "seed " << seed << ", case " << i;
            ASSERT_GE(margin, reached - double(kObstacleResolution) - rounding) << "seed " << seed << ", case " << i;
            ASSERT_GE(margin, 0.0) << "seed " << seed << ", case " << i;
            most_below = std::max(most_below, reached - margin);
            ++clear;
            near_miss += truth.upper < double(kObstacleResolution) ? 1U : 0U;
        } else if (truth.upper <= 0.0) {
            ASSERT_LT(margin, 0.0) << "seed " << seed << ", case " << i;
            // The reduced box is clear; a box larger by the resolution is not.
            const double largest = double(half.maxCoeff());
            const double left = 1.0 + margin / largest;
            const Vec3 smaller = half * static_cast<float>(left);
            const Vec3 larger = half * static_cast<float>(std::min(left + double(kOverlapResolution), 1.0));
            if (left > 0.0) {
                ASSERT_GT(swept_box_bounds(smaller, from, to, shape, 1e-5).upper, 0.0) << "case " << i;
            }
            ASSERT_LE(swept_box_bounds(larger, from, to, shape, 1e-5).lower, rounding)
                << "seed " << seed << ", case " << i;
            ++overlapping;
        }
    }
    EXPECT_GT(clear, cases / 30);
    EXPECT_GT(near_miss, cases / 150);
    EXPECT_GT(overlapping, cases / 60);
    std::printf(
        "[ measured ] at most %.4f m below the distance; %zu clear, %zu of them nearer than the resolution, %zu "
        "overlaps\n",
        most_below, clear, near_miss, overlapping);
}

}  // namespace
}  // namespace jink::world
