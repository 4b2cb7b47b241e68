// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>

#include "toolchain/sim/scenario.hpp"

namespace jink::sim {

/// HEARTBEAT.custom_mode of a mode, from the autopilots' own sources: Copter's or ArduPlane's numbers, PX4's
/// main << 16 | sub << 24.
[[nodiscard]] constexpr std::uint32_t custom_mode(Stack stack, Mode mode, bool plane = false) noexcept
{
    if (plane) {
        switch (mode) {
        case Mode::mission: return 10;  // AUTO
        case Mode::external:
        case Mode::guided: return 15;  // GUIDED
        case Mode::hold:
        case Mode::brake: return 12;  // LOITER
        case Mode::home:
        case Mode::land: return 11;  // RTL: it has no LAND
        case Mode::pilot: return 6;  // FLY_BY_WIRE_B
        }
    }
    const auto px4 = [](std::uint32_t main, std::uint32_t sub) { return main << 16U | sub << 24U; };
    const bool ardupilot = stack == Stack::ardupilot;
    switch (mode) {
    case Mode::mission: return ardupilot ? 3 : px4(4, 4);   // AUTO; AUTO.MISSION
    case Mode::external: return ardupilot ? 4 : px4(6, 0);  // GUIDED; OFFBOARD
    case Mode::hold: return ardupilot ? 5 : px4(4, 3);      // LOITER; AUTO.LOITER
    case Mode::brake: return ardupilot ? 17 : px4(4, 3);    // BRAKE; PX4 has none
    case Mode::home: return ardupilot ? 6 : px4(4, 5);      // RTL; AUTO.RTL
    case Mode::land: return ardupilot ? 9 : px4(4, 6);      // LAND; AUTO.LAND
    case Mode::guided: return ardupilot ? 4 : px4(4, 3);    // GUIDED; AUTO.LOITER
    case Mode::pilot: break;
    }
    return ardupilot ? 16 : px4(3, 0);  // POSHOLD; POSCTL
}

/// The mode that param2 and param3 of DO_SET_MODE request; nothing for unknown mode numbers.
[[nodiscard]] constexpr std::optional<Mode> requested_mode(Stack stack, float param2, float param3,
                                                           bool plane = false) noexcept
{
    for (const Mode mode :
         {Mode::mission, Mode::external, Mode::hold, Mode::brake, Mode::home, Mode::pilot, Mode::land}) {
        const std::uint32_t number = custom_mode(stack, mode, plane);
        const float first =
            stack == Stack::ardupilot ? static_cast<float>(number) : static_cast<float>(number >> 16U & 0xFFU);
        const float second = stack == Stack::ardupilot ? param3 : static_cast<float>(number >> 24U);
        if (param2 == first && param3 == second) {
            return mode;
        }
    }
    return std::nullopt;
}

}  // namespace jink::sim
