// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "firmware/link/dronecan/codec.hpp"

// Data types of sensors and traffic receivers; see messages.hpp.

namespace jink::link::dronecan {

struct RangeMeasurement {
    static constexpr TypeInfo kType{TransferKind::message, 1050, 0x049C, 15};
    enum class Reading : std::uint8_t { undefined = 0, valid = 1, too_close = 2, too_far = 3 };
    std::uint64_t stamp = 0;  ///< [us] of the bus's common clock, 56 bits; 0: not given
    std::uint8_t sensor = 0;
    std::array<std::int8_t, 3> roll_pitch_yaw{};  ///< of the beam, body frame (FRD), fifteenths of half a turn
    bool orientation_defined = false;
    float field_of_view = 0.0F;    ///< [rad]
    std::uint8_t sensor_type = 0;  ///< 1 sonar, 2 lidar, 3 radar
    Reading reading = Reading::undefined;
    float range = 0.0F;  ///< [m]

    template <class Io, class Self>
    static constexpr void describe(Io& io, Self& m) noexcept
    {
        io(u<56>, m.stamp);
        io(u<8>, m.sensor);
        io(each(s<5>), m.roll_pitch_yaw);
        io(u<1>, m.orientation_defined);
        io(f16, m.field_of_view);
        io(u<5>, m.sensor_type);
        io(u<3>, m.reading);
        io(f16, m.range);
    }
};

struct Proximity {
    static constexpr TypeInfo kType{TransferKind::message, 21910, 0x96AC, 8};
    enum class Reading : std::uint8_t { no_data = 0, not_connected = 1, good = 2 };
    std::uint8_t sensor = 0;
    Reading reading = Reading::no_data;
    std::uint8_t flags = 0;
    float yaw = 0.0F;       ///< [deg] clockwise from the nose
    float pitch = 0.0F;     ///< [deg] upwards
    float distance = 0.0F;  ///< [m]

    template <class Io, class Self>
    static constexpr void describe(Io& io, Self& m) noexcept
    {
        io(u<8>, m.sensor);
        io(u<3>, m.reading);
        io(u<5>, m.flags);
        io(f16, m.yaw);
        io(f16, m.pitch);
        io(f16, m.distance);
    }
};

struct TrafficReport {
    static constexpr TypeInfo kType{TransferKind::message, 20790, 0x71FB, 47};
    static constexpr std::uint8_t kUnmanned = 14;
    static constexpr std::uint8_t kPointObstacle = 19;
    static constexpr std::uint8_t kGeometricAltitude = 2;  ///< ALT_TYPE_WGS84
    std::uint64_t stamp = 0;                               ///< [us], 56 bits; 0: not given
    std::uint32_t icao = 0;
    std::uint16_t tslc = 0;                    ///< time since the last reception [s]
    std::int32_t latitude = 0, longitude = 0;  ///< [deg 1e-7]
    float altitude = 0.0F;                     ///< [m]
    float heading = 0.0F;                      ///< [rad]
    std::array<float, 3> velocity{};           ///< [m/s], NED
    std::uint16_t squawk = 0;
    std::array<std::uint8_t, 9> callsign{};
    std::uint8_t source = 0;  ///< 0 ADS-B, 1 UAT, 2 FLARM
    std::uint8_t traffic_type = 0;
    std::uint8_t altitude_type = 0;  ///< 0 unknown, 1 pressure above mean sea level, 2 WGS84
    bool position_valid = false, heading_valid = false, velocity_valid = false, callsign_valid = false;
    bool ident_valid = false, simulated = false, vertical_velocity_valid = false, baro_valid = false;

    template <class Io, class Self>
    static constexpr void describe(Io& io, Self& m) noexcept
    {
        io(u<56>, m.stamp);
        io(u<32>, m.icao);
        io(u<16>, m.tslc);
        io(s<32>, m.latitude);
        io(s<32>, m.longitude);
        io(f32, m.altitude);
        io(f16, m.heading);
        io(each(f16), m.velocity);
        io(u<16>, m.squawk);
        io(each(u<8>), m.callsign);
        io(u<3>, m.source);
        io(u<5>, m.traffic_type);
        io(u<7>, m.altitude_type);
        io(u<1>, m.position_valid);
        io(u<1>, m.heading_valid);
        io(u<1>, m.velocity_valid);
        io(u<1>, m.callsign_valid);
        io(u<1>, m.ident_valid);
        io(u<1>, m.simulated);
        io(u<1>, m.vertical_velocity_valid);
        io(u<1>, m.baro_valid);
    }
};

/// GNSS fix, without the ECEF position that may follow.
struct Fix2 {
    static constexpr TypeInfo kType{TransferKind::message, 1063, 0xC798, 222};
    enum class Status : std::uint8_t { no_fix = 0, time_only = 1, fix_2d = 2, fix_3d = 3 };
    std::uint64_t stamp = 0, gnss_stamp = 0;  ///< [us], 56 bits; 0: not given
    std::uint8_t time_standard = 0, leap_seconds = 0;
    std::int64_t longitude = 0, latitude = 0;           ///< [deg 1e-8]
    std::int32_t height_ellipsoid = 0, height_msl = 0;  ///< [mm], 27 bits
    std::array<float, 3> velocity{};                    ///< [m/s], NED
    std::uint8_t satellites = 0;
    Status status = Status::no_fix;
    std::uint8_t mode = 0, sub_mode = 0;
    StaticVector<float, 36> covariance;  ///< position and velocity [m2, m2/s2]: 1, 6 (diagonal), 21 or 36 numbers
    float pdop = 0.0F;

    template <class Io, class Self>
    static constexpr void describe(Io& io, Self& m) noexcept
    {
        io(u<56>, m.stamp);
        io(u<56>, m.gnss_stamp);
        io(u<3>, m.time_standard);
        io(filler<13>);
        io(u<8>, m.leap_seconds);
        io(s<37>, m.longitude);
        io(s<37>, m.latitude);
        io(s<27>, m.height_ellipsoid);
        io(s<27>, m.height_msl);
        io(each(f32), m.velocity);
        io(u<6>, m.satellites);
        io(u<2>, m.status);
        io(u<4>, m.mode);
        io(u<6>, m.sub_mode);
        io(list(f16), m.covariance);
        io(f16, m.pdop);
        io(rest);
    }
};

struct AhrsSolution {
    static constexpr TypeInfo kType{TransferKind::message, 1000, 0x2055, 84};
    using Covariance = StaticVector<float, 9>;
    std::uint64_t stamp = 0;             ///< [us], 56 bits; 0: not given
    std::array<float, 4> orientation{};  ///< quaternion x, y, z, w
    Covariance orientation_covariance;
    std::array<float, 3> angular_velocity{};  ///< [rad/s]
    Covariance angular_velocity_covariance;
    std::array<float, 3> acceleration{};  ///< [m/s2]
    Covariance acceleration_covariance;

    template <class Io, class Self>
    static constexpr void describe(Io& io, Self& m) noexcept
    {
        io(u<56>, m.stamp);
        io(each(f16), m.orientation);
        io(filler<4>);
        io(list(f16), m.orientation_covariance);
        io(each(f16), m.angular_velocity);
        io(filler<4>);
        io(list(f16), m.angular_velocity_covariance);
        io(each(f16), m.acceleration);
        io(tail(f16), m.acceleration_covariance);
    }
};

}  // namespace jink::link::dronecan
