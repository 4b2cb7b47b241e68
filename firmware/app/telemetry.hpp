// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <span>

#include "firmware/app/autopilot_control.hpp"
#include "firmware/app/autopilot_state.hpp"
#include "firmware/app/decision.hpp"
#include "firmware/app/diagnostics.hpp"
#include "firmware/app/outbox.hpp"
#include "firmware/app/picture.hpp"
#include "firmware/app/step_log.hpp"
#include "firmware/app/step_report.hpp"
#include "hal/last_words.hpp"

namespace jink::app {

/// What telemetry reports about.
struct Reported {
    const Configuration& configuration;
    const AutopilotState& autopilot;
    const OwnState& own;
    const Picture& picture;
    const Decision& decision;
    const AutopilotControl& control;
    bool is_passive;
    bool was_bus_up;
};

/// What the co-processor reports of itself: heartbeats, texts, warnings of a conflict, status and near objects on the
/// bus, and its last words. Texts are said once per cause, not once per step.
class Telemetry {
public:
    /// @param bus  may be null
    Telemetry(link::Link& link, link::SensorBus* bus, Diagnostics& counts) noexcept
        : link_(link), bus_(bus), counts_(counts)
    {
    }

    /// From now on every step prepares the texts of a fault handler. They outlive this.
    void keep_last_words(hal::LastWords& words) noexcept { last_words_ = &words; }
    /// What a step took, on boards that count [cycles].
    void note_cycles(std::uint32_t cycles) noexcept { most_cycles_ = std::max(most_cycles_, cycles); }
    /// Requests of messages: the HEARTBEAT is sent in this step, and with the next one a text of the longest step where
    /// a text is asked for and steps are counted; the version is sent at once; others are refused.
    /// The log takes its own commands. @param log  may be null
    void take_commands(std::span<const link::CommandRequest> commands, StepLog* log,
                       const Parameters& parameters) noexcept;
    /// What became of control in this step.
    void note(TakeoverEvent event, const StepReport& report) noexcept;

    // In each step, in this order.
    [[nodiscard]] static link::SystemState system_state(const StepReport& report, const Reported& of) noexcept;
    void report_to_autopilot(TimePoint now, const StepReport& report, const Reported& of, Outbox& outbox) noexcept;
    /// Before anything of this step goes out, so that the last words are newer than all of it.
    /// @param last_step  start of this step
    void prepare_last_words(TimePoint last_step, const Reported& of) noexcept;
    void report_to_bus(TimePoint now, const StepReport& report, const Reported& of, Outbox& outbox) noexcept;
    [[nodiscard]] bool is_near_due(TimePoint now, const StepReport& report, const Reported& of) const noexcept;
    /// Sends the nearest objects around the vehicle on the bus. @param tracks  at now
    void report_near(TimePoint now, std::span<const world::Track> tracks, const Reported& of) noexcept;

    /// The last heartbeat and text before a stop on purpose. @param faults  of the last step
    void shut_down(TimePoint now, std::uint16_t faults, Outbox& outbox) noexcept;

private:
    void report_causes(const Reported& of, Outbox& outbox) noexcept;
    void report_autopilot(const StepReport& report, const Reported& of, Outbox& outbox) noexcept;
    void warn_of_conflict(TimePoint now, const StepReport& report, const Reported& of, Outbox& outbox) noexcept;
    void report_choice(TimePoint now, const avoid::Guidance& guidance, Outbox& outbox) noexcept;
    void report_alert(const avoid::Guidance& guidance, Outbox& outbox) noexcept;
    void report_braking(TimePoint now, const avoid::Guidance& guidance, Outbox& outbox) noexcept;

    struct Heartbeat {
        bool is_sent = false;
        TimePoint at;
        link::SystemState state = link::SystemState::boot;
    };
    /// Said already.
    struct Said {
        bool left_out = false;
        bool unsuited = false;
        bool flood = false;
        bool harder = false;    ///< a neighbour accelerates harder than the own vehicle may
        bool coarse = false;    ///< boxes stand for pieces of the map
        bool advising = false;  ///< this vehicle cannot be steered
        bool alone = false;     ///< no autopilot
    };
    /// A conflict, and what was said of it.
    struct Conflict {
        bool is_reported = false;
        TimePoint reported_at;
        bool said_unsafe = false;
        bool said_braking = false;
        bool said_for_stop = false;
        std::uint8_t said_by = 0;  ///< method; 0: none
        world::Alert said_alert = world::Alert::none;
        TimePoint said_by_at;
        TimePoint last;
    };

    link::Link& link_;
    link::SensorBus* bus_;
    Diagnostics& counts_;
    hal::LastWords* last_words_ = nullptr;
    Heartbeat heartbeat_;
    Said said_;
    Conflict conflict_;
    int unsteerable_reports_ = 0;  ///< HEARTBEATs one after another
    bool loss_unsaid_ = false;     ///< control was lost while the line was down
    TimePoint last_near_;
    std::uint32_t most_cycles_ = 0;  ///< of a step
    bool cycles_asked_ = false;
};

}  // namespace jink::app
