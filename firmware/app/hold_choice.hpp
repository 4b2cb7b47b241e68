// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/vehicle/vehicle.hpp"
#include "core/world/conflict.hpp"
#include "core/world/world.hpp"

namespace jink::app {

/// Whether an autopilot that does not give control had better stop than fly on. Asked once there is just the time to
/// stop before the conflict.
///
/// In front of a static obstacle, or of a threat slower than kHoldStands: always. Traffic flies on: stopping helps
/// where the vehicle stays farther from it than on its own path, by kHoldBetter at least, while it brakes and at rest,
/// for kHoldAhead. A crossing is such a case. An intruder from ahead or behind is not: it would hit a vehicle that
/// brakes or stands.
///
/// @param track  the threat as in the situation of `own`; nullptr: an obstacle or closed area
[[nodiscard]] bool is_stopping_safer(const vehicle::VehicleState& own, const vehicle::VehicleLimits& limits,
                                     const world::Conflict& conflict, const world::Track* track) noexcept;

inline constexpr Seconds kHoldAhead = 30.0F;
inline constexpr float kHoldBetter = 1.0F;  // [m]
inline constexpr float kHoldStands = 0.5F;  // [m/s]

}  // namespace jink::app
