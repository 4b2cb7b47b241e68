// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include "core/avoid/fallback.hpp"
#include "core/avoid/final_check.hpp"
#include "core/avoid/give_way.hpp"
#include "core/avoid/phase.hpp"
#include "core/avoid/sliced_plan.hpp"

namespace jink::avoid {

/// The state machine of the supervisor, free of the methods' types. See Supervisor, and phase.hpp for its transitions.
///
/// Memory: two manoeuvres (about 2 KiB each with 64 path points). One update: two conflict searches, three
/// with two nominal paths, at most one plan, two checks, one parallel offset and one fallback choice; all under
/// Settings::budget.
class StateMachine {
public:
    explicit StateMachine(const Settings& settings) noexcept : settings_(settings) {}

    Guidance update(const world::Situation& given, const world::Reference* other, bool in_control,
                    const Planning& planning) noexcept;

    /// From now on a plan goes on over several updates. It outlives this.
    void plan_in_slices(SlicedPlan& plan) noexcept { sliced_ = &plan; }
    /// From now on a plan is made in one update, as at first.
    void plan_in_whole() noexcept
    {
        drop_plan();
        sliced_ = nullptr;
    }
    /// Drops what is planned at present: something that it goes by has changed.
    void drop_plan() noexcept;

    /// Forgets what is flown: after a pilot took over, after the estimator was reset. Diagnostics stay.
    void reset() noexcept;

    [[nodiscard]] bool configure(const Settings& settings) noexcept;
    [[nodiscard]] const Settings& settings() const noexcept { return settings_; }
    [[nodiscard]] State state() const noexcept { return state_of(phase_); }
    [[nodiscard]] const Diagnostics& diagnostics() const noexcept { return diagnostics_; }
    /// What is being flown, or was offered last while not in control; null when nothing is.
    [[nodiscard]] const world::Manoeuvre* flying() const noexcept { return flying_ ? &*flying_ : nullptr; }
    /// A plan has begun and goes on in the next update.
    [[nodiscard]] bool plan_runs() const noexcept { return sliced_ != nullptr && sliced_->runs(); }

private:
    struct Tick;  // what one update carries along
    /// On which nominal path the last update saw a conflict.
    enum class ConflictOn : std::uint8_t { none, first, other };

    // state_machine.cpp
    void enter(Phase next) noexcept;
    void update_control(TimePoint now, bool in_control) noexcept;
    void update_conflict(const Tick& tick) noexcept;
    void update_clearness(Tick& tick) noexcept;
    void run_phase(Tick& tick) noexcept;
    void watch(Tick& tick) noexcept;
    void keep_stoppable(Tick& tick) noexcept;
    [[nodiscard]] bool plan(Tick& tick, bool hurries, std::uint8_t only = 0) noexcept;
    [[nodiscard]] std::uint32_t units_for_planning(const Tick& tick) const noexcept;
    [[nodiscard]] MethodOrder order_for(const Tick& tick) const noexcept;
    static void charge_planning(Tick& tick, std::uint32_t units) noexcept;
    [[nodiscard]] world::PlanStatus plan_at_once(Tick& tick, const Settings& settings, Choice& choice) noexcept;
    [[nodiscard]] world::PlanStatus plan_a_slice(Tick& tick, const Settings& settings, bool hurries,
                                                 Choice& choice) noexcept;
    [[nodiscard]] bool is_due(const Tick& tick, Seconds time_to_loss) const noexcept;
    [[nodiscard]] Seconds latest_manoeuvre_time(const Tick& tick) const noexcept;
    [[nodiscard]] bool is_urgent(const Tick& tick, Seconds time_to_loss) const noexcept;
    [[nodiscard]] bool is_clear_for(const Tick& tick, Seconds span) const noexcept;
    // avoiding.cpp
    void avoid(Tick& tick) noexcept;
    void take(Tick& tick) noexcept;
    void fly(const world::Manoeuvre& manoeuvre, Tick& tick) const noexcept;
    [[nodiscard]] bool renew(Tick& tick) noexcept;
    void replace(Tick& tick, const world::ThreatRef& against) noexcept;
    [[nodiscard]] bool find_faster(Tick& tick) noexcept;
    // giving_way.cpp
    [[nodiscard]] bool gives_way() const noexcept { return flying_ && flying_->by == kGivesWay; }
    [[nodiscard]] bool see_aircraft(Tick& tick) noexcept;
    [[nodiscard]] bool give_way(Tick& tick) noexcept;
    // braking.cpp
    void brake(Tick& tick) noexcept;
    void fall_back(Tick& tick) noexcept;
    void back_off(Tick& tick) noexcept;
    [[nodiscard]] bool stays_given_up(Tick& tick) noexcept;
    void give_up_when_blocked(Tick& tick) noexcept;
    // rejoin.cpp
    void rejoin(Tick& tick) noexcept;
    void follow_nominal(Tick& tick) const noexcept;
    [[nodiscard]] bool keep_parallel(Tick& tick) noexcept;
    [[nodiscard]] Seconds time_to_turn(const Tick& tick) const noexcept;
    [[nodiscard]] bool leads_back(Tick& tick) const noexcept;
    [[nodiscard]] bool keep_course(Tick& tick) noexcept;
    [[nodiscard]] bool is_bent_into_conflict(Tick& tick) const noexcept;
    [[nodiscard]] bool is_back(const Tick& tick) const noexcept;
    // nominal_choice.cpp
    [[nodiscard]] bool counts(const Tick& tick, const world::Conflict& conflict) const noexcept;
    void choose_nominal(Tick& tick) noexcept;
    [[nodiscard]] bool may_give_back(Tick& tick) noexcept;
    [[nodiscard]] bool leaves_stop(Tick& tick, Seconds ahead) noexcept;

    Settings settings_;
    Diagnostics diagnostics_;
    std::uint32_t transitions_ = 0;  ///< of this update, as Guidance::transitions
    Phase phase_ = Phase::watching;
    ConflictOn conflict_on_ = ConflictOn::none;
    std::optional<TimePoint> control_since_;   ///< empty without control; anew where a decision keeps it
    std::optional<TimePoint> clear_since_;     ///< the nominal path, by Settings::clear_extra; empty while it is not
    std::optional<TimePoint> free_since_;      ///< the nominal path, of conflicts; empty while it is not
    std::optional<TimePoint> standing_since_;  ///< braking in front of something
    std::optional<TimePoint> all_asked_at_;    ///< last time all methods were asked, while a velocity is flown
    std::optional<TimePoint>
        faster_sought_at_;  ///< last search for a faster manoeuvre; empty unless a slow one is flown
    std::optional<world::Commanded> commanded_;  ///< by the last update; empty unless in control
    std::optional<Fallback> fallback_;           ///< flown, or offered while not in control
    std::optional<world::Manoeuvre> flying_;     ///< flown, or offered while not in control
    Vec3 chosen_side_ = Vec3::Zero();  ///< of what is flown, when it was taken; its own side follows the flight
    Seconds backed_off_ = 0.0F;        ///< in this conflict
    TimePoint last_update_;
    bool held_back_ = false;        ///< the last command, so that all can stop
    Vec3 block_at_ = Vec3::Zero();  ///< where the vehicle is since block_since_, more or less
    TimePoint block_since_;         ///< moved on where the vehicle does not brake
    world::Manoeuvre answer_;       ///< of the last plan
    SlicedPlan* sliced_ = nullptr;
};

}  // namespace jink::avoid
