// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gtest/gtest.h>

#include <array>
#include <functional>
#include <memory>
#include <optional>
#include <sstream>
#include <string>
#include <vector>

#include "firmware/link/mavlink/catalogue.hpp"
#include "firmware/linux/flight_log/assembly.hpp"
#include "firmware/linux/flight_log/flight_log.hpp"
#include "firmware/linux/flight_log/log_files.hpp"
#include "firmware/linux/flight_log/replay.hpp"
#include "hal/memory/counting_watchdog.hpp"
#include "hal/memory/manual_clock.hpp"
#include "toolchain/sim/cable.hpp"
#include "toolchain/sim/lidar.hpp"
#include "toolchain/sim/plant.hpp"
#include "toolchain/sim/timing.hpp"
#include "toolchain/sim/tunnel_line.hpp"

// Flights in process whose log is kept in memory.

namespace jink::test {

/// A log in memory, from which signing keys are removed as from files.
class MemoryLog final : public flightlog::Output {
public:
    explicit MemoryLog(const flightlog::Setup& setup)
        : bytes_(flightlog::head_of_file(flightlog::definitions_of(setup), 0, "jink_test", 0)), passed_(bytes_.size())
    {
    }
    bool add(std::span<const std::byte> messages, std::uint32_t count, flightlog::Records /*records*/) noexcept override
    {
        bytes_.insert(bytes_.end(), messages.begin(), messages.end());
        passed_ += keys_.pass(std::span(bytes_).subspan(passed_));
        counts_.messages += count;
        return true;
    }
    void lose() noexcept override { ++counts_.dropped; }
    [[nodiscard]] flightlog::LogCounts counts() const noexcept override { return counts_; }

    [[nodiscard]] std::string text() const { return {reinterpret_cast<const char*>(bytes_.data()), bytes_.size()}; }

private:
    std::vector<std::byte> bytes_;
    std::size_t passed_ = 0;  ///< bytes without keys
    flightlog::KeyFilter keys_;
    flightlog::LogCounts counts_;
};

/// What jinkd without options flies.
inline flightlog::Setup plain_setup()
{
    flightlog::Setup setup;
    const app::Parameters parameters;
    setup.initial = parameters.values();
    setup.stored = parameters.values();
    setup.generation = parameters.generation();
    setup.reach_sets = flightlog::reach_sets_checksum();
    setup.version = flightlog::build_version();
    setup.digest = flightlog::build_digest();
    return setup;
}

struct RecordedFlight {
    std::string log;
    std::uint64_t steps = 0;
    std::uint32_t manoeuvres = 0;
    std::uint32_t lost = 0;
};

/// What happens beside the flight, called before each step.
using BesideFlight = std::function<void(std::uint64_t step, TimePoint now, app::Coprocessor&, flightlog::HalRecorder&)>;

/// How the co-processor of a flight is set up.
struct FlightOptions {
    flightlog::Setup setup = plain_setup();  ///< on_bus: MAVLink goes through the tunnel of a DroneCAN bus
    std::optional<files::SigningKey> key;    ///< of both ends
    BesideFlight beside;
    flightlog::Output* output = nullptr;  ///< in place of a log in memory
    bool without_log = false;             ///< nothing is recorded
    bool without_records = false;         ///< messages alone are composed, as for a live page without a log
};

/// A step and its log. tests/flight_log/cost_check.py counts the instructions below this function.
[[gnu::noinline]] inline app::StepReport counted_step(flightlog::FlightLog* log, app::Coprocessor& coprocessor,
                                                      TimePoint now, std::int64_t took_us)
{
    if (log != nullptr) {
        log->begin(now);
    }
    const app::StepReport report = coprocessor.step(now);
    if (log != nullptr) {
        log->end(report, coprocessor, now, took_us);
    }
    return report;
}

/// The autopilot's end signs what it sends, and the co-processor's frames are taken as they are.
class SigningEnd {
public:
    explicit SigningEnd(const std::optional<files::SigningKey>& key) : key_(key) {}
    /// Frames with signatures in place of those without.
    [[nodiscard]] std::vector<std::byte> sign(std::vector<std::byte> bytes)
    {
        if (!key_) {
            return bytes;
        }
        std::vector<std::byte> out;
        std::span<const std::byte> rest(bytes);
        while (const auto frame = parser_.next(rest)) {
            out.insert(out.end(), {std::byte{0xFD}, static_cast<std::byte>(frame->length), std::byte{1}, std::byte{0},
                                   static_cast<std::byte>(sequence_++), static_cast<std::byte>(frame->header.system_id),
                                   static_cast<std::byte>(frame->header.component_id),
                                   static_cast<std::byte>(frame->message_id & 0xFFU),
                                   static_cast<std::byte>(frame->message_id >> 8U & 0xFFU),
                                   static_cast<std::byte>(frame->message_id >> 16U)});
            finish(*frame, out);
        }
        return out;
    }

private:
    void finish(const link::mavlink::Frame& frame, std::vector<std::byte>& out)
    {
        const std::size_t begin = out.size() - 10;
        out.insert(out.end(), frame.payload.begin(), frame.payload.begin() + frame.length);
        std::uint16_t crc = 0xFFFF;
        const auto add = [&](std::uint8_t byte) {
            auto t = static_cast<std::uint8_t>(byte ^ (crc & 0xFFU));
            t = static_cast<std::uint8_t>(t ^ (t << 4U));
            crc = static_cast<std::uint16_t>((crc >> 8U) ^ (t << 8U) ^ (t << 3U) ^ (t >> 4U));
        };
        for (std::size_t i = begin + 1; i < out.size(); ++i) {
            add(static_cast<std::uint8_t>(out[i]));
        }
        add(link::mavlink::find_message(frame.message_id)->crc_extra);
        out.push_back(static_cast<std::byte>(crc & 0xFFU));
        out.push_back(static_cast<std::byte>(crc >> 8U));
        out.resize(out.size() + 13);
        signer_.sign(std::span(out).subspan(begin));
    }

