// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <map>

#include "toolchain/sim/child.hpp"

namespace jink::sim {

/// What this machine did to a program, not what the program did itself: the program's own account of its lateness would
/// excuse the program too.
class HoldUp {
public:
    struct Sample {
        double wall = 0.0;    ///< now [s]
        double stolen = 0.0;  ///< processor time that went to other machines, of all processors, since the start [s]
        Child::Threads threads;
    };

    /// The longest of: a thread of the program left without a processor, ready to run; time stolen from this machine's
    /// processors; no look at all. Since the look before, or still going on [s]; 0 at the first.
    double look(const Sample& now);
    /// Looks where the last look lies kLookEvery back; for loops that turn faster.
    void watch(const Child& child, double wall);
    /// The longest of all looks [s].
    [[nodiscard]] double longest() const noexcept { return longest_; }

    /// At present; `wall` [s]. What the system does not tell is 0.
    [[nodiscard]] static Sample sample(const Child& child, double wall);

    /// Between two looks [s].
    static constexpr double kLookEvery = 0.02;
    /// Beyond this the machine stood still, and a clock of an emulator leapt by it: nothing can be said of such a
    /// flight [s].
    static constexpr double kStall = 0.1;

private:
    Sample last_;
    std::map<pid_t, double> ready_since_;  ///< found ready and not to have run since the look before
    double longest_ = 0.0;
    bool first_ = true;
};

/// `run(attempt, held_up)` returns its failures and tells how long this machine held it up; one that fails where the
/// machine stood still says nothing and is run again, at most four times in all. The failures of the last.
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
