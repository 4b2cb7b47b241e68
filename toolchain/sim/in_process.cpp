// SPDX-License-Identifier: BSD-3-Clause
#include "toolchain/sim/in_process.hpp"

#include <algorithm>
#include <array>
#include <ctime>
#include <memory>

#include "firmware/app/coprocessor.hpp"
#include "firmware/link/mavlink/endpoint.hpp"
#include "hal/memory/counting_watchdog.hpp"
#include "hal/memory/manual_clock.hpp"
#include "hal/memory/memory_serial_link.hpp"
#include "toolchain/sim/fan.hpp"

namespace jink::sim {
namespace {

constexpr Micros kTick = 20'000;
/// The co-processor's clock has nothing to do with the autopilot's.
constexpr std::int64_t kClockStart = 1'234'567'890;
/// 921600 baud carry a report of 40 bytes in 0.4 ms; USB adapters add a few.
constexpr std::int64_t kLineLatency = 1'000;

class Stopwatch {
public:
    void note(double us)
    {
        ++durations_.count;
        sum_ += us;
        durations_.worst = std::max(durations_.worst, us);
        durations_.mean = sum_ / static_cast<double>(durations_.count);
    }
    void keep(double us) { durations_.times.push_back(us); }
    [[nodiscard]] const Durations& durations() const noexcept { return durations_; }

private:
    Durations durations_;
    double sum_ = 0.0;
};

/// Of this thread: a step that is interrupted by other work of the machine is not thereby a long one.
double cpu_microseconds()
{
    timespec t{};
    ::clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return static_cast<double>(t.tv_sec) * 1e6 + static_cast<double>(t.tv_nsec) * 1e-3;
}

/// The co-processor with its own watch on it.
class Bench {
public:
    Bench(hal::SerialPort& port, hal::Watchdog& watchdog)
        : coprocessor_(std::make_unique<app::Coprocessor>(endpoint_, port, watchdog, app::Parameters()))
    {
    }

    void step(TimePoint now)
    {
        const std::uint32_t plans = coprocessor_->supervisor_diagnostics().plans;
        const std::uint32_t found = coprocessor_->supervisor_diagnostics().plans_found;
        const double began = cpu_microseconds();
        const app::StepReport report = coprocessor_->step(now);
        const double took = cpu_microseconds() - began;
        steps_.note(took);
        if (coprocessor_->supervisor_diagnostics().plans != plans) {
            plan_steps_.note(took);
            plan_steps_.keep(took);
        }
        const bool planned = coprocessor_->supervisor_diagnostics().plans != plans;
        const bool succeeded = coprocessor_->supervisor_diagnostics().plans_found != found;
        if ((succeeded && !found_) || (planned && fan_.empty())) {
            fan_ = fan_of(*coprocessor_, report, first_candidate_);
            found_ = succeeded;
        }
    }

    [[nodiscard]] Inside inside() const
    {
        const auto& s = coprocessor_->supervisor_diagnostics();
        const auto& d = coprocessor_->diagnostics();
        const auto& t = coprocessor_->track_diagnostics();
        const auto& l = endpoint_.diagnostics();
        Inside in;
        in.steps = steps_.durations();
        in.plan_steps = plan_steps_.durations();
        in.conflicts = s.conflicts;
        in.plans = s.plans;
        in.plans_found = s.plans_found;
        in.answers_rejected = s.answers_rejected;
        in.manoeuvres = s.manoeuvres;
        in.replans = s.replans;
        in.flips = s.flips;
        in.brakes = s.brakes;
        in.escapes = s.escapes;
        in.holds = s.holds;
        in.rejoined = s.rejoined;
        in.control_lost = s.control_lost;
        in.budget_spent = s.budget_spent;
        in.most_work = s.most_work;
        in.deadlines_missed = d.deadlines_missed;
        in.setpoints_withheld = d.setpoints_withheld;
        in.own_state_refused = d.own_state_refused;
        in.autopilot_reboots = d.autopilot_reboots;
        in.clock_relocks = l.clock_relocks;
        in.tracks_refused = t.not_finite + t.out_of_range + t.stale + t.future + t.full;
        in.track_jumps = t.jumps;
        in.frames_refused = l.frames_refused;
        in.not_finite = l.not_finite;
        in.stale_stamp = l.stale_stamp;
        in.inbox_full = l.inbox_full;
        in.outbox_full = l.outbox_full;
        in.first_candidate = first_candidate_;
        in.fan = fan_;
        return in;
    }

private:
    link::mavlink::Endpoint endpoint_;
    std::unique_ptr<app::Coprocessor> coprocessor_;
    Stopwatch steps_;
    Stopwatch plan_steps_;
    std::string first_candidate_;
    std::vector<FanCurve> fan_;
    bool found_ = false;
};

}  // namespace

Record fly_in_process(const Scenario& scenario)
{
    hal::ManualClock clock(kClockStart);
    const auto cable = std::make_unique<hal::MemorySerialLink>(clock, scenario.seed);
    hal::LineFaults line;
    line.latency_us = kLineLatency;
    cable->a_to_b().set_faults(line);
    cable->b_to_a().set_faults(line);
    hal::CountingWatchdog watchdog;
    Bench bench(cable->b(), watchdog);
    Plant plant(scenario);
    std::array<std::byte, 4096> buffer{};
    bool overflow = false;

    while (!plant.finished()) {
        plant.deliver({buffer.data(), cable->a().read(buffer)});
        plant.step();
        const std::vector<std::byte> out = plant.collect();
        overflow = overflow || cable->a().write(out) != out.size();
        clock.advance(kStep);
        if (plant.now() % kTick == 0) {
            bench.step({clock.now_us()});
        }
    }
    Record record = plant.record();
    record.transport = "in process";
    record.inside = bench.inside();
    if (overflow) {
        record.faults.emplace_back("the cable could not carry the autopilot's telemetry");
    }
    conclude(scenario, record);
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
