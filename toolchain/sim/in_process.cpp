// SPDX-License-Identifier: BSD-3-Clause
#include "toolchain/sim/in_process.hpp"

#include <array>
#include <memory>
#include <ostream>

#include "hal/memory/counting_watchdog.hpp"
#include "hal/memory/manual_clock.hpp"
#include "toolchain/sim/bench.hpp"
#include "toolchain/sim/cable.hpp"
#include "toolchain/sim/lidar.hpp"
#include "toolchain/sim/step_record.hpp"
#include "toolchain/sim/tunnel_line.hpp"

namespace jink::sim {
namespace {

/// The co-processor's clock is independent of the autopilot's.
constexpr std::int64_t kClockStart = 1'234'567'890;

/// Records the bytes that each step reads and writes on a line.
class Tap final : public hal::SerialPort {
public:
    Tap(hal::SerialPort& line, std::ostream* steps, const Board& board)
        : line_(line), steps_(steps),
          start_((board.reduced_sets ? kStartsWithReducedSets : kStartsAnew) + board.clock * kStepClock)
    {
    }

    [[nodiscard]] std::size_t read(std::span<std::byte> into) noexcept override
    {
        const std::size_t n = line_.read(into);
        in_.insert(in_.end(), into.begin(), into.begin() + static_cast<std::ptrdiff_t>(n));
        return n;
    }
    [[nodiscard]] std::size_t write(std::span<const std::byte> from) noexcept override
    {
        const std::size_t n = line_.write(from);
        out_.insert(out_.end(), from.begin(), from.begin() + static_cast<std::ptrdiff_t>(n));
        return n;
    }
    [[nodiscard]] hal::PortHealth health() const noexcept override { return line_.health(); }

    /// Ends a step's record.
    void note(TimePoint now)
    {
        if (steps_ != nullptr) {
            const StepRecord record{kStepMagic, first_ ? start_ : 0U, now.us, static_cast<std::uint32_t>(in_.size()),
                                    static_cast<std::uint32_t>(out_.size())};
            steps_->write(reinterpret_cast<const char*>(&record), sizeof record);
            steps_->write(reinterpret_cast<const char*>(in_.data()), static_cast<std::streamsize>(in_.size()));
            steps_->write(reinterpret_cast<const char*>(out_.data()), static_cast<std::streamsize>(out_.size()));
        }
        first_ = false;
        in_.clear();
        out_.clear();
    }

private:
    hal::SerialPort& line_;
    std::ostream* steps_;
    std::uint32_t start_;
    bool first_ = true;
    std::vector<std::byte> in_;
    std::vector<std::byte> out_;
};

void to(hal::ManualClock& clock, Micros flown) { clock.advance(kClockStart + flown - clock.now_us()); }

Record fly(const Scenario& scenario, const Timing& timing, hal::ManualClock& clock, LineEnd& line, Bench& bench,
           Tap& tap, Lidar* lidar)
{
    Plant plant(scenario);
    Ticks ticks(timing);
    std::array<std::byte, 4096> buffer{};
    bool overflow = false;
    while (!plant.finished()) {
        plant.deliver({buffer.data(), line.read(buffer)});
        plant.step();
        if (lidar != nullptr) {
            lidar->step(plant.world());
        }
        overflow = !line.write(plant.collect()) || overflow;
        for (; ticks.next() <= plant.now(); ticks.begin()) {
            to(clock, ticks.next());
            bench.step({clock.now_us()});
            tap.note({clock.now_us()});
            if (bench.chosen()) {
                plant.note_choice(*bench.chosen());
            }
        }
        to(clock, plant.now());
    }
    Record record = plant.record(lidar != nullptr ? lidar->reported() : std::vector<double>{});
    record.transport = "in process";
    record.inside = bench.inside();
    if (overflow) {
        record.faults.emplace_back("the line could not carry the autopilot's telemetry");
    }
    if (bench.foreign_plans() > 0) {
        record.faults.emplace_back("plans by other settings than the scenario's planner");
    }
    conclude(scenario, record);
    return record;
}

std::unique_ptr<Lidar> lidar_of(const Scenario& scenario)
{
    return scenario.lidar ? std::make_unique<Lidar>(scenario) : nullptr;
}

}  // namespace

Record fly_in_process(const Scenario& given, const Timing& timing, std::ostream* steps)
{
    Scenario scenario = given;
    scenario.scan.phase = timing.scan_phase;
    scenario.traffic.phase = timing.traffic_phase;
    hal::ManualClock clock(kClockStart);
    hal::CountingWatchdog watchdog;
    const auto cable = std::make_unique<Cable>(clock, scenario.seed, timing);
    Tap tap(cable->port(), steps, scenario.board);
    const std::unique_ptr<Lidar> lidar = lidar_of(scenario);
    Bench bench(tap, watchdog,
                {.planner = scenario.planner,
                 .parameters = {},
                 .cloud = lidar.get(),
                 .board = scenario.board,
                 .timed = scenario.timed,
                 .start = {kClockStart}});
    return fly(scenario, timing, clock, *cable, bench, tap, lidar.get());
}

Record fly_in_process(const Scenario& scenario, std::ostream* steps)
{
    return fly_in_process(scenario, Timing{}, steps);
}

Record fly_through_tunnel(const Scenario& scenario)
{
    hal::ManualClock clock(kClockStart);
    hal::CountingWatchdog watchdog;
    const auto line = std::make_unique<TunnelLine>(clock, scenario.seed);
    Tap tap(line->bus().serial(), nullptr, scenario.board);
    const std::unique_ptr<Lidar> lidar = lidar_of(scenario);
    Bench bench(tap, watchdog,
                {.planner = scenario.planner,
                 .parameters = {},
                 .bus = &line->bus(),
                 .cloud = lidar.get(),
                 .board = scenario.board,
                 .timed = scenario.timed,
                 .start = {kClockStart}});
    Record record = fly(scenario, Timing{}, clock, *line, bench, tap, lidar.get());
    record.transport = "tunnel";
    return record;
}

Record fly_alone(const Scenario& scenario)
{
    Plant plant(scenario);
    while (!plant.finished()) {
        plant.step();
        static_cast<void>(plant.collect());
    }
    Record record = plant.record();
    record.transport = "none";
    record.faults.clear();
    conclude(scenario, record);
    return record;
}

}  // namespace jink::sim
