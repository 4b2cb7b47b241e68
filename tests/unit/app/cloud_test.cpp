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

class CloudImage : public test::CloudImageBench {
protected:
    CloudImage()
    {
        view.position = Vec3(100, 200, 50);
        view.half_extents = Vec3(2, 2, 1);
        look();
    }
};

TEST_F(CloudImage, OneHitIsASmallSphereThere)
{
    scan({Vec3(20, 1, 2)});
    ASSERT_EQ(obstacles().size(), 1U);
    EXPECT_EQ(obstacles()[0].shape.kind, geometry::ShapeKind::sphere);
    EXPECT_EQ(obstacles()[0].shape.radius, kMinReturnRadius);
    EXPECT_LT((obstacles()[0].shape.centre - Vec3(120, 201, 52)).norm(), 0.05F);
    EXPECT_EQ(count().obstacles, 1U);
}

TEST_F(CloudImage, TurnedByTheYaw)
{
    view.yaw = 0.5F * kPi;
    look();
    scan({Vec3(20, 0.5F, 0), Vec3(0, 30, 1)});
    EXPECT_TRUE(is_covered(Vec3(99.5F, 220, 50)));
    EXPECT_TRUE(is_covered(Vec3(70, 200, 51)));
}

TEST_F(CloudImage, PlacedWhereTheVehicleWasAtTheStamp)
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

TEST_F(CloudImage, WithoutAPlaceNothingIsGiven)
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

TEST_F(CloudImage, NoTableTakesNothing)
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

TEST_F(CloudImage, NearestOfADirectionHidesWhatIsFarBehind)
{
    scan({at(5, 10, 40), at(6, 11, 20), at(4, 9, 21), at(5, 10, 60)});
    ASSERT_EQ(obstacles().size(), 1U);
    const Vec3 own(100, 200, 50);
    EXPECT_TRUE(is_covered(own + at(6, 11, 20)));
    EXPECT_TRUE(is_covered(own + at(4, 9, 21)));
    EXPECT_FALSE(is_covered(own + at(5, 10, 40)));
    EXPECT_EQ(count().behind, 1U);  // the last; the first was the nearest when it came
    EXPECT_EQ(count().kept, 3U);
}

TEST_F(CloudImage, OwnBodyIsDroppedAndCounted)
{
    scan({Vec3(2, 2, 1), Vec3(-1.9F, 0, -0.9F), Vec3(2.1F, 0, 0), Vec3(0.1F, 0, 1.1F)});
    EXPECT_EQ(count().body, 2U);
    EXPECT_EQ(obstacles().size(), 2U);
}

TEST_F(CloudImage, GroundBelowTheFloorIsDroppedAndCounted)
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

TEST_F(CloudImage, BeyondReachIsDroppedAndCounted)
{
    scan({Vec3(600.1F, 0, 0), Vec3(0, 599.9F, 0)});
    EXPECT_EQ(count().beyond, 1U);
    EXPECT_EQ(obstacles().size(), 1U);
}

TEST_F(CloudImage, StraightUpAndDownAreSeen)
{
    scan({Vec3(0, 0, 10), Vec3(0, 0, -10)});
    EXPECT_TRUE(is_covered(Vec3(100, 200, 60)));
    EXPECT_TRUE(is_covered(Vec3(100, 200, 40)));
}

TEST_F(CloudImage, ObstaclesExpire)
{
    view.keep = 1.5F;
    look();
    scan({Vec3(20, 1, 0)});
    table->expire(now + 1.5F);
    EXPECT_EQ(obstacles().size(), 1U);
    table->expire(now + 1.51F);
    EXPECT_TRUE(obstacles().empty());
}

TEST_F(CloudImage, SeenEmptyGivesUpTheFormerObstacle)
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

TEST_F(CloudImage, HiddenByTheBodyOrInvalidIsNotSeenEmpty)
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

TEST_F(CloudImage, GroundBelowTheFloorIsSeenEmpty)
{
    scan({at(5, -20, 20)});
    view.has_floor = true;
    view.floor = 45.0F;
    look();
    scan({at(5, -20, 40)});
    EXPECT_TRUE(obstacles().empty());
}

TEST_F(CloudImage, NearestFirstAndNoMoreThanItsShare)
{
    std::vector<Vec3> hits;
    for (std::size_t i = 0; i < kMaxCloudObstacles + 10; ++i) {
        // A bin each, the nearer the later.
        const auto k = static_cast<float>(i);
        hits.push_back(at(5.0F + 10.0F * static_cast<float>(i % 36), 10.0F * static_cast<float>(i / 36), 100.0F - k));
    }
    scan(hits);
    EXPECT_EQ(obstacles().size(), kMaxCloudObstacles);
    EXPECT_EQ(count().no_room, 10U);
    const Vec3 own(100, 200, 50);
    for (std::size_t i = 0; i < hits.size(); ++i) {
        EXPECT_EQ(is_covered(own + hits[i]), i >= 10) << i;
    }
    // Obstacles beyond the share are dropped, even if reported before.
    scan({hits[0]});
    EXPECT_EQ(obstacles().size(), kMaxCloudObstacles + 1);
    scan(hits);
    EXPECT_EQ(obstacles().size(), kMaxCloudObstacles);
}

TEST_F(CloudImage, SensorsHaveObstaclesOfTheirOwn)
{
    scan({at(5, 2, 20)}, 0, 0);
    scan({at(5, 2, 30)}, 0, 255);
    ASSERT_EQ(obstacles().size(), 2U);
    EXPECT_GE(obstacles()[0].id, 0x1000000U);
    EXPECT_LT(obstacles()[1].id, 0x1020000U);
}

TEST_F(CloudImage, BinsPartTheSphere)
{
    std::set<std::size_t> bins;
    for (int azimuth = -175; azimuth < 180; azimuth += 10) {
        for (int elevation = -40; elevation <= 40; elevation += 10) {
            bins.insert(CloudObstacles::bin_of(at(static_cast<float>(azimuth), static_cast<float>(elevation), 1)));
        }
        EXPECT_EQ(CloudObstacles::bin_of(at(static_cast<float>(azimuth), 80, 1)),
                  CloudObstacles::bin_of(at(static_cast<float>(azimuth), 40, 1)));
        EXPECT_EQ(CloudObstacles::bin_of(at(static_cast<float>(azimuth), -89, 1)),
                  CloudObstacles::bin_of(at(static_cast<float>(azimuth), -36, 1)));
    }
    EXPECT_EQ(bins.size(), CloudObstacles::kBins);
    EXPECT_EQ(*bins.rbegin(), CloudObstacles::kBins - 1);
    // Right behind, on both sides of the seam.
    EXPECT_LT(CloudObstacles::bin_of(Vec3(-1, 0.0F, 0)), CloudObstacles::kBins);
    EXPECT_LT(CloudObstacles::bin_of(Vec3(-1, -0.0F, 0)), CloudObstacles::kBins);
}

TEST_F(CloudImage, MemoryIsWhatImagesCanAfford) { EXPECT_LE(sizeof(CloudObstacles), 4096U); }

}  // namespace
}  // namespace jink::app
