// SPDX-License-Identifier: BSD-3-Clause
#include "toolchain/host/plan_output.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdarg>
#include <cstdio>

namespace jink::host {
namespace {

using geometric::Candidate;
using geometric::CandidateStatus;
using nlohmann::ordered_json;

#if defined(__GNUC__)
__attribute__((format(printf, 1, 2)))
#endif
std::string
format(const char* pattern, ...)
{
    std::array<char, 512> buffer{};
    va_list arguments;
    va_start(arguments, pattern);
    const int n = std::vsnprintf(buffer.data(), buffer.size(), pattern, arguments);
    va_end(arguments);
    return {buffer.data(), static_cast<std::size_t>(std::clamp(n, 0, static_cast<int>(buffer.size()) - 1))};
}

double degrees(float radians) { return static_cast<double>(radians) * 180.0 / static_cast<double>(kPi); }
double as_double(float value) { return static_cast<double>(value); }

bool has_cost(const Candidate& c)
{
    return c.status == CandidateStatus::available || c.status == CandidateStatus::chosen;
}

std::string_view words_of(CandidateStatus status)
{
    switch (status) {
    case CandidateStatus::available: return "available";
    case CandidateStatus::chosen: return "CHOSEN";
    case CandidateStatus::hits_static: return "hits";
    case CandidateStatus::hits_moving: return "hits";
    case CandidateStatus::hits_airspace: return "leaves";
    case CandidateStatus::not_flyable: return "not flyable";
    case CandidateStatus::not_evaluated: return "not evaluated";
    }
    return "?";
}

const std::string& main_name(const ProblemFile& file)
{
    return file.main_is_moving_solid ? file.moving_solids[file.main].name
           : file.main_is_obstacle   ? file.obstacles[file.main].name
                                     : file.threats[file.main].name;
}

std::string verdict(const ProblemFile& file, const PlanOutcome& outcome)
{
    using world::PlanStatus;
    switch (outcome.status) {
    case PlanStatus::found: {
        const Candidate& c = outcome.result.candidates[outcome.result.chosen];
        float fastest = 0.0F;
        for (const path::PathPoint& point : outcome.result.path.points) {
            fastest = std::max(fastest, point.velocity.norm());
        }
        return format("Fly candidate %zu: %s, plane %.1f deg, offset %+.2f m, %.2f s at up to %.2f m/s, cost %.4f.",
                      outcome.result.chosen, std::string(to_string(c.shape.family)).c_str(), degrees(c.shape.plane),
                      as_double(c.shape.offset), as_double(c.duration), as_double(fastest), as_double(c.total));
    }
    case PlanStatus::too_close:
        return format("Stop: the main threat is %.2f m away, nearer than 2.5 of its radii (%.2f m).",
                      as_double(file.distance), as_double(geometric::kMinDistanceInRadii * file.main_radius));
    case PlanStatus::none_available: return "Stop: no candidate is available.";
    case PlanStatus::budget_spent: return "Stop: the work budget ran out before an answer.";
    case PlanStatus::no_conflict: return "Nothing to avoid.";
    case PlanStatus::running:  // never at the end of a plan
    case PlanStatus::bad_input: break;
    }
    return "The planner refuses the problem.";
}

/// A float as the shortest decimal that reads back to the same value; null where infinite.
ordered_json json_of(float value)
{
    return std::isfinite(value) ? ordered_json(std::stod(files::to_text(value))) : ordered_json(nullptr);
}

ordered_json json_of(const Vec3& v) { return ordered_json::array({json_of(v.x()), json_of(v.y()), json_of(v.z())}); }

ordered_json json_of(const ProblemFile& file, const world::ThreatRef& hit)
{
    if (hit.kind == world::ThreatKind::none) {
        return nullptr;
    }
    constexpr std::array kKinds{"none", "threat", "obstacle", "floor", "ceiling", "keep_in", "cylinder"};
    return {{"kind", kKinds[static_cast<std::size_t>(hit.kind)]}, {"index", hit.index}, {"name", hit_name(file, hit)}};
}

ordered_json json_of(const ProblemFile& file, const Candidate& c)
{
    ordered_json out{{"kind", to_string(c.shape.family)},
                     {"plane_deg", json_of(static_cast<float>(degrees(c.shape.plane)))},
                     {"offset", json_of(c.shape.offset)},
                     {"elevation_deg", json_of(static_cast<float>(degrees(std::asin(c.sin_alpha))))},
                     {"status", name_of(c.status)},
                     {"hits", json_of(file, c.hit)},
                     {"duration", json_of(c.duration)}};
    if (has_cost(c)) {
        out["terms"] = {{"time", json_of(c.terms.time)},
                        {"smoothness", json_of(c.terms.smoothness)},
                        {"smoothness_penalised", json_of(c.terms.smoothness_penalised)},
                        {"closeness", json_of(c.terms.closeness)},
                        {"energy", json_of(c.terms.energy)},
                        {"hover_power", json_of(c.terms.hover_power)},
                        {"passing", json_of(c.terms.passing)},
                        {"beyond", json_of(c.terms.beyond)}};
        const cost::NormalisedTerms normalised = cost::normalise(c.terms, file.settings.caps);
        out["normalised"] = {{"time", json_of(normalised.time)},
                             {"smoothness", json_of(normalised.smoothness)},
                             {"smoothness_penalised", json_of(normalised.smoothness_penalised)},
                             {"closeness", json_of(normalised.closeness)},
                             {"energy", json_of(normalised.energy)},
                             {"passing", json_of(normalised.passing)},
                             {"beyond", json_of(normalised.beyond)}};
        out["total"] = json_of(c.total);
        out["flip_penalty"] = json_of(c.flip_penalty);
    }
    return out;
}

ordered_json json_of(const path::TimedPath& path)
{
    ordered_json out = ordered_json::array();
    for (const path::PathPoint& point : path.points) {
        out.push_back({{"time", json_of(point.time)},
                       {"position", json_of(point.position)},
                       {"velocity", json_of(point.velocity)}});
    }
    return out;
}

}  // namespace

std::string_view name_of(world::PlanStatus status)
{
    using world::PlanStatus;
    switch (status) {
    case PlanStatus::found: return "found";
    case PlanStatus::no_conflict: return "no_conflict";
    case PlanStatus::too_close: return "too_close";
    case PlanStatus::none_available: return "none_available";
    case PlanStatus::budget_spent: return "budget_spent";
    case PlanStatus::bad_input: return "bad_input";
    case PlanStatus::running: return "running";
    }
    return "?";
}

std::string_view name_of(CandidateStatus status)
{
    switch (status) {
    case CandidateStatus::available: return "available";
    case CandidateStatus::chosen: return "chosen";
    case CandidateStatus::hits_static: return "hits_static";
    case CandidateStatus::hits_moving: return "hits_moving";
    case CandidateStatus::hits_airspace: return "hits_airspace";
    case CandidateStatus::not_flyable: return "not_flyable";
    case CandidateStatus::not_evaluated: return "not_evaluated";
    }
    return "?";
}

std::string hit_name(const ProblemFile& file, const world::ThreatRef& hit)
{
    switch (hit.kind) {
    case world::ThreatKind::track: return hit.index < file.threats.size() ? file.threats[hit.index].name : "?";
    case world::ThreatKind::obstacle: {
        const std::size_t at_rest = file.obstacles.size();
        const std::size_t moving = hit.index - at_rest;  // counted after the static obstacles
        return hit.index < at_rest                  ? file.obstacles[hit.index].name
               : moving < file.moving_solids.size() ? file.moving_solids[moving].name
                                                    : "?";
    }
    case world::ThreatKind::floor: return "floor";
    case world::ThreatKind::ceiling: return "ceiling";
    case world::ThreatKind::keep_in: return "keep-in distance";
    case world::ThreatKind::cylinder: return "closed area";
    case world::ThreatKind::none: break;
    }
    return {};
}

std::string plan_table(const ProblemFile& file, const PlanOutcome& outcome)
{
    const geometric::Settings& s = file.settings;
    std::string out = file.title + "\n";
    out += format(
        "vehicle %s at %.2f m/s; main threat %s, D %.2f m, R %.2f m; %s security, offsets by the %s rule, l %d, n %d\n",
        file.vehicle.name.c_str(), as_double(file.speed), main_name(file).c_str(), as_double(file.distance),
        as_double(file.main_radius), s.security == geometric::SecurityMode::swept ? "swept" : "time-aware",
        s.offset_rule == geometric::OffsetRule::source ? "source's" : "clearing", int{s.offsets}, int{s.extra_planes});
    out += "terms: T time [s], S smoothness, S_rp the same with rotation penalty, M closeness [1/m], E energy [J], P "
           "mean rotor power [W]; "
           "then T, S_rp, M, E on 0 to 1, and the total cost\n\n";
    if (!outcome.result.candidates.empty()) {
        out += "  #  kind       plane  offset  status                     T       S    S_rp       M        E         P "
               "|     T  S_rp     M     E |  cost\n";
    }
    for (std::size_t i = 0; i < outcome.result.candidates.size(); ++i) {
        const Candidate& c = outcome.result.candidates[i];
        std::string status(words_of(c.status));
        if (c.hit.kind != world::ThreatKind::none) {
            status.append(" ").append(hit_name(file, c.hit));
        }
        out += format("%3zu  %-9s  %5.1f  %+6.2f  %-20.40s  %6.3f", i, std::string(to_string(c.shape.family)).c_str(),
                      degrees(c.shape.plane), as_double(c.shape.offset), status.c_str(), as_double(c.duration));
        if (has_cost(c)) {
            const cost::NormalisedTerms normalised = cost::normalise(c.terms, file.settings.caps);
            out += format(" %7.4f %7.4f %7.4f %8.2f %9.1f | %.3f %.3f %.3f %.3f | %.4f", as_double(c.terms.smoothness),
                          as_double(c.terms.smoothness_penalised), as_double(c.terms.closeness),
                          as_double(c.terms.energy), as_double(c.terms.hover_power), as_double(normalised.time),
                          as_double(normalised.smoothness_penalised), as_double(normalised.closeness),
                          as_double(normalised.energy), as_double(c.total));
            out += c.flip_penalty > 0.0F ? format(" +%.2f side change", as_double(c.flip_penalty)) : std::string();
        }
        out += "\n";
    }
    out.append("\n").append(verdict(file, outcome)).append("\n");
    out += format("%u units of work, %zu %s.\n", outcome.work, outcome.tries,
                  outcome.tries == 1 ? "attempt" : "attempts, slower, further out and waiting");
    return out;
}

std::string plan_csv(const ProblemFile& file, const PlanOutcome& outcome)
{
    std::string out =
        "candidate,kind,plane_deg,offset,status,hits,duration,time,smoothness,smoothness_penalised,closeness,energy,"
        "hover_power,time_n,smoothness_n,smoothness_penalised_n,closeness_n,energy_n,total,flip_penalty\n";
    for (std::size_t i = 0; i < outcome.result.candidates.size(); ++i) {
        const Candidate& c = outcome.result.candidates[i];
        std::string hit = hit_name(file, c.hit);
        for (std::size_t at = hit.find('"'); at != std::string::npos; at = hit.find('"', at + 2)) {
            hit.insert(at, 1, '"');
        }
        out += format("%zu,%s,%.6g,%.9g,%s,", i, std::string(to_string(c.shape.family)).c_str(), degrees(c.shape.plane),
                      as_double(c.shape.offset), std::string(name_of(c.status)).c_str());
        out += hit.empty() ? std::string() : "\"" + hit + "\"";
        out += format(",%.9g", as_double(c.duration));
        if (has_cost(c)) {
            const cost::NormalisedTerms normalised = cost::normalise(c.terms, file.settings.caps);
            out += format(",%.9g,%.9g,%.9g,%.9g,%.9g,%.9g", as_double(c.terms.time), as_double(c.terms.smoothness),
                          as_double(c.terms.smoothness_penalised), as_double(c.terms.closeness),
                          as_double(c.terms.energy), as_double(c.terms.hover_power));
            out += format(",%.9g,%.9g,%.9g,%.9g,%.9g,%.9g,%.9g\n", as_double(normalised.time),
                          as_double(normalised.smoothness), as_double(normalised.smoothness_penalised),
                          as_double(normalised.closeness), as_double(normalised.energy), as_double(c.total),
                          as_double(c.flip_penalty));
        } else {
            out += ",,,,,,,,,,,,,\n";
        }
    }
    return out;
}

ordered_json plan_json(const ProblemFile& file, const PlanOutcome& outcome, bool points)
{
    const bool found = outcome.status == world::PlanStatus::found;
    ordered_json out{{"title", file.title},
                     {"status", name_of(outcome.status)},
                     {"verdict", verdict(file, outcome)},
                     {"chosen", found ? ordered_json(outcome.result.chosen) : ordered_json(nullptr)},
                     {"vehicle", file.vehicle.name},
                     {"main", main_name(file)},
                     {"distance", json_of(file.distance)},
                     {"main_radius", json_of(file.main_radius)},
                     {"speed", json_of(file.speed)},
                     {"start", json_of(file.start)},
                     {"direction", json_of(file.direction)},
                     {"work", outcome.work},
                     {"tries", outcome.tries}};
    ordered_json& candidates = out["candidates"] = ordered_json::array();
    ProblemStorage storage;
    const geometric::Problem problem = problem_of(file, storage);
    for (const Candidate& c : outcome.result.candidates) {
        ordered_json one = json_of(file, c);
        path::TimedPath path;
        if (points &&
            geometric::make_candidate_path(problem, c.shape, file.settings.waypoints, file.vehicle.limits, path)) {
            for (const path::PathPoint& point : path.points) {
                one["points"].push_back(json_of(point.position));
            }
        }
        candidates.push_back(std::move(one));
    }
    out["path"] = found ? json_of(outcome.result.path) : ordered_json::array();
    return out;
}

}  // namespace jink::host
