// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "core/path/follower.hpp"
#include "core/world/separation.hpp"

namespace jink::avoid {

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

/// Of the supervisor.
struct Settings {
    Reactive reactive = Reactive::never;
    LadderOrder order = LadderOrder::as_given;
    /// With so many tracks and obstacles within `clutter_radius`, methods that are asked as given are asked in the
    /// reverse order; 0: never.
    std::uint16_t clutter = 0;
    float clutter_radius = 20.0F;  ///< 1..200 [m]
    Seconds lookahead = 8.0F;      ///< conflicts are predicted this far ahead, 1..60 [s]
    Seconds commit = 5.0F;         ///< a loss of separation nearer than this is planned around, 0.5..60 [s]
    /// Plans keep this much more than the margin, so that noise does not undo them, 0..10 [m].
    float clearance_buffer = 0.4F;
    Seconds prediction_step = 0.2F;   ///< of the predicted flight, 0.02..0.5 [s]
    Seconds fallback_horizon = 4.0F;  ///< over which fallbacks are compared, 1..20 [s]
    Seconds reserve = 0.75F;          ///< on top of the stopping time, before which nothing is forced, 0..5 [s]
    Seconds settle = 1.0F;            ///< the nominal path is trusted after it has been clear this long, 0..10 [s]
    float clear_extra = 0.5F;         ///< and clear by this much more than the margin, 0..10 [m]
    float on_leg = 1.0F;              ///< cross-track error at which the leg counts as rejoined, > 0 [m]
    Seconds blocked_patience = 2.0F;  ///< after standing in front of something this long, the vehicle backs off [s]
    float back_off_speed = 1.0F;      ///< backwards, 0: never [m/s]
    Seconds back_off_limit = 10.0F;   ///< per conflict, at most [s]
    /// Control is kept at least this long, on the nominal path once that is clear: a conflict that comes and goes makes
    /// one take-over, not several, 0..60 [s].
    Seconds least_control = 5.0F;
    /// A vehicle that static threats block for this long, without getting anywhere, gives up control and asks for a
    /// hold; 0: never [s].
    Seconds patience = 20.0F;
    /// Of `budget` at most for the plans of one update, so that checks and fallbacks have theirs [work units].
    std::uint32_t plan_budget = 20000;
    /// Of `plan_budget` kept back for each method that is asked after another one [work units].
    std::uint32_t kept_for_next = 8000;
    std::uint32_t budget = 60000;  ///< per update [work units]: what bounds a step's time on every target
    path::FollowerGains gains;
    world::EscapeRule escape;
};
/// Whether every setting lies within its range. O(1).
[[nodiscard]] bool is_valid(const Settings& settings) noexcept;

}  // namespace jink::avoid
