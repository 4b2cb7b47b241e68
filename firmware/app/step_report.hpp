// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "core/avoid/guidance.hpp"
#include "firmware/app/takeover.hpp"
#include "firmware/link/link.hpp"

namespace jink::app {

/// Why the co-processor is not fit to act; a bit set.
enum class Fault : std::uint16_t {
    none = 0,
    no_autopilot = 1,       ///< never heard
    autopilot_silent = 2,   ///< HEARTBEAT too old
    own_state_missing = 4,  ///< the autopilot's; that of a receiver on the bus is good for advice alone
    own_state_stale = 8,
    port_lost = 16,
    late = 32,                ///< this step came over 0.5 s after the one before
    not_finite = 64,          ///< a command with NaN or infinity: never sent
    passive = 128,            ///< set to plan and request nothing (stay_passive)
    bus_lost = 256,           ///< the sensor bus is not there: its silence does not mean that nothing is near
    airspace_unplaced = 512,  ///< a closed area or the map is known by its place on the globe, but no origin to place
                              ///< it by, or one that is too far away
    map_unresolved = 1024,    ///< pieces of the map about the vehicle are too many to be known one by one
};

[[nodiscard]] constexpr std::uint16_t bit(Fault fault) noexcept { return static_cast<std::uint16_t>(fault); }

/// Texts and requests go nowhere while one of these faults lasts.
inline constexpr unsigned kDeadLine = bit(Fault::port_lost) | bit(Fault::autopilot_silent);

/// Whose own state the picture of the world is drawn about.
enum class OwnSource : std::uint8_t { none, autopilot, bus };

/// What one step did and cost.
struct StepReport {
    link::SystemState state = link::SystemState::boot;
    std::uint16_t faults = 0;      ///< Fault bits
    bool deadline_missed = false;  ///< this step came over two ticks after the one before
    bool setpoint_sent = false;
    std::uint32_t work = 0;  ///< units of the supervisor's budget
    std::uint32_t bytes_in = 0;
    std::uint32_t bytes_out = 0;
    std::uint16_t tracks = 0;
    std::uint16_t uncertain_heights = 0;  ///< tracks with a Track::half_height
    std::uint16_t obstacles = 0;
    std::uint16_t map_pieces = 0;  ///< obstacles among them that are a piece of the map, or several
    std::uint16_t cylinders = 0;   ///< closed volumes and storm cells that are known
    Control control = Control::autopilot;
    OwnSource own_source = OwnSource::none;
    std::uint32_t conflict_track = 0;  ///< id of the track that guidance.conflict is with; 0: none
    avoid::Guidance guidance;
};

}  // namespace jink::app
