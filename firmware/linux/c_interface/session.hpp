// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include "firmware/app/can_bus.hpp"
#include "firmware/app/cloud_input.hpp"
#include "firmware/app/coprocessor.hpp"
#include "firmware/app/plan_memory.hpp"
#include "firmware/app/reach_picture.hpp"
#include "firmware/link/mavlink/endpoint.hpp"
#include "firmware/linux/c_interface/jink.h"
#include "firmware/linux/c_interface/ports.hpp"
#include "firmware/linux/c_interface/reporting_link.hpp"
#include "hal/watchdog.hpp"

namespace jink::c_interface {

/// What a handle stands for: the co-processor as jinkd sets it up, over ports whose other end is the caller.
class Session {
public:
    using AutopilotLine = CallersLine<8192, link::mavlink::Endpoint::kTransmitBytes>;
    using CloudLine = CallersLine<262144, 2>;

    /// @param options  as check() accepts them
    explicit Session(const jink_options& options) noexcept;
    Session(const Session&) = delete;
    Session& operator=(const Session&) = delete;

    [[nodiscard]] static jink_result check(const jink_options& options) noexcept;
    /// The clock of the options leaves time for a plan. Otherwise the session is not to be used.
    [[nodiscard]] bool has_time_for_plans() const noexcept { return has_time_; }

    [[nodiscard]] jink_result step(TimePoint now) noexcept;
    [[nodiscard]] jink_result shut_down(TimePoint now) noexcept;
    /// JINK_OK where a step may follow at `now`.
    [[nodiscard]] jink_result may_step(std::int64_t now_us) const noexcept;

    /// All of them or none.
    [[nodiscard]] jink_result set_parameters(const char* const* names, const float* values, std::size_t count) noexcept;
    /// With what waits for the next step.
    [[nodiscard]] const app::Parameters& parameters() const noexcept { return wanted_; }

    /// nullptr: there is none.
    [[nodiscard]] AutopilotLine* autopilot() noexcept { return over_can_ ? nullptr : &line_; }
    [[nodiscard]] CloudLine* cloud() noexcept { return has_cloud_ ? &cloud_ : nullptr; }
    [[nodiscard]] CallersBus* can() noexcept { return bus_ ? &can_ : nullptr; }
    [[nodiscard]] ReportingLink& link() noexcept { return link_; }
    [[nodiscard]] app::Coprocessor& coprocessor() noexcept { return *coprocessor_; }
    /// Empty before the first step.
    [[nodiscard]] std::optional<TimePoint> last_step() const noexcept { return last_step_; }

    /// Of the last step; 0 before it, and while the own position is not known.
    [[nodiscard]] std::uint16_t tracks() const noexcept { return report_.tracks; }

    void write(jink_status& status) const noexcept;
    void write(jink_counters& counters) const noexcept;

private:
    /// The caller has its own: it sees each step end.
    class NoWatchdog final : public hal::Watchdog {
    public:
        void feed() noexcept override {}
    };

    AutopilotLine line_;
    CloudLine cloud_;
    CallersBus can_;
    NoWatchdog watchdog_;
    std::optional<app::CanBus> bus_;
    app::CloudInput clouds_;
    link::mavlink::Endpoint endpoint_;
    ReportingLink link_{endpoint_};
    app::PlanMemory plans_;
    app::ReachPicture picture_;
    std::optional<app::Coprocessor> coprocessor_;
    app::Parameters wanted_;
    app::StepReport report_;
    std::optional<TimePoint> last_step_;
    std::uint32_t generation_ = 0;  ///< of the co-processor's parameters that are in wanted_
    bool over_can_;
    bool has_cloud_;
    bool has_time_ = true;
    bool reach_damaged_ = false;
    bool has_ended_ = false;
};

}  // namespace jink::c_interface
