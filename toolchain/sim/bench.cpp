// SPDX-License-Identifier: BSD-3-Clause
#include "toolchain/sim/bench.hpp"

#include <ctime>
#include <stdexcept>

#include "firmware/app/reach_sets.hpp"
#include "firmware/app/work_rate.hpp"
#include "firmware/vehicles/default/reach_sets_reduced.hpp"
#include "toolchain/sim/decision_at.hpp"

namespace jink::sim {
namespace {

/// Processor time of this thread: interruptions by other work of the host do not count.
double cpu_microseconds()
{
    timespec t{};
    ::clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return static_cast<double>(t.tv_sec) * 1e6 + static_cast<double>(t.tv_nsec) * 1e-3;
}

const reach::VehicleSets& reach_sets_of(const Board& board)
{
    return board.reduced_sets ? reach::kDefaultReducedSets : app::reach_sets();
}

app::Parameters parameters_of(const BenchSetup& setup)
{
    app::Parameters parameters = setup.parameters;
    if (setup.board.reduced_sets) {
        parameters.use(reach_sets_of(setup.board));
    }
    return parameters;
}

}  // namespace

Bench::Bench(hal::SerialPort& port, hal::Watchdog& watchdog, const BenchSetup& setup)
    : endpoint_({.system_id = setup.system}),
      coprocessor_(std::make_unique<app::Coprocessor>(endpoint_, port, watchdog, parameters_of(setup), setup.bus)),
      planner_(setup.planner), timed_(setup.timed), start_(setup.start)
{
    if (setup.board.clock != 0) {
        if (setup.cloud != nullptr) {
            throw std::runtime_error("reach sets see a LiDAR's points, which change while a plan goes on: no clock");
        }
        plan_memory_ = std::make_unique<app::PlanMemory>();
        if (!coprocessor_->plan_in_slices(plan_memory_->plan, app::WorkRate::of_megahertz(setup.board.clock).work())) {
            throw std::runtime_error("a step at this clock has no time for a plan");
        }
    }
    if (setup.cloud != nullptr) {
        clouds_ = std::make_unique<app::CloudInput>(setup.cloud);
        picture_ = std::make_unique<app::ReachPicture>(reach_sets_of(setup.board));
        coprocessor_->use_clouds(*clouds_);
        coprocessor_->let_reach_sets_see(*picture_);
    }
    hand_over_settings();
}

void Bench::step(TimePoint now)
{
    const std::uint32_t plans = coprocessor_->supervisor_diagnostics().plans;
    const std::uint32_t found = coprocessor_->supervisor_diagnostics().plans_found;
    const double began = timed_ ? cpu_microseconds() : 0.0;
    const app::StepReport report = coprocessor_->step(now);
    const bool planned = coprocessor_->supervisor_diagnostics().plans != plans;
    if (timed_) {
        const double took = cpu_microseconds() - began;
        steps_.note(took);
        if (planned) {
            plan_steps_.note(took);
            plan_steps_.keep(took);
        }
    }
    to_answer_.note(report.guidance);
    chosen_.reset();
    if (report.guidance.new_manoeuvre && coprocessor_->flying() != nullptr) {
        chosen_ = coprocessor_->flying()->side.cast<double>();
    }
    if (coprocessor_->parameters().generation() != generation_) {
        foreign_plans_ += coprocessor_->supervisor_diagnostics().plans - plans;
        hand_over_settings();
    }
    take_notes(report, now, planned, coprocessor_->supervisor_diagnostics().plans_found != found);
}

void Bench::take_notes(const app::StepReport& report, TimePoint now, bool planned, bool found)
{
    constexpr double kMicro = 1e-6;
    const double time = static_cast<double>(now.us - start_.us) * kMicro;
    work_.push_back({time, report.work});
    if (found && !found_) {
        first_candidate_ = chosen_candidate(*coprocessor_);
        found_ = true;
    }
    if (report.guidance.new_manoeuvre) {
        decisions_.push_back(decision_at(*coprocessor_, report, time));
    } else if (planned && !first_plan_) {
        first_plan_ = decision_at(*coprocessor_, report, time);
    }
}

Inside Bench::inside() const
{
    const auto& s = coprocessor_->supervisor_diagnostics();
    const auto& d = coprocessor_->diagnostics();
    const auto& t = coprocessor_->track_diagnostics();
    const auto& l = endpoint_.diagnostics();
    Inside in;
    in.to_answer = to_answer_.counted();
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
    in.decisions = decisions_;
    if (decisions_.empty() && first_plan_) {
        in.decisions.push_back(*first_plan_);
    }
    in.work = work_;
    return in;
}

void Bench::hand_over_settings()
{
    generation_ = coprocessor_->parameters().generation();
    if (planner_ == PlannerKind::source) {
        if (!coprocessor_->planner().configure(geometric::source_settings())) {
            throw std::logic_error("the planner refuses the source's settings");
        }
    }
}

}  // namespace jink::sim
