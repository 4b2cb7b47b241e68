// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "core/orca/velocity_filter.hpp"
#include "core/world/method.hpp"

namespace jink::orca {

/// What the situation does not say. FlightRules::lookahead is the horizon towards other vehicles, longer where braking
/// or the delay ask for it.
struct Settings {
    float conflict_ratio = 0.8F;  ///< conflict region's size, of the warning region's, 0.5..0.95
    Seconds reach = 0.5F;         ///< of full acceleration that a new command may ask for, 0.1..5
    Seconds stale = 1.0F;         ///< a track not seen for longer is not counted on, > 0
    std::uint16_t smoothing = 1;  ///< commands in the mean, 1..CommandFilter::kMax
    Conflict conflict = Conflict::at_rest;
    /// No answer where the vehicle makes no progress for long, so that another method is asked; else it waits.
    bool gives_up_blocked = true;
    BiasSettings bias{.near = 15.0F};
};
[[nodiscard]] bool is_valid(const Settings& settings) noexcept;

/// The method: satisfies world's AvoidanceMethod. Each plan is one decision of a VelocityFilter, made anew every tick
/// (MethodTraits::reactive): the velocity along the way to the reference, changed as little as keeps clear (Alejo 7).
///
/// * Vehicle: its box as the cylinder about it, obstacles and the airspace's bounds as hard half-spaces. Around each
///   track the region that keeps the box from the track's sphere, grown to when they are nearest, lies within the
///   conflict region.
/// * An uncertain height (Track::half_height): the region is at most twice as high as wide, about the point of the
///   capsule's axis that is nearest in height. So a command may lead over or under the rest of a taller capsule. The
///   final check counts the whole capsule and refuses such a command.
/// * Cooperative tracks (Track::cooperative, not stale) are left half of the reaction, all others none. Of two such
///   vehicles neither closes in faster than both can undo (Conflict::at_rest), and the final check covers them as far
///   ahead as the vehicle needs to stop (Situation::shared_horizon), at all others to the path's end.
/// * Horizons are as long as braking and the delay need at least (check()).
///
/// The answer is of kind `velocity`: its command, and the flight predicted under it. found whenever there is a command,
/// whether or not something was in the way, and even where conflict regions had to be given up: the final check says
/// whether that is flown. No answer (none_available) where the vehicle is blocked, with Settings::gives_up_blocked.
///
/// A fixed wing flies no slower than kWingShare of its cruise speed, and turns no tighter than its acceleration lets
/// it.
///
/// Memory: sizeof(Planner), about 10 KiB with the default capacities. O(tracks + obstacles) and the programs' turns,
/// bounded by the budget.
class Planner {
public:
    static constexpr world::MethodTraits kTraits{
        .id = 3, .reactive = true, .keeps_clearance = true, .needs_sets = false};
    static constexpr float kWingShare = 0.9F;

    explicit Planner(const Settings& settings = {}) noexcept { static_cast<void>(configure(settings)); }

    [[nodiscard]] world::PlanStatus plan(const world::Situation& situation, WorkBudget& budget,
                                         world::Manoeuvre& out) noexcept;

    /// Refused (false, nothing changed) when out of range.
    [[nodiscard]] bool configure(const Settings& settings) noexcept;
    [[nodiscard]] const Settings& settings() const noexcept { return settings_; }
    /// Forgets what was planned and flown before.
    void reset() noexcept
    {
        filter_.reset();
        has_planned_ = false;
    }
    [[nodiscard]] const Decision& last() const noexcept { return decision_; }

private:
    [[nodiscard]] FilterSettings filter_settings(const world::Situation& situation, Seconds tick) const noexcept;
    void take_command(const world::Situation& situation) noexcept;

    Settings settings_;
    VelocityFilter filter_;
    StaticVector<Neighbour, kMaxTracks> neighbours_;  ///< of a plan; not on the stack
    Decision decision_;
    TimePoint last_plan_;
    bool has_planned_ = false;
};

}  // namespace jink::orca
