// SPDX-License-Identifier: BSD-3-Clause
// Segments of the automaton: the tests required by the reach-set specification, section 6, and every refusal.
#include "tests/reference/reach/segments.hpp"

#include <limits>
#include <vector>

#include <gtest/gtest.h>

namespace jink::reach {
namespace {

TEST(Segments, WithoutAnyStateAreTheSources)
{
    const Segments segments;
    EXPECT_EQ(segments.count(), 1U);
    EXPECT_EQ(segments.at({}).segment, 0U);
    EXPECT_FALSE(segments.at({}).outside);
    EXPECT_FLOAT_EQ(segments.limits(0).yaw, 15.0F * kPi / 180.0F);
    EXPECT_FLOAT_EQ(segments.limits(0).pitch, 15.0F * kPi / 180.0F);
}

TEST(Segments, ASeparatorBelongsToTheUpperIntervalAndTheUpperBoundToTheLast)
{
    Segments segments;
    const float separators[] = {10.0F, 20.0F};
    ASSERT_EQ(segments.split(Impact::speed, 5.0F, 30.0F, separators), SegmentStatus::good);
    const auto of = [&](float speed) {
        Condition condition;
        condition.speed = speed;
        const SegmentAt at = segments.at(condition);
        EXPECT_FALSE(at.outside) << speed;
        return static_cast<int>(at.segment);
    };
    EXPECT_EQ(of(5.0F), 0);
    EXPECT_EQ(of(std::nextafter(10.0F, 0.0F)), 0);
    EXPECT_EQ(of(10.0F), 1);
    EXPECT_EQ(of(std::nextafter(20.0F, 0.0F)), 1);
    EXPECT_EQ(of(20.0F), 2);
    EXPECT_EQ(of(30.0F), 2);
}

TEST(Segments, OutsideTheEnvelopeIsTheNearestAndSaidSo)
{
    Segments segments;
    const float separators[] = {10.0F};
    ASSERT_EQ(segments.split(Impact::altitude, 0.0F, 100.0F, separators), SegmentStatus::good);
    const auto at = [&](float altitude) {
        Condition condition;
        condition.altitude = altitude;
        return segments.at(condition);
    };
    EXPECT_EQ(at(-1.0F).segment, 0U);
    EXPECT_TRUE(at(-1.0F).outside);
    EXPECT_EQ(at(101.0F).segment, 1U);
    EXPECT_TRUE(at(101.0F).outside);
    EXPECT_TRUE(at(std::numeric_limits<float>::quiet_NaN()).outside);
    EXPECT_TRUE(at(std::numeric_limits<float>::infinity()).outside);
}

TEST(Segments, TheirNumberIsTheProduct)
{
    Segments segments;
    const float three[] = {1.0F, 2.0F, 3.0F};
    ASSERT_EQ(segments.split(Impact::speed, 0.0F, 4.0F, three), SegmentStatus::good);
    EXPECT_EQ(segments.count(), 4U);
    ASSERT_EQ(segments.split(Impact::pitch, -1.0F, 1.0F, {}), SegmentStatus::good);
    EXPECT_EQ(segments.count(), 4U);
    ASSERT_EQ(segments.split(Impact::altitude, 0.0F, 4.0F, three), SegmentStatus::good);
    EXPECT_EQ(segments.count(), 16U);
    const float four[] = {1.0F, 2.0F, 3.0F, 3.5F};
    EXPECT_EQ(segments.split(Impact::payload, 0.0F, 4.0F, four), SegmentStatus::too_many_segments);
    EXPECT_EQ(segments.count(), 16U) << "what is refused changes nothing";
    ASSERT_EQ(segments.split(Impact::payload, 0.0F, 4.0F, three), SegmentStatus::good);
    EXPECT_EQ(segments.count(), kMaxSegments);
}

TEST(Segments, WhatIsWrongIsRefusedByItsCause)
{
    Segments segments;
    const float ordered[] = {1.0F, 2.0F};
    const float unordered[] = {2.0F, 1.0F};
    const float twice[] = {1.0F, 1.0F};
    const float on_bound[] = {0.0F};
    const float eight[] = {1, 2, 3, 4, 5, 6, 7, 8};
    constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
    const float unknown[] = {kNaN};
    EXPECT_EQ(segments.split(Impact::speed, 0.0F, 0.0F, {}), SegmentStatus::bad_bounds);
    EXPECT_EQ(segments.split(Impact::speed, kNaN, 1.0F, {}), SegmentStatus::bad_bounds);
    EXPECT_EQ(segments.split(Impact::speed, 0.0F, INFINITY, {}), SegmentStatus::bad_bounds);
    EXPECT_EQ(segments.split(Impact::speed, 0.0F, 9.0F, unordered), SegmentStatus::bad_separators);
    EXPECT_EQ(segments.split(Impact::speed, 0.0F, 9.0F, twice), SegmentStatus::bad_separators);
    EXPECT_EQ(segments.split(Impact::speed, 0.0F, 9.0F, on_bound), SegmentStatus::bad_separators);
    EXPECT_EQ(segments.split(Impact::speed, 0.0F, 2.0F, ordered), SegmentStatus::bad_separators);
    EXPECT_EQ(segments.split(Impact::speed, 0.0F, 9.0F, unknown), SegmentStatus::bad_separators);
    EXPECT_EQ(segments.split(Impact::speed, 0.0F, 9.0F, eight), SegmentStatus::too_many_intervals);
    ASSERT_EQ(segments.split(Impact::speed, 0.0F, 9.0F, ordered), SegmentStatus::good);
    EXPECT_EQ(segments.split(Impact::speed, 0.0F, 9.0F, ordered), SegmentStatus::named_twice);
    EXPECT_EQ(segments.set(3, {}), SegmentStatus::no_such_segment);
    EXPECT_EQ(segments.set(2, {-0.1F, 0.1F, 1.0F}), SegmentStatus::bad_limits);
    EXPECT_EQ(segments.set(2, {0.1F, kNaN, 1.0F}), SegmentStatus::bad_limits);
    EXPECT_EQ(segments.set(2, {0.1F, 0.1F, -1.0F}), SegmentStatus::bad_limits);
    EXPECT_EQ(segments.set(2, {0.1F, 0.2F, 1.0F}), SegmentStatus::good);
    EXPECT_EQ(segments.limits(2).yaw, 0.2F);
    EXPECT_EQ(segments.count(), 3U);
}

}  // namespace
}  // namespace jink::reach
