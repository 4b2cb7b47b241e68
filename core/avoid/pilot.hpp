// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/avoid/guard.hpp"
#include "core/world/method.hpp"
#include "core/world/threat_set.hpp"

namespace jink::avoid {

/// A situation to plan in: for a vehicle with room to spare, and as it is.
struct Rounds {
    const world::Situation& wide;
    const world::Situation& plain;
};

/// The ladder of methods as the state machine sees it: one function that plans, checked answers only.
struct Ladder {
    void* self = nullptr;
    world::PlanStatus (*plan)(void* self, const Rounds&, const Settings&, WorkBudget&, Diagnostics&, world::Manoeuvre&,
                              float& margin) noexcept = nullptr;
};

/// The state machine of the supervisor, free of the methods' types. See Supervisor.
///
/// Memory: two manoeuvres (about 2 KiB each with 64 path points). One update: two conflict searches, three
/// with two nominal paths, at most one plan, two checks, one flight beside the leg and one fallback choice; all under
/// Settings::budget.
class Pilot {
public:
    explicit Pilot(const Settings& settings) noexcept : settings_(settings) {}

    Guidance update(const world::Situation& given, const world::Reference* other, bool in_control,
                    const Ladder& ladder) noexcept;

    /// Forgets what is flown: after a pilot took over, after the estimator was reset. What was counted stays.
    void reset() noexcept;

    [[nodiscard]] bool configure(const Settings& settings) noexcept;
    [[nodiscard]] const Settings& settings() const noexcept { return settings_; }
    [[nodiscard]] State state() const noexcept { return state_; }
    [[nodiscard]] const Diagnostics& diagnostics() const noexcept { return diagnostics_; }
    /// What is being flown, or was offered last while not in control; null when nothing is.
    [[nodiscard]] const world::Manoeuvre* flying() const noexcept { return has_flying_ ? &flying_ : nullptr; }

private:
    struct Tick;  // what one update carries along

    void watch(Tick& tick) noexcept;
    void avoid(Tick& tick) noexcept;
    void rejoin(Tick& tick) noexcept;
    void brake(Tick& tick) noexcept;
    [[nodiscard]] bool plan(Tick& tick) noexcept;
    [[nodiscard]] bool due(const Tick& tick, Seconds time_to_loss) const noexcept;
    [[nodiscard]] Seconds last_moment(const Tick& tick) const noexcept;
    [[nodiscard]] bool urgent(const Tick& tick, Seconds time_to_loss) const noexcept;
    void take(Tick& tick) noexcept;
    void fly(Tick& tick) const noexcept;
    [[nodiscard]] bool renew(Tick& tick) noexcept;
    void replace(Tick& tick) noexcept;
    void fall_back(Tick& tick) noexcept;
    void enter_rejoining() noexcept;
    [[nodiscard]] bool way_clear_for(const Tick& tick, Seconds span) const noexcept;
    void follow_way(Tick& tick) noexcept;
    [[nodiscard]] bool keep_beside(Tick& tick) noexcept;
    [[nodiscard]] bool keep_course(Tick& tick) noexcept;
    [[nodiscard]] bool is_back(const Tick& tick) const noexcept;
    [[nodiscard]] bool find_faster(Tick& tick) noexcept;
    void give_ground(Tick& tick) noexcept;
    void note_clearness(Tick& tick) noexcept;
    void note_control(TimePoint now, bool in_control) noexcept;
    void keep_control(TimePoint now) noexcept;
    [[nodiscard]] bool counts(const Tick& tick, const world::Conflict& conflict) const noexcept;
    void choose_nominal(Tick& tick) noexcept;
    [[nodiscard]] bool may_give_back(Tick& tick) noexcept;
    [[nodiscard]] bool stays_given_up(Tick& tick) noexcept;
    void note_block(Tick& tick) noexcept;

    Settings settings_;
    Diagnostics diagnostics_;
    world::ThreatSet threats_;  ///< of this update
    State state_ = State::watching;
    bool had_control_ = false;
    bool in_conflict_ = false;
    bool has_flying_ = false;
    bool was_clear_ = false;
    bool was_free_ = false;
    bool standing_ = false;
    bool beside_ = false;   ///< flying beside the leg
    bool is_slow_ = false;  ///< what is flown
    TimePoint looked_at_;   ///< when a faster one was looked for last
    bool has_fallback_ = false;
    bool has_commanded_ = false;
    world::Commanded commanded_;
    TimePoint clear_since_;
    TimePoint free_since_;
    TimePoint standing_since_;
    Seconds ground_given_ = 0.0F;
    TimePoint last_update_;
    Fallback fallback_;
    bool gave_back_ = false;  ///< while still in control
    bool blocked_ = false;    ///< given up, likewise
    bool on_other_ = false;   ///< the last conflict that was seen
    TimePoint control_since_;
    Vec3 block_at_ = Vec3::Zero();  ///< where the vehicle is since block_since_, more or less
    TimePoint block_since_;
    Vec3 chosen_side_ = Vec3::Zero();  ///< of what is flown, when it was taken; its own side follows the flight
    world::Manoeuvre flying_;
    world::Manoeuvre answer_;
};

}  // namespace jink::avoid
