// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>

#include "toolchain/sim/record.hpp"
#include "toolchain/sim/scenario.hpp"

namespace jink::sim {

/// What is kept of one encounter of the campaign: one line of text (`to_line`), enough to count, to compare planners
/// and to tune weights by. All of it repeats bit by bit for the same seed and planner, on any number of machines with
/// the same build.
struct EncounterResult {
    std::uint64_t seed = 0;
    unsigned intruders = 0;
    Stack stack = Stack::ardupilot;
    Outcome outcome = Outcome::failed;
    double separation = 0.0;  ///< least, centre to surface [m]
    double at = 0.0;          ///< when [s]
    unsigned nearest = 0;     ///< index of the threat it was
    double told = -1.0;       ///< when the first message of that threat was sent; negative: never [s]
    double alone = 0.0;       ///< least separation of the same mission without a co-processor [m]
    double duration = 0.0;    ///< of the flight [s]
    unsigned takeovers = 0;
    SideCounts sides;         ///< as flown
    SideCounts chosen_sides;  ///< as chosen
    unsigned brakes = 0;      ///< the supervisor's fallbacks: brake,
    unsigned escapes = 0;     ///< and way of least harm
    unsigned faults = 0;      ///< rules of the protocol or of the airspace that were broken
    bool conflict = false;    ///< the mission, flown on, breaks the promise towards a threat that was told of
    unsigned keep = 0;        ///< manoeuvres of the judge that keep it from when that was so; 0: none, or no conflict
    bool told_too_late = false;     ///< the promise was broken before anybody could tell, and worst then (report.hpp)
    bool failed_avoidable = false;  ///< the promise was broken, and a manoeuvre of the judge would have kept it
    unsigned last_keep = 0;         ///< how many would, from the first sighting or the first conflict on,
    unsigned late_keep = 0;         ///< and kReaction later (report.hpp)
    double noiseless = 0.0;         ///< failed_avoidable: least separation of the same encounter when sensors tell the
                                    ///< truth [m]; 0 otherwise
    double deviation_most = 0.0;    ///< greatest distance from the line of the leg [m]
    double deviation_rms = 0.0;     ///< over the flight [m]
    double acceleration = 0.0;      ///< integral of the squared acceleration [m2/s3]
    double jerk = 0.0;              ///< integral of the squared jerk, from differences of 20 ms [m2/s5]
    double away = 0.0;              ///< time under the co-processor's control [s]
};

/// Who flies an encounter: the co-processor with one of the planners, set up like this.
struct Variant {
    PlannerKind planner = PlannerKind::product;
    /// Of the co-processor by name, beyond those that the encounter sets itself. The autopilot sends them in the order
    /// of their names, and again until they are taken.
    std::map<std::string, double> parameters;

    bool operator==(const Variant&) const = default;
};

/// What is wrong with a variant's parameters, in words: an unknown name, or a value that the co-processor refuses
/// however often it is asked. Empty when all of them are taken. O(n^2) for n parameters.
[[nodiscard]] std::string refusal_of(const Variant& variant);

/// Flies open_encounter(seed) in process and judges it (Trials::until_broken). One that was avoidable is flown once
/// more without the sensors' noise, with the same delays and losses: what keeps the promise then was lost to noise.
[[nodiscard]] EncounterResult fly_encounter(std::uint64_t seed, const Variant& variant);

/// open_encounter(seed) for one variant.
[[nodiscard]] Scenario encounter_scenario(std::uint64_t seed, const Variant& variant);

/// What is kept of a flight that was made already; it is judged here.
[[nodiscard]] EncounterResult result_of(const Scenario& scenario, Record record);

/// Names of a line's columns, separated by blanks.
[[nodiscard]] std::string encounter_columns();
/// Numbers in the shortest decimal form that reads back to the same bits.
[[nodiscard]] std::string to_line(const EncounterResult& result);
/// Nothing when the line is not one of to_line's.
[[nodiscard]] std::optional<EncounterResult> parse_line(std::string_view line);

}  // namespace jink::sim
