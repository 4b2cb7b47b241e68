// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>

#include "toolchain/sim/encounter_kind.hpp"
#include "toolchain/sim/record.hpp"
#include "toolchain/sim/scenario.hpp"

namespace jink::sim {

/// Result of one encounter of the campaign: one line of text (`to_line`), sufficient to count, to compare planners and
/// to tune weights. Bit-identical for the same seed, planner and build, on any number of machines.
struct EncounterResult {
    std::uint64_t seed = 0;
    unsigned intruders = 0;
    Stack stack = Stack::ardupilot;
    Outcome outcome = Outcome::failed;
    double separation = 0.0;  ///< least, centre to surface [m]
    double at = 0.0;          ///< time of `separation` [s]
    unsigned nearest = 0;     ///< index of the threat at `separation`
    double reported = -1.0;   ///< time of the first message or LiDAR scan that reports that threat; negative:
                              ///< never [s]
    double alone = 0.0;       ///< least separation of the same mission without a co-processor [m]
    double duration = 0.0;    ///< of the flight [s]
    double goal_at = -1.0;    ///< when the goal was reached; negative: never [s]
    unsigned takeovers = 0;
    SideCounts sides;                ///< as flown
    SideCounts chosen_sides;         ///< as chosen
    unsigned brakes = 0;             ///< supervisor fallbacks: brake
    unsigned escapes = 0;            ///< supervisor fallbacks: max-clearance escape
    unsigned faults = 0;             ///< broken rules of the protocol or of the airspace
    bool conflict = false;           ///< the mission, if continued, breaks the promise towards a reported threat
    bool avoidable = false;          ///< a judge's manoeuvre keeps the promise from the detection of `conflict` on
    bool reported_too_late = false;  ///< the promise was broken, and worst, before the threat was detected (report.hpp)
    bool failed_avoidable = false;   ///< the promise was broken, and a judge's manoeuvre would have kept it
    unsigned last_keep = 0;          ///< number that keep it from the first sighting or the first conflict on
    unsigned late_keep = 0;          ///< number that keep it kReaction later (report.hpp)
    double noiseless = 0.0;          ///< failed_avoidable: least separation of the same encounter with exact sensors
                                     ///< [m]; 0 otherwise
    double deviation_most = 0.0;     ///< greatest distance from the line of the leg [m]
    double deviation_rms = 0.0;      ///< over the flight [m]
    double acceleration = 0.0;       ///< integral of the squared acceleration [m2/s3]
    double jerk = 0.0;               ///< integral of the squared jerk, from differences of 20 ms [m2/s5]
    double away = 0.0;               ///< time under the co-processor's control [s]
    StepsToAnswer to_answer;
    /// Flown, and straight on to the goal from where the flight ended, less the straight line from start to goal [m].
    double detour = 0.0;
};

/// What is flown, and the configuration of the co-processor that flies it.
struct Variant {
    PlannerKind planner = PlannerKind::product;
    /// Co-processor parameters by name, in addition to the encounter's own. The autopilot sends them in the order of
    /// their names, and repeats each until it is accepted.
    std::map<std::string, double> parameters;
    Board board{};
    EncounterKind kind = EncounterKind::open;
    bool as_recorded = false;  ///< vehicles answer as their autopilots in the recordings: answer_as_recorded()

    bool operator==(const Variant&) const = default;
};

/// Error in a variant's parameters, in words: an unknown name, or a value that the co-processor refuses permanently.
/// Empty when all are accepted. O(n^2) for n parameters.
[[nodiscard]] std::string refusal_of(const Variant& variant);

/// Flies encounter_scenario(seed, variant) in process and judges it (Trials::until_kept). An avoidable failure is flown
/// again without sensor noise, with the same delays and losses. If the promise is then kept, noise caused the failure.
[[nodiscard]] EncounterResult fly_encounter(std::uint64_t seed, const Variant& variant);

/// The encounter of the variant's kind, encounter_of(), with its planner, board and parameters.
[[nodiscard]] Scenario encounter_scenario(std::uint64_t seed, const Variant& variant);

/// Result of a finished flight; judges the flight.
[[nodiscard]] EncounterResult result_of(const Scenario& scenario, Record record);

/// Column names of a line, separated by blanks.
[[nodiscard]] std::string encounter_columns();
/// One line; numbers in the shortest decimal form that reads back to the same bits.
[[nodiscard]] std::string to_line(const EncounterResult& result);
/// Inverse of to_line; nothing for any other text.
[[nodiscard]] std::optional<EncounterResult> parse_line(std::string_view line);

}  // namespace jink::sim
