// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

// Numbers of MAVLink's enumerations that several parts of Endpoint use.

namespace jink::link::mavlink {

inline constexpr std::uint8_t kAutopilotComponent = 1;  // MAV_COMP_ID_AUTOPILOT1
inline constexpr std::uint8_t kAutopilotInvalid = 8;    // MAV_AUTOPILOT_INVALID
inline constexpr std::uint8_t kArmed = 128;             // MAV_MODE_FLAG_SAFETY_ARMED
inline constexpr std::uint8_t kReal32 = 9;              // MAV_PARAM_TYPE_REAL32

// MAV_CMD
inline constexpr std::uint16_t kDoSetMode = 176;
inline constexpr std::uint16_t kDoReposition = 192;
inline constexpr std::uint16_t kSetMessageInterval = 511;
inline constexpr std::uint16_t kRequestMessage = 512;

// MAV_FRAME
inline constexpr std::uint8_t kFrameGlobal = 0;
inline constexpr std::uint8_t kFrameLocalNed = 1;
inline constexpr std::uint8_t kFrameGlobalInt = 5;
inline constexpr std::uint8_t kFrameBodyFrd = 12;

}  // namespace jink::link::mavlink
