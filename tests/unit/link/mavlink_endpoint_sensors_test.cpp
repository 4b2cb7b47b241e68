// SPDX-License-Identifier: BSD-3-Clause
// Traffic, range scans and range readings.
#include <gtest/gtest.h>
#include <limits>
#include <set>

#include "firmware/link/mavlink/text.hpp"
#include "tests/numbers.hpp"
#include "tests/unit/link/mavlink_endpoint_fixture.hpp"

namespace jink::link::mavlink {
namespace {

using namespace test;
constexpr float kDegree = kPi / 180.0F;

class MavlinkEndpointSensors : public EndpointTest {
protected:
    void SetUp() override
    {
        heartbeat();
        local_position();
        attitude(0.0F);
        clear();
    }

    /// 1000 m north, 500 m east, 100 m above the origin; heading east at 20 m/s, climbing at 2 m/s.
    static AdsbVehicle traffic()
    {
        AdsbVehicle m;
        m.ICAO_address = 0xABCDEF;
        m.lat = 473977420 + 89832;
        m.lon = 85455940 + 66348;
        m.altitude = 588000;
        m.heading = 9000;
        m.hor_velocity = 2000;
        m.ver_velocity = 200;
        m.flags = 1 | 2 | 4 | 8 | 128;
        return m;
    }
    static ObstacleDistance scan()
    {
        ObstacleDistance m;
        m.distances.fill(65535);
        m.increment = 5;
        m.min_distance = 20;
        m.max_distance = 4000;
        m.frame = 12;
        return m;
    }
    static DistanceSensor reading()
    {
        DistanceSensor m;
        m.min_distance = 10;
        m.max_distance = 3000;
        m.current_distance = 1234;
        m.id = 3;
        return m;
    }
};

TEST_F(MavlinkEndpointSensors, TrafficIsPlacedOnTheLocalPlane)
{
    origin();
    from(kSystem, 156, traffic());
    ASSERT_EQ(inbox->tracks.size(), 1U);
    const TrackReport& t = inbox->tracks[0];
    EXPECT_EQ(t.id, 0xABCDEFU);
    expect_near(t.position, {500, 1000, 100}, 0.3F);
    EXPECT_TRUE(t.has_velocity);
    expect_near(t.velocity, {20, 0, 2}, 1e-4F);
    EXPECT_EQ(t.stamp, now);
    EXPECT_EQ(t.source, world::TrackSource::adsb);
    EXPECT_FALSE(t.at_rest);
}

TEST_F(MavlinkEndpointSensors, TrafficIsOldByTheTimeSinceItWasHeard)
{
    origin();
    AdsbVehicle m = traffic();
    m.tslc = 2;
    from(kSystem, 156, m);
    EXPECT_EQ(inbox->tracks[0].stamp.us, now.us - 2'000'000);
}

TEST_F(MavlinkEndpointSensors, TrafficVelocityNeedsHeadingAndSpeed)
{
    origin();
    for (const unsigned flags : {3U, 3U | 4U, 3U | 8U, 3U | 4U | 8U}) {
        AdsbVehicle m = traffic();
        m.flags = static_cast<std::uint16_t>(flags);
        clear();
        from(kSystem, 156, m);
        ASSERT_EQ(inbox->tracks.size(), 1U);
        EXPECT_EQ(inbox->tracks[0].has_velocity, flags == (3U | 4U | 8U));
        EXPECT_EQ(inbox->tracks[0].velocity.z(), 0.0F) << "vertical speed not marked as valid";
    }
}

TEST_F(MavlinkEndpointSensors, TrafficOfUnknownClimbIsNotTakenForLevel)
{
    origin();
    AdsbVehicle m = traffic();
    from(kSystem, 156, m);
    EXPECT_EQ(inbox->tracks[0].sigma_velocity, 0.0F) << "not said";
    m.flags = static_cast<std::uint16_t>(m.flags & ~128U);
    from(kSystem, 156, m);
    EXPECT_EQ(inbox->tracks[1].velocity.z(), 0.0F);
    EXPECT_GE(inbox->tracks[1].sigma_velocity, 5.0F);
    m.emitter_type = 19;
    from(kSystem, 156, m);
    EXPECT_EQ(inbox->tracks[2].sigma_velocity, 0.0F) << "stands";
}

TEST_F(MavlinkEndpointSensors, StandingObstaclesOfTrafficReceiversStandStill)
{
    origin();
    AdsbVehicle m = traffic();
    m.emitter_type = 19;
    from(kSystem, 156, m);
    EXPECT_TRUE(inbox->tracks[0].at_rest);
    EXPECT_TRUE(inbox->tracks[0].has_velocity);
    EXPECT_EQ(inbox->tracks[0].velocity, Vec3(0, 0, 0));
}

TEST_F(MavlinkEndpointSensors, TrafficWithoutAPlaceIsRefused)
{
    from(kSystem, 156, traffic());
    EXPECT_EQ(count().no_origin, 1U);
    origin();
    for (const unsigned flags : {0U, 1U, 2U, 0xFFFCU}) {
        AdsbVehicle m = traffic();
        m.flags = static_cast<std::uint16_t>(flags);
        from(kSystem, 156, m);
    }
    AdsbVehicle off = traffic();
    off.lat = 900000001;
    from(kSystem, 156, off);
    EXPECT_EQ(count().out_of_range, 5U);
    from(9, 1, traffic());
    EXPECT_EQ(count().frames_ignored, 1U) << "what another vehicle's autopilot hears may be us";
    EXPECT_TRUE(inbox->tracks.empty());
}

TEST_F(MavlinkEndpointSensors, TrafficBeyondTheInboxIsCounted)
{
    origin();
    for (std::uint32_t i = 0; i < kMaxTrackReports + 3; ++i) {
        AdsbVehicle m = traffic();
        m.ICAO_address = i;
        from(kSystem, 156, m);
    }
    EXPECT_EQ(inbox->tracks.size(), kMaxTrackReports);
    EXPECT_EQ(count().inbox_full, 3U);
}

TEST_F(MavlinkEndpointSensors, BodyScanTurnsWithTheVehicle)
{
    attitude(kPi / 2);  // nose east: sector 0 points east, sector 18 (90 degrees clockwise) south
    ObstacleDistance m = scan();
    m.distances[0] = 1000;
    m.distances[18] = 2000;
    from(kSystem, 154, m);
    ASSERT_EQ(inbox->scans.size(), 1U);
    const RangeScan& s = inbox->scans[0];
    EXPECT_EQ(s.ranges.size(), 72U);
    EXPECT_NEAR(s.yaw_first, 0.0F, 1e-5F);
    EXPECT_NEAR(s.increment, -5.0F * kDegree, 1e-6F);
    EXPECT_NEAR(std::remainder(s.yaw_first + 18.0F * s.increment + kPi / 2, 2 * kPi), 0.0F, 1e-5F);
    EXPECT_FLOAT_EQ(s.ranges[0], 10.0F);
    EXPECT_FLOAT_EQ(s.ranges[18], 20.0F);
    EXPECT_EQ(s.ranges[1], RangeScan::kUnknown);
    EXPECT_FLOAT_EQ(s.min_range, 0.2F);
    EXPECT_FLOAT_EQ(s.max_range, 40.0F);
    EXPECT_EQ(s.stamp, now);
}

TEST_F(MavlinkEndpointSensors, NorthUpScansDoNotTurn)
{
    attitude(1.0F);
    for (const std::uint8_t frame : {0, 1}) {
        ObstacleDistance m = scan();
        m.frame = frame;
        m.angle_offset = 30.0F;
        from(kSystem, 154, m);
        EXPECT_NEAR(inbox->scans[0].yaw_first, kPi / 2 - 30.0F * kDegree, 1e-5F);
    }
}

TEST_F(MavlinkEndpointSensors, DistancesAtTheEdges)
{
    ObstacleDistance m = scan();
    m.distances[0] = 0;   // contact
    m.distances[1] = 19;  // nearer than the sensor can measure
    m.distances[2] = 20;
    m.distances[3] = 4000;
    m.distances[4] = 4001;  // nothing
    m.distances[5] = 65534;
    from(kSystem, 154, m);
    const auto& r = inbox->scans[0].ranges;
    EXPECT_FLOAT_EQ(r[0], 0.2F) << "touching must not vanish";
    EXPECT_FLOAT_EQ(r[1], 0.2F);
    EXPECT_FLOAT_EQ(r[2], 0.2F);
    EXPECT_FLOAT_EQ(r[3], 40.0F);
    EXPECT_EQ(r[4], RangeScan::kNothing);
    EXPECT_EQ(r[5], RangeScan::kNothing);
    EXPECT_EQ(r[6], RangeScan::kUnknown);
}

TEST_F(MavlinkEndpointSensors, IncrementsOfEveryKind)
{
    struct Case {
        std::uint8_t increment;
        float increment_f;
        std::size_t sectors;
        float expected;
    };
    for (const Case& c :
         {Case{5, 0.0F, 72, -5.0F}, Case{0, 7.5F, 48, -7.5F}, Case{9, -5.0F, 72, 5.0F}, Case{7, 0.0F, 52, -7.0F},
          Case{1, 0.0F, 72, -1.0F}, Case{180, 0.0F, 2, -180.0F}, Case{0, 0.5F, 72, -0.5F}}) {
        ObstacleDistance m = scan();
        m.increment = c.increment;
        m.increment_f = c.increment_f;
        clear();
        from(kSystem, 154, m);
        ASSERT_EQ(inbox->scans.size(), 1U);
        EXPECT_EQ(inbox->scans[0].ranges.size(), c.sectors);
        EXPECT_NEAR(inbox->scans[0].increment, c.expected * kDegree, 1e-6F);
    }
    EXPECT_EQ(count().out_of_range, 0U);
}

TEST_F(MavlinkEndpointSensors, ScansThatMeanNothingAreRefused)
{
    const auto refused = [&](auto spoil) {
        ObstacleDistance m = scan();
        spoil(m);
        const std::uint32_t before = count().out_of_range + count().not_finite;
        from(kSystem, 154, m);
        EXPECT_EQ(count().out_of_range + count().not_finite, before + 1);
    };
    refused([](ObstacleDistance& m) { m.increment = 0; });
    refused([](ObstacleDistance& m) { m.increment_f = 0.4F; });
    refused([](ObstacleDistance& m) { m.increment = 200; });
    refused([](ObstacleDistance& m) { m.increment_f = kNan; });
    refused([](ObstacleDistance& m) { m.angle_offset = kNan; });
    refused([](ObstacleDistance& m) { m.angle_offset = 1e6F; });
    refused([](ObstacleDistance& m) { m.frame = 8; });
    refused([](ObstacleDistance& m) { m.frame = 20; });
    refused([](ObstacleDistance& m) { m.max_distance = 0; });
    refused([](ObstacleDistance& m) { m.min_distance = 4001; });
    EXPECT_TRUE(inbox->scans.empty());
    EXPECT_EQ(count().not_finite, 2U);
}

TEST_F(MavlinkEndpointSensors, BodyRangesNeedAFreshHeading)
{
    wait(0.9F);
    from(kSystem, 154, scan());
    from(kSystem, 154, reading());
    EXPECT_EQ(inbox->scans.size(), 1U);
    EXPECT_EQ(inbox->readings.size(), 1U);
    wait(0.2F);
    clear();
    from(kSystem, 154, scan());
    from(kSystem, 154, reading());
    EXPECT_TRUE(inbox->scans.empty()) << "nobody knows where it looked";
    EXPECT_TRUE(inbox->readings.empty());
    EXPECT_EQ(count().no_origin, 2U);
    ObstacleDistance north = scan();
    north.frame = 1;
    from(kSystem, 154, north);
    EXPECT_EQ(inbox->scans.size(), 1U);
    DistanceSensor down = reading();
    down.orientation = 25;
    from(kSystem, 154, down);
    EXPECT_EQ(inbox->readings.size(), 1U);
}

/// As a LiDAR at the front and one at the rear, each on its own computer.
TEST_F(MavlinkEndpointSensors, ScansOfOneTypeOfTwoComponentsAreTwoSensors)
{
    for (const std::uint8_t component : {154, 155, 156, 157}) {
        ObstacleDistance m = scan();
        m.distances[0] = static_cast<std::uint16_t>(10 * component);
        from(kSystem, component, m);
    }
    EXPECT_EQ(count().inbox_full, 0U);
    ASSERT_EQ(inbox->scans.size(), 4U);
    std::set<unsigned> sensors;
    for (std::size_t i = 0; i < 4; ++i) {
        EXPECT_FLOAT_EQ(inbox->scans[i].ranges[0], 15.4F + 0.1F * static_cast<float>(i));
        sensors.insert(inbox->scans[i].sensor);
    }
    EXPECT_EQ(sensors.size(), 4U);
    from(kSystem, 158, scan());
    EXPECT_EQ(count().inbox_full, 1U);
    EXPECT_EQ(inbox->scans.size(), 4U);
    ObstacleDistance unknown_type = scan();
    unknown_type.sensor_type = 64;
    from(kSystem, 154, unknown_type);
    EXPECT_EQ(count().out_of_range, 1U);
}

TEST_F(MavlinkEndpointSensors, ScansOfTwoSensorsInATickAreBothKeptAndASecondOfOneReplacesItsFirst)
{
    ObstacleDistance front = scan();
    ObstacleDistance rear = scan();
    front.sensor_type = 0;
    rear.sensor_type = 1;
    front.distances[0] = 1000;
    rear.distances[0] = 2000;
    from(kSystem, 154, front);
    from(kSystem, 154, rear);
    EXPECT_EQ(count().inbox_full, 0U);
    front.distances[0] = 900;
    from(kSystem, 154, front);
    EXPECT_EQ(count().inbox_full, 1U);
    ASSERT_EQ(inbox->scans.size(), 2U);
    EXPECT_FLOAT_EQ(inbox->scans[0].ranges[0], 9.0F);
    EXPECT_FLOAT_EQ(inbox->scans[1].ranges[0], 20.0F);
    EXPECT_EQ(inbox->scans[0].ranges.size(), 72U) << "nothing of the former one";
}

TEST_F(MavlinkEndpointSensors, ReadingsLookWhereTheirOrientationSays)
{
    attitude(0.0F);  // nose north
    const std::array<std::pair<std::uint8_t, Vec3>, 6> cases{
        {{0, {0, 1, 0}}, {2, {1, 0, 0}}, {4, {0, -1, 0}}, {6, {-1, 0, 0}}, {24, {0, 0, 1}}, {25, {0, 0, -1}}}};
    for (const auto& [orientation, direction] : cases) {
        clear();
        DistanceSensor m = reading();
        m.orientation = orientation;
        from(kSystem, 154, m);
        ASSERT_EQ(inbox->readings.size(), 1U);
        expect_near(inbox->readings[0].direction, direction, 1e-5F);
        EXPECT_FLOAT_EQ(inbox->readings[0].range, 12.34F);
        EXPECT_FLOAT_EQ(inbox->readings[0].max_range, 30.0F);
    }
}

/// By component, id, and level, up or down: 32 of them; a level sensor that turns is the same one.
TEST_F(MavlinkEndpointSensors, ReadingsOfSensorsThatAreNotTheSameAreKeptApart)
{
    attitude(0.0F);
    const auto number = [&](std::uint8_t component, std::uint8_t id, std::uint8_t orientation) {
        wait(0.01F);
        attitude(0.0F);
        clear();
        DistanceSensor m = reading();
        m.id = id;
        m.orientation = orientation;
        from(kSystem, component, m);
        return inbox->readings.size() == 1 ? int{inbox->readings[0].sensor} : -1;
    };
    std::set<int> numbers;
    for (const std::uint8_t component : {158, 159}) {
        for (const std::uint8_t id : {0, 1, 255}) {
            for (const std::uint8_t orientation : {0, 24, 25}) {
                EXPECT_TRUE(numbers.insert(number(component, id, orientation)).second);
            }
            EXPECT_TRUE(numbers.contains(number(component, id, 6)));
        }
    }
    const int first = number(158, 0, 0);
    for (int id = 2; id < 100; ++id) {
        const int given = number(160, static_cast<std::uint8_t>(id), 0);
        EXPECT_TRUE(given >= 0 && given < 32) << given;
        EXPECT_NE(given, first);
        EXPECT_EQ(number(158, 0, 0), first) << "heard all the time";
    }
    EXPECT_EQ(endpoint->diagnostics().sensors_evicted, 18U + 98U - 32U);
}

TEST_F(MavlinkEndpointSensors, ReadingsAtTheEdges)
{
    const auto range_of = [&](std::uint16_t centimetres) {
        clear();
        DistanceSensor m = reading();
        m.current_distance = centimetres;
        from(kSystem, 154, m);
        return inbox->readings[0].range;
    };
    EXPECT_FLOAT_EQ(range_of(0), 0.1F);
    EXPECT_FLOAT_EQ(range_of(9), 0.1F);
    EXPECT_FLOAT_EQ(range_of(3000), 30.0F);
    EXPECT_EQ(range_of(3001), RangeScan::kNothing);
    EXPECT_EQ(range_of(65535), RangeScan::kNothing);

    clear();
    DistanceSensor m = reading();
    m.horizontal_fov = 0.5F;
    from(kSystem, 154, m);
    EXPECT_FLOAT_EQ(inbox->readings[0].half_angle, 0.25F);
    m.horizontal_fov = 100.0F;
    from(kSystem, 154, m);
    EXPECT_FLOAT_EQ(inbox->readings[1].half_angle, kPi / 2);
    m.horizontal_fov = -1.0F;
    from(kSystem, 154, m);
    EXPECT_GT(inbox->readings[2].half_angle, 0.0F);
    m.horizontal_fov = std::numeric_limits<float>::denorm_min();
    from(kSystem, 154, m);
    EXPECT_GT(inbox->readings[3].half_angle, 0.01F);
}

TEST_F(MavlinkEndpointSensors, ReadingsThatMeanNothingAreRefused)
{
    const auto refused = [&](auto spoil) {
        DistanceSensor m = reading();
        spoil(m);
        const std::uint32_t before = count().out_of_range + count().not_finite;
        from(kSystem, 154, m);
        EXPECT_EQ(count().out_of_range + count().not_finite, before + 1);
    };
    for (const std::uint8_t orientation : {8, 23, 26, 100, 255}) {
        refused([orientation](DistanceSensor& m) { m.orientation = orientation; });
    }
    refused([](DistanceSensor& m) { m.max_distance = 0; });
    refused([](DistanceSensor& m) { m.min_distance = 3001; });
    refused([](DistanceSensor& m) { m.signal_quality = 1; });
    refused([](DistanceSensor& m) { m.horizontal_fov = kNan; });
    EXPECT_TRUE(inbox->readings.empty());
    EXPECT_EQ(count().not_finite, 1U);
}

TEST_F(MavlinkEndpointSensors, ReadingsBeyondTheInboxAreCounted)
{
    for (std::size_t i = 0; i < inbox->readings.capacity() + 2; ++i) {
        from(kSystem, 154, reading());
    }
    EXPECT_EQ(count().inbox_full, 2U);
}

TEST_F(MavlinkEndpointSensors, RangesOfAnotherSystemAreIgnored)
{
    from(9, 154, scan());
    from(9, 154, reading());
    EXPECT_TRUE(inbox->scans.empty());
    EXPECT_TRUE(inbox->readings.empty());
    EXPECT_EQ(count().frames_ignored, 2U);
}

}  // namespace
}  // namespace jink::link::mavlink
