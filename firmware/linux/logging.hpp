// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>

#include "firmware/linux/background.hpp"
#include "firmware/linux/flight_log/flight_log.hpp"
#include "firmware/linux/flight_log/setup.hpp"
#include "firmware/linux/flight_log/writer.hpp"

namespace jink::host {

struct LogOptions {
    std::string folder;  ///< empty: no log
    bool clouds = false;
    unsigned file_megabytes = 64;
    unsigned files = 32;
};

/// The flight log of jinkd, if one is wanted: the ports that record, the loop's side and the thread that writes.
class Logging {
public:
    Logging(const LogOptions& options, const flightlog::Setup& setup);
    Logging(const Logging&) = delete;
    Logging& operator=(const Logging&) = delete;

    /// nullptr: no log.
    [[nodiscard]] flightlog::HalRecorder* recorder() noexcept { return log_ ? &log_->recorder() : nullptr; }
    [[nodiscard]] const flightlog::Output* output() const noexcept { return writer_ ? &*writer_ : nullptr; }
    /// The ports that the co-processor is given: the given ones, recorded if there is a log. They outlive this.
    [[nodiscard]] hal::SerialPort& line(hal::SerialPort& port);
    [[nodiscard]] hal::SerialPort& cloud(hal::SerialPort& port);
    [[nodiscard]] hal::CanPort& can(hal::CanPort& port);

    // The control loop's.
    void begin(TimePoint began) noexcept;
    void end(const app::StepReport& report, app::Coprocessor& coprocessor, TimePoint began, std::int64_t took_us,
             Background& background) noexcept;
    void begin_shut_down(TimePoint now) noexcept;
    /// Waits half a second at most until everything is written.
    void end_shut_down(TimePoint now) noexcept;

private:
    LogOptions options_;
    std::optional<flightlog::Writer> writer_;
    std::optional<flightlog::FlightLog> log_;
    std::optional<flightlog::RecordingSerialPort> line_;
    std::optional<flightlog::RecordingSerialPort> cloud_;
    std::optional<flightlog::RecordingCanPort> can_;
};

}  // namespace jink::host
