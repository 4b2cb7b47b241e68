// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <cstdint>
#include <optional>

#include "core/base/vec3.hpp"

namespace jink::link::mavlink {

/// Position on the wire: degrees * 1e7, millimetres above mean sea level.
struct GlobalPosition {
    std::int32_t lat = 0;
    std::int32_t lon = 0;
    std::int32_t alt = 0;
};

inline constexpr float kMetresPerDegE7 = 6378137.0F * kPi / 180.0F * 1e-7F;

/// North, east, down on the wire and our ENU: the same swap both ways.
[[nodiscard]] inline Vec3 swap_ned_enu(const Vec3& v) noexcept { return {v.y(), v.x(), -v.z()}; }
/// Compass angle (clockwise from north) and ENU yaw (counter-clockwise from east): the same both ways [rad].
[[nodiscard]] inline float swap_heading_yaw(float angle) noexcept { return 0.5F * kPi - angle; }

/// Latitude and longitude within their range (a longitude of 180 degrees counts as both).
[[nodiscard]] constexpr bool is_on_earth(const GlobalPosition& p) noexcept
{
    return p.lat >= -900000000 && p.lat <= 900000000 && p.lon >= -1800000000 && p.lon <= 1800000000;
}

/// Position relative to `origin` on the plane that touches the sphere there [m, ENU]. Differences are taken in
/// integers, so the error is that of the plane: below 1 m within 10 km of the origin up to 60 degrees of latitude.
[[nodiscard]] inline Vec3 to_local(const GlobalPosition& p, const GlobalPosition& origin) noexcept
{
    constexpr std::int64_t kTurn = 3600000000LL;
    std::int64_t dlon = static_cast<std::int64_t>(p.lon) - origin.lon;
    if (dlon > kTurn / 2) {
        dlon -= kTurn;
    } else if (dlon < -kTurn / 2) {
        dlon += kTurn;
    }
    const std::int64_t dlat = static_cast<std::int64_t>(p.lat) - origin.lat;
    const float cosine = std::cos(static_cast<float>(origin.lat) * 1e-7F * kPi / 180.0F);
    return {static_cast<float>(dlon) * kMetresPerDegE7 * cosine, static_cast<float>(dlat) * kMetresPerDegE7,
            static_cast<float>(static_cast<std::int64_t>(p.alt) - origin.alt) * 1e-3F};
}

/// Beyond this latitude a plane with meridians for one axis is no map any more [degE7].
inline constexpr std::int32_t kHighestLatitude = 850000000;

/// The inverse of `to_local`: where a local position (components up to 1000 km) lies on the globe. Same accuracy.
/// Nothing when the origin or the result lies beyond kHighestLatitude or the altitude does not fit.
[[nodiscard]] inline std::optional<GlobalPosition> to_global(const Vec3& local, const GlobalPosition& origin) noexcept
{
    constexpr std::int64_t kTurn = 3600000000LL;
    constexpr std::int64_t kHighestAltitude = 1000000000;
    if (origin.lat < -kHighestLatitude || origin.lat > kHighestLatitude) {
        return std::nullopt;
    }
    const float cosine = std::cos(static_cast<float>(origin.lat) * 1e-7F * kPi / 180.0F);
    const std::int64_t lat = origin.lat + static_cast<std::int64_t>(local.y() / kMetresPerDegE7);
    const std::int64_t alt = origin.alt + static_cast<std::int64_t>(local.z() * 1e3F);
    std::int64_t lon = origin.lon + static_cast<std::int64_t>(local.x() / (kMetresPerDegE7 * cosine));
    lon += lon > kTurn / 2 ? -kTurn : lon < -kTurn / 2 ? kTurn : 0;
    if (lat < -kHighestLatitude || lat > kHighestLatitude || alt < -kHighestAltitude || alt > kHighestAltitude) {
        return std::nullopt;
    }
    return GlobalPosition{static_cast<std::int32_t>(lat), static_cast<std::int32_t>(lon),
                          static_cast<std::int32_t>(alt)};
}

}  // namespace jink::link::mavlink
