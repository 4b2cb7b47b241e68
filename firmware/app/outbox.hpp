// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string_view>

#include "core/base/static_vector.hpp"
#include "firmware/app/step_log.hpp"
#include "firmware/app/step_report.hpp"
#include "firmware/app/text.hpp"
#include "firmware/link/link.hpp"
#include "firmware/link/sensor_bus.hpp"
#include "hal/serial_port.hpp"

namespace jink::app {

/// The way out: texts for the autopilot and the bus, and the link's queued bytes for the port. The only part of
/// Coprocessor that other parts call to act.
class Outbox {
public:
    /// A restart reports three lines about the run before: two of a fault, one of its consequence.
    static constexpr std::size_t kMaxNotices = 3;

    /// @param bus  may be null
    Outbox(link::Link& link, hal::SerialPort& port, link::SensorBus* bus) noexcept : link_(link), port_(port), bus_(bus)
    {
    }

    /// From now on the log has every text. It outlives this.
    void log_to(StepLog& log) noexcept { log_ = &log; }
    /// nullptr: none.
    [[nodiscard]] StepLog* log() const noexcept { return log_; }
    /// Sends a text on the link, and on the bus where there is one.
    void say(link::Severity severity, std::string_view text) noexcept;
    /// Keeps a text for send_notices(). @return false: kMaxNotices wait already
    [[nodiscard]] bool keep(link::Severity severity, const Text& text) noexcept
    {
        return notices_.try_push_back({severity, text});
    }
    void send_notices() noexcept;
    /// Gives the port what the link has queued, as far as the port takes it. A lost port: all of it is discarded,
    /// because it must not go out when it is no longer true.
    /// @return bytes written
    std::uint32_t write() noexcept;
    /// Bytes of the last write().
    [[nodiscard]] std::uint32_t last_written() const noexcept { return last_written_; }
    /// Nothing waited for the port after the last write().
    [[nodiscard]] bool is_line_empty() const noexcept { return is_line_empty_; }

private:
    struct Notice {
        link::Severity severity = link::Severity::info;
        Text text;
    };

    std::uint32_t write_pending() noexcept;

    link::Link& link_;
    hal::SerialPort& port_;
    link::SensorBus* bus_;
    StepLog* log_ = nullptr;
    std::uint32_t last_written_ = 0;
    bool is_line_empty_ = true;
    StaticVector<Notice, kMaxNotices> notices_;
};

}  // namespace jink::app
