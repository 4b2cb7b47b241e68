// SPDX-License-Identifier: BSD-3-Clause
// Heights of traffic by a barometer and by satellites, traffic of other systems, and the ranges of ArduPilot's
// proximity library.
#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "tests/numbers.hpp"
#include "tests/unit/link/mavlink_endpoint_fixture.hpp"

namespace jink::link::mavlink {
namespace {

using namespace test;

/// Pressure at a height in the standard atmosphere, by its barometric formula [hPa].
float standard_pressure(double height)
{
    return static_cast<float>(1013.25 * std::pow(1 - 2.25577e-5 * height, 5.25588));
}

class MavlinkEndpointHeights : public EndpointTest {
protected:
    void SetUp() override
    {
        heartbeat();
        origin();  // 488 m above sea level
        local_position(Vec3(0, 0, -30));
        attitude(0.0F);
        clear();
    }
    /// 100 m above the origin, as reported.
    static AdsbVehicle traffic(std::uint8_t altitude_type)
    {
        AdsbVehicle m;
        m.ICAO_address = 0xABCDEF;
        m.lat = 473977420 + 8983;
        m.lon = 85455940;
        m.altitude = 588000;
        m.flags = 1 | 2;
        m.altitude_type = altitude_type;
        return m;
    }
    void pressure(float hectopascal)
    {
        ScaledPressure m;
        m.press_abs = hectopascal;
        autopilot(m);
    }
    /// Sea level lies `undulation` [mm] above the ellipsoid here.
    void gps(std::int32_t undulation, std::uint8_t fix = 3, std::uint8_t component = 1)
    {
        GpsRawInt m;
        m.alt = 518000;
        m.alt_ellipsoid = m.alt + undulation;
        m.fix_type = fix;
        from(kSystem, component, m);
    }
    TrackReport heard(std::uint8_t altitude_type, std::uint8_t system = kSystem, std::uint8_t component = 156)
    {
        clear();
        from(system, component, traffic(altitude_type));
        return inbox->tracks.empty() ? TrackReport{} : inbox->tracks[0];
    }
    /// Of the sector `i` of ArduPilot's proximity library.
    static DistanceSensor sector(std::uint8_t i, std::uint16_t distance)
    {
        DistanceSensor m;
        m.min_distance = 20;
        m.max_distance = 700;
        m.current_distance = distance;
        m.id = static_cast<std::uint8_t>(10 + i);
        m.orientation = i;
        return m;
    }
};

TEST_F(MavlinkEndpointHeights, OfSatellitesIsExactAndOfABarometerIsNot)
{
    EXPECT_EQ(heard(1).height, HeightSource::geometric);
    EXPECT_EQ(count().pressure_heights, 0U);
    for (const std::uint8_t type : {0, 2, 255}) {
        const TrackReport t = heard(type);
        EXPECT_EQ(t.height, HeightSource::pressure) << int(type);
        EXPECT_NEAR(t.position.z(), 100.0F, 0.01F);
    }
    EXPECT_EQ(count().pressure_heights, 3U);
    EXPECT_EQ(count().heights_compared, 0U);
}

/// Weather: the pressure altitude of where we are is 80 m less than our height. Traffic that sends its standard
/// pressure altitude is then 80 m above its reported height; traffic that knows the pressure at sea level is at it.
TEST_F(MavlinkEndpointHeights, BothReadingsOfAPressureAltitudeAreHeld)
{
    for (const double error : {0.0, 80.0, -120.0}) {
        pressure(standard_pressure(518.0 - error));
        const TrackReport t = heard(0);
        EXPECT_EQ(t.height, HeightSource::compared);
        const double low = double(t.position.z() - t.height_spread);
        const double high = double(t.position.z() + t.height_spread);
        EXPECT_NEAR(low, std::min(100.0, 100.0 + error), 0.5) << error;
        EXPECT_NEAR(high, std::max(100.0, 100.0 + error), 0.5) << error;
    }
    EXPECT_EQ(heard(1).height, HeightSource::geometric);
    EXPECT_NEAR(inbox->tracks[0].position.z(), 100.0F, 0.01F);
}

/// MAVLink does not say whether a geometric altitude is above sea level or above the ellipsoid: in Germany 48 m apart.
TEST_F(MavlinkEndpointHeights, BothReadingsOfAGeometricAltitudeAreHeld)
{
    for (const std::int32_t undulation : {48'000, -35'000, 120'000, -120'000, 1}) {  // changes in flight
        gps(undulation);
        const TrackReport t = heard(1);
        EXPECT_EQ(t.height, HeightSource::geometric);
        const float above_ellipsoid = 100.0F - 1e-3F * static_cast<float>(undulation);
        EXPECT_NEAR(t.position.z() - t.height_spread, std::min(100.0F, above_ellipsoid), 0.01F) << undulation;
        EXPECT_NEAR(t.position.z() + t.height_spread, std::max(100.0F, above_ellipsoid), 0.01F) << undulation;
    }
    EXPECT_EQ(count().pressure_heights, 0U);
}

TEST_F(MavlinkEndpointHeights, AGeometricAltitudeIsAsReportedUntilTheUndulationIsKnown)
{
    const auto as_reported = [&] {
        const TrackReport t = heard(1);
        return std::abs(t.position.z() - 100.0F) < 0.01F && t.height_spread == 0.0F;
    };
    EXPECT_TRUE(as_reported());
    EXPECT_FALSE(endpoint->undulation());
    gps(48'000, 2);  // no 3D fix
    gps(-518'000);   // ellipsoid height 0: unknown
    gps(121'000);    // no geoid on earth
    gps(-121'000);
    gps(48'000, 3, 156);  // not the autopilot's
    EXPECT_TRUE(as_reported());
    EXPECT_FALSE(endpoint->undulation());
    gps(48'000);
    EXPECT_NEAR(heard(1).height_spread, 24.0F, 0.01F);
    gps(121'000);
    gps(10'000, 2);
    EXPECT_NEAR(heard(1).height_spread, 24.0F, 0.01F) << "the last good one counts";
    EXPECT_EQ(endpoint->undulation(), 48'000);
    gps(0);
    EXPECT_TRUE(as_reported()) << "sea level and ellipsoid are the same here";
    EXPECT_EQ(endpoint->undulation(), 0);
}

TEST_F(MavlinkEndpointHeights, TheUndulationLeavesPressureAltitudesAlone)
{
    gps(48'000);
    EXPECT_NEAR(heard(0).position.z(), 100.0F, 0.01F);
    EXPECT_EQ(heard(0).height_spread, 0.0F);
    pressure(standard_pressure(518.0 - 80.0));
    const TrackReport t = heard(0);
    EXPECT_EQ(t.height, HeightSource::compared);
    EXPECT_NEAR(t.position.z(), 140.0F, 0.5F);
    EXPECT_NEAR(t.height_spread, 40.0F, 0.5F);
}

TEST_F(MavlinkEndpointHeights, AnOwnPressureThatIsNoneIsNotUsed)
{
    for (const float bad : {0.0F, 50.0F, 1300.0F, 700.0F}) {  // the last: 2.5 km off
        const std::uint32_t before = count().out_of_range;
        pressure(bad);
        EXPECT_EQ(count().out_of_range, before + 1) << bad;
        EXPECT_EQ(heard(0).height, HeightSource::pressure) << bad;
    }
    pressure(kNan);
    EXPECT_EQ(count().not_finite, 1U);
    EXPECT_EQ(heard(0).height, HeightSource::pressure);
}

TEST_F(MavlinkEndpointHeights, AnOldPressureIsNotUsed)
{
    pressure(standard_pressure(518.0));
    wait(9.9F);
    EXPECT_EQ(heard(0).height, HeightSource::compared);
    wait(0.2F);
    EXPECT_EQ(heard(0).height, HeightSource::pressure);
    pressure(standard_pressure(518.0));
    EXPECT_EQ(heard(0).height, HeightSource::pressure) << "the own height is 10 s old";
}

/// A receiver on the ground, with a system id of its own.
TEST_F(MavlinkEndpointHeights, TrafficOfAnotherSystemIsTakenUnlessItsAutopilotPassesItOn)
{
    EXPECT_EQ(heard(1, 255, 190).id, 0xABCDEFU);
    EXPECT_EQ(heard(1, 9, 156).id, 0xABCDEFU);
    EXPECT_EQ(count().traffic_relayed, 2U);
    EXPECT_EQ(heard(1, kSystem, 1).id, 0xABCDEFU) << "our autopilot's receiver";
    EXPECT_EQ(count().traffic_relayed, 2U);
    const std::uint32_t before = count().frames_ignored;
    EXPECT_EQ(heard(1, 9, 1).id, 0U) << "what it hears may be us";
    EXPECT_EQ(count().frames_ignored, before + 1);
}

TEST_F(MavlinkEndpointHeights, AProximitySectorAtItsReachIsClear)
{
    for (std::uint8_t i = 0; i < 8; ++i) {
        clear();
        autopilot(sector(i, 700));
        ASSERT_EQ(inbox->readings.size(), 1U);
        EXPECT_EQ(inbox->readings[0].range, RangeScan::kNothing);
        EXPECT_FLOAT_EQ(inbox->readings[0].half_angle, kPi / 8) << "an eighth of the circle";
        clear();
        autopilot(sector(i, 699));
        EXPECT_FLOAT_EQ(inbox->readings[0].range, 6.99F);
    }
    DistanceSensor up = sector(9, 700);
    up.orientation = 24;
    clear();
    autopilot(up);
    EXPECT_EQ(inbox->readings[0].range, RangeScan::kNothing);
    EXPECT_LT(inbox->readings[0].half_angle, kPi / 8) << "no sector";
}

/// A reading at its reach is a distance to a range finder: the message has no other word for it.
TEST_F(MavlinkEndpointHeights, RangeFindersAndOtherAutopilotsAreNotProximitySectors)
{
    DistanceSensor finder = sector(0, 700);
    finder.id = 9;
    autopilot(finder);
    from(kSystem, 154, sector(0, 700));
    heartbeat(12);
    autopilot(sector(0, 700));
    ASSERT_EQ(inbox->readings.size(), 3U);
    for (const RangeReading& reading : inbox->readings) {
        EXPECT_FLOAT_EQ(reading.range, 7.0F);
        EXPECT_LT(reading.half_angle, kPi / 8);
    }
}

}  // namespace
}  // namespace jink::link::mavlink
