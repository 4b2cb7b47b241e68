// SPDX-License-Identifier: BSD-3-Clause
#include "core/world/obstacle_distance.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

#include <gtest/gtest.h>

#include "tests/property/core/world/separation_oracle.hpp"

namespace jink::world {
namespace {

using geometry::oracle::any_shape;
using geometry::oracle::case_count;
using geometry::oracle::in_cube;
using geometry::oracle::seed_of;
using geometry::oracle::swept_box_bounds;
using geometry::oracle::Vec3d;
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
        } else if (truth.upper <= 0.0 && shape.kind == geometry::ShapeKind::box) {
            ASSERT_LT(margin, 0.0) << "seed " << seed << ", case " << i;
            ++overlapping;
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

/// How far a box at rest has to be moved until it is apart from another one, by trying directions all around: not below
/// the truth, and above it by the directions' distance from the best one.
double way_out(const Vec3d& half, const Vec3d& offset, const geometry::Shape& box)
{
    const Eigen::Matrix3d axes = box.axes.cast<double>();
    const auto apart = [&](const Vec3d& to) {
        const double reach = half.dot(to.cwiseAbs()) + box.half.cast<double>().dot((axes.transpose() * to).cwiseAbs());
        return reach - offset.dot(to);
    };
    double least = std::min(apart(Vec3d::UnitZ()), apart(-Vec3d::UnitZ()));
    constexpr int kTurns = 7200;
    for (int i = 0; i < kTurns; ++i) {
        const double angle = 2.0 * double(kPi) * i / kTurns;
        least = std::min(least, apart(Vec3d(std::cos(angle), std::sin(angle), 0.0)));
    }
    return least;
}

/// Upright boxes: at rest the depth is the way out. On the way it is no less than that of any point of it, nor more
/// than what has to be cleared along any one axis.
TEST(ObstacleMargin, InsideABoxItIsTheWayOut)
{
    const std::uint64_t seed = seed_of(20261128);
    Random random(seed);
    std::size_t inside = 0;
    double most_above = 0.0;
    const std::size_t cases = case_count(500);
    for (std::size_t i = 0; i < cases; ++i) {
        const float angle = random.uniform(-kPi, kPi);
        const Mat3 axes = Eigen::AngleAxisf(angle, Vec3::UnitZ()).toRotationMatrix();
        const Vec3 size(random.uniform(0.05F, 12.0F), random.uniform(0.05F, 3.0F), random.uniform(0.5F, 15.0F));
        const geometry::Shape box = geometry::make_box(in_cube(random, 50.0F), size, axes);
        const Vec3 half(random.uniform(0.2F, 1.0F), random.uniform(0.2F, 1.0F), random.uniform(0.1F, 0.5F));
        const Vec3 from = box.centre + axes * Vec3(in_cube(random, 1.0F).cwiseProduct(size + half));
        const Vec3 way = in_cube(random, 2.0F);
        const auto margin = [&](const Vec3& a, const Vec3& b) {
            WorkBudget budget(kPlenty);
            return double(obstacle_margin(half, a, b, box, budget));
        };
        const auto truth = [&](double t) {
            const Vec3d at = from.cast<double>() + t * way.cast<double>() - box.centre.cast<double>();
            return way_out(half.cast<double>(), at, box);
        };
        const double rounding = 3e-5 * double((from - box.centre).norm() + half.norm() + size.norm()) + 1e-4;
        // Directions are 0.05 degrees apart.
        const double slant = rounding + 4.5e-4 * double((from - box.centre).norm() + half.norm() + size.norm());
        const double still = truth(0.0);
        if (still > rounding) {
            ASSERT_LE(-margin(from, from), still + rounding) << "seed " << seed << ", case " << i;
            ASSERT_GE(-margin(from, from), still - slant) << "seed " << seed << ", case " << i;
            ++inside;
        } else if (still < -rounding) {
            ASSERT_GE(margin(from, from), 0.0) << "seed " << seed << ", case " << i;
        }
        double deepest = -1e9;
        for (int k = 0; k <= 20; ++k) {
            deepest = std::max(deepest, truth(0.05 * k));
        }
        if (deepest > rounding) {
            const double found = -margin(from, Vec3(from + way));
            ASSERT_GE(found, deepest - slant) << "seed " << seed << ", case " << i;
            ASSERT_LE(found, double((half + axes.cwiseAbs() * size).minCoeff()) + rounding);
            most_above = std::max(most_above, found - deepest);
        }
    }
    EXPECT_GT(inside, cases / 10);
    std::printf("[ measured ] %zu inside; along a way up to %.3f m deeper than its deepest point\n", inside,
                most_above);
}

}  // namespace
}  // namespace jink::world
