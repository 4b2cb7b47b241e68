// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>

#include "firmware/link/messages.hpp"

namespace jink::sim {

/// The autopilot's own name for HEARTBEAT.custom_mode.
///
/// ArduPilot: Mode::Number of ArduCopter and of ArduPlane (fixed wing) in its `mode.h`. PX4: main mode of
/// `px4_custom_mode.h`; in AUTO the sub mode by the name that its documentation gives the flight mode (HOLD for
/// AUTO.LOITER). A number without a name here: the number itself. An unknown stack: the number itself.
[[nodiscard]] std::string mode_name(link::AutopilotStack stack, bool fixed_wing, std::uint32_t custom_mode);

}  // namespace jink::sim
