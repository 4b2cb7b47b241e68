// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <limits>
#include <set>

#include "toolchain/sim/phases.hpp"

namespace jink::sim {

/// How flights of one scenario end that differ in their timing alone.
struct Envelope {
    unsigned flights = 0;
    std::set<Outcome> outcomes;
    std::set<bool> given_back;
    std::set<Mode> final_modes;
    std::set<unsigned> takeovers;
    double least = std::numeric_limits<double>::infinity();  ///< of the least separations [m]
    double most = -std::numeric_limits<double>::infinity();

    void add(const Record& record);
};

/// So far beyond the envelope may a least separation lie [m]: what finitely many phases leave out at the edges. A
/// flight in real time differs in some more than its timing: its autopilot and its co-processor start 0..20 ms apart.
[[nodiscard]] double envelope_slack(double separation) noexcept;

/// In what a flight lies outside, in words; empty where it lies within. Nothing lies within an envelope of no flights.
[[nodiscard]] std::vector<std::string> outside(const Envelope& envelope, const Record& record);

/// Timings that a flight in real time may have: ticks and line in any phase, held up by no more than a flight is
/// allowed to be before it is thrown away (daemon.hpp), sensors as in the file.
inline constexpr Spread kRealTime{false, 0.004, 100'000};
/// So many of them make the envelope, of the seeds from 1 on. Rare ends come once in hundreds of flights.
inline constexpr unsigned kEnvelopePhases = 400;

/// In what a flight lies outside the envelope of kEnvelopePhases flights in process. No more of them are flown than it
/// takes to see that it lies within: an envelope only grows.
[[nodiscard]] std::vector<std::string> outside_phases(const Scenario& scenario, const Record& record);

}  // namespace jink::sim
