// SPDX-License-Identifier: BSD-3-Clause
// What a range sensor saw belongs to a direction of the world, not to a sector of the vehicle.
#include "firmware/app/range_obstacles.hpp"

#include <algorithm>
#include <cmath>
#include <initializer_list>

#include <gtest/gtest.h>

#include "firmware/app/range_return.hpp"

namespace jink::app {
namespace {

using link::RangeScan;
constexpr float kDegree = kPi / 180.0F;
constexpr TimePoint kNow{5'000'000};

class RangeDirections : public testing::Test {
protected:
    void scan(std::initializer_list<float> ranges, float yaw_first, float increment)
    {
        RangeScan s;
        s.stamp = kNow;
        s.yaw_first = yaw_first;
        s.increment = increment;
        for (const float r : ranges) {
            s.ranges.unchecked_push_back(r);
        }
        place_scan(s, Vec3::Zero(), configuration, table);
    }
    void read(const Vec3& direction, float range)
    {
        link::RangeReading r;
        r.stamp = kNow;
        r.direction = direction;
        r.range = range;
        r.half_angle = 0.05F;
        ASSERT_TRUE(place_reading(r, Vec3::Zero(), configuration, table));
    }
    [[nodiscard]] std::size_t count() const { return table.obstacles().size(); }

    Configuration configuration;
    world::ObstacleTable table;
};

TEST_F(RangeDirections, WhatAScanSawStaysWhenTheSensorTurnsAway)
{
    constexpr float kNothing = RangeScan::kNothing;
    scan({6.0F, kNothing, kNothing}, 0.0F, -0.1F);
    ASSERT_EQ(count(), 1U);
    for (const float turned : {1.0F, -1.0F, 0.5F * kPi, 3.0F, -3.0F}) {
        scan({kNothing, kNothing, kNothing}, turned, -0.1F);
        EXPECT_EQ(count(), 1U) << turned;
    }
    scan({30.0F, kNothing, kNothing}, 2.0F, -0.1F);
    EXPECT_EQ(count(), 2U) << "what is farther elsewhere";
    scan({kNothing, kNothing, kNothing}, 0.1F, -0.1F);
    EXPECT_EQ(count(), 1U) << "seen empty by another sector";
    scan({kNothing, kNothing, kNothing}, 2.0F + 2.0F * kPi, -0.1F);
    EXPECT_EQ(count(), 0U);
}

TEST_F(RangeDirections, WhatAReadingSawStaysWhenTheSensorTurnsAway)
{
    read(Vec3::UnitX(), 6.0F);
    ASSERT_EQ(count(), 1U);
    read(Vec3::UnitY(), RangeScan::kNothing);
    EXPECT_EQ(count(), 1U);
    read(-Vec3::UnitX(), 20.0F);
    EXPECT_EQ(count(), 2U);
    read(Vec3::UnitX(), 7.0F);
    EXPECT_EQ(count(), 2U) << "the newer of a direction";
    read(Vec3::UnitX(), RangeScan::kNothing);
    read(-Vec3::UnitX(), RangeScan::kNothing);
    EXPECT_EQ(count(), 0U);
}

TEST_F(RangeDirections, EachSectorOfAFullCircleHasOneOfItsOwnHoweverTheVehicleIsTurned)
{
    for (const float increment : {5.0F, 7.0F, -5.0F, 7.5F, -11.3F, 45.0F, 180.0F}) {
        const float half_angle = 0.5F * std::abs(increment) * kDegree;
        const auto sectors = static_cast<std::size_t>(std::ceil(360.0F / std::abs(increment)));
        for (float yaw = -7.0F; yaw < 7.0F; yaw += 0.037F) {
            RangeScan s;
            s.stamp = kNow;
            s.yaw_first = yaw;
            s.increment = increment * kDegree;
            s.ranges.resize(sectors);
            std::fill(s.ranges.begin(), s.ranges.end(), 20.0F);
            table.clear();
            place_scan(s, Vec3::Zero(), configuration, table);
            ASSERT_EQ(count(), sectors * return_parts(half_angle)) << increment << " " << yaw;
            std::fill(s.ranges.begin(), s.ranges.end(), RangeScan::kNothing);
            place_scan(s, Vec3::Zero(), configuration, table);
            ASSERT_EQ(count(), 0U) << increment << " " << yaw;
        }
    }
}

}  // namespace
}  // namespace jink::app
