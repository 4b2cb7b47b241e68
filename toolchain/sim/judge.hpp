// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "toolchain/sim/scenario.hpp"

namespace jink::sim {

/// Whether an encounter could have been avoided, found out by trying.
struct Verdict {
    bool conflict = false;   ///< the mission, flown on, breaks the promise towards a threat that was told of
    double detected = 0.0;   ///< first instant at which the truth says so; of `judge_from` the instant given [s]
    bool avoidable = false;  ///< some manoeuvre keeps the promise towards all threats, seen or not
    unsigned keep = 0;       ///< how many of those tried
    unsigned tried = 0;
    double best = 0.0;  ///< greatest least separation of all that were tried [m]
    Vec best_command = Vec::Zero();
};

/// How far the manoeuvres are flown. What keeps the promise, and how many do, is the same.
enum class Trials : std::uint8_t {
    to_the_end,    ///< all of them: `best` is known whatever it is
    until_broken,  ///< as far as each keeps the promise, a third of the work: `best` is of those that keep it
};

/// Judges a scenario with perfect knowledge and without core's code: flies the mission alone to the instant of
/// detection, then from there each of 240 directions at three speeds, and braking, as constant velocity commands
/// through the true vehicle model against the true motion of all threats for `horizon` seconds. O(commands * steps *
/// threats).
[[nodiscard]] Verdict judge(const Scenario& scenario, double horizon = 12.0, Trials trials = Trials::to_the_end);

/// The same manoeuvres from a given true state at a given time.
[[nodiscard]] Verdict judge_from(const Scenario& scenario, const Truth& start, double at, double horizon = 12.0,
                                 Trials trials = Trials::to_the_end);

}  // namespace jink::sim
