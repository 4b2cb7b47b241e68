// SPDX-License-Identifier: BSD-3-Clause
#include "core/geometry/sweep.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace jink::geometry {
namespace {

const Vec3 kSweepHalf(1.0F, 2.0F, 3.0F);
const Vec3 kNowhere = Vec3::Zero();

Motion at(float x, float y, float z) { return {Vec3(x, y, z), kNowhere}; }
Motion moving(const Vec3& position, const Vec3& velocity) { return {position, velocity}; }

TEST(ContactInterval, CrossesTheBoxFaceToFace)
{
    const auto contact = contact_interval(kSweepHalf, {}, moving({-5.0F, 0.0F, 0.0F}, {2.0F, 0.0F, 0.0F}), 1.0F, 10.0F);
    ASSERT_TRUE(contact);
    EXPECT_NEAR(contact->first, 1.5F, 1e-5F);
    EXPECT_NEAR(contact->last, 3.5F, 1e-5F);
}

TEST(ContactInterval, BothMovingIsTheRelativeMotion)
{
    const auto contact = contact_interval(kSweepHalf, moving({0.0F, 0.0F, 0.0F}, {-1.0F, 0.0F, 0.0F}),
                                          moving({-5.0F, 0.0F, 0.0F}, {1.0F, 0.0F, 0.0F}), 1.0F, 10.0F);
    ASSERT_TRUE(contact);
    EXPECT_NEAR(contact->first, 1.5F, 1e-5F);
    EXPECT_NEAR(contact->last, 3.5F, 1e-5F);
}

TEST(ContactInterval, RoundsTheCornerInsteadOfFillingIt)
{
    // Passing the edge x = 1, y = 2 at 0.8 in both axes: 1.13 away, outside of a sphere of 1 but inside of the square
    // corner.
    EXPECT_FALSE(contact_interval(kSweepHalf, {}, moving({1.8F, 2.8F, -9.0F}, {0.0F, 0.0F, 1.0F}), 1.0F, 100.0F));
    // The same at 0.7: 0.99 away.
    EXPECT_TRUE(contact_interval(kSweepHalf, {}, moving({1.7F, 2.7F, -9.0F}, {0.0F, 0.0F, 1.0F}), 1.0F, 100.0F));
    // Past the corner (1, 2, 3), diagonally: 0.6 in each axis is 1.04 away, 0.57 is 0.99.
    EXPECT_FALSE(contact_interval(kSweepHalf, {}, moving({5.6F, -1.4F, 3.6F}, {-1.0F, 1.0F, 0.0F}), 1.0F, 100.0F));
    EXPECT_TRUE(contact_interval(kSweepHalf, {}, moving({5.57F, -1.43F, 3.57F}, {-1.0F, 1.0F, 0.0F}), 1.0F, 100.0F));
}

TEST(ContactInterval, WhatIsNotANumberIsContact)
{
    const float nan = std::numeric_limits<float>::quiet_NaN();
    const Motion far = moving({50.0F, 0.0F, 0.0F}, {0.0F, 1.0F, 0.0F});
    ASSERT_FALSE(contact_interval(kSweepHalf, {}, far, 1.0F, 5.0F));
    EXPECT_TRUE(contact_interval(kSweepHalf, {}, far, nan, 5.0F));
    EXPECT_TRUE(contact_interval(Vec3(nan, 1.0F, 1.0F), {}, far, 1.0F, 5.0F));
    EXPECT_TRUE(contact_interval(kSweepHalf, {}, moving({nan, 0.0F, 0.0F}, {0.0F, 1.0F, 0.0F}), 1.0F, 5.0F));
    EXPECT_TRUE(contact_interval(kSweepHalf, {}, moving({50.0F, 0.0F, 0.0F}, {nan, 0.0F, 0.0F}), 1.0F, 5.0F));
    EXPECT_TRUE(contact_interval({}, at(50.0F, 0.0F, 0.0F), nan, 5.0F)) << "spheres at rest";
    EXPECT_TRUE(contact_interval({}, at(nan, 0.0F, 0.0F), 1.0F, 5.0F));
}

TEST(ContactInterval, TouchingAFaceCounts)
{
    const auto along = contact_interval(kSweepHalf, {}, moving({2.0F, -10.0F, 0.0F}, {0.0F, 1.0F, 0.0F}), 1.0F, 100.0F);
    ASSERT_TRUE(along);
    EXPECT_NEAR(along->first, 8.0F, 0.01F);
    EXPECT_NEAR(along->last, 12.0F, 0.01F);
    EXPECT_TRUE(contact_interval(kSweepHalf, {}, at(2.0F, 0.0F, 0.0F), 1.0F, 1.0F));
    EXPECT_FALSE(contact_interval(kSweepHalf, {}, at(2.0001F, 0.0F, 0.0F), 1.0F, 1.0F));
}

TEST(ContactInterval, StartingInsideBeginsAtZero)
{
    const auto leaving = contact_interval(kSweepHalf, {}, moving(kNowhere, {1.0F, 0.0F, 0.0F}), 1.0F, 10.0F);
    ASSERT_TRUE(leaving);
    EXPECT_EQ(leaving->first, 0.0F);
    EXPECT_NEAR(leaving->last, 2.0F, 1e-5F);
    const auto staying = contact_interval(kSweepHalf, {}, at(0.5F, 0.0F, 0.0F), 0.0F, 7.0F);
    ASSERT_TRUE(staying);
    EXPECT_EQ(staying->first, 0.0F);
    EXPECT_EQ(staying->last, 7.0F);
}

TEST(ContactInterval, OutsideTheHorizonDoesNotCount)
{
    const Motion threat = moving({-5.0F, 0.0F, 0.0F}, {2.0F, 0.0F, 0.0F});
    EXPECT_FALSE(contact_interval(kSweepHalf, {}, threat, 1.0F, 1.49F));
    const auto clipped = contact_interval(kSweepHalf, {}, threat, 1.0F, 2.0F);
    ASSERT_TRUE(clipped);
    EXPECT_EQ(clipped->last, 2.0F);
    // Already past.
    EXPECT_FALSE(contact_interval(kSweepHalf, {}, moving({5.0F, 0.0F, 0.0F}, {2.0F, 0.0F, 0.0F}), 1.0F, 100.0F));
}

TEST(ContactInterval, ABoxWithoutSizeIsASphere)
{
    const Motion threat = moving({-5.0F, 0.6F, 0.0F}, {2.0F, 0.0F, 0.0F});
    const auto box = contact_interval(kNowhere, {}, threat, 1.0F, 10.0F);
    const auto sphere = contact_interval({}, threat, 1.0F, 10.0F);
    ASSERT_TRUE(box && sphere);
    EXPECT_NEAR(box->first, 2.1F, 1e-5F);
    EXPECT_NEAR(box->last, 2.9F, 1e-5F);
    EXPECT_NEAR(sphere->first, 2.1F, 1e-5F);
    EXPECT_NEAR(sphere->last, 2.9F, 1e-5F);
}

TEST(ContactInterval, PointAndPointMeetAtOneInstant)
{
    const auto contact = contact_interval({}, moving({-4.0F, 0.0F, 0.0F}, {2.0F, 0.0F, 0.0F}), 0.0F, 10.0F);
    ASSERT_TRUE(contact);
    EXPECT_NEAR(contact->first, 2.0F, 1e-5F);
    EXPECT_NEAR(contact->last, 2.0F, 1e-5F);
}

TEST(ContactInterval, SpheresAtRestTouchOrDoNot)
{
    const auto contact = contact_interval({}, at(2.0F, 0.0F, 0.0F), 2.0F, 3.0F);
    ASSERT_TRUE(contact);
    EXPECT_EQ(contact->first, 0.0F);
    EXPECT_EQ(contact->last, 3.0F);
    EXPECT_FALSE(contact_interval({}, at(2.001F, 0.0F, 0.0F), 2.0F, 3.0F));
}

TEST(LeastDistance, OfNoHorizonIsTheDistanceNow)
{
    const Approach now = least_distance(kSweepHalf, {}, moving({4.0F, 6.0F, 0.0F}, {-1.0F, -1.0F, -1.0F}), 0.0F);
    EXPECT_EQ(now.distance, 5.0F);
    EXPECT_EQ(now.when, 0.0F);
}

TEST(LeastDistance, AtTheEndWhenStillClosing)
{
    const Approach found = least_distance(kSweepHalf, {}, moving({11.0F, 0.0F, 0.0F}, {-1.0F, 0.0F, 0.0F}), 4.0F);
    EXPECT_FLOAT_EQ(found.distance, 6.0F);
    EXPECT_EQ(found.when, 4.0F);
}

TEST(LeastDistance, PassingAnEdgeIsAtItsFoot)
{
    const Approach found = least_distance(kSweepHalf, {}, moving({5.0F, -2.0F, 0.0F}, {-1.0F, 1.0F, 0.0F}), 100.0F);
    // The line x + y = 3 goes through the edge x = 1, y = 2.
    EXPECT_NEAR(found.distance, 0.0F, 1e-6F);
    EXPECT_NEAR(found.when, 4.0F, 1e-5F);
}

TEST(SweptDistance, OfTwoPointsIsTheBoxDistance)
{
    EXPECT_EQ(swept_distance(kSweepHalf, kNowhere, kNowhere, {4.0F, 6.0F, 0.0F}, {4.0F, 6.0F, 0.0F}), 5.0F);
}

TEST(SweptDistance, IgnoresTime)
{
    // They cross the same place at different times.
    const Vec3 a(-10.0F, 0.0F, 0.0F);
    const Vec3 b(10.0F, 0.0F, 0.0F);
    const Vec3 c(9.0F, -10.0F, 0.0F);
    const Vec3 d(9.0F, 10.0F, 0.0F);
    EXPECT_EQ(swept_distance(kSweepHalf, a, b, c, d), 0.0F);
    EXPECT_GT(least_distance(kSweepHalf, {a, b - a}, {c, d - c}, 1.0F).distance, 1.0F);
}

TEST(SweptDistance, OfParallelAndOfOpposedWays)
{
    const Vec3 a(0.0F, 0.0F, 0.0F);
    const Vec3 b(10.0F, 0.0F, 0.0F);
    EXPECT_FLOAT_EQ(swept_distance(kSweepHalf, a, b, {0.0F, 5.0F, 0.0F}, {10.0F, 5.0F, 0.0F}), 3.0F);
    EXPECT_FLOAT_EQ(swept_distance(kSweepHalf, a, b, {30.0F, 5.0F, 0.0F}, {15.0F, 5.0F, 0.0F}), 5.0F);
}

TEST(PointSegmentDistance, ToTheInsideTheEndsAndAPoint)
{
    EXPECT_FLOAT_EQ(point_segment_distance({5.0F, 3.0F, 4.0F}, kNowhere, {10.0F, 0.0F, 0.0F}), 5.0F);
    EXPECT_FLOAT_EQ(point_segment_distance({-3.0F, 4.0F, 0.0F}, kNowhere, {10.0F, 0.0F, 0.0F}), 5.0F);
    EXPECT_FLOAT_EQ(point_segment_distance({13.0F, 0.0F, -4.0F}, kNowhere, {10.0F, 0.0F, 0.0F}), 5.0F);
    EXPECT_FLOAT_EQ(point_segment_distance({3.0F, 0.0F, -4.0F}, kNowhere, kNowhere), 5.0F);
}

}  // namespace
}  // namespace jink::geometry
