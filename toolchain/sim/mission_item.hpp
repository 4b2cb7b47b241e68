// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "toolchain/sim/vec.hpp"

namespace jink::sim {

/// The autopilot's mode, independent of the stack's name for it.
enum class Mode : std::uint8_t {
    mission,
    external,  ///< GUIDED or OFFBOARD, requested by the co-processor
    hold,
    brake,
    home,
    pilot,
    land,
    guided,  ///< flies to a place set by another sender: ArduPilot's GUIDED, PX4's AUTO.LOITER after DO_REPOSITION
};

/// Kind of a mission item.
enum class ItemKind : std::uint8_t {
    waypoint,
    spline,  ///< curve to the place; ArduPilot only
    turns,   ///< circles about the place, LOITER_TURNS; ArduPilot only
    wait,    ///< stays at the place, LOITER_TIME; a plane circles about it
    take_off,
    land,
    home,    ///< RETURN_TO_LAUNCH
    speed,   ///< DO_CHANGE_SPEED
    jump,    ///< DO_JUMP
    circle,  ///< circles about the place without end, LOITER_UNLIM; planes only
};

struct Item {
    ItemKind kind = ItemKind::waypoint;
    Vec place = Vec::Zero();  ///< in the local frame
    /// turns: radius [m]; wait: [s]; speed: [m/s]; jump: index of the item that follows, counted without ArduPilot's
    /// home
    double value = 0.0;
    int count = 0;  ///< turns: number of turns; jump: number of jumps
};

/// A flight with more than the legs between a scenario's waypoints.
struct NominalFlight {
    std::vector<Item> items;     ///< the mission
    std::vector<Item> uploaded;  ///< set by a ground station on another line, as many as `items`
    double upload_at = -1.0;     ///< time of the upload [s]; negative: never
    Mode mode = Mode::mission;   ///< at the start
    Vec target = Vec::Zero();    ///< flown to in Mode::guided
    double mission_at = -1.0;    ///< time at which another sender chooses Mode::mission [s]; negative: never
    double moved_at = -1.0;      ///< Mode::pilot: the place is held until this time [s]
    Vec stick = Vec::Zero();     ///< velocity flown after `moved_at` [m/s]
};

}  // namespace jink::sim
