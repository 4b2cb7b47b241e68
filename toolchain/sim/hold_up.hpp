// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <map>

#include "toolchain/sim/child.hpp"

namespace jink::sim {

/// Delays that the host imposed on a program, measured from outside. The program's own report of its lateness would
/// also excuse the program's faults.
class HoldUp {
public:
    struct Sample {
        double wall = 0.0;    ///< now [s]
        double stolen = 0.0;  ///< processor time taken by other virtual machines, sum over all processors, since the
                              ///< start [s]
        Child::Threads threads;
    };

    /// Takes one sample. @return the longest delay since the previous sample, or still in progress [s]; 0 at the first
    /// sample. Counted are: a runnable thread of the program waiting for a processor, time stolen from the host's
    /// processors, and a missing sample.
    double look(const Sample& now);
    /// Takes a sample if the last sample is kCheckEvery old; for loops with a shorter period.
    void watch(const Child& child, double wall);
    /// The longest delay of all samples [s].
    [[nodiscard]] double longest() const noexcept { return longest_; }

    /// The present values; `wall` [s]. Values that the system does not report are 0.
    [[nodiscard]] static Sample sample(const Child& child, double wall);

    /// Interval between samples [s].
    static constexpr double kCheckEvery = 0.02;
    /// A longer delay is a stall of the host: an emulator's clock jumps, and the flight is inconclusive [s].
    static constexpr double kStall = 0.1;

private:
    Sample last_;
    std::map<pid_t, double> ready_since_;  ///< threads found runnable that did not run since the previous sample
    double longest_ = 0.0;
    bool first_ = true;
};

/// Calls `run(attempt, held_up)`, which returns its failures and sets the host's longest delay. A run that fails during
/// a stall is inconclusive and is repeated, four runs at most. Returns the failures of the last run.
template <class Run>
int run_unheld(Run run)
{
    constexpr int kAttempts = 4;
    int failures = 0;
    for (int attempt = 1; attempt <= kAttempts; ++attempt) {
        double held_up = 0.0;
        failures = run(attempt, held_up);
        if (failures == 0 || held_up <= HoldUp::kStall) {
            break;
        }
    }
    return failures;
}

}  // namespace jink::sim
