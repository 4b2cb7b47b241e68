// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/geometric/candidate.hpp"
#include "toolchain/sim/autopilot.hpp"
#include "toolchain/sim/side_log.hpp"

namespace jink::sim {

/// The flight at one instant.
struct Sample {
    double time = 0.0;
    Vec position = Vec::Zero();
    Vec velocity = Vec::Zero();
    Vec acceleration = Vec::Zero();
    Vec setpoint = Vec::Zero();  ///< in force; meaningful in external mode
    Mode mode = Mode::mission;
    double separation = 0.0;  ///< vehicle's centre to the nearest surface [m]
    std::size_t nearest = 0;  ///< index of the threat at `separation`
    int jink_state = 0;       ///< last received MAV_STATE
};

/// A new manoeuvre, and the candidates of the geometric planner's last plan then, as in a flight log.
struct DecisionAt {
    double time = 0.0;
    std::string text;  ///< the method whose answer is flown, and the chosen candidate in words
    Vec start = Vec::Zero();
    std::optional<Vec> own_at_closest;  ///< at the predicted closest approach, towards which curves lie
    std::vector<geometric::Candidate> candidates;
};

/// Work units of one step.
struct WorkAt {
    double time = 0.0;
    std::uint32_t work = 0;
};

/// Wall time of a kind of call [us].
struct Durations {
    unsigned count = 0;
    double mean = 0.0;
    double worst = 0.0;
    std::vector<double> times;  ///< each duration, where they are few; from the daemon with a resolution of 10 us
};

/// Steps from the one that begins a plan to the one that first commands its answer, both counted. A frame waits for
/// less than a tick until its step: so many ticks at most lie between its last byte and the command. Plans that end
/// without an answer, and velocities that are renewed, do not count.
struct StepsToAnswer {
    unsigned first = 0;    ///< of a flight; 0: none was flown
    unsigned slowest = 0;  ///< of all
    /// From the first plan of the first conflict that was answered, with plans before that had no answer.
    unsigned from_first_plan = 0;
};

/// Internals of the co-processor.
struct Inside {
    StepsToAnswer to_answer;
    Durations steps;       ///< Coprocessor::step
    Durations plan_steps;  ///< steps that called the planner
    unsigned conflicts = 0, plans = 0, plans_found = 0, answers_rejected = 0, manoeuvres = 0, replans = 0, flips = 0,
             brakes = 0, escapes = 0, holds = 0, rejoined = 0, control_lost = 0, budget_spent = 0, most_work = 0;
    unsigned deadlines_missed = 0, setpoints_withheld = 0, own_state_refused = 0, autopilot_reboots = 0,
             clock_relocks = 0;
    unsigned tracks_refused = 0, track_jumps = 0, frames_refused = 0, not_finite = 0, stale_stamp = 0, inbox_full = 0,
             outbox_full = 0;
    std::string first_candidate;  ///< of the first plan found; empty: none was
    /// In process alone. Without a new manoeuvre: the first plan tried, if there was one.
    std::vector<DecisionAt> decisions;
    std::vector<WorkAt> work;  ///< in process alone
};

/// The record of a flight.
struct Record {
    std::string name;
    std::string title;
    std::string transport;  ///< "in process", "daemon" or the board under emulation
    Stack stack = Stack::ardupilot;
    std::uint64_t seed = 0;
    double promise = 0.7;
    Outcome outcome = Outcome::failed;
    std::vector<std::string> faults;  ///< rules broken, in words
    double duration = 0.0;
    Closest closest;
    std::string closest_threat;
    double closest_area = 1e9;  ///< least signed distance, centre to the body of a closed area, negative inside [m]
    unsigned takeovers = 0;
    int flips = 0;              ///< side changes of the commanded track about the leg
    double longest_hold = 0.0;  ///< longest commanded stop [s]
    bool given_back = false;
    Mode final_mode = Mode::mission;
    double cross_track = 0.0;  ///< at the end [m]
    double goal_at = -1.0;     ///< when the last waypoint was reached; negative: never [s]
    double lowest = 0.0;       ///< least height of the centre [m]
    bool below_floor = false;  ///< was below the floor while the leg was not: a mission may lead below the floor by
                               ///< itself
    Heard heard;
    unsigned critical_texts = 0;  ///< of the autopilot, caused by the co-processor
    unsigned late_steps = 0;      ///< real time: steps begun more than a tick late
    double latest_step = 0.0;     ///< real time: largest lateness of a step [s]
    double held_up = 0.0;         ///< emulated: longest delay of the emulator by the host [s]
    unsigned repeats = 0;         ///< real time: flights discarded before because the host stalled
    std::vector<Vec> mission;
    std::vector<Threat> threats;
    std::vector<double> appeared;  ///< time at which each threat appeared; negative: never [s]
    std::vector<double> reported;  ///< time at which the first message of each threat left the autopilot's end, or the
                                   ///< first LiDAR scan with a return from it arrived; of a level scan: never;
                                   ///< negative: never [s]
    std::vector<double> course_reported;  ///< time at which the first message since the last turn of each threat left;
                                          ///< negative: never [s]
    SideCounts sides;                     ///< as flown, conflict by conflict
    SideCounts chosen_sides;              ///< as chosen; in process alone
    std::vector<Sample> samples;
    std::optional<Inside> inside;
};

/// Counts side changes of the commanded track. A change: the vehicle's position one second ahead under the command,
/// seen along the leg, lies beyond a dead band on the side opposite to the last side.
class FlipCounter {
public:
    explicit FlipCounter(const std::vector<Vec>& mission);
    void note(const Vec& position, const Vec& command);
    [[nodiscard]] int flips() const noexcept { return flips_; }

private:
    Vec start_;
    Vec forward_;
    Vec side_ = Vec::Zero();
    int flips_ = 0;
};

/// Unmet expectations; empty when all are met.
[[nodiscard]] std::vector<std::string> unmet(const Scenario& scenario, const Record& record);

}  // namespace jink::sim
