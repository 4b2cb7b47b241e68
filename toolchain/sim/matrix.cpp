// SPDX-License-Identifier: BSD-3-Clause
#include "toolchain/sim/matrix.hpp"

#include <algorithm>

#include "toolchain/sim/in_process.hpp"
#include "toolchain/sim/judge.hpp"

namespace jink::sim {
namespace {

constexpr int kCriticalSeverity = 2;  // MAV_SEVERITY_CRITICAL
/// The judge's manoeuvres continue for this long after the closest approach [s].
constexpr double kBeyond = 3.0;

/// Whether a judge's manoeuvre keeps the promise from the vehicle's state at `reported`.
bool is_avoidable(const Scenario& scenario, const Record& record, double reported)
{
    const auto sample =
        std::find_if(record.samples.begin(), record.samples.end(), [&](const Sample& s) { return s.time >= reported; });
    if (reported < 0.0 || sample == record.samples.end() || record.closest.time <= reported) {
        return false;
    }
    Truth truth;
    truth.position = sample->position;
    truth.velocity = sample->velocity;
    truth.acceleration = sample->acceleration;
    const double horizon = record.closest.time - reported + kBeyond;
    return judge_from(scenario, truth, sample->time, horizon, Trials::until_kept).avoidable;
}

/// The first message of the course on which the intruder came nearest: intruders turn once.
double course_reported_at(const Scenario& scenario, const Record& record)
{
    const std::vector<Turn>& turns = scenario.threats.front().turns;
    const bool turned = !turns.empty() && turns.front().at < record.closest.time;
    return turned ? record.course_reported.front() : record.reported.front();
}

bool is_worse_than_critical(const Text& text) { return text.severity <= kCriticalSeverity; }

void add_flight(const Scenario& scenario, const Record& record, Cell& cell)
{
    const bool hit = record.closest.surface < scenario.promise;
    const bool mission = is_mission(cell.behaviour);
    const bool avoidable = hit && mission && is_avoidable(scenario, record, record.reported.front());
    const bool finished = mission && record.goal_at >= 0.0 && record.final_mode == Mode::mission;
    const auto warned_at = static_cast<double>(record.heard.first_warning) * 1e-6;
    const bool warned = record.heard.first_warning >= 0 && warned_at < record.closest.time;
    const std::vector<Text>& texts = record.heard.texts;
    ++cell.flights;
    cell.hits += hit ? 1U : 0U;
    cell.avoidable += avoidable ? 1U : 0U;
    cell.foreseeable += avoidable && is_avoidable(scenario, record, course_reported_at(scenario, record)) ? 1U : 0U;
    cell.unwarned += hit && !warned ? 1U : 0U;
    cell.taken_over += record.takeovers > 0 ? 1U : 0U;
    cell.given_back += record.given_back ? 1U : 0U;
    cell.finished += finished ? 1U : 0U;
    cell.critical_texts += record.critical_texts;
    cell.own_critical += std::any_of(texts.begin(), texts.end(), is_worse_than_critical) ? 1U : 0U;
    cell.broken_rules += record.faults.empty() ? 0U : 1U;
    cell.least = std::min(cell.least, record.closest.surface + scenario.threats.front().radius);
    if (avoidable || !record.faults.empty() || (mission && !finished)) {
        cell.bad.push_back(scenario.seed);
    }
}

}  // namespace

std::string_view to_string(Behaviour behaviour) noexcept
{
    switch (behaviour) {
    case Behaviour::leg: return "leg";
    case Behaviour::first_leg: return "first_leg";
    case Behaviour::off_leg: return "off_leg";
    case Behaviour::fast: return "fast";
    case Behaviour::speed_change: return "speed_change";
    case Behaviour::turns: return "turns";
    case Behaviour::wait: return "wait";
    case Behaviour::take_off: return "take_off";
    case Behaviour::land_item: return "land_item";
    case Behaviour::home_item: return "home_item";
    case Behaviour::upload: return "upload";
    case Behaviour::jump: return "jump";
    case Behaviour::spline: return "spline";
    case Behaviour::hold: return "hold";
    case Behaviour::home: return "home";
    case Behaviour::land: return "land";
    case Behaviour::pilot: return "pilot";
    case Behaviour::guided: break;
    }
    return "guided";
}

std::string_view to_string(Meeting meeting) noexcept
{
    switch (meeting) {
    case Meeting::head_on: return "head_on";
    case Meeting::from_left: return "from_left";
    case Meeting::from_right: return "from_right";
    case Meeting::overtaking: return "overtaking";
    case Meeting::from_above: return "from_above";
    case Meeting::from_below: return "from_below";
    case Meeting::at_turn: break;
    }
    return "at_turn";
}

std::string_view to_string(Flyer flyer) noexcept
{
    switch (flyer) {
    case Flyer::arducopter: return "arducopter";
    case Flyer::arduplane: return "arduplane";
    case Flyer::px4: break;
    }
    return "px4";
}

Cell fly_cell(Flyer flyer, Behaviour behaviour, Meeting meeting, std::uint64_t from, std::size_t count,
              Conditions conditions)
{
    Cell cell;
    cell.flyer = flyer;
    cell.behaviour = behaviour;
    cell.meeting = meeting;
    for (std::size_t i = 0; i < count; ++i) {
        const Scenario scenario = matrix_scenario(flyer, behaviour, meeting, from + i, conditions);
        add_flight(scenario, fly_in_process(scenario), cell);
    }
    return cell;
}

}  // namespace jink::sim
