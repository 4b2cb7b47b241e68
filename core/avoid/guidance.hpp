// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>

#include "core/world/well_clear.hpp"

namespace jink::avoid {

enum class State : std::uint8_t {
    watching,   ///< the autopilot flies; conflicts are predicted
    avoiding,   ///< a checked manoeuvre is flown
    rejoining,  ///< back to the leg, or parallel to it while the path back is not clear
    braking,    ///< nothing was safe: brake, hold turn, or the max-clearance escape
};

/// What is to be done this tick.
struct Guidance {
    State state = State::watching;
    bool wants_control = false;               ///< the vehicle should follow `velocity`
    Vec3 velocity = Vec3::Zero();             ///< command [m/s]; valid when wants_control
    std::optional<world::Conflict> conflict;  ///< of the nominal path that counts
    world::Alert alert = world::Alert::none;  ///< of aircraft that the nominal path comes too near to
    bool on_other = false;                    ///< that is the other nominal path, because its conflict comes first
    bool other_conflict = false;              ///< control is kept because the other nominal path is not clear
    bool for_stop = false;                    ///< control is wanted or kept so that all can stop (common_stop.hpp)
    bool blocked = false;                     ///< given up (Settings::patience): the autopilot has to hold
    float margin = world::kSeparationCap;     ///< least predicted margin of what is flown or offered [m]
    world::ManoeuvreKind kind = world::ManoeuvreKind::follow_path;
    world::PlanStatus plan_status =
        world::PlanStatus::no_conflict;  ///< of this tick's plan, no_conflict when none was made
    bool new_manoeuvre = false;
    std::uint8_t by = 0;            ///< MethodTraits::id of the method whose answer is flown or offered; 0: none
    std::uint8_t answers = 0;       ///< in this tick's plan: checked ones, of which the least costly one counts
    Seconds cost = 0.0F;            ///< and that one's (objective.hpp)
    std::uint32_t transitions = 0;  ///< bit i: this update made transition i of kTransitions (phase.hpp)
    std::uint32_t work = 0;         ///< of this update [work units]
};

/// Counts since start.
struct Diagnostics {
    std::uint32_t updates = 0;
    std::uint32_t conflicts = 0;  ///< begun
    std::uint32_t plans = 0;      ///< asked of a method
    std::uint32_t plans_found = 0;
    std::uint32_t found_by_next = 0;     ///< of these by a method that was not asked first
    std::uint32_t answers_rejected = 0;  ///< by the final check
    std::uint32_t manoeuvres = 0;        ///< begun under control
    std::uint32_t replans = 0;           ///< manoeuvres replaced because the situation changed
    std::uint32_t flips = 0;             ///< replaced by one on the other side of the leg
    std::uint32_t brakes = 0;            ///< fallbacks begun
    std::uint32_t escapes = 0;           ///< fallbacks that had to move
    std::uint32_t held_back = 0;         ///< updates whose command was slowed, so that all can stop (common_stop.hpp)
    std::uint32_t gave_way = 0;          ///< times that giving way to aircraft began
    std::uint32_t holds = 0;             ///< parallel offsets begun, because the path back was not clear
    std::uint32_t rejoined = 0;
    std::uint32_t on_other = 0;      ///< conflicts begun on the other nominal path
    std::uint32_t kept_control = 0;  ///< updates in which the other nominal path alone kept control
    std::uint32_t for_stop = 0;      ///< updates with Guidance::for_stop
    std::uint32_t blocked = 0;       ///< times given up in front of static threats
    std::uint32_t control_lost = 0;  ///< control ended while it was wanted
    std::uint32_t budget_spent = 0;  ///< updates that ran out of work budget
    std::uint32_t most_work = 0;     ///< of the worst update [work units]
};

}  // namespace jink::avoid
