// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <span>

#include "core/reach/vehicle_sets.hpp"
#include "firmware/app/methods.hpp"
#include "firmware/app/nominal_paths.hpp"
#include "firmware/app/parameters.hpp"
#include "firmware/app/sight.hpp"

namespace jink::app {

/// What one decision is made of.
struct DecisionInput {
    TimePoint now;
    const vehicle::VehicleState& measured;  ///< newest own state
    const vehicle::VehicleState& own;       ///< the same carried forward to now
    const world::Leg* leg;                  ///< AutopilotState::flown_leg
    bool in_control;                        ///< the autopilot follows our commands
    world::Surroundings around;             ///< at now
    world::TrackId own_track;               ///< Link::own_track
};

/// What is flown, or advised: nominal paths, methods and the supervisor, set as the parameters say.
class Decision {
public:
    explicit Decision(const Configuration& c) noexcept
        : methods_(c), supervisor_(methods_.supervisor(supervisor_settings(c)))
    {
    }
    Decision(const Decision&) = delete;
    Decision& operator=(const Decision&) = delete;

    [[nodiscard]] avoid::Guidance update(const DecisionInput& input, const Configuration& c) noexcept;

    /// Another frame, or own state comes from elsewhere.
    void reset() noexcept;
    /// The background services, with what a step has left of its units: the way past the obstacles
    /// (Sight); and one piece of the check of the reach sets' tables (reach::TableCheck), none while there are not
    /// enough units. `failed`: the tables are left out from now on.
    [[nodiscard]] Progress advance_background(std::uint32_t spent, const Configuration& c) noexcept;
    /// Somebody else flies: nothing is held on to.
    void reset_supervisor() noexcept { supervisor_.reset(); }
    void configure(const Configuration& c) noexcept;
    /// From now on no plan is made by reach sets, whatever the parameters say.
    void leave_out_reach_sets(const Configuration& c) noexcept;
    /// From now on reach sets plan by its cells, answers are compared by the way past the obstacles, and every plan may
    /// spend more work units. It outlives this.
    void let_reach_sets_see(Sight& sight, const Configuration& c) noexcept;

    /// From now on plans go on over several updates, in `plan`, and an update does as much as `work` says. It outlives
    /// this. False, and nothing changed, where the work is too little (avoid::is_valid).
    [[nodiscard]] bool plan_in_slices(avoid::SlicedPlan& plan, const avoid::WorkPerUpdate& work,
                                      const Configuration& c) noexcept;

    [[nodiscard]] bool leaves_out_reach_sets() const noexcept { return leaves_reach_out_; }
    [[nodiscard]] const NominalPaths& nominal_paths() const noexcept { return nominal_; }
    [[nodiscard]] const avoid::Diagnostics& diagnostics() const noexcept { return supervisor_.diagnostics(); }
    [[nodiscard]] const world::Manoeuvre* flying() const noexcept { return supervisor_.flying(); }
    [[nodiscard]] const Methods& methods() const noexcept { return methods_; }
    [[nodiscard]] Methods& methods() noexcept { return methods_; }

private:
    [[nodiscard]] avoid::Settings supervisor_settings(const Configuration& c) const noexcept;

    // The supervisor's settings depend on these: they come before it.
    avoid::WorkPerUpdate work_;
    bool leaves_reach_out_ = false;
    Sight* sight_ = nullptr;  ///< what reach sets see by; null: nothing of that kind
    Methods methods_;
    Methods::Supervisor supervisor_;
    NominalPaths nominal_;
    world::ThreatSet threats_;  ///< of one update
    std::optional<reach::TableCheck> tables_;
};

}  // namespace jink::app
