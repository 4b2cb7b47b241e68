// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "toolchain/sim/scenario.hpp"

namespace jink::sim {

/// Whether an encounter was avoidable, determined by trial.
struct Verdict {
    bool conflict = false;   ///< the mission, if continued, breaks the promise towards a reported threat
    double detected = 0.0;   ///< first instant at which the true motion leads to `conflict`; the given instant for
                             ///< `judge_from` [s]
    bool avoidable = false;  ///< at least one manoeuvre keeps the promise towards all threats, detected or not
    unsigned keep = 0;       ///< number of tried manoeuvres that do
    unsigned tried = 0;
    double best = 0.0;  ///< greatest least separation of the tried manoeuvres [m]
    Vec best_command = Vec::Zero();
};

/// How far the manoeuvres are flown. `avoidable` is the same for all.
enum class Trials : std::uint8_t {
    to_the_end,    ///< all to the horizon: `best` is always exact
    until_broken,  ///< each until it breaks the promise, a third of the work: `best` covers only manoeuvres that keep
                   ///< the promise
    until_kept,    ///< the same, and none after the first that keeps the promise: `keep` is 0 or 1
};

/// Judges a scenario with perfect knowledge and without core's code. Flies the mission alone to the instant of
/// detection. From there flies 240 directions at three speeds, and braking, as constant velocity commands through the
/// true vehicle model against the true motion of all threats for `horizon` seconds. O(commands * steps * threats).
[[nodiscard]] Verdict judge(const Scenario& scenario, double horizon = 12.0, Trials trials = Trials::to_the_end);

/// The same manoeuvres from a given true state at a given time.
[[nodiscard]] Verdict judge_from(const Scenario& scenario, const Truth& start, double at, double horizon = 12.0,
                                 Trials trials = Trials::to_the_end);

}  // namespace jink::sim
