// SPDX-License-Identifier: BSD-3-Clause
#include "toolchain/sim/encounter.hpp"

#include <array>
#include <charconv>
#include <cmath>
#include <utility>
#include <vector>

#include "firmware/app/parameters.hpp"
#include "toolchain/sim/in_process.hpp"
#include "toolchain/sim/random_scenario.hpp"
#include "toolchain/sim/report.hpp"

namespace jink::sim {
namespace {

constexpr std::array kStacks{Stack::ardupilot, Stack::px4};
constexpr std::array kOutcomes{Outcome::clear,  Outcome::avoided,   Outcome::braked,
                               Outcome::breach, Outcome::collision, Outcome::failed};

/// The columns in their order, for both writer and reader.
template <class Result, class Visit>
void each_column(Result& r, Visit&& visit)
{
    visit("seed", r.seed);
    visit("intruders", r.intruders);
    visit("stack", r.stack);
    visit("outcome", r.outcome);
    visit("separation", r.separation);
    visit("at", r.at);
    visit("nearest", r.nearest);
    visit("told", r.reported);
    visit("alone", r.alone);
    visit("duration", r.duration);
    visit("goal_at", r.goal_at);
    visit("takeovers", r.takeovers);
    visit("conflicts", r.sides.conflicts);
    visit("flips_same", r.sides.same_picture);
    visit("flips_changed", r.sides.changed_picture);
    visit("flips_most_same", r.sides.most_same);
    visit("promises_of_side_broken", r.sides.broken);
    visit("choices", r.chosen_sides.conflicts);
    visit("chosen_same", r.chosen_sides.same_picture);
    visit("chosen_changed", r.chosen_sides.changed_picture);
    visit("chosen_most_same", r.chosen_sides.most_same);
    visit("choices_broken", r.chosen_sides.broken);
    visit("brakes", r.brakes);
    visit("escapes", r.escapes);
    visit("faults", r.faults);
    visit("conflict", r.conflict);
    visit("avoidable", r.avoidable);
    visit("reported_too_late", r.reported_too_late);
    visit("failed_avoidable", r.failed_avoidable);
    visit("last_keep", r.last_keep);
    visit("late_keep", r.late_keep);
    visit("noiseless", r.noiseless);
    visit("deviation_most", r.deviation_most);
    visit("deviation_rms", r.deviation_rms);
    visit("acceleration", r.acceleration);
    visit("jerk", r.jerk);
    visit("away", r.away);
    visit("first_answer", r.to_answer.first);
    visit("slowest_answer", r.to_answer.slowest);
    visit("answer_from_first_plan", r.to_answer.from_first_plan);
    visit("detour", r.detour);
}

std::string text_of(Stack stack) { return std::string(to_string(stack)); }
std::string text_of(Outcome outcome) { return std::string(to_string(outcome)); }
std::string text_of(bool value) { return value ? "1" : "0"; }
template <class Number>
std::string text_of(Number value)
{
    std::array<char, 32> buffer{};
    const auto end = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value).ptr;
    return {buffer.data(), end};
}

template <class Enum, std::size_t N>
bool read_word(std::string_view text, Enum& value, const std::array<Enum, N>& values)
{
    for (const Enum one : values) {
        if (to_string(one) == text) {
            value = one;
            return true;
        }
    }
    return false;
}

bool read(std::string_view text, Stack& value) { return read_word(text, value, kStacks); }
bool read(std::string_view text, Outcome& value) { return read_word(text, value, kOutcomes); }
bool read(std::string_view text, bool& value)
{
    value = text == "1";
    return value || text == "0";
}
template <class Number>
bool read(std::string_view text, Number& value)
{
    const auto [end, bad] = std::from_chars(text.data(), text.data() + text.size(), value);
    return bad == std::errc{} && end == text.data() + text.size();
}

/// The manoeuvre's costs: deviation from the leg, detour, and effort.
void measure(const Scenario& scenario, const std::vector<Sample>& samples, EncounterResult& result)
{
    const Vec& start = scenario.mission[0];
    const Vec& goal = scenario.mission[1];
    const Vec forward = (goal - start).normalized();
    double squares = 0.0;
    double flown = 0.0;
    for (std::size_t i = 0; i < samples.size(); ++i) {
        const Vec from_start = samples[i].position - start;
        const double off = (from_start - forward * from_start.dot(forward)).norm();
        result.deviation_most = std::max(result.deviation_most, off);
        squares += off * off;
        if (i == 0) {
            continue;
        }
        flown += (samples[i].position - samples[i - 1].position).norm();
        const double step = samples[i].time - samples[i - 1].time;
        const Vec change = samples[i].acceleration - samples[i - 1].acceleration;
        result.acceleration +=
            0.5 * step * (samples[i].acceleration.squaredNorm() + samples[i - 1].acceleration.squaredNorm());
        result.jerk += change.squaredNorm() / step;
        result.away += samples[i].mode == Mode::external ? step : 0.0;
    }
    if (!samples.empty()) {
        const double straight = (goal - samples.front().position).norm();
        result.detour = flown + (goal - samples.back().position).norm() - straight;
    }
    result.deviation_rms = samples.empty() ? 0.0 : std::sqrt(squares / static_cast<double>(samples.size()));
}

}  // namespace

