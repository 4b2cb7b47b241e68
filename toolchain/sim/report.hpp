// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <iosfwd>
#include <string>
#include <vector>

#include "toolchain/sim/judge.hpp"
#include "toolchain/sim/record.hpp"

namespace jink::sim {

/// Time from a traffic report leaving the autopilot until the resulting command takes effect there [s]: a tick of the
/// co-processor, the line twice and a tick of the autopilot.
inline constexpr double kReaction = 0.05;

/// A flight with its report data.
struct ReportedFlight {
    Scenario scenario;
    Record record;
    std::vector<std::string> unmet;  ///< unmet expectations of the scenario; empty: as expected
    double alone = 0.0;              ///< least separation of the same mission without a co-processor [m]
    bool judged = false;
    Verdict verdict;  ///< when judged
    /// The promise was broken, and one of the judge's manoeuvres would have kept it from the vehicle's state when the
    /// first sighting of the threat arrived (or when the first conflict became detectable, if later).
    bool failed_avoidable = false;
    bool reported_too_late = false;  ///< detected too late: the promise was broken, and worst, before the threat was
                                     ///< reported
    Verdict last_chance;             ///< verdict at that instant, if the promise was broken afterwards
    Verdict late_chance;  ///< verdict kReaction later: an avoidable break is then a fault of the choice alone
};

/// Adds the results that follow a flight: unmet expectations, the flight alone and, if `with_judge`, the verdict.
/// @param trials  of `verdict`; the last chances always count all manoeuvres that keep the promise
[[nodiscard]] ReportedFlight report_on(const Scenario& scenario, Record record, bool with_judge,
                                       Trials trials = Trials::to_the_end);

/// Table for people: name, outcome, least separation with time and threat, longest step with a plan.
void print_table(std::ostream& out, const std::vector<ReportedFlight>& flights);

/// Writes run.json, the input of `jink report`; tests/scenario/README.md describes its layout. An earlier file is
/// replaced as a whole. @throws std::runtime_error when the file cannot be written
void write_run(const std::filesystem::path& file, const std::vector<ReportedFlight>& flights);

/// The same as text, without times of steps when `machine_independent`: equal for equal seeds, byte by byte.
[[nodiscard]] std::string run_text(const std::vector<ReportedFlight>& flights, bool machine_independent);

}  // namespace jink::sim
