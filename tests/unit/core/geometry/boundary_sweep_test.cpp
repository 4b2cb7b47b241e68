// SPDX-License-Identifier: BSD-3-Clause
// Closed forms where they change: the slowest speed that counts, points with exactly crossing paths, the first of many
// equally near instants, every side of a box.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "core/base/random.hpp"
#include "core/base/work_units.hpp"
#include "core/geometry/convex.hpp"
#include "core/geometry/quick_reject.hpp"
#include "core/geometry/sweep.hpp"
#include "core/geometry/swept_box.hpp"

namespace jink::geometry {
namespace {

const Vec3 kOrigin = Vec3::Zero();

TEST(SweepBorder, TheSlowestSpeedThatCountsArrivesInItsTime)
{
    // 1e-18 m/s is no rest: 4 m take 4e18 s. Below it nothing moves.
    const float slowest = 1e-18F;
    const float slower = std::nextafter(slowest, 0.0F);
    for (int axis = 0; axis < 3; ++axis) {
        for (const float side : {-1.0F, 1.0F}) {
            const Vec3 at = side * 6.0F * Vec3::Unit(axis);
            const Motion coming{at, -side * slowest * Vec3::Unit(axis)};
            const Motion resting{at, -side * slower * Vec3::Unit(axis)};
            const auto of_box = contact_interval(Vec3::Ones(), {}, coming, 1.0F, 1e19F);
            ASSERT_TRUE(of_box);
            EXPECT_NEAR(of_box->first * 1e-18F, 4.0F, 1e-4F);
            EXPECT_NEAR(of_box->last * 1e-18F, 8.0F, 1e-4F);
            const auto of_sphere = contact_interval({}, coming, 2.0F, 1e19F);
            ASSERT_TRUE(of_sphere);
            EXPECT_NEAR(of_sphere->first * 1e-18F, 4.0F, 1e-4F);
            EXPECT_NEAR(of_sphere->last * 1e-18F, 8.0F, 1e-4F);
            EXPECT_FALSE(contact_interval(Vec3::Ones(), {}, resting, 1.0F, 1e19F));
            EXPECT_FALSE(contact_interval({}, resting, 2.0F, 1e19F));
            const Approach approach = least_distance(Vec3::Ones(), {}, coming, 1e19F);
            EXPECT_NEAR(approach.distance, 0.0F, 1e-5F);
            EXPECT_NEAR(approach.when * 1e-18F, 5.0F, 1e-4F);
            EXPECT_EQ(least_distance(Vec3::Ones(), {}, resting, 1e19F).distance, 5.0F);
        }
    }
}

TEST(SweepBorder, PointsWhoseWaysCrossTouch)
{
    // No box, no radius: the plane of both paths contains the single point.
    EXPECT_EQ(swept_distance(kOrigin, -Vec3::UnitX(), Vec3::UnitX(), -Vec3::UnitY(), Vec3::UnitY()), 0.0F);
    EXPECT_EQ(swept_distance(kOrigin, Vec3(-3.0F, 1.0F, 2.0F), Vec3(1.0F, 1.0F, 2.0F), Vec3(0.0F, 1.0F, -2.0F),
                             Vec3(0.0F, 1.0F, 3.0F)),
              0.0F);
    // A flat box in their plane, and one that moves edgewise.
    EXPECT_EQ(swept_distance(Vec3(0.5F, 0.5F, 0.0F), -Vec3::UnitX(), Vec3::UnitX(), -4.0F * Vec3::UnitY(),
                             4.0F * Vec3::UnitY()),
              0.0F);
    EXPECT_EQ(swept_distance(Vec3(0.5F, 0.5F, 0.0F), -Vec3::UnitX(), Vec3::UnitX(), Vec3(0.0F, -4.0F, 2.0F),
                             Vec3(0.0F, 4.0F, 2.0F)),
              2.0F);
}

TEST(SweepBorder, TheFirstOfManyInstantsThatAreEquallyNearIsReported)
{
    // Straight through the box: nearest from where it enters to where it leaves.
    for (std::uint64_t seed = 1; seed <= 20'000; ++seed) {
        Random random(seed);
        const auto any = [&](float side) {
            return Vec3(random.uniform(-side, side), random.uniform(-side, side), random.uniform(-side, side));
        };
        const Vec3 half = any(1.0F).cwiseAbs() + Vec3::Constant(1.0F);
        const Vec3 from = any(10.0F);
        const Seconds duration = random.uniform(1.0F, 8.0F);
        const Vec3 velocity = (0.9F * half.cwiseProduct(any(1.0F)) - from) / duration;  // inside of it at `duration`
        const Approach approach = least_distance(half, {}, {from, velocity}, 2.0F * duration);
        double entry = 0;
        for (int i = 0; i < 3; ++i) {
            const double speed = std::abs(double(velocity[i]));
            const double place = velocity[i] < 0.0F ? -double(from[i]) : double(from[i]);
            entry = std::max(entry, speed > 0 ? (-double(half[i]) - place) / speed : 0.0);
        }
        ASSERT_LE(approach.distance, 1e-5F) << "seed " << seed;
        // Its speed is at least its distance through the slab over the remaining time.
        ASSERT_NEAR(double(approach.when), entry, 1e-3) << "seed " << seed;
    }
}

TEST(SweepBorder, TheBoxDistanceKnowsEverySide)
{
    const Vec3 half(1.0F, 2.0F, 3.0F);
    for (int axis = 0; axis < 3; ++axis) {
        for (const float side : {-1.0F, 1.0F}) {
            const Vec3 out = side * Vec3::Unit(axis);
            EXPECT_EQ(box_distance(half, out * (half[axis] + 4.0F)), 4.0F);
            EXPECT_EQ(box_distance(half, out * half[axis]), 0.0F);
            EXPECT_EQ(box_distance(half, out * (0.5F * half[axis])), 0.0F);
            EXPECT_GT(box_distance(half, out * std::nextafter(half[axis], 9.0F)), 0.0F);
        }
    }
    EXPECT_EQ(box_distance(half, Vec3(-4.0F, 6.0F, -3.0F)), 5.0F);
    EXPECT_EQ(box_distance(kOrigin, Vec3(2.0F, -3.0F, 6.0F)), 7.0F);
    for (std::uint64_t seed = 1; seed <= 1'000; ++seed) {
        Random random(seed);
        const Vec3 point(random.uniform(-9.0F, 9.0F), random.uniform(-9.0F, 9.0F), random.uniform(-9.0F, 9.0F));
        ASSERT_EQ(box_distance(half, point), least_distance(half, {}, {point, kOrigin}, 1.0F).distance)
            << "sweep.hpp: to the last bit, seed " << seed;
    }
}

TEST(SweepBorder, TheQuickRejectKeepsOffTheBorderByItsShareOfAllLengths)
{
    // 1e-5 of both places, the box and the radius together. A static point above the box.
    const auto at_gap = [](const Vec3& half, float radius, float share) {
        const float most = half.z() + radius;
        const float sizes = 2.0F * most + half.sum() + radius;
        const Vec3 place(0.0F, 0.0F, most + share * 1e-5F * sizes);
        return quick_reject(half, place, place, radius);
    };
    for (const Vec3& half : {kOrigin, Vec3(0.0F, 0.0F, 1.0F), Vec3(5.0F, 1.0F, 0.5F)}) {
        for (const float radius : {0.5F, 8.0F}) {
            EXPECT_EQ(at_gap(half, radius, 0.9F), QuickReject::unclear);
            EXPECT_EQ(at_gap(half, radius, 1.1F), QuickReject::apart);
        }
    }
}

TEST(SweepBorder, ASphereIsAPointMovedPastTheBox)
{
    // Queries for a sphere by shape and by centre give the same result, to the last bit.
    for (std::uint64_t seed = 1; seed <= 2'000; ++seed) {
        Random random(seed);
        const auto any = [&](float side) {
            return Vec3(random.uniform(-side, side), random.uniform(-side, side), random.uniform(-side, side));
        };
        const Vec3 half = any(2.0F).cwiseAbs();
        const Vec3 from = any(9.0F);
        const Vec3 to = any(9.0F);
        const Shape sphere = make_sphere(any(9.0F), random.uniform());
        const detail::SweptBox box{half, from, to};
        const float distance = least_distance(half, {from, to - from}, {sphere.centre, kOrigin}, 1.0F).distance;
        WorkBudget budget(units::kSphereQuery);
        ASSERT_EQ(swept_box_distance(half, from, to, sphere, 100.0F, 0.0F, budget),
                  std::max(distance - sphere.radius - box.slack(sphere), 0.0F))
            << "seed " << seed;
        ASSERT_EQ(budget.left(), 0U);
    }
}

}  // namespace
}  // namespace jink::geometry
