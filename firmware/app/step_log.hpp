// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>
#include <string_view>

#include "core/avoid/guidance.hpp"
#include "core/geometric/planner.hpp"
#include "firmware/app/diagnostics.hpp"
#include "firmware/app/step_report.hpp"
#include "firmware/link/link.hpp"

namespace jink::app {

class Parameters;  // parameters.hpp depends on the methods of an image, this does not

/// The geometric planner's last plan, which the next one overwrites.
struct LastPlan {
    const geometric::Result* result = nullptr;  ///< null: the image is built without the planner
    std::uint32_t number = 0;                   ///< of plans begun: another one, another result
};

/// What a log reads of a step.
struct LoggedStep {
    TimePoint now;
    const StepReport& report;          ///< bytes_out: of the step before
    const vehicle::VehicleState& own;  ///< as measured
    std::span<const world::Track> tracks;
    const Parameters& parameters;
    const Diagnostics& counts;
    const avoid::Diagnostics& supervisor_counts;
    LastPlan plan;
    std::uint32_t duration_us;  ///< of the step before; 0: not counted
    bool is_line_free;          ///< the port is open and has taken all bytes of the steps before
};

/// A log that goes out over the link. It reads what the co-processor does and changes none of it.
class StepLog {
public:
    // In each step, in this order.
    virtual void begin(TimePoint now, std::span<const link::LogAck> acks) noexcept = 0;
    /// LOGGING_START, LOGGING_STOP; others are unsupported. @param parameters  in force
    [[nodiscard]] virtual link::CommandResult take(const link::CommandRequest& request,
                                                   const Parameters& parameters) noexcept = 0;
    /// A text that is sent in this step.
    virtual void note_text(link::Severity severity, std::string_view text) noexcept = 0;
    /// After all other messages of the step were queued: queues one part of the log at most.
    virtual void end(const LoggedStep& step, link::Link& link) noexcept = 0;

protected:
    ~StepLog() = default;
};

}  // namespace jink::app
