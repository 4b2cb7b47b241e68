// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "firmware/link/messages.hpp"

namespace jink::link::mavlink {

/// Mode numbers of the autopilots (their own source code; docs/guides/take_over.md).
enum class VehicleClass : std::uint8_t { copter, plane };

/// Vehicle class whose mode numbers and rules apply. ArduPilot's VTOLs are QuadPlanes: ArduPlane (Q_MAV_TYPE).
[[nodiscard]] VehicleClass vehicle_class(AutopilotStack stack, std::uint8_t mav_type) noexcept;
/// No EXTENDED_SYS_STATE received. MAV_VTOL_STATE 0 means that the vehicle is no VTOL, or that its state is unknown.
inline constexpr std::uint8_t kVtolUnheard = 255;

/// Whether jink can steer the vehicle in the external mode: by velocities, or a plane of ArduPlane by guided points.
/// ArduPlane reports a QuadPlane as a fixed wing too (Q_MAV_TYPE 0); its vtol_state distinguishes both.
/// @param vtol_state  MAV_VTOL_STATE of EXTENDED_SYS_STATE, or kVtolUnheard
[[nodiscard]] bool is_steerable(AutopilotStack stack, std::uint8_t mav_type, std::uint8_t vtol_state) noexcept;
/// Meaning of a custom_mode.
[[nodiscard]] FlightMode classify(AutopilotStack stack, VehicleClass vehicle, std::uint32_t custom_mode) noexcept;
/// custom_mode of the mode that follows a companion's set-points, and of the holding mode.
[[nodiscard]] std::uint32_t external_mode(AutopilotStack stack, VehicleClass vehicle) noexcept;
[[nodiscard]] std::uint32_t hold_mode(AutopilotStack stack, VehicleClass vehicle) noexcept;

/// PX4 packs main and sub mode into custom_mode.
[[nodiscard]] constexpr std::uint32_t px4_mode(std::uint32_t main, std::uint32_t sub) noexcept
{
    return main << 16U | sub << 24U;
}
[[nodiscard]] constexpr std::uint32_t px4_main(std::uint32_t custom) noexcept { return custom >> 16U & 0xFFU; }
[[nodiscard]] constexpr std::uint32_t px4_sub(std::uint32_t custom) noexcept { return custom >> 24U; }

}  // namespace jink::link::mavlink
