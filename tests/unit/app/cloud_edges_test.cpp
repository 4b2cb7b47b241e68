// SPDX-License-Identifier: BSD-3-Clause
// The range image at its limits: body, floor, reach, patch, age, and a scan's effect on an empty direction.
#include <cmath>
#include <memory>
#include <vector>

#include <gtest/gtest.h>

#include "firmware/app/cloud.hpp"
#include "firmware/app/range_return.hpp"
#include "tests/numbers.hpp"
#include "tests/unit/app/cloud_image_bench.hpp"

namespace jink::app {
namespace {

using link::Ray;

class CloudEdges : public test::CloudImageBench {
protected:
    CloudEdges()
    {
        view.half_extents = Vec3(2.0F, 1.5F, 1.0F);
        look();
    }
    void before_scan() override { look(); }
};

TEST_F(CloudEdges, TheBodyEndsWithTheBox)
{
    EXPECT_EQ(scan({Vec3(2.0F, 1.5F, -1.0F), Vec3(-2.0F, -1.5F, 1.0F)}), 0U);
    EXPECT_EQ(count().body, 2U);
    EXPECT_EQ(scan({Vec3(2.01F, 0.0F, 0.0F), Vec3(0.0F, -1.51F, 0.0F), Vec3(0.0F, 0.0F, 1.01F)}), 3U);
    EXPECT_EQ(count().body, 2U);
    // Unknown vehicle position: own-body hits are unknown too.
    view.is_placed = false;
    EXPECT_EQ(scan({Vec3(1.0F, 0.0F, 0.0F)}), 3U);
    EXPECT_EQ(count().body, 2U);
    EXPECT_EQ(count().kept, 4U);
}

TEST_F(CloudEdges, TheReachIsIncluded)
{
    EXPECT_EQ(scan({Vec3(600.0F, 0.0F, 0.0F)}), 1U);
    EXPECT_EQ(scan({Vec3(0.0F, 600.1F, 0.0F)}), 1U);
    EXPECT_EQ(count().beyond, 1U);
    EXPECT_EQ(scan({Vec3(0.0F, kInfinity, 0.0F), Vec3(0.0F, kNan, 0.0F)}), 1U);
    EXPECT_EQ(count().beyond, 3U);
    EXPECT_EQ(count().hits, 4U);
}

TEST_F(CloudEdges, TheFloorIsHalfAMetreLowerForAScan)
{
    view.has_floor = true;
    view.position = Vec3(0.0F, 0.0F, 50.0F);
    view.floor = 40.0F;
    EXPECT_EQ(scan({Vec3(20.0F, 0.5F, -10.5F)}), 1U) << "half a metre to the millimetre";
    EXPECT_EQ(scan({Vec3(-20.0F, 0.5F, -10.51F)}), 1U);
    EXPECT_EQ(count().below_floor, 1U);
    // The vehicle has climbed since the own state: the scan's own height counts.
    view.stamp = now - 0.4F;
    view.velocity = Vec3(0.0F, 0.0F, 10.0F);
    EXPECT_EQ(scan({Vec3(0.0F, -20.0F, -14.4F), Vec3(0.0F, 20.0F, -14.6F)}), 2U);
    EXPECT_EQ(count().below_floor, 2U);
    view.is_placed = false;
    EXPECT_EQ(scan({Vec3(0.0F, 20.0F, -14.6F)}), 2U);
    EXPECT_EQ(count().below_floor, 2U) << "without a place nobody knows";
}

/// A mission flies below the floor: the floor bounds nothing there, and what lies at the vehicle's height is in its
/// way.
TEST_F(CloudEdges, BelowTheFloorOnlyWhatIsBelowTheVehicleIsDropped)
{
    view.has_floor = true;
    view.position = Vec3(0.0F, 0.0F, 50.0F);
    view.floor = 60.0F;
    EXPECT_EQ(scan({Vec3(20.0F, 0.5F, 4.0F), Vec3(-20.0F, 0.5F, 0.01F)}), 2U);
    EXPECT_EQ(count().below_floor, 0U);
    // A landed vehicle's ground lies a landing gear below its centre.
    forget();
    EXPECT_EQ(scan({Vec3(3.0F, 0.5F, -0.1F), Vec3(-3.0F, 0.5F, -0.1F), Vec3(20.0F, 0.5F, -0.1F)}), 0U);
    EXPECT_EQ(count().below_floor, 3U);
    // Its scan's own height counts.
    view.stamp = now - 0.4F;
    view.velocity = Vec3(0.0F, 0.0F, 30.0F);
    EXPECT_EQ(scan({Vec3(20.0F, 0.5F, -2.4F), Vec3(-20.0F, 0.5F, -2.6F)}), 1U);
}

TEST_F(CloudEdges, ASurfaceIsAMetreDeepOrThreeTenthsOfItsRange)
{
    EXPECT_EQ(CloudSurface::patch_depth(0.0F), 1.0F);
    EXPECT_EQ(CloudSurface::patch_depth(3.0F), 1.0F);
    EXPECT_NEAR(CloudSurface::patch_depth(10.0F), 3.0F, 1e-5F);
    for (const float nearest : {2.5F, 20.0F}) {
        SCOPED_TRACE(nearest);
        const float depth = CloudSurface::patch_depth(nearest);
        for (const float past : {-0.05F, 0.05F}) {
            forget();
            scan({at(5, 8, nearest), at(5, 8, nearest + depth + past)});
            ASSERT_EQ(obstacles().size(), past < 0.0F ? 1U : 2U);
            EXPECT_TRUE(is_covered(at(5, 8, nearest)));
            EXPECT_TRUE(is_covered(at(5, 8, nearest + depth + past)));
            EXPECT_FALSE(is_covered(at(5, 8, nearest - 0.4F)));
            EXPECT_FALSE(is_covered(at(5, 8, nearest + depth + 0.45F)));
        }
    }
}

/// Each extent separately: the hits are covered, not the whole bin.
TEST_F(CloudEdges, AnObstacleIsAsWideAsWhatWasSeen)
{
    const float range = 40.0F;
    const auto half_of = [&](const std::vector<Vec3>& hits) {
        forget();
        scan(hits);
        EXPECT_EQ(obstacles().size(), 1U);
        for (const Vec3& hit : hits) {
            EXPECT_TRUE(is_covered(hit));
        }
        const geometry::Shape shape = obstacles().empty() ? geometry::Shape{} : obstacles()[0].shape;
        return shape.kind == geometry::ShapeKind::capsule ? Vec3(shape.radius, shape.radius, shape.half.z())
                                                          : shape.half;
    };
    // 6 degrees at 40 m are 4.19 m across; between two of the directions in which extents are kept a tenth more.
    EXPECT_NEAR(half_of({at(2, 8, range), at(8, 8, range)}).x(), 2.07F, 0.05F);
    EXPECT_NEAR(half_of({at(8, 8, range), at(2, 8, range)}).x(), 2.07F, 0.05F);
    EXPECT_NEAR(half_of({at(5, 13, range), at(5, 7, range)}).z(), 2.06F, 0.05F);
    EXPECT_NEAR(half_of({at(5, -7, range), at(5, -13, range)}).z(), 2.06F, 0.05F);
    EXPECT_NEAR(half_of({at(5, 8, range), at(5, 8, range + 6.0F)}).x(), 2.97F, 0.1F);
    EXPECT_NEAR(half_of({at(-175, 8, range), at(-179, 8, range)}).x(), 1.4F, 0.06F);
    EXPECT_NEAR(half_of({at(175, 8, range), at(179, 8, range)}).x(), 1.4F, 0.06F);
}

TEST_F(CloudEdges, AScanIsPlacedByAnOwnStateOfItsAgeAndNoOlder)
{
    view.velocity = Vec3(10.0F, -4.0F, 2.0F);
    view.own_age = 0.5F;
    view.stamp = {now.us - 500'000};
    EXPECT_EQ(scan({Vec3(20.0F, 1.0F, 0.0F)}), 1U) << "0.5 s to the microsecond";
    EXPECT_EQ(count().scans_unplaced, 0U);
    EXPECT_TRUE(is_covered(Vec3(25.0F, -1.0F, 1.0F)));
    view.stamp.us -= 1;
    EXPECT_EQ(scan({Vec3(-20.0F, 1.0F, 0.0F)}), 1U);
    EXPECT_EQ(count().scans_unplaced, 1U);
    forget();
    view.stamp = {now.us + 2'000'000};
    EXPECT_EQ(scan({Vec3(20.0F, 1.0F, 0.0F)}), 1U) << "the link refuses scans that are too old";
    EXPECT_TRUE(is_covered(Vec3(0.0F, 9.0F, -4.0F)));
}

TEST_F(CloudEdges, IsTurnedByTheYawAboutTheVehicle)
{
    view.position = Vec3(100.0F, 200.0F, 50.0F);
    view.yaw = 2.0F;
    scan({Vec3(30.0F, 10.0F, 5.0F)});
    const Vec3 world(100.0F + std::cos(2.0F) * 30.0F - std::sin(2.0F) * 10.0F,
                     200.0F + std::sin(2.0F) * 30.0F + std::cos(2.0F) * 10.0F, 55.0F);
    ASSERT_EQ(obstacles().size(), 1U);
    EXPECT_TRUE(is_covered(world));
    EXPECT_LT((obstacles()[0].shape.centre - world).norm(), 0.05F);
    EXPECT_LE(obstacles()[0].shape.radius, 1.42F * kMinReturnRadius);
}

TEST_F(CloudEdges, AViewHoldsForScansThatBeginAfterIt)
{
    begin();
    view.position = Vec3(1000.0F, 0.0F, 0.0F);
    image->look_from(view);
    image->add(Ray::hit, Vec3(20.0F, 1.0F, 0.0F));
    image->end_scan(0);
    EXPECT_TRUE(is_covered(Vec3(20.0F, 1.0F, 0.0F)));
}

TEST_F(CloudEdges, WhatHidesADirectionOrIsBelowTheFloorIsKeptApart)
{
    const Vec3 far = at(5, -18, 20);
    const Vec3 body = at(5, -18, 1);
    const auto remains = [&](const std::vector<std::pair<Ray, Vec3>>& rays) {
        forget();
        view.has_floor = false;
        scan({far});
        EXPECT_EQ(obstacles().size(), 1U);
        view.has_floor = true;
        view.floor = -8.0F;  // the far hit lies 6.2 m below the vehicle, one at 40 m 12.4 m
        begin();
        for (const auto& [ray, point] : rays) {
            image->add(ray, point);
        }
        image->end_scan(0);
        return obstacles().size() == 1;
    };
    const Vec3 low = at(5, -18, 40);
    EXPECT_FALSE(remains({{Ray::hit, low}})) << "seen empty down to the floor";
    EXPECT_TRUE(remains({{Ray::hit, body}})) << "hidden";
    EXPECT_TRUE(remains({{Ray::hit, body}, {Ray::hit, low}})) << "in part";
    EXPECT_TRUE(remains({{Ray::hit, low}, {Ray::hit, body}}));
    EXPECT_TRUE(remains({{Ray::invalid, body}, {Ray::hit, low}}));
    EXPECT_TRUE(remains({{Ray::hit, low}, {Ray::invalid, body}}));
    EXPECT_FALSE(remains({{Ray::nothing, body}, {Ray::hit, low}}));
    EXPECT_FALSE(remains({{Ray::hit, low}, {Ray::nothing, body}}));
    EXPECT_TRUE(remains({{Ray::hit, far}, {Ray::hit, low}})) << "a hit is a hit, whatever else";
    EXPECT_TRUE(remains({{Ray::hit, far}, {Ray::hit, body}}));
    EXPECT_TRUE(remains({}));
}

TEST_F(CloudEdges, LostRaysSpoilWhatIsSeenEmptyAndNothingElse)
{
    scan({at(5, 8, 20), at(95, 8, 20)});
    begin();
    image->add(Ray::nothing, at(5, 8, 1));
    image->add(Ray::hit, at(95, 8, 30));
    image->end_scan(3);
    EXPECT_EQ(count().lost, 3U);
    EXPECT_EQ(obstacles().size(), 2U);
    EXPECT_TRUE(is_covered(at(95, 8, 30)));
    EXPECT_TRUE(is_covered(at(5, 8, 20)));
    EXPECT_EQ(count().nothing, 1U);
    EXPECT_EQ(count().invalid, 0U);
    begin();
    image->add(Ray::invalid, at(5, 8, 1));
    image->end_scan(0);
    EXPECT_EQ(count().invalid, 1U);
    EXPECT_EQ(count().scans, 3U);
}

TEST_F(CloudEdges, BinsAreTenDegreesWide)
{
    const auto same = [](const Vec3& a, const Vec3& b) { return CloudImage::bin_of(a) == CloudImage::bin_of(b); };
    for (int azimuth = -180; azimuth < 180; azimuth += 10) {
        const auto left = static_cast<float>(azimuth);
        EXPECT_TRUE(same(at(left + 0.1F, 0, 1), at(left + 9.9F, 0, 7)));
        EXPECT_FALSE(same(at(left + 9.9F, 0, 1), at(left + 10.1F, 0, 1)));
    }
    for (int elevation = -35; elevation < 35; elevation += 10) {
        const auto low = static_cast<float>(elevation);
        EXPECT_TRUE(same(at(5, low + 0.1F, 1), at(5, low + 9.9F, 1)));
        EXPECT_FALSE(same(at(5, low + 9.9F, 1), at(5, low + 10.1F, 1)));
        EXPECT_FALSE(same(at(5, low - 0.1F, 1), at(5, low + 0.1F, 1)));
    }
    EXPECT_TRUE(same(at(5, 35.1F, 1), at(5, 89, 1)));
    EXPECT_TRUE(same(at(5, -35.1F, 1), at(5, -89, 1)));
}

}  // namespace
}  // namespace jink::app
