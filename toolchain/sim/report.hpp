// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <iosfwd>
#include <string>
#include <vector>

#include "toolchain/sim/judge.hpp"
#include "toolchain/sim/record.hpp"

namespace jink::sim {

/// What passes from a sighting's leaving the autopilot until the command that it leads to takes effect there: a tick of
/// the co-processor, the line twice and a tick of the autopilot [s].
inline constexpr double kReaction = 0.05;

/// A flight with what belongs to it in a report.
struct ReportedFlight {
    Scenario scenario;
    Record record;
    std::vector<std::string> unmet;  ///< of the scenario's expectations; empty: as expected
    double alone = 0.0;              ///< least separation of the same mission without a co-processor [m]
    bool judged = false;
    Verdict verdict;  ///< when judged
    /// The promise was broken, and from where the vehicle was when the first sighting of the threat arrived (or the
    /// first conflict came into sight, if that was later) one of the judge's manoeuvres would have kept it.
    bool failed_avoidable = false;
    bool told_too_late = false;  ///< the promise was broken before anybody was told of the threat, and worst then
    Verdict last_chance;         ///< of that instant, where the promise was broken afterwards,
    Verdict late_chance;         ///< and kReaction later: what is avoidable there was missed by the choice alone
};

/// Adds what can be found out after a flight: the expectation, the flight alone and, when `with_judge`, the verdict.
[[nodiscard]] ReportedFlight report_on(const Scenario& scenario, Record record, bool with_judge,
                                       Trials trials = Trials::to_the_end);

/// Table for people: name, outcome, least separation with time and threat, longest step with a plan.
void print_table(std::ostream& out, const std::vector<ReportedFlight>& flights);

/// Writes run.json, the input of `jink report`; its layout stands in tests/scenario/README.md. False when the file
/// cannot be written.
[[nodiscard]] bool write_run(const std::filesystem::path& file, const std::vector<ReportedFlight>& flights);

/// The same as text, without times of steps when `machine_independent`: equal for equal seeds, byte by byte.
[[nodiscard]] std::string run_text(const std::vector<ReportedFlight>& flights, bool machine_independent);

}  // namespace jink::sim
