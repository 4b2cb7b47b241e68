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

/// Gives each message to the files of the log and to the live page.
class TwoOutputs final : public flightlog::Output {
public:
    TwoOutputs(flightlog::Output& files, flightlog::Output& page) : files_(files), page_(page) {}
    bool add(std::span<const std::byte> messages, std::uint32_t count, flightlog::Records records) noexcept override
    {
        const bool is_shown = page_.add(messages, count, records);
        return files_.add(messages, count, records) && is_shown;
    }
    void lose() noexcept override
    {
        page_.lose();
        files_.lose();
    }
    [[nodiscard]] flightlog::LogCounts counts() const noexcept override { return files_.counts(); }

private:
    flightlog::Output& files_;
    flightlog::Output& page_;
};

/// The flight log of jinkd, if files or a live page want it: the ports that record, the loop's side and the thread that
/// writes files.
class Logging {
public:
    /// @param page  nullptr: none; outlives this
    Logging(const LogOptions& options, const flightlog::Setup& setup, flightlog::Output* page);
    Logging(const Logging&) = delete;
    Logging& operator=(const Logging&) = delete;

    /// nullptr: neither files nor a page.
    [[nodiscard]] flightlog::HalRecorder* recorder() noexcept { return log_ ? &log_->recorder() : nullptr; }
    /// Of the files; nullptr: none.
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
    void set_time(TimePoint now) noexcept;

    LogOptions options_;
    std::optional<flightlog::Writer> writer_;
    std::optional<TwoOutputs> both_;
    std::optional<flightlog::FlightLog> log_;
    std::optional<flightlog::RecordingSerialPort> line_;
    std::optional<flightlog::RecordingSerialPort> cloud_;
    std::optional<flightlog::RecordingCanPort> can_;
};

}  // namespace jink::host
