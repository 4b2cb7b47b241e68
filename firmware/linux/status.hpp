// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>

#include "firmware/app/can_bus.hpp"
#include "firmware/app/cloud_input.hpp"
#include "firmware/app/coprocessor.hpp"
#include "firmware/link/mavlink/endpoint.hpp"
#include "firmware/linux/background.hpp"
#include "firmware/linux/flight_log/output.hpp"
#include "hal/serial_port.hpp"

namespace jink::host {

/// The objects whose state is reported.
struct Watched {
    const app::Coprocessor& coprocessor;
    const link::mavlink::Endpoint& endpoint;
    const hal::SerialPort& port;  ///< MAVLink's
    const app::CanBus* bus;       ///< nullptr: no bus
    const app::CloudInput& clouds;
    const flightlog::Output* log;  ///< nullptr: no log
};

/// The daemon's status line and its final summary.
class StatusLog {
public:
    /// @param period  seconds between status lines on standard output; 0: none
    explicit StatusLog(double period) : period_us_(static_cast<std::int64_t>(period * 1e6)) {}

    /// Counts a step. @return the status line, if one is due
    std::optional<std::string> note(const app::StepReport& report, const Watched& watched, std::int64_t now_us,
                                    std::int64_t took_us);

    /// Writes a JSON file; false if it cannot be written.
    [[nodiscard]] bool write_summary(const std::string& path, const Watched& watched,
                                     const BackgroundCounts& counts) const;

private:
    /// Step times in bins of 10 us; the last bin holds all longer times.
    static constexpr std::size_t kBins = 500;
    static constexpr std::int64_t kBinWidth = 10;

    std::int64_t period_us_;
    std::int64_t last_line_us_ = 0;
    std::int64_t total_us_ = 0;
    std::int64_t longest_us_ = 0;
    std::uint64_t steps_ = 0;
    std::array<std::uint32_t, kBins> bins_{};
    std::array<std::uint32_t, kBins> plan_bins_{};  ///< of the steps in which a plan was made
    std::uint32_t last_plans_ = 0;
    std::int64_t longest_plan_us_ = 0;
    std::int64_t total_plan_us_ = 0;
    std::uint64_t plan_steps_ = 0;
};

}  // namespace jink::host
