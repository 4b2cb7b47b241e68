// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <functional>
#include <memory>
#include <sstream>
#include <string>
#include <vector>

#include "firmware/linux/flight_log/assembly.hpp"
#include "firmware/linux/flight_log/flight_log.hpp"
#include "firmware/linux/flight_log/log_files.hpp"
#include "firmware/linux/flight_log/replay.hpp"
#include "hal/memory/manual_clock.hpp"
#include "toolchain/sim/cable.hpp"
#include "toolchain/sim/plant.hpp"
#include "toolchain/sim/timing.hpp"

// Flights in process whose log is kept in memory.

namespace jink::test {

/// A log in memory.
class MemoryLog final : public flightlog::Output {
public:
    explicit MemoryLog(const flightlog::Setup& setup)
        : bytes_(flightlog::head_of_file(flightlog::definitions_of(setup), 0, "jink_test", 0))
    {
    }
    bool add(std::span<const std::byte> message) noexcept override
    {
        bytes_.insert(bytes_.end(), message.begin(), message.end());
        ++counts_.messages;
        return true;
    }
    void lose() noexcept override { ++counts_.dropped; }
    [[nodiscard]] flightlog::LogCounts counts() const noexcept override { return counts_; }

    [[nodiscard]] std::string text() const { return {reinterpret_cast<const char*>(bytes_.data()), bytes_.size()}; }

private:
    std::vector<std::byte> bytes_;
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

/// Flies a scenario with the timing given; MAVLink on a line in memory.
inline RecordedFlight fly_recorded(const sim::Scenario& scenario, const sim::Timing& timing,
                                   const BesideFlight& beside = {})
{
    constexpr std::int64_t kClockStart = 1'234'567'890;
    hal::ManualClock clock(kClockStart);
    hal::CountingWatchdog watchdog;
    const auto cable = std::make_unique<sim::Cable>(clock, scenario.seed, timing);
    const flightlog::Setup setup = plain_setup();
    MemoryLog memory(setup);
    flightlog::FlightLog log(memory, {}, setup.stored);
    flightlog::RecordingSerialPort line(cable->port(), log.recorder(), flightlog::Port::line);
    link::mavlink::Signing signing;
    flightlog::Assembly assembly(setup, app::Parameters(), {&line, nullptr, nullptr}, watchdog, signing, nullptr);
    app::Coprocessor& coprocessor = assembly.coprocessor();
    sim::Plant plant(scenario);
    sim::Ticks ticks(timing);
    std::array<std::byte, 4096> buffer{};
    RecordedFlight flight;
    const auto advance = [&](sim::Micros flown) { clock.advance(kClockStart + flown - clock.now_us()); };
    while (!plant.finished()) {
        plant.deliver({buffer.data(), cable->read(buffer)});
        plant.step();
        static_cast<void>(cable->write(plant.collect()));
        for (; ticks.next() <= plant.now(); ticks.begin()) {
            advance(ticks.next());
            const TimePoint now{clock.now_us()};
            if (beside) {
                beside(flight.steps, now, coprocessor, log.recorder());
            }
            log.begin(now);
            const app::StepReport report = coprocessor.step(now);
            log.end(report, coprocessor, now, 100 + static_cast<std::int64_t>(flight.steps % 7));
            ++flight.steps;
            flight.manoeuvres += report.guidance.new_manoeuvre ? 1U : 0U;
        }
        advance(plant.now());
    }
    const TimePoint end{clock.now_us()};
    log.begin_shut_down(end);
    coprocessor.shut_down(end);
    log.end_shut_down(end);
    flight.log = memory.text();
    flight.lost = memory.counts().dropped;
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