    std::optional<files::SigningKey> key_;
    link::mavlink::Signing signer_{key_.value_or(files::SigningKey{}), 7, 1'000'000};
    link::mavlink::Parser parser_;
    std::uint8_t sequence_ = 0;
};

/// Flies a scenario with the timing given, over a line or a bus in memory, with its LiDAR where it has one.
inline RecordedFlight fly_recorded(const sim::Scenario& scenario, const sim::Timing& timing,
                                   const FlightOptions& options = {})
{
    constexpr std::int64_t kClockStart = 1'234'567'890;
    const flightlog::Setup& setup = options.setup;
    hal::ManualClock clock(kClockStart);
    hal::CountingWatchdog watchdog;
    const auto cable = std::make_unique<sim::Cable>(clock, scenario.seed, timing);
    const auto tunnel = std::make_unique<sim::TunnelLine>(clock, scenario.seed);
    sim::LineEnd& end_of_line = setup.on_bus ? static_cast<sim::LineEnd&>(*tunnel) : *cable;
    const auto lidar = scenario.lidar ? std::make_unique<sim::Lidar>(scenario) : nullptr;
    MemoryLog memory(setup);
    flightlog::Output& output = options.output != nullptr ? *options.output : memory;
    flightlog::FlightLog::Limits limits;
    limits.record += flightlog::FlightLog::Limits::kOfBus + flightlog::FlightLog::Limits::kOfClouds;
    limits.record = options.without_records ? 0 : limits.record;
    flightlog::FlightLog log(output, limits, setup.stored);
    flightlog::RecordingSerialPort line(cable->port(), log.recorder(), flightlog::Port::line);
    flightlog::RecordingCanPort can(tunnel->wire().port(1), log.recorder());
    std::optional<flightlog::RecordingSerialPort> cloud;
    if (lidar) {
        cloud.emplace(*lidar, log.recorder(), flightlog::Port::cloud);
    }
    link::mavlink::Signing signing;
    signing.let_keys_be_set(setup.keys_can_be_set);
    signing.advance_to(setup.signing_time);
    if (options.key) {
        signing.set_key(*options.key, setup.signing_time);
    }
    app::Parameters initial;
    EXPECT_EQ(initial.set_all(setup.initial), app::ParamStatus::ok);
    hal::SerialPort& given_line = options.without_log ? cable->port() : line;
    flightlog::Assembly assembly(
        setup, initial,
        {setup.on_bus ? nullptr : &given_line, setup.has_bus ? &can : nullptr, cloud ? &*cloud : nullptr}, watchdog,
        signing, nullptr);
    app::Coprocessor& coprocessor = assembly.coprocessor();
    sim::Plant plant(scenario);
    sim::Ticks ticks(timing);
    SigningEnd signer(options.key);
    std::array<std::byte, 4096> buffer{};
    RecordedFlight flight;
    const auto advance = [&](sim::Micros flown) { clock.advance(kClockStart + flown - clock.now_us()); };
    while (!plant.finished()) {
        plant.deliver({buffer.data(), end_of_line.read(buffer)});
        plant.step();
        if (lidar) {
            lidar->step(plant.world());
        }
        static_cast<void>(end_of_line.write(signer.sign(plant.collect())));
        for (; ticks.next() <= plant.now(); ticks.begin()) {
            advance(ticks.next());
            const TimePoint now{clock.now_us()};
            if (options.beside) {
                options.beside(flight.steps, now, coprocessor, log.recorder());
            }
            const app::StepReport report = counted_step(options.without_log ? nullptr : &log, coprocessor, now,
                                                        100 + static_cast<std::int64_t>(flight.steps % 7));
            ++flight.steps;
            flight.manoeuvres += report.guidance.new_manoeuvre ? 1U : 0U;
        }
        advance(plant.now());
    }
    const TimePoint end{clock.now_us()};
    if (options.without_log) {
        coprocessor.shut_down(end);
        return flight;
    }
    log.begin_shut_down(end);
    coprocessor.shut_down(end);
    log.end_shut_down(end);
    flight.log = memory.text();
    flight.lost = output.counts().dropped;
    return flight;
}

inline flightlog::ReplayResult replay(const std::string& log, const flightlog::ReplayOptions& options = {})
{
    std::istringstream in(log);
    ulog::Reader reader(in);
    const auto flight = std::make_unique<flightlog::FlightReplay>(options);
    static_cast<void>(flight->play(reader));
    return flight->result();
}

}  // namespace jink::test
