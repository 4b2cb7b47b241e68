// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "core/path/follower.hpp"
#include "core/world/conflict.hpp"

namespace jink::avoid {

enum class State : std::uint8_t {
    watching,   ///< the autopilot flies; conflicts are looked for
    avoiding,   ///< a checked manoeuvre is flown
    rejoining,  ///< back to the leg, or beside it while the way back is not clear
    braking,    ///< nothing was safe: brake, hold turn, or the way of least harm
};

/// In which order the methods are asked, and which.
enum class LadderOrder : std::uint8_t {
    as_given,  ///< one after the other, until one answers
    reversed,  ///< the last one first
    first,     ///< the first alone
    last,      ///< the last alone
};

/// Whether the method that decides every tick anew (kReactive) is asked; the order is that of the others.
enum class Reactive : std::uint8_t {
    never,
    first,  ///< before all others
    alone,
};

struct Settings {
    Reactive reactive = Reactive::never;
    LadderOrder order = LadderOrder::as_given;
    /// With so many tracks and obstacles within `clutter_radius`, methods that are asked as given are asked in the
    /// reverse order; 0: never.
    std::uint16_t clutter = 0;
    float clutter_radius = 20.0F;  ///< 1..200 [m]
    Seconds lookahead = 8.0F;      ///< conflicts are looked for this far ahead, 1..60 [s]
    Seconds commit = 5.0F;         ///< the way is left when its loss of separation is nearer than this, 0.5..60 [s]
    float room = 0.4F;  ///< plans are asked for with this much to spare, so that noise does not undo them, 0..10 [m]
    Seconds prediction_step = 0.2F;     ///< of the predicted flight, 0.02..0.5 [s]
    Seconds fallback_horizon = 4.0F;    ///< over which fallbacks are compared, 1..20 [s]
    Seconds reserve = 0.75F;            ///< on top of the stopping time, before which nothing is forced, 0..5 [s]
    Seconds settle = 1.0F;              ///< the way must have been clear this long before it is trusted, 0..10 [s]
    float clear_extra = 0.5F;           ///< and clear by this much more than the margin, 0..10 [m]
    float on_leg = 1.0F;                ///< cross-track error at which the leg counts as rejoined, > 0 [m]
    Seconds blocked_patience = 2.0F;    ///< standing in front of something this long, the vehicle gives ground [s]
    float give_ground_speed = 1.0F;     ///< backwards, 0: never [m/s]
    Seconds give_ground_limit = 10.0F;  ///< per conflict, at most [s]
    /// Control is kept at least this long, on the nominal path once that is clear: a conflict that comes and goes makes
    /// one take-over, not several, 0..60 [s].
    Seconds least_control = 5.0F;
    /// Blocked by what stands for so long, without getting anywhere, control is given up and a hold asked for; 0: never
    /// [s].
    Seconds patience = 20.0F;
    /// Of the units below at most for the plans of one update, so that checks and fallbacks have theirs.
    std::uint32_t plan_budget = 20000;
    /// Of these kept back for each method that is asked after another one.
    std::uint32_t kept_for_next = 8000;
    std::uint32_t budget = 60000;  ///< units of work per update (WorkBudget): what bounds a step's time on every target
    path::FollowerGains gains;
    world::EscapeRule escape;
};
[[nodiscard]] bool is_valid(const Settings& settings) noexcept;

/// What is to be done this tick.
struct Guidance {
    State state = State::watching;
    bool wants_control = false;    ///< the vehicle should follow `velocity`
    Vec3 velocity = Vec3::Zero();  ///< command [m/s]; valid when wants_control
    bool has_conflict = false;
    world::Conflict conflict;     ///< of the nominal path that counts, when has_conflict
    bool on_other = false;        ///< that is the other nominal path, because its conflict comes first
    bool other_conflict = false;  ///< control is kept because the other nominal path is not clear
    bool blocked = false;         ///< given up (Settings::patience): to be handed over to the autopilot's hold mode
    float margin = world::kSeparationCap;  ///< least predicted margin of what is flown or offered [m]
    world::ManoeuvreKind kind = world::ManoeuvreKind::follow_path;
    world::PlanStatus plan_status =
        world::PlanStatus::no_conflict;  ///< of this tick's plan, no_conflict when none was made
    bool new_manoeuvre = false;
    std::uint32_t work = 0;  ///< units that this update spent
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
    std::uint32_t replans = 0;           ///< manoeuvres replaced because the picture changed
    std::uint32_t flips = 0;             ///< replaced by one on the other side of the leg
    std::uint32_t brakes = 0;            ///< fallbacks begun
    std::uint32_t escapes = 0;           ///< fallbacks that had to move
    std::uint32_t holds = 0;             ///< flights beside the leg begun, because the way back was not clear
    std::uint32_t rejoined = 0;
    std::uint32_t on_other = 0;  ///< conflicts begun on the other nominal path
    std::uint32_t kept_control =
        0;                      ///< updates in which the other nominal path alone kept control from being given back
    std::uint32_t blocked = 0;  ///< times given up in front of what stands
    std::uint32_t control_lost = 0;  ///< control ended while it was wanted
    std::uint32_t budget_spent = 0;  ///< updates that ran out of work budget
    std::uint32_t most_work = 0;     ///< units, the worst update
};

}  // namespace jink::avoid
