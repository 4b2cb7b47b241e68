// SPDX-License-Identifier: BSD-3-Clause
#include "toolchain/sim/geodesy.hpp"

#include <cmath>
#include <numbers>

namespace jink::sim {
namespace {

constexpr double kDegrees = 180.0 / std::numbers::pi;
/// Metres per 1e-7 degree of latitude (ArduPilot, LOCATION_SCALING_FACTOR).
constexpr double kArdupilotScaling = 0.011131884502145034;
/// Earth's radius in PX4's map projection [m].
constexpr double kPx4Radius = 6371000.0;

struct Degrees {
    double lat, lon;
};

Degrees on_plane(double north, double east) noexcept
{
    const double scale = std::cos(kHomeLatitude / kDegrees);
    return {kHomeLatitude + north / kArdupilotScaling * 1e-7,
            kHomeLongitude + east / (kArdupilotScaling * scale) * 1e-7};
}

Degrees on_sphere(double north, double east) noexcept
{
    const double c = std::hypot(north, east) / kPx4Radius;
    if (c < 1e-15) {
        return {kHomeLatitude, kHomeLongitude};
    }
    const double x = north / kPx4Radius;
    const double y = east / kPx4Radius;
    const double lat0 = kHomeLatitude / kDegrees;
    const double lat = std::asin(std::cos(c) * std::sin(lat0) + x * std::sin(c) * std::cos(lat0) / c);
    const double lon = std::atan2(y * std::sin(c), c * std::cos(lat0) * std::cos(c) - x * std::sin(lat0) * std::sin(c));
    return {lat * kDegrees, kHomeLongitude + lon * kDegrees};
}

}  // namespace

Vec to_local(const GlobalPosition& global) noexcept
{
    const double north = (static_cast<double>(global.lat) - kHomeLatitude * 1e7) * kArdupilotScaling;
    const double east = (static_cast<double>(global.lon) - kHomeLongitude * 1e7) * kArdupilotScaling *
                        std::cos(kHomeLatitude / kDegrees);
    return {east, north, static_cast<double>(global.alt) * 1e-3 - kHomeAltitude};
}

GlobalPosition to_global(const Vec& local, Stack stack) noexcept
{
    const Degrees d = stack == Stack::ardupilot ? on_plane(local.y(), local.x()) : on_sphere(local.y(), local.x());
    return {static_cast<std::int32_t>(std::lround(d.lat * 1e7)), static_cast<std::int32_t>(std::lround(d.lon * 1e7)),
            static_cast<std::int32_t>(std::lround((kHomeAltitude + local.z()) * 1e3))};
}

}  // namespace jink::sim
