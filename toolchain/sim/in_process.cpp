// SPDX-License-Identifier: BSD-3-Clause
#include "toolchain/sim/in_process.hpp"

#include <algorithm>
#include <array>
#include <ctime>
#include <memory>
#include <optional>
#include <ostream>
#include <stdexcept>

#include "firmware/app/cloud_input.hpp"
#include "firmware/app/coprocessor.hpp"
#include "firmware/app/reach_picture.hpp"
#include "firmware/app/reach_sets.hpp"
#include "firmware/link/mavlink/endpoint.hpp"
#include "hal/memory/counting_watchdog.hpp"
#include "hal/memory/manual_clock.hpp"
#include "hal/memory/memory_serial_link.hpp"
#include "toolchain/sim/fan.hpp"
#include "toolchain/sim/lidar.hpp"
#include "toolchain/sim/step_record.hpp"
#include "toolchain/sim/tunnel_line.hpp"

namespace jink::sim {
namespace {

/// The co-processor's clock has nothing to do with the autopilot's.
constexpr std::int64_t kClockStart = 1'234'567'890;

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

/// Listens in on a line: what each step reads and writes.
class Tap final : public hal::SerialPort {
public:
    Tap(hal::SerialPort& line, std::ostream* steps) : line_(line), steps_(steps) {}

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
            const StepRecord record{kStepMagic, first_ ? 1U : 0U, now.us, static_cast<std::uint32_t>(in_.size()),
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
    bool first_ = true;
    std::vector<std::byte> in_;
    std::vector<std::byte> out_;
};

/// The co-processor with its own watch on it.
class Bench {
public:
    /// @param cloud  a LiDAR's line; nullptr: there is none
    Bench(hal::SerialPort& port, hal::Watchdog& watchdog, link::SensorBus* bus, PlannerKind planner,
          hal::SerialPort* cloud)
        : coprocessor_(std::make_unique<app::Coprocessor>(endpoint_, port, watchdog, app::Parameters(), bus)),
          planner_(planner)
    {
        if (cloud != nullptr) {
            clouds_ = std::make_unique<app::CloudInput>(cloud);
            picture_ = std::make_unique<app::ReachPicture>(app::reach_sets());
            coprocessor_->use_clouds(*clouds_);
            coprocessor_->let_reach_sets_see(*picture_);
        }
        hand_over_settings();
    }

    void close(const std::vector<ClosedArea>& areas, TimePoint now)
    {
        coprocessor_->set_constraints(constraints_of(areas, now), now);
    }

    void step(TimePoint now)
    {
        const std::uint32_t plans = coprocessor_->supervisor_diagnostics().plans;
        const std::uint32_t found = coprocessor_->supervisor_diagnostics().plans_found;
        const double began = cpu_microseconds();
        const app::StepReport report = coprocessor_->step(now);
        const double took = cpu_microseconds() - began;
        chosen_.reset();
        if (report.guidance.new_manoeuvre && coprocessor_->flying() != nullptr) {
            chosen_ = coprocessor_->flying()->side.cast<double>();
        }
        if (coprocessor_->parameters().generation() != generation_) {
            foreign_plans_ += coprocessor_->supervisor_diagnostics().plans - plans;
            hand_over_settings();
        }
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

    /// Plans that went by the parameters' settings although others were handed over: those of a step that took a
    /// parameter. A flight as it is meant has none.
    [[nodiscard]] unsigned foreign_plans() const noexcept
    {
        return planner_ == PlannerKind::product ? 0U : foreign_plans_;
    }

    /// Side of the manoeuvre that the last step took.
    [[nodiscard]] const std::optional<Vec>& chosen() const noexcept { return chosen_; }

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
    /// A change of a parameter gives the planner the product's settings again.
    void hand_over_settings()
    {
        generation_ = coprocessor_->parameters().generation();
        if (planner_ == PlannerKind::source) {
            geometric::Settings settings = geometric::source_settings();
            // What the supervisor sees as a conflict the planner has to see too.
            settings.lookahead = coprocessor_->parameters().configuration().planner.lookahead;
            if (!coprocessor_->planner().configure(settings)) {
                throw std::logic_error("the planner refuses the source's settings");
            }
        }
    }

    link::mavlink::Endpoint endpoint_;
    std::unique_ptr<app::CloudInput> clouds_;
    std::unique_ptr<app::ReachPicture> picture_;
    std::unique_ptr<app::Coprocessor> coprocessor_;
    PlannerKind planner_;
    std::uint32_t generation_ = 0;
    unsigned foreign_plans_ = 0;
    Stopwatch steps_;
    Stopwatch plan_steps_;
    std::string first_candidate_;
    std::vector<FanCurve> fan_;
    bool found_ = false;
    std::optional<Vec> chosen_;
};

class Cable final : public LineEnd {
public:
    Cable(hal::Clock& clock, std::uint64_t seed, const Timing& timing)
        : link_(clock, seed), there_(timing, kThere), back_(timing, kBack), port_(*this)
    {
    }
    std::size_t read(std::span<std::byte> into) override { return link_.a().read(into); }
    bool write(std::span<const std::byte> bytes) override
    {
        set_latency(link_.a_to_b(), there_);
        return link_.a().write(bytes) == bytes.size();
    }
    hal::SerialPort& port() { return port_; }

private:
    static constexpr std::uint64_t kThere = 1;
    static constexpr std::uint64_t kBack = 2;

    /// The co-processor's end.
    class Port final : public hal::SerialPort {
    public:
        explicit Port(Cable& cable) : cable_(cable) {}
        [[nodiscard]] std::size_t read(std::span<std::byte> into) noexcept override
        {
            return cable_.link_.b().read(into);
        }
        [[nodiscard]] std::size_t write(std::span<const std::byte> from) noexcept override
        {
            set_latency(cable_.link_.b_to_a(), cable_.back_);
            return cable_.link_.b().write(from);
        }
        [[nodiscard]] hal::PortHealth health() const noexcept override { return cable_.link_.b().health(); }

    private:
        Cable& cable_;
    };

    static void set_latency(hal::MemoryLine& line, Delays& delays)
    {
        hal::LineFaults faults;
        faults.latency_us = delays.next();
        line.set_faults(faults);
    }

    hal::MemorySerialLink link_;
    Delays there_;
    Delays back_;
    Port port_;
};

void to(hal::ManualClock& clock, Micros flown) { clock.advance(kClockStart + flown - clock.now_us()); }

Record fly(const Scenario& scenario, const Timing& timing, hal::ManualClock& clock, LineEnd& line, Bench& bench,
           Tap& tap, Lidar* lidar)
{
    Plant plant(scenario);
    bench.close(scenario.areas, {clock.now_us()});
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
    Record record = plant.record();
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
    Tap tap(cable->port(), steps);
    const std::unique_ptr<Lidar> lidar = lidar_of(scenario);
    Bench bench(tap, watchdog, nullptr, scenario.planner, lidar.get());
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
    Tap tap(line->bus().serial(), nullptr);
    const std::unique_ptr<Lidar> lidar = lidar_of(scenario);
    Bench bench(tap, watchdog, &line->bus(), scenario.planner, lidar.get());
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