std::string refusal_of(const Variant& variant)
{
    app::Parameters parameters;
    // A parameter that is refused now may be accepted once another is set: the autopilot repeats its requests.
    std::string refused;
    for (std::size_t round = 0; round <= variant.parameters.size(); ++round) {
        refused.clear();
        for (const auto& [name, value] : variant.parameters) {
            const app::ParamStatus status = parameters.set(name, static_cast<float>(value));
            if (status == app::ParamStatus::unknown_name) {
                return name + " is no parameter";
            }
            if (status != app::ParamStatus::ok && refused.empty()) {
                refused = name + " = " + text_of(value) + " is refused";
            }
        }
    }
    return refused;
}

Scenario encounter_scenario(std::uint64_t seed, const Variant& variant)
{
    Scenario scenario = encounter_of(variant.kind, seed);
    scenario.planner = variant.planner;
    scenario.board = variant.board;
    if (variant.as_recorded) {
        answer_as_recorded(scenario);
    }
    for (const auto& [name, value] : variant.parameters) {
        scenario.parameters[name] = value;
    }
    return scenario;
}

EncounterResult result_of(const Scenario& scenario, Record flown)
{
    const ReportedFlight flight = report_on(scenario, std::move(flown), true, Trials::until_kept);
    const Record& record = flight.record;
    EncounterResult r;
    r.seed = scenario.seed;
    r.intruders = static_cast<unsigned>(scenario.threats.size());
    r.stack = scenario.stack;
    r.outcome = record.outcome;
    r.separation = record.closest.surface;
    r.at = record.closest.time;
    r.nearest = static_cast<unsigned>(record.closest.threat);
    r.reported = record.reported[record.closest.threat];
    r.alone = flight.alone;
    r.duration = record.duration;
    r.goal_at = record.goal_at;
    r.takeovers = record.takeovers;
    r.sides = record.sides;
    r.chosen_sides = record.chosen_sides;
    r.brakes = record.inside ? record.inside->brakes : 0;
    r.escapes = record.inside ? record.inside->escapes : 0;
    r.to_answer = record.inside ? record.inside->to_answer : StepsToAnswer{};
    r.faults = static_cast<unsigned>(record.faults.size());
    r.conflict = flight.verdict.conflict;
    r.avoidable = flight.verdict.avoidable;
    r.reported_too_late = flight.reported_too_late;
    r.failed_avoidable = flight.failed_avoidable;
    r.last_keep = flight.last_chance.keep;
    r.late_keep = flight.late_chance.keep;
    measure(scenario, record.samples, r);
    return r;
}

EncounterResult fly_encounter(std::uint64_t seed, const Variant& variant)
{
    Scenario scenario = encounter_scenario(seed, variant);
    EncounterResult result = result_of(scenario, fly_in_process(scenario));
    if (result.failed_avoidable) {
        scenario.traffic.sigma_position = scenario.traffic.sigma_velocity = 0.0;
        if (scenario.lidar) {
            scenario.lidar->sigma = 0.0;
        }
        result.noiseless = fly_in_process(scenario).closest.surface;
    }
    return result;
}

std::string encounter_columns()
{
    std::string line;
    EncounterResult any;
    each_column(any, [&](std::string_view name, const auto&) { line.append(line.empty() ? "" : " ").append(name); });
    return line;
}

std::string to_line(const EncounterResult& result)
{
    std::string line;
    each_column(result, [&](std::string_view, const auto& value) {
        line.append(line.empty() ? "" : " ").append(text_of(value));
    });
    return line;
}

std::optional<EncounterResult> parse_line(std::string_view line)
{
    EncounterResult result;
    bool good = true;
    bool more = true;
    each_column(result, [&](std::string_view, auto& value) {
        const std::size_t end = line.find(' ');
        good = good && more && read(line.substr(0, end), value);
        more = end != std::string_view::npos;
        line.remove_prefix(more ? end + 1 : line.size());
    });
    return good && !more ? std::optional(result) : std::nullopt;
}

}  // namespace jink::sim
