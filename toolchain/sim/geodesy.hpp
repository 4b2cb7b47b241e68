// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "toolchain/sim/scenario.hpp"

namespace jink::sim {

/// Global position in wire format.
struct GlobalPosition {
    std::int32_t lat = 0;  ///< [degE7]
    std::int32_t lon = 0;  ///< [degE7]
    std::int32_t alt = 0;  ///< above mean sea level [mm]
};

/// Home position in the Alps, so that a degree of longitude differs strongly from a degree of latitude.
inline constexpr double kHomeLatitude = 46.7;
inline constexpr double kHomeLongitude = 8.2;
inline constexpr double kHomeAltitude = 570.0;

/// Global position of a point in the local frame by the autopilot's own projection: ArduPilot's plane with its constant
/// scaling factor, PX4's azimuthal equidistant projection on a sphere of 6371000 m. Both differ on purpose from the
/// co-processor's projection.
[[nodiscard]] GlobalPosition to_global(const Vec& local, Stack stack) noexcept;
/// Inverse of ArduPilot's projection.
[[nodiscard]] Vec to_local(const GlobalPosition& global) noexcept;

}  // namespace jink::sim
