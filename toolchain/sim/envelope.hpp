// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <limits>
#include <set>

#include "toolchain/sim/phases.hpp"

namespace jink::sim {

/// Endings of flights of one scenario that differ in timing alone.
struct Envelope {
    unsigned flights = 0;
    std::set<Outcome> outcomes;
    std::set<bool> given_back;
    std::set<Mode> final_modes;
    std::set<unsigned> takeovers;
    double least = std::numeric_limits<double>::infinity();  ///< minimum of the least separations [m]
    double most = -std::numeric_limits<double>::infinity();

    void add(const Record& record);
};

/// Tolerance of a least separation beyond the envelope [m]: covers the edges that finitely many phases miss. A flight
/// in real time differs in more than timing: its autopilot and its co-processor start 0..20 ms apart.
[[nodiscard]] double envelope_slack(double separation) noexcept;

/// The quantities in which a flight lies outside, in words; empty: the flight lies within. Every flight lies outside an
/// empty envelope.
[[nodiscard]] std::vector<std::string> outside(const Envelope& envelope, const Record& record);

/// Timings that a flight in real time may have: ticks and line in any phase, delays up to the limit for discarding a
/// flight (daemon.hpp), sensors as in the file.
inline constexpr Spread kRealTime{false, 0.004, 100'000};
/// Number of timings in the envelope, of the seeds from 1 on. Rare endings occur once in hundreds of flights.
inline constexpr unsigned kEnvelopePhases = 400;

/// The quantities in which a flight lies outside the envelope of kEnvelopePhases flights in process. Stops early once
/// the flight lies within: an envelope only grows.
[[nodiscard]] std::vector<std::string> outside_phases(const Scenario& scenario, const Record& record);

}  // namespace jink::sim
