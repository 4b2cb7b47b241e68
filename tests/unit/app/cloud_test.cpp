// SPDX-License-Identifier: BSD-3-Clause
// The polar image: which hits become which obstacles, which do not, and where each is counted.
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <set>

#include "firmware/app/cloud.hpp"
#include "firmware/app/range_return.hpp"
#include "tests/unit/app/cloud_image_bench.hpp"

namespace jink::app {
namespace {

using link::Ray;

class Cloud : public test::CloudImageBench {
protected:
    Cloud()
    {
        view.position = Vec3(100, 200, 50);
        view.half_extents = Vec3(2, 2, 1);
        look();
    }
};

TEST_F(Cloud, OneHitIsASmallPillarThere)
{
    scan({Vec3(20, 1, 2)});
    ASSERT_EQ(obstacles().size(), 1U);
    EXPECT_EQ(obstacles()[0].shape.kind, geometry::ShapeKind::capsule);
    EXPECT_LE(obstacles()[0].shape.radius, 1.42F * kMinReturnRadius);
    EXPECT_LE(obstacles()[0].shape.half.z(), kMinReturnRadius);
    EXPECT_LT((obstacles()[0].shape.centre - Vec3(120, 201, 52)).norm(), 0.05F);
    EXPECT_EQ(count().obstacles, 1U);
}

TEST_F(Cloud, TurnedByTheYaw)
{
    view.yaw = 0.5F * kPi;
    look();
    scan({Vec3(20, 0.5F, 0), Vec3(0, 30, 1)});
    EXPECT_TRUE(is_covered(Vec3(99.5F, 220, 50)));
    EXPECT_TRUE(is_covered(Vec3(70, 200, 51)));
}

TEST_F(Cloud, PlacedWhereTheVehicleWasAtTheStamp)
{
    view.velocity = Vec3(5, 0, -1);
    view.stamp = now + 0.2F;  // the own state is younger than the scan
    look();
    scan({Vec3(20, 1, 0)});
    EXPECT_TRUE(is_covered(Vec3(119, 201, 50.2F)));
    view.stamp = now - 0.4F;  // and older
    look();
    scan({Vec3(-20, 1, 0)});
    EXPECT_TRUE(is_covered(Vec3(82, 201, 49.6F)));
}

TEST_F(Cloud, WithoutAPlaceNothingIsGiven)
{
    view.stamp = now - 0.52F;
    look();
    scan({Vec3(20, 1, 0)});
    EXPECT_EQ(count().scans_unplaced, 1U);
    view.stamp = now;
    view.is_placed = false;
    look();
    scan({Vec3(20, 1, 0)});
    EXPECT_EQ(count().scans_unplaced, 2U);
    EXPECT_TRUE(obstacles().empty());
    EXPECT_EQ(count().hits, 2U);
}

TEST_F(Cloud, NoTableTakesNothing)
{
    const auto alone = std::make_unique<CloudObstacles>(0);
    alone->look_from(view);
    link::CloudScan scan;
    scan.stamp = now;
    alone->begin_scan(scan);
    alone->add(Ray::hit, Vec3(20, 0, 0));
    alone->end_scan(0);
    EXPECT_EQ(alone->diagnostics().obstacles, 0U);
}

TEST_F(Cloud, WhatIsSeenPastSomethingIsReportedToo)
{
    const Vec3 own(100, 200, 50);
    for (const std::vector<Vec3>& hits : {std::vector{at(5, 13, 40), at(6, 14, 20), at(4, 12, 21), at(5, 13, 60)},
                                          std::vector{at(5, 13, 60), at(5, 13, 40), at(4, 12, 21), at(6, 14, 20)}}) {
        forget();
        scan(hits);
        EXPECT_EQ(obstacles().size(), 2U);
        for (const Vec3& hit : hits) {
            EXPECT_TRUE(is_covered(own + hit));
        }
        EXPECT_FALSE(is_covered(own + at(5, 13, 30))) << "free between the nearest and the others";
        EXPECT_EQ(count().kept, 4U);
    }
}

/// Two walls of a street that are seen from close by must not hide the house across it.
TEST_F(Cloud, WhatIsNearAndLargeTakesNoPlaceFromWhatIsAhead)
{
    std::vector<Vec3> hits;
    for (float azimuth = -179.0F; azimuth < 180.0F; azimuth += 2.0F) {
        for (float elevation = -44.0F; elevation <= 44.0F; elevation += 2.0F) {
            const Vec3 ray = at(azimuth, elevation, 1.0F);
            const float side = 3.0F / std::max(std::abs(ray.y()), 1e-6F);
            const float ahead = ray.x() > 0.0F ? 18.0F / ray.x() : 1e9F;
            const float range = std::min(side, ahead);
            if (range < 60.0F) {
                hits.push_back(range * ray);
            }
        }
    }
    scan(hits);
    const Vec3 own(100, 200, 50);
    for (const Vec3& hit : hits) {
        EXPECT_TRUE(is_covered(own + hit));
    }
    EXPECT_LE(obstacles().size(), 20U);
    EXPECT_EQ(count().coarse, 0U);
    for (float x = -20.0F; x <= 16.5F; x += 0.5F) {
        for (float y = -2.0F; y <= 2.0F; y += 0.5F) {
            EXPECT_FALSE(is_covered(own + Vec3(x, y, 0))) << x << ' ' << y << ": the street is free";
        }
    }
}

/// A gap between two houses in one line stays a gap.
TEST_F(Cloud, WhatIsSeenToBeEmptyIsNotCovered)
{
    begin();
    for (float azimuth = -59.0F; azimuth < 60.0F; azimuth += 2.0F) {
        const Vec3 ray = at(azimuth, 2, 1.0F);
        const Vec3 hit = ray * (20.0F / ray.x());
        const bool is_free = std::abs(hit.y()) < 5.0F;
        image->add(is_free ? Ray::nothing : Ray::hit, is_free ? ray : hit);
    }
    image->end_scan(0);
    const Vec3 own(100, 200, 50);
    for (float y = -3.0F; y <= 3.0F; y += 0.5F) {
        EXPECT_FALSE(is_covered(own + Vec3(20, y, 20.0F * std::tan(2.0F * kPi / 180.0F)))) << y;
    }
    EXPECT_TRUE(is_covered(own + at(31, 2, 1.0F) * (20.0F / at(31, 2, 1.0F).x())));
}

/// Things in different directions with nothing seen between them are things of their own, whatever lies in line.
TEST_F(Cloud, WhatLiesApartIsReportedApart)
{
    const Vec3 own(100, 200, 50);
    scan({at(95, 2, 8), at(-95, 2, 8)});
    EXPECT_EQ(obstacles().size(), 2U);
    EXPECT_FALSE(is_covered(own));
    forget();
    scan({at(5, 2, 10), at(15, 2, 20)});  // neighbours, one far behind the other
    EXPECT_EQ(obstacles().size(), 2U);
    EXPECT_FALSE(is_covered(own + 0.5F * (at(5, 2, 10) + at(15, 2, 20))));
}

TEST_F(Cloud, OwnBodyIsDroppedAndCounted)
{
    scan({Vec3(2, 2, 1), Vec3(-1.9F, 0, -0.9F), Vec3(2.1F, 0, 0), Vec3(0.1F, 0, 1.1F)});
    EXPECT_EQ(count().body, 2U);
    EXPECT_EQ(obstacles().size(), 2U);
}

TEST_F(Cloud, GroundBelowTheFloorIsDroppedAndCounted)
{
    view.has_floor = true;
    view.floor = 40.0F;
    look();
    scan({Vec3(20, 1, -10.4F), Vec3(-20, 1, -10.6F)});
    EXPECT_EQ(count().below_floor, 1U);
    ASSERT_EQ(obstacles().size(), 1U);
    EXPECT_TRUE(is_covered(Vec3(120, 201, 39.6F)));
    view.has_floor = false;
    look();
    scan({Vec3(20, 1, -10.4F), Vec3(-20, 1, -10.6F)});
    EXPECT_EQ(obstacles().size(), 2U);
}

TEST_F(Cloud, BeyondReachIsDroppedAndCounted)
{
    scan({Vec3(600.1F, 0, 0), Vec3(0, 599.9F, 0)});
    EXPECT_EQ(count().beyond, 1U);
    EXPECT_EQ(obstacles().size(), 1U);
}

TEST_F(Cloud, StraightUpAndDownAreSeen)
{
    scan({Vec3(0, 0, 10), Vec3(0, 0, -10)});
    EXPECT_TRUE(is_covered(Vec3(100, 200, 60)));
    EXPECT_TRUE(is_covered(Vec3(100, 200, 40)));
}

TEST_F(Cloud, ObstaclesExpire)
{
    view.keep = 1.5F;
    look();
    scan({Vec3(20, 1, 0)});
    table->expire(now + 1.5F);
    EXPECT_EQ(obstacles().size(), 1U);
    table->expire(now + 1.51F);
    EXPECT_TRUE(obstacles().empty());
}

TEST_F(Cloud, SeenEmptyGivesUpTheFormerObstacle)
{
    const auto scan_of = [&](Ray ray, std::uint32_t lost) {
        scan({at(5, 2, 20), at(95, 2, 20)});
        EXPECT_EQ(obstacles().size(), 2U);
        begin();
        image->add(ray, at(5, 2, 1));
        image->end_scan(lost);
        return obstacles().size();
    };
    EXPECT_EQ(scan_of(Ray::nothing, 0), 1U);  // the other direction was not scanned: it stays
    EXPECT_TRUE(is_covered(Vec3(100, 200, 50) + at(95, 2, 20)));
    EXPECT_EQ(scan_of(Ray::nothing, 1), 2U);  // the hit may be among the lost points
    EXPECT_EQ(scan_of(Ray::invalid, 0), 2U);
}

TEST_F(Cloud, HiddenByTheBodyOrInvalidIsNotSeenEmpty)
{
    for (const bool body_first : {false, true}) {
        scan({at(5, 2, 20)});
        begin();
        image->add(body_first ? Ray::hit : Ray::nothing, at(5, 2, 1));
        image->add(body_first ? Ray::nothing : Ray::hit, at(5, 2, 1));
        image->end_scan(0);
        EXPECT_EQ(obstacles().size(), 1U);
        begin();
        image->add(body_first ? Ray::invalid : Ray::nothing, at(5, 2, 1));
        image->add(body_first ? Ray::nothing : Ray::invalid, at(5, 2, 1));
        image->end_scan(0);
        EXPECT_EQ(obstacles().size(), 1U);
    }
    // And a hit beside them is one all the same.
    begin();
    image->add(Ray::invalid, at(5, 2, 1));
    image->add(Ray::nothing, at(5, 2, 1));
    image->add(Ray::hit, at(5, 2, 1));
    image->add(Ray::hit, at(5, 2, 30));
    image->add(Ray::nothing, at(5, 2, 1));
    image->add(Ray::invalid, at(5, 2, 1));
    image->end_scan(0);
    EXPECT_TRUE(is_covered(Vec3(100, 200, 50) + at(5, 2, 30)));
    EXPECT_EQ(obstacles().size(), 1U);
}

TEST_F(Cloud, GroundBelowTheFloorIsSeenEmpty)
{
    scan({at(5, -20, 20)});
    view.has_floor = true;
    view.floor = 45.0F;
    look();
    scan({at(5, -20, 40)});
    EXPECT_TRUE(obstacles().empty());
}

TEST_F(Cloud, NoMoreThanItsShareAndTheFarthestGo)
{
    std::vector<Vec3> hits;
    for (std::size_t i = 0; i < kMaxCloudObstacles + 10; ++i) {
        // Every other bin, far apart in range from its neighbours, the nearer the later.
        const auto k = static_cast<float>(i);
        hits.push_back(
            at(5.0F + 20.0F * static_cast<float>(i % 18), 20.0F * static_cast<float>(i / 18) - 38.0F, 100.0F - k));
    }
    scan(hits);
    EXPECT_LE(obstacles().size(), kMaxCloudObstacles);
    EXPECT_GE(obstacles().size(), kMaxCloudObstacles - 3);
    EXPECT_GE(count().left_out, 5U);
    EXPECT_EQ(count().coarse, 0U);
    const Vec3 own(100, 200, 50);
    EXPECT_FALSE(is_covered(own + hits[0]));
    for (std::size_t i = 14; i < hits.size(); ++i) {
        EXPECT_TRUE(is_covered(own + hits[i])) << i;
    }
}

/// What begins within the sure range is reported whatever there is: coarser, but all of it.
TEST_F(Cloud, NearThingsShareObstaclesBeforeOneIsLeftOut)
{
    std::vector<Vec3> hits;
    for (std::size_t i = 0; i < kMaxCloudObstacles + 10; ++i) {
        hits.push_back(at(5.0F + 20.0F * static_cast<float>(i % 18), 20.0F * static_cast<float>(i / 18) - 38.0F,
                          i % 2 == 0 ? 6.0F : 14.0F));
    }
    scan(hits);
    EXPECT_EQ(count().left_out, 0U);
    EXPECT_GT(count().coarse, 0U);
    for (const Vec3& hit : hits) {
        EXPECT_TRUE(is_covered(Vec3(100, 200, 50) + hit));
    }
    EXPECT_EQ(CloudObstacles::sure_range(view), 15.0F);
    view.velocity = Vec3(10, 0, 0);
    EXPECT_EQ(CloudObstacles::sure_range(view), 35.0F) << "twice the 10 m that it takes to stop";
}

/// A wall that comes within the own box is seen by no ray any more: it is still there.
TEST_F(Cloud, WhatCameWithinTheBodyIsNotForgotten)
{
    std::vector<Vec3> wall;
    for (float y = -10.0F; y <= 10.0F; y += 0.5F) {
        for (float z = -5.0F; z <= 5.0F; z += 0.5F) {
            wall.push_back(Vec3(2.5F, y, z));
        }
    }
    scan(wall);
    const Vec3 there(102.5F, 200, 50);
    ASSERT_TRUE(is_covered(there));
    view.position.x() += 1.0F;
    for (Vec3& hit : wall) {
        hit.x() -= 1.0F;
    }
    for (int i = 0; i < 50; ++i) {
        now = now + 0.1F;
        view.stamp = now;
        look();
        scan(wall);
        table->expire(now);
        ASSERT_TRUE(is_covered(there)) << i;
    }
    EXPECT_GT(count().body, 0U);
    EXPECT_GT(count().remembered, 0U);
    // Away from it, its place is seen again: now it is gone when it is not there.
    view.position.x() -= 10.0F;
    now = now + 0.1F;
    view.stamp = now;
    look();
    begin();
    for (float azimuth = -179.0F; azimuth < 180.0F; azimuth += 2.0F) {
        for (float elevation = -44.0F; elevation <= 44.0F; elevation += 2.0F) {
            image->add(Ray::nothing, at(azimuth, elevation, 1));
        }
    }
    image->end_scan(0);
    EXPECT_TRUE(obstacles().empty());
}

/// Sensors that have fallen silent take no memory from one that goes on.
TEST_F(Cloud, ASilentSensorIsForgotten)
{
    std::vector<Vec3> all;
    for (float azimuth = -175.0F; azimuth < 180.0F; azimuth += 10.0F) {
        for (float elevation = -40.0F; elevation <= 40.0F; elevation += 10.0F) {
            all.push_back(at(azimuth, elevation, 20));
            all.push_back(at(azimuth, elevation, 50));
        }
    }
    scan(all, 0, 1);
    now = now + 2.0F;
    view.stamp = now;
    look();
    scan({at(5, 2, 20)});
    now = now + 0.1F;
    view.stamp = now;
    look();
    scan({at(95, 2, 20)});
    EXPECT_TRUE(is_covered(Vec3(100, 200, 50) + at(5, 2, 20))) << "remembered, though another sensor once saw much";
}

/// What a scan does not see stays where it was in the world, however the vehicle turns and moves meanwhile.
TEST_F(Cloud, WhatIsNotSeenAgainStaysWhereItWas)
{
    scan({at(90, 2, 20)});
    const Vec3 there = Vec3(100, 200, 50) + at(90, 2, 20);
    for (int i = 1; i <= 9; ++i) {
        now = now + 0.1F;
        view.stamp = now;
        view.position = Vec3(100.0F + static_cast<float>(i), 200, 50);
        view.yaw = 0.2F * static_cast<float>(i);
        look();
        scan({at(-120, 2, 30)});
        table->expire(now);
        ASSERT_TRUE(is_covered(there)) << i;
    }
    now = now + 0.2F;
    view.stamp = now;
    look();
    scan({at(-120, 2, 30)});
    EXPECT_FALSE(is_covered(there)) << "kept for a second";
}

TEST_F(Cloud, SensorsHaveObstaclesOfTheirOwn)
{
    scan({at(5, 2, 20)}, 0, 0);
    scan({at(5, 2, 30)}, 0, 255);
    ASSERT_EQ(obstacles().size(), 2U);
    EXPECT_GE(obstacles()[0].id, 0x1000000U);
    EXPECT_LT(obstacles()[1].id, 0x1020000U);
}

TEST_F(Cloud, BinsPartTheSphere)
{
    std::set<std::size_t> bins;
    for (int azimuth = -175; azimuth < 180; azimuth += 10) {
        for (int elevation = -40; elevation <= 40; elevation += 10) {
            bins.insert(CloudImage::bin_of(at(static_cast<float>(azimuth), static_cast<float>(elevation), 1)));
        }
        EXPECT_EQ(CloudImage::bin_of(at(static_cast<float>(azimuth), 80, 1)),
                  CloudImage::bin_of(at(static_cast<float>(azimuth), 40, 1)));
        EXPECT_EQ(CloudImage::bin_of(at(static_cast<float>(azimuth), -89, 1)),
                  CloudImage::bin_of(at(static_cast<float>(azimuth), -36, 1)));
    }
    EXPECT_EQ(bins.size(), CloudImage::kBins);
    EXPECT_EQ(*bins.rbegin(), CloudImage::kBins - 1);
    // Right behind, on both sides of the seam.
    EXPECT_LT(CloudImage::bin_of(Vec3(-1, 0.0F, 0)), CloudImage::kBins);
    EXPECT_LT(CloudImage::bin_of(Vec3(-1, -0.0F, 0)), CloudImage::kBins);
}

}  // namespace
}  // namespace jink::app
