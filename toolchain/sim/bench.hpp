// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "firmware/app/cloud_input.hpp"
#include "firmware/app/coprocessor.hpp"
#include "firmware/app/plan_memory.hpp"
#include "firmware/app/reach_picture.hpp"
#include "firmware/link/mavlink/endpoint.hpp"
#include "toolchain/sim/record.hpp"
#include "toolchain/sim/scenario.hpp"

namespace jink::sim {

/// Measures repeated durations.
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

/// Counts StepsToAnswer.
class AnswerCounter {
public:
    /// The guidance of each step.
    void note(const avoid::Guidance& guidance)
    {
        const bool plans = guidance.plan_status != world::PlanStatus::no_conflict;
        steps_ = plans ? steps_ + 1 : 0;
        if (steps_ > 0 && (guidance.new_manoeuvre || (guidance.by != 0 && by_ == 0))) {
            counted_.first = counted_.first == 0 ? steps_ : counted_.first;
            counted_.slowest = std::max(counted_.slowest, steps_);
        }
        steps_ = guidance.plan_status == world::PlanStatus::running ? steps_ : 0;
        by_ = guidance.by;
        note_conflict(guidance, plans);
    }
    [[nodiscard]] const StepsToAnswer& counted() const noexcept { return counted_; }

private:
    void note_conflict(const avoid::Guidance& guidance, bool plans)
    {
        since_first_plan_ = plans || since_first_plan_ > 0 ? since_first_plan_ + 1 : 0;
        if (guidance.by != 0 && counted_.from_first_plan == 0) {
            counted_.from_first_plan = since_first_plan_;
        }
        since_first_plan_ =
            guidance.conflict || guidance.plan_status == world::PlanStatus::running ? since_first_plan_ : 0;
    }

    StepsToAnswer counted_;
    unsigned steps_ = 0;             ///< of the plan that goes on
    unsigned since_first_plan_ = 0;  ///< of the conflict that goes on
    std::uint8_t by_ = 0;
};

/// Start-up configuration of a co-processor, beside its line.
struct BenchSetup {
    PlannerKind planner = PlannerKind::product;
    app::Parameters parameters;
    std::uint8_t system = 0;           ///< system id of its autopilot; 0: the first autopilot received
    link::SensorBus* bus = nullptr;    ///< outlives the bench
    hal::SerialPort* cloud = nullptr;  ///< a LiDAR's line; outlives the bench
    Board board;
    bool timed = false;  ///< steps are timed
    TimePoint start{0};  ///< time 0 of Inside::decisions and Inside::work on its clock
};

/// The co-processor in this process; its steps are timed where BenchSetup says so.
class Bench {
public:
    /// @param port, watchdog  outlive the bench
    Bench(hal::SerialPort& port, hal::Watchdog& watchdog, const BenchSetup& setup);

    void step(TimePoint now);

    /// Plans made with the parameters' settings although other settings were handed over: plans of a step that accepted
    /// a parameter. 0 in a valid flight.
    [[nodiscard]] unsigned foreign_plans() const noexcept
    {
        return planner_ == PlannerKind::product ? 0U : foreign_plans_;
    }

    /// Side of the manoeuvre chosen in the last step.
    [[nodiscard]] const std::optional<Vec>& chosen() const noexcept { return chosen_; }

    [[nodiscard]] Inside inside() const;
    [[nodiscard]] app::Coprocessor& coprocessor() noexcept { return *coprocessor_; }

private:
    /// Hands the settings over again: a changed parameter resets the planner to the product's settings.
    void hand_over_settings();

    link::mavlink::Endpoint endpoint_;
    std::unique_ptr<app::CloudInput> clouds_;
    std::unique_ptr<app::ReachPicture> picture_;
    std::unique_ptr<app::PlanMemory> plan_memory_;
    std::unique_ptr<app::Coprocessor> coprocessor_;
    PlannerKind planner_;
    bool timed_;
    std::uint32_t generation_ = 0;
    unsigned foreign_plans_ = 0;
    AnswerCounter to_answer_;
    Stopwatch steps_;
    Stopwatch plan_steps_;
    void take_notes(const app::StepReport& report, TimePoint now, bool planned, bool found);

    TimePoint start_;
    std::string first_candidate_;
    bool found_ = false;
    std::vector<DecisionAt> decisions_;
    std::optional<DecisionAt> first_plan_;
    std::vector<WorkAt> work_;
    std::optional<Vec> chosen_;
};

}  // namespace jink::sim
