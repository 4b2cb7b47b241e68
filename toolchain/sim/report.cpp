// SPDX-License-Identifier: BSD-3-Clause
#include "toolchain/sim/report.hpp"

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <ostream>
#include <stdexcept>

#include <nlohmann/json.hpp>

#include "firmware/linux/param_store.hpp"
#include "toolchain/sim/decision_at.hpp"
#include "toolchain/sim/in_process.hpp"

namespace jink::sim {
namespace {

using Json = nlohmann::ordered_json;

/// Every fifth sample: 10 Hz.
constexpr std::size_t kStride = 5;
/// Separations beyond this are not reported [m].
constexpr double kNobody = 1e8;
/// Duration of the judge's manoeuvres [s].
constexpr double kJudged = 12.0;

/// Millimetres, so that files stay small and readable.
double rounded(double value) { return std::round(value * 1e3) / 1e3 + 0.0; }

Json json(const Vec& v) { return Json::array({rounded(v.x()), rounded(v.y()), rounded(v.z())}); }

Json json_or_null(double value) { return value < kNobody ? Json(rounded(value)) : Json(nullptr); }

Json series(const Record& record)
{
    Json t = Json::array();
    Json position = Json::array();
    Json velocity = Json::array();
    Json setpoint = Json::array();
    Json mode = Json::array();
    Json separation = Json::array();
    Json nearest = Json::array();
    Json state = Json::array();
    for (std::size_t i = 0; i < record.samples.size(); i += kStride) {
        const Sample& s = record.samples[i];
        t.push_back(rounded(s.time));
        position.push_back(json(s.position));
        velocity.push_back(json(s.velocity));
        setpoint.push_back(s.mode == Mode::external ? json(s.setpoint) : Json(nullptr));
        mode.push_back(to_string(s.mode));
        separation.push_back(json_or_null(s.separation));
        nearest.push_back(s.nearest);
        state.push_back(s.jink_state);
    }
    return {{"t", t},       {"position", position},     {"velocity", velocity}, {"setpoint", setpoint},
            {"mode", mode}, {"separation", separation}, {"nearest", nearest},   {"jink_state", state}};
}

Json threats(const Record& record)
{
    Json all = Json::array();
    for (std::size_t k = 0; k < record.threats.size(); ++k) {
        const Threat& threat = record.threats[k];
        Json positions = Json::array();
        const std::size_t count =
            threat.at_rest() ? std::min<std::size_t>(1, record.samples.size()) : record.samples.size();
        for (std::size_t i = 0; i < count; i += kStride) {
            positions.push_back(json(threat.position_at(record.samples[i].time)));
        }
        all.push_back({{"name", threat.name},
                       {"form", to_string(threat.form)},
                       {"half_extents", json(threat.half_extents)},
                       {"radius", threat.radius},
                       {"half_height", threat.half_height},
                       {"sensed_by", to_string(threat.sensed_by)},
                       {"moves", !threat.at_rest()},
                       {"appeared", record.appeared[k] < 0.0 ? Json(nullptr) : Json(rounded(record.appeared[k]))},
                       {"positions", positions}});
    }
    return all;
}

Json link_of(const Record& record)
{
    const Heard& h = record.heard;
    Json texts = Json::array();
    for (const Text& text : h.texts) {
        texts.push_back({{"t", rounded(text.time)}, {"severity", text.severity}, {"text", text.text}});
    }
    return {{"frames", h.frames},
            {"frames_refused", h.frames_refused},
            {"heartbeats", h.heartbeats},
            {"longest_heartbeat_gap", rounded(to_seconds(h.longest_heartbeat_gap))},
            {"setpoints", h.setpoints},
            {"bad_setpoints", h.bad_setpoints},
            {"setpoints_overruled", h.setpoints_overruled},
            {"longest_setpoint_gap", rounded(to_seconds(h.longest_setpoint_gap))},
            {"warnings", h.warnings},
            {"external_requests", h.external_requests},
            {"refused_requests", h.refused_requests},
            {"texts", texts}};
}

Json json(const Durations& d)
{
    return {{"count", d.count}, {"mean_us", rounded(d.mean)}, {"worst_us", rounded(d.worst)}};
}

Json inside_of(const Inside& in, bool machine_independent)
{
    Json j;
    if (!machine_independent) {
        j["steps"] = json(in.steps);
        j["plan_steps"] = json(in.plan_steps);
        for (const double us : in.plan_steps.times) {
            j["plan_steps"]["times_us"].push_back(std::round(us));
        }
    }
    j["conflicts"] = in.conflicts;
    j["plans"] = in.plans;
    j["plans_found"] = in.plans_found;
    j["answers_rejected"] = in.answers_rejected;
    j["manoeuvres"] = in.manoeuvres;
    j["replans"] = in.replans;
    j["flips"] = in.flips;
    j["brakes"] = in.brakes;
    j["escapes"] = in.escapes;
    j["holds"] = in.holds;
    j["rejoined"] = in.rejoined;
    j["control_lost"] = in.control_lost;
    j["budget_spent"] = in.budget_spent;
    j["most_work"] = in.most_work;
    j["deadlines_missed"] = in.deadlines_missed;
    j["setpoints_withheld"] = in.setpoints_withheld;
    j["own_state_refused"] = in.own_state_refused;
    j["autopilot_reboots"] = in.autopilot_reboots;
    j["clock_relocks"] = in.clock_relocks;
    j["tracks_refused"] = in.tracks_refused;
    j["track_jumps"] = in.track_jumps;
    j["frames_refused"] = in.frames_refused;
    j["not_finite"] = in.not_finite;
    j["stale_stamp"] = in.stale_stamp;
    j["inbox_full"] = in.inbox_full;
    j["outbox_full"] = in.outbox_full;
    j["first_candidate"] = in.first_candidate;
    return j;
}

Json json(const geometric::Candidate& candidate)
{
    return {{"family", to_string(candidate.shape.family)},
            {"plane", rounded(static_cast<double>(candidate.shape.plane))},
            {"offset", rounded(static_cast<double>(candidate.shape.offset))},
            {"status", status_name(candidate.status)},
            {"cost", rounded(static_cast<double>(candidate.total))}};
}

Json decisions_of(const Inside& in)
{
    Json decisions = Json::array();
    for (const DecisionAt& decision : in.decisions) {
        Json candidates = Json::array();
        for (const geometric::Candidate& candidate : decision.candidates) {
            candidates.push_back(json(candidate));
        }
        decisions.push_back(
            {{"t", rounded(decision.time)},
             {"text", decision.text},
             {"start", json(decision.start)},
             {"own_at_closest", decision.own_at_closest ? json(*decision.own_at_closest) : Json(nullptr)},
             {"candidates", candidates}});
    }
    return decisions;
}

/// The most of a step since the sample before; null: no step.
Json work_of(const Record& record)
{
    Json column = Json::array();
    auto step = record.inside->work.begin();
    for (std::size_t i = 0; i < record.samples.size(); i += kStride) {
        constexpr double kRounding = 1e-9;
        Json most = nullptr;
        for (; step != record.inside->work.end() && step->time <= record.samples[i].time + kRounding; ++step) {
            most = most.is_null() ? step->work : std::max(most.get<std::uint32_t>(), step->work);
        }
        column.push_back(most);
    }
    return column;
}

Json json(const ReportedFlight& flight, bool machine_independent)
{
    const Record& r = flight.record;
    Json expected = Json::array();
    for (const Outcome outcome : flight.scenario.expect.outcomes) {
        expected.push_back(to_string(outcome));
    }
    Json mission = Json::array();
    for (const Vec& waypoint : r.mission) {
        mission.push_back(json(waypoint));
    }
    Json j{{"name", r.name},
           {"title", r.title},
           {"transport", r.transport},
           {"stack", to_string(r.stack)},
           {"seed", r.seed},
           {"outcome", to_string(r.outcome)},
           {"expected", expected},
           {"as_expected", flight.unmet.empty()},
           {"unmet", flight.unmet},
           {"faults", r.faults},
           {"promise", r.promise},
           {"duration", rounded(r.duration)},
           {"least",
            {{"surface", json_or_null(r.closest.surface)},
             {"box", json_or_null(r.closest.box)},
             {"alone", json_or_null(flight.alone)},
             {"t", rounded(r.closest.time)},
             {"threat", r.closest_threat},
             {"own", json(r.closest.own)},
             {"centre", json(r.closest.threat_centre)}}},
           {"takeovers", r.takeovers},
           {"flips", r.flips},
           {"longest_hold", rounded(r.longest_hold)},
           {"given_back", r.given_back},
           {"final_mode", to_string(r.final_mode)},
           {"cross_track", rounded(r.cross_track)},
           {"goal_at", r.goal_at < 0.0 ? Json(nullptr) : Json(rounded(r.goal_at))},
           {"lowest", rounded(r.lowest)}};
    if (!machine_independent) {
        j["late_steps"] = r.late_steps;
        j["latest_step"] = rounded(r.latest_step);
        j["held_up"] = rounded(r.held_up);
        j["repeats"] = r.repeats;
    }
    j["link"] = link_of(r);
    if (flight.judged) {
        j["judge"] = {{"conflict", flight.verdict.conflict},
                      {"detected", rounded(flight.verdict.detected)},
                      {"avoidable", flight.verdict.avoidable},
                      {"keep", flight.verdict.keep},
                      {"tried", flight.verdict.tried},
                      {"best", json_or_null(flight.verdict.best)},
                      {"best_command", json(flight.verdict.best_command)}};
    }
    j["mission"] = mission;
    j["threats"] = threats(r);
    j["series"] = series(r);
    if (r.inside) {
        j["inside"] = inside_of(*r.inside, machine_independent);
        j["decisions"] = decisions_of(*r.inside);
        if (!r.inside->work.empty()) {
            j["series"]["work"] = work_of(r);
        }
    }
    return j;
}

}  // namespace

ReportedFlight report_on(const Scenario& scenario, Record record, bool with_judge, Trials trials)
{
    ReportedFlight flight;
    flight.scenario = scenario;
    flight.record = std::move(record);
    flight.unmet = unmet(scenario, flight.record);
    flight.alone = fly_alone(scenario).closest.surface;
    flight.judged = with_judge;
    if (!with_judge) {
        return flight;
    }
    flight.verdict = judge(scenario, kJudged, trials);
    const Record& r = flight.record;
    if (r.closest.surface < scenario.promise) {
        const double reported =
            r.reported[r.closest.threat];  // jitter and dropouts included: the threat is unknown before
        flight.reported_too_late = reported < 0.0 || r.closest.time <= reported;
        if (flight.reported_too_late) {
            return flight;
        }
        const double in_sight = std::max(reported, flight.verdict.conflict ? flight.verdict.detected : 0.0);
        const auto judge_at = [&](double time) {
            const Sample& then =
                *std::find_if(r.samples.begin(), r.samples.end() - 1, [&](const Sample& s) { return s.time >= time; });
            return judge_from(
                scenario,
                {then.position, then.velocity, then.acceleration, 0.0, held_at(then.velocity, scenario.vehicle)},
                then.time, kJudged, trials == Trials::until_kept ? Trials::until_broken : trials);
        };
        flight.last_chance = judge_at(in_sight);
        flight.late_chance = judge_at(in_sight + kReaction);
        flight.failed_avoidable = flight.last_chance.avoidable;
    }
    return flight;
}

void print_table(std::ostream& out, const std::vector<ReportedFlight>& flights)
{
    out << std::left << std::setw(24) << "flight" << std::setw(12) << "transport" << std::setw(10) << "outcome"
        << std::right << std::setw(9) << "least m" << std::setw(9) << "alone m" << std::setw(8) << "at s"
        << "  " << std::left << std::setw(16) << "nearest threat" << std::right << std::setw(9) << "plan us"
        << "  verdict\n";
    for (const ReportedFlight& f : flights) {
        const Record& r = f.record;
        const bool anybody = r.closest.surface < kNobody;
        out << std::left << std::setw(24) << r.name << std::setw(12) << r.transport << std::setw(10)
            << to_string(r.outcome) << std::right << std::fixed << std::setprecision(2);
        if (anybody) {
            out << std::setw(9) << r.closest.surface << std::setw(9) << f.alone << std::setw(8) << r.closest.time;
        } else {
            out << std::setw(9) << "-" << std::setw(9) << "-" << std::setw(8) << "-";
        }
        out << "  " << std::left << std::setw(16) << r.closest_threat.substr(0, 15) << std::right << std::setw(9)
            << std::setprecision(0) << (r.inside ? r.inside->plan_steps.worst : 0.0) << "  ";
        if (f.unmet.empty()) {
            out << "as expected";
        }
        for (std::size_t i = 0; i < f.unmet.size(); ++i) {
            out << (i > 0 ? "; " : "") << f.unmet[i];
        }
        for (const std::string& fault : r.faults) {
            out << " [" << fault << "]";
        }
        out << "\n";
    }
}

std::string run_text(const std::vector<ReportedFlight>& flights, bool machine_independent)
{
    Json all = Json::array();
    for (const ReportedFlight& flight : flights) {
        all.push_back(json(flight, machine_independent));
    }
    const Json run{{"format", "jink-sim run"},
                   {"version", 2},
                   {"units", "metres, seconds, metres per second; x east, y north, z up from home"},
                   {"world_step", to_seconds(kStep)},
                   {"flights", all}};
    // Names may come from file names, which need not be UTF-8.
    return run.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

void write_run(const std::filesystem::path& file, const std::vector<ReportedFlight>& flights)
{
    if (const std::string wrong = files::replace_file(file.string(), run_text(flights, false) + "\n"); !wrong.empty()) {
        throw std::runtime_error(file.string() + ": " + wrong);
    }
}

}  // namespace jink::sim
