// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gtest/gtest.h>

#include <cmath>

#include "tests/numbers.hpp"
#include "tests/unit/link/dronecan_tools.hpp"

namespace jink::link::dronecan::test {

inline constexpr double kHalfPi = 1.5707963267948966;
inline constexpr std::int32_t kLatitude = 474000000;
inline constexpr std::int32_t kLongitude = 85000000;

inline NodeOptions options_of(std::uint8_t id)
{
    NodeOptions options;
    options.node = id;
    return options;
}

class DronecanEndpoint : public testing::Test {
protected:
    template <Described M>
    void give(const M& message, std::uint8_t source = 20)
    {
        std::uint8_t& transfer = transfers_[source];
        for (const Frame& frame : frames_of(message, source, transfer)) {
            static_cast<void>(endpoint.receive(frame, now, inbox));
        }
        transfer = static_cast<std::uint8_t>((transfer + 1U) % kTransferIds);
    }
    /// 111 m north of the origin per 1e-3 degrees.
    static Fix2 fix(std::int64_t north = 0, std::int64_t east = 0)
    {
        Fix2 m;
        m.latitude = (std::int64_t{kLatitude} + north) * 10;
        m.longitude = (std::int64_t{kLongitude} + east) * 10;
        m.height_msl = 500'000;
        m.velocity = {3.0F, 1.0F, -0.5F};
        m.status = Fix2::Status::fix_3d;
        return m;
    }
    /// Turned by yaw (clockwise from north), then pitch (nose up), then roll (right wing down) [rad].
    static AhrsSolution attitude(double yaw, double pitch = 0.0, double roll = 0.0)
    {
        const double cy = std::cos(yaw / 2), sy = std::sin(yaw / 2);
        const double cp = std::cos(pitch / 2), sp = std::sin(pitch / 2);
        const double cr = std::cos(roll / 2), sr = std::sin(roll / 2);
        AhrsSolution m;
        m.orientation = {
            static_cast<float>(sr * cp * cy - cr * sp * sy), static_cast<float>(cr * sp * cy + sr * cp * sy),
            static_cast<float>(cr * cp * sy - sr * sp * cy), static_cast<float>(cr * cp * cy + sr * sp * sy)};
        return m;
    }
    static TrafficReport traffic()
    {
        TrafficReport m;
        m.icao = 0xABCDEF;
        m.tslc = 2;
        m.latitude = kLatitude + 10000;  // 111.3 m north
        m.longitude = kLongitude;
        m.altitude = 530.0F;
        m.velocity = {10.0F, -20.0F, 2.0F};
        m.position_valid = m.velocity_valid = m.vertical_velocity_valid = true;
        return m;
    }
    static Proximity proximity(float yaw, float distance, float pitch = 0.0F)
    {
        Proximity m;
        m.sensor = 7;
        m.reading = Proximity::Reading::good;
        m.yaw = yaw;
        m.pitch = pitch;
        m.distance = distance;
        return m;
    }
    static RangeMeasurement measurement(std::int8_t pitch = 0, std::int8_t yaw = 0)
    {
        RangeMeasurement m;
        m.sensor = 3;
        m.roll_pitch_yaw = {0, pitch, yaw};
        m.orientation_defined = true;
        m.field_of_view = 0.2F;
        m.reading = RangeMeasurement::Reading::valid;
        m.range = 8.0F;
        return m;
    }
    const LinkDiagnostics& seen() { return endpoint.diagnostics(); }

    EndpointOptions options_{true, {kLatitude, kLongitude, 480'000}, false, 1.0F};
    Endpoint endpoint{options_of(42), options_};
    Inbox inbox;
    TimePoint now{10'000'000};
    std::array<std::uint8_t, 128> transfers_{};
};

inline void expect_near(const Vec3& got, const Vec3& expected, float tolerance)
{
    EXPECT_LE((got - expected).norm(), tolerance) << got.x() << " " << got.y() << " " << got.z();
}

}  // namespace jink::link::dronecan::test
