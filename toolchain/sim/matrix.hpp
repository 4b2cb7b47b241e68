// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <string_view>
#include <vector>

#include "toolchain/sim/record.hpp"
#include "toolchain/sim/scenario.hpp"

namespace jink::sim {

/// The vehicle's behaviour when the intruder arrives. Distances and speeds are for a multirotor; matrix_plane.cpp has a
/// plane's.
enum class Behaviour : std::uint8_t {
    leg,           ///< a later leg of a mission at 5 m/s
    first_leg,     ///< the first leg, after a take-off in a guided mode
    off_leg,       ///< the mission continues at a parallel offset of 18 m from its leg
    fast,          ///< a mission at 12 m/s, unknown to the co-processor's parameters
    speed_change,  ///< DO_CHANGE_SPEED to 10 m/s
    turns,         ///< LOITER_TURNS
    wait,          ///< LOITER_TIME: hovers in the mission mode; a plane circles
    take_off,      ///< TAKEOFF item
    land_item,     ///< LAND item
    home_item,     ///< RETURN_TO_LAUNCH item
    upload,        ///< another mission under the same numbers
    jump,          ///< DO_JUMP
    spline,        ///< SPLINE_WAYPOINT
    hold,          ///< LOITER, AUTO.LOITER
    home,          ///< RTL, AUTO.RTL
    land,          ///< LAND, AUTO.LAND
    pilot,         ///< POSHOLD, POSCTL, FLY_BY_WIRE_B: holds position, then moves
    guided,        ///< target of another sender
};
inline constexpr std::array kBehaviours{
    Behaviour::leg,    Behaviour::first_leg, Behaviour::off_leg,  Behaviour::fast,      Behaviour::speed_change,
    Behaviour::turns,  Behaviour::wait,      Behaviour::take_off, Behaviour::land_item, Behaviour::home_item,
    Behaviour::upload, Behaviour::jump,      Behaviour::spline,   Behaviour::hold,      Behaviour::home,
    Behaviour::land,   Behaviour::pilot,     Behaviour::guided};

enum class Meeting : std::uint8_t { head_on, from_left, from_right, overtaking, from_above, from_below, at_turn };
inline constexpr std::array kMeetings{Meeting::head_on,    Meeting::from_left,  Meeting::from_right,
                                      Meeting::overtaking, Meeting::from_above, Meeting::from_below,
                                      Meeting::at_turn};

/// A column of the matrix. matrix_scenario.cpp sets each column's vehicle and parameters.
enum class Flyer : std::uint8_t { arducopter, px4, arduplane };
inline constexpr std::array kFlyers{Flyer::arducopter, Flyer::px4, Flyer::arduplane};

[[nodiscard]] std::string_view to_string(Behaviour behaviour) noexcept;
[[nodiscard]] std::string_view to_string(Meeting meeting) noexcept;
[[nodiscard]] std::string_view to_string(Flyer flyer) noexcept;

/// False where the autopilot lacks the item or mode. ArduPlane has no splines and no LAND mode, and leaves the mission
/// mode for RTL at a RETURN_TO_LAUNCH item.
[[nodiscard]] bool can_fly(Flyer flyer, Behaviour behaviour) noexcept;
/// True for behaviours in the mission mode. The co-processor takes over only there, and advises in all other modes.
[[nodiscard]] bool is_mission(Behaviour behaviour) noexcept;

/// The flight without an intruder; `meets_at`: time at which an intruder would arrive [s].
struct Nominal {
    Scenario scenario;
    double meets_at = 0.0;
};
[[nodiscard]] Nominal nominal_flight(Flyer flyer, Behaviour behaviour, std::uint64_t seed);

enum class Conditions : std::uint8_t {
    calm,   ///< traffic reports at 5 Hz with 0.3 m of noise
    rough,  ///< ADS-B at 1 Hz with its quantisation, an estimator with bias, drift and latency, gusts of a wind of 15
            ///< kt
};

/// One flight of a cell: one intruder, aimed at the vehicle's position in the flight without a co-processor.
[[nodiscard]] Scenario matrix_scenario(Flyer flyer, Behaviour behaviour, Meeting meeting, std::uint64_t seed,
                                       Conditions conditions = Conditions::calm);

struct Cell {
    Flyer flyer = Flyer::arducopter;
    Behaviour behaviour = Behaviour::leg;
    Meeting meeting = Meeting::head_on;
    unsigned flights = 0;
    unsigned hits = 0;               ///< flights with a separation below the promise
    unsigned avoidable = 0;          ///< hits in the mission mode for which the judge has a manoeuvre at the first
                                     ///< sighting
    unsigned foreseeable = 0;        ///< of these, hits for which it has one at the first sighting since the
                                     ///< intruder's last turn too: before, nobody could know where it flies
    unsigned unwarned = 0;           ///< hits without a preceding COLLISION
    unsigned taken_over = 0;         ///< flights with a take-over
    unsigned given_back = 0;         ///< take-overs with control given back
    unsigned finished = 0;           ///< missions
    unsigned critical_texts = 0;     ///< of the autopilot, caused by the co-processor
    unsigned own_critical = 0;       ///< flights with a text of severity CRITICAL or worse of the co-processor
    unsigned broken_rules = 0;       ///< flights with a broken rule (Record::faults)
    double least = 1e9;              ///< least distance between centres [m]
    std::vector<std::uint64_t> bad;  ///< seeds with an avoidable hit, a broken rule or an unfinished mission
};

/// Flies `count` seeds of a cell in process, from `from` on.
[[nodiscard]] Cell fly_cell(Flyer flyer, Behaviour behaviour, Meeting meeting, std::uint64_t from, std::size_t count,
                            Conditions conditions = Conditions::calm);

}  // namespace jink::sim
