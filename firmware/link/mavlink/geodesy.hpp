// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <cstdint>
#include <optional>

#include "core/base/vec3.hpp"
#include "firmware/link/global_position.hpp"

namespace jink::link::mavlink {

using link::GlobalPosition;

inline constexpr float kEarthRadius = 6378137.0F;  ///< [m]

/// Converts between North, East, Down on the wire and our ENU: the same swap both ways.
[[nodiscard]] inline Vec3 swap_ned_enu(const Vec3& v) noexcept { return {v.y(), v.x(), -v.z()}; }
/// Converts between compass angle (clockwise from north) and ENU yaw (counter-clockwise from east): the same both ways
/// [rad].
[[nodiscard]] inline float swap_heading_yaw(float angle) noexcept { return 0.5F * kPi - angle; }

/// Latitude and longitude within their range (a longitude of 180 degrees counts as both).
[[nodiscard]] constexpr bool is_on_earth(const GlobalPosition& p) noexcept
{
    return p.lat >= -900000000 && p.lat <= 900000000 && p.lon >= -1800000000 && p.lon <= 1800000000;
}

/// Beyond this latitude there is no local map: its east direction turns too fast [degE7].
inline constexpr std::int32_t kHighestLatitude = 850000000;

/// Largest error of a local position against great circle and bearing (the azimuthal projection that PX4 uses;
/// ArduPilot differs from it by half the second-order term), on the same sphere, for places within 10 km of the origin
/// [m].
inline constexpr float kMapError = 0.05F;      ///< up to 60 degrees of latitude
inline constexpr float kPolarMapError = 1.0F;  ///< up to kHighestLatitude
/// Distance from the origin up to which both bounds hold [m].
inline constexpr float kMapReach = 10'000.0F;

/// Position relative to `origin` [m, ENU], on a sphere, to second order in the distance: see kMapError. Differences are
/// computed in integers, without rounding. PX4 uses a radius that is 0.11 % smaller than ours and ArduPilot's: 1 m in 1
/// km.
[[nodiscard]] inline Vec3 to_local(const GlobalPosition& p, const GlobalPosition& origin) noexcept
{
    constexpr std::int64_t kTurn = 3600000000LL;
    constexpr float kRadians = 1e-7F * kPi / 180.0F;
    std::int64_t dlon = static_cast<std::int64_t>(p.lon) - origin.lon;
    dlon += dlon > kTurn / 2 ? -kTurn : dlon < -kTurn / 2 ? kTurn : 0;
    const std::int64_t dlat = static_cast<std::int64_t>(p.lat) - origin.lat;
    const float lat0 = static_cast<float>(origin.lat) * kRadians;
    const float sine = std::sin(lat0);
    const float cosine = std::cos(lat0);
    const float north = static_cast<float>(dlat) * kRadians;
    const float turn = static_cast<float>(dlon) * kRadians;
    return {kEarthRadius * turn * (cosine - sine * north), kEarthRadius * (north + 0.5F * turn * turn * sine * cosine),
            static_cast<float>(static_cast<std::int64_t>(p.alt) - origin.alt) * 1e-3F};
}

/// The inverse of `to_local`: position on the globe of a local position (components up to 1000 km). Same accuracy.
/// Nothing if the origin or the result lies beyond kHighestLatitude or the altitude is out of range.
[[nodiscard]] inline std::optional<GlobalPosition> to_global(const Vec3& local, const GlobalPosition& origin) noexcept
{
    constexpr std::int64_t kTurn = 3600000000LL;
    constexpr std::int64_t kHighestAltitude = 1000000000;
    constexpr float kRadians = 1e-7F * kPi / 180.0F;
    if (origin.lat < -kHighestLatitude || origin.lat > kHighestLatitude) {
        return std::nullopt;
    }
    const float lat0 = static_cast<float>(origin.lat) * kRadians;
    const float east = local.x() / kEarthRadius;
    const float north = local.y() / kEarthRadius - 0.5F * east * east * std::tan(lat0);
    const std::int64_t lat = origin.lat + std::llround(north / kRadians);
    const std::int64_t alt = origin.alt + std::llround(local.z() * 1e3F);
    if (lat < -kHighestLatitude || lat > kHighestLatitude || alt < -kHighestAltitude || alt > kHighestAltitude) {
        return std::nullopt;
    }
    std::int64_t lon = origin.lon + std::llround(east / ((std::cos(lat0) - std::sin(lat0) * north) * kRadians));
    lon += lon > kTurn / 2 ? -kTurn : lon < -kTurn / 2 ? kTurn : 0;
    return GlobalPosition{static_cast<std::int32_t>(lat), static_cast<std::int32_t>(lon),
                          static_cast<std::int32_t>(alt)};
}

}  // namespace jink::link::mavlink
