// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include "tests/unit/link/dronecan_endpoint_fixture.hpp"

namespace jink::link::dronecan {
namespace {

using namespace test;

TEST_F(DronecanEndpoint, ProximityLooksWhereTheBodyDoes)
{
    give(proximity(0.0F, 5.0F));
    EXPECT_EQ(seen().no_origin, 1U);  // no attitude
    give(attitude(kHalfPi));          // nose to the east
    give(proximity(0.0F, 5.0F));
    give(proximity(90.0F, 6.0F));        // right of the nose: south
    give(proximity(0.0F, 7.0F, 90.0F));  // up
    give(proximity(-90.0F, 0.0F));       // contact
    ASSERT_EQ(inbox.readings.size(), 4U);
    expect_near(inbox.readings[0].direction, {1.0F, 0.0F, 0.0F}, 2e-3F);
    EXPECT_EQ(inbox.readings[0].range, 5.0F);
    expect_near(inbox.readings[1].direction, {0.0F, -1.0F, 0.0F}, 2e-3F);
    expect_near(inbox.readings[2].direction, {0.0F, 0.0F, 1.0F}, 2e-3F);
    expect_near(inbox.readings[3].direction, {0.0F, 1.0F, 0.0F}, 2e-3F);
    EXPECT_EQ(inbox.readings[3].range, 0.0F);

    inbox.clear();
    give(attitude(0.0, 0.5));  // nose up
    give(proximity(0.0F, 5.0F));
    expect_near(inbox.readings[0].direction, {0.0F, std::cos(0.5F), std::sin(0.5F)}, 2e-3F);
    inbox.clear();
    give(attitude(0.0, 0.0, 0.5));  // right wing down
    give(proximity(90.0F, 5.0F));
    expect_near(inbox.readings[0].direction, {std::cos(0.5F), 0.0F, -std::sin(0.5F)}, 2e-3F);

    now = now + 1.001F;
    give(proximity(0.0F, 5.0F));
    EXPECT_EQ(seen().no_origin, 2U);  // the attitude is too old
}

TEST_F(DronecanEndpoint, BadProximityIsRefused)
{
    give(attitude(0.0));
    Proximity m = proximity(0.0F, 5.0F);
    m.reading = Proximity::Reading::no_data;
    give(m);
    m.reading = Proximity::Reading::not_connected;
    give(m);
    give(proximity(0.0F, -1.0F));
    give(proximity(361.0F, 5.0F));
    give(proximity(0.0F, 5.0F, 91.0F));
    EXPECT_EQ(seen().out_of_range, 5U);
    give(proximity(kNan, 5.0F));
    give(proximity(0.0F, kInfinity));
    give(proximity(0.0F, 5.0F, kNan));
    EXPECT_EQ(seen().not_finite, 3U);
    EXPECT_TRUE(inbox.readings.empty());
}

TEST_F(DronecanEndpoint, DirectionsAreUnitVectorsThoughTheWireRounds)
{
    AhrsSolution m = attitude(0.7, 0.3, -0.2);
    for (float& x : m.orientation) {
        x *= 1.04F;
    }
    give(m);
    give(proximity(30.0F, 5.0F));
    ASSERT_EQ(inbox.readings.size(), 1U);
    EXPECT_NEAR(inbox.readings[0].direction.norm(), 1.0F, 1e-5F);
}

TEST_F(DronecanEndpoint, RangeFinders)
{
    give(attitude(0.0));
    give(measurement());
    give(measurement(-5));      // nose down by 60 degrees
    give(measurement(0, -5));   // 60 degrees to the left
    give(measurement(0, -15));  // backwards
    // CoarseOrientation: radians times 4.7746482927568605, which is 15 / pi.
    ASSERT_EQ(inbox.readings.size(), 4U);
    expect_near(inbox.readings[0].direction, {0.0F, 1.0F, 0.0F}, 1e-6F);
    EXPECT_EQ(inbox.readings[0].range, 8.0F);
    EXPECT_NEAR(inbox.readings[0].half_angle, 0.1F, 1e-4F);
    expect_near(inbox.readings[1].direction, {0.0F, 0.5F, -0.8660254F}, 1e-6F);
    expect_near(inbox.readings[2].direction, {-0.8660254F, 0.5F, 0.0F}, 1e-6F);
    expect_near(inbox.readings[3].direction, {0.0F, -1.0F, 0.0F}, 1e-6F);

    inbox.clear();
    RangeMeasurement m = measurement();
    m.reading = RangeMeasurement::Reading::too_far;
    m.range = 40.0F;
    give(m);
    EXPECT_EQ(inbox.readings[0].range, RangeScan::kNothing);
    EXPECT_EQ(inbox.readings[0].max_range, 40.0F);
    m.reading = RangeMeasurement::Reading::too_close;
    m.range = 0.2F;
    give(m);
    EXPECT_NEAR(inbox.readings[1].range, 0.2F, 1e-4F);
    for (const float unsaid : {kNan, -1.0F, kInfinity}) {
        m.range = unsaid;
        give(m);
        EXPECT_EQ(inbox.readings.back().range, 0.0F);  // nearer than it can see is no reason to vanish
    }
    m = measurement();
    m.field_of_view = 0.0F;
    give(m);
    EXPECT_GT(inbox.readings.back().half_angle, 0.0F);
}

TEST_F(DronecanEndpoint, BadRangesAreRefused)
{
    give(attitude(0.0));
    RangeMeasurement m = measurement();
    m.orientation_defined = false;
    give(m);
    m = measurement();
    m.reading = RangeMeasurement::Reading::undefined;
    give(m);
    m.reading = static_cast<RangeMeasurement::Reading>(7);
    give(m);
    m = measurement();
    m.range = -0.5F;
    give(m);
    EXPECT_EQ(seen().out_of_range, 4U);
    m.range = kNan;
    give(m);
    m = measurement();
    m.field_of_view = kInfinity;
    give(m);
    EXPECT_EQ(seen().not_finite, 2U);
    EXPECT_TRUE(inbox.readings.empty());
}

TEST_F(DronecanEndpoint, EachDirectionOfEachSensorHasItsOwnNumber)
{
    give(attitude(0.0));
    std::array<int, 256> used{};
    const auto number = [&](float yaw, std::uint8_t source) {
        inbox.clear();
        give(proximity(yaw, 5.0F), source);
        return inbox.readings[0].sensor;
    };
    for (int i = 0; i < 24; ++i) {
        const std::uint8_t first = number(static_cast<float>(i) * 15.0F, 20);
        EXPECT_EQ(number(static_cast<float>(i) * 15.0F + 5.0F, 20), first);
        EXPECT_EQ(++used[first], 1) << i;
    }
    for (int i = 0; i < 22; ++i) {
        EXPECT_EQ(++used[number(static_cast<float>(i) * 15.0F, 21)], 1) << i;
    }
    RangeMeasurement m = measurement();
    for (const std::uint8_t sensor : {std::uint8_t{3}, std::uint8_t{7}}) {  // 7 is the proximity sensor's id too
        inbox.clear();
        m.sensor = sensor;
        give(m, 20);
        EXPECT_EQ(++used[inbox.readings[0].sensor], 1);
    }
    EXPECT_EQ(endpoint.diagnostics().sensors_evicted, 0U);  // 48
    now = now + 0.01F;
    const std::uint8_t first = number(0.0F, 20);
    now = now + 0.01F;
    const std::uint8_t evicting = number(0.0F, 22);  // one more: the sensor with the oldest report is replaced
    EXPECT_NE(evicting, first);
    EXPECT_EQ(used[evicting], 1);
    EXPECT_EQ(endpoint.diagnostics().sensors_evicted, 1U);
}

}  // namespace
}  // namespace jink::link::dronecan
