// SPDX-License-Identifier: BSD-3-Clause
#include "toolchain/host/flight_page.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include <nlohmann/json.hpp>

namespace jink::host {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kMetres = 0.01;
constexpr double kSeconds = 0.001;

std::string base64(const std::vector<std::uint8_t>& bytes)
{
    constexpr std::string_view kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string text;
    text.reserve((bytes.size() + 2) / 3 * 4);
    for (std::size_t i = 0; i < bytes.size(); i += 3) {
        const std::size_t n = std::min<std::size_t>(3, bytes.size() - i);
        std::uint32_t group = 0;
        for (std::size_t k = 0; k < 3; ++k) {
            group = group << 8U | (k < n ? bytes[i + k] : 0U);
        }
        for (std::size_t k = 0; k < 4; ++k) {
            text += k <= n ? kDigits[group >> (18U - 6U * k) & 63U] : '=';
        }
    }
    return text;
}

bool is_shown(double value) { return std::abs(value) <= kMaxShown; }

/// Differences from the least value in steps. At most 2 kMaxShown / 0.001 = 2e10 steps do not fit into 4 bytes: then
/// the step is made larger.
Json json(const Column& values, double step)
{
    double low = std::numeric_limits<double>::infinity();
    double high = -low;
    for (const double value : values) {
        low = is_shown(value) ? std::min(low, value) : low;
        high = is_shown(value) ? std::max(high, value) : high;
    }
    if (!(low <= high)) {
        low = high = 0.0;
    }
    constexpr double kMaxCode = 4294967294.0;
    while ((high - low) / step > kMaxCode) {
        step *= 10.0;
    }
    low = std::floor(low / step) * step;
    const unsigned bytes = (high - low) / step < 65534.0 ? 2U : 4U;
    std::vector<std::uint8_t> codes;
    codes.reserve(values.size() * bytes);
    for (const double value : values) {
        const auto code =
            is_shown(value) ? static_cast<std::uint32_t>(std::llround((value - low) / step)) : 0xFFFFFFFFU;
        for (unsigned k = 0; k < bytes; ++k) {
            codes.push_back(static_cast<std::uint8_t>(code >> (8U * k) & 0xFFU));
        }
    }
    return {{"from", low}, {"step", step}, {"bytes", bytes}, {"data", base64(codes)}};
}

Json json(const Columns3& columns, double step)
{
    return Json::array({json(columns.x, step), json(columns.y, step), json(columns.z, step)});
}

/// Null where it is unknown.
Json number(double value) { return is_shown(value) ? Json(std::round(value * 1e3) / 1e3 + 0.0) : Json(nullptr); }

Json json(const PageDecision& decision)
{
    Json candidates = Json::array();
    for (const PageCandidate& candidate : decision.candidates) {
        Json one{{"fate", name_of(candidate.fate)}, {"cost", number(candidate.cost)}};
        if (!candidate.points.x.empty()) {
            one["points"] = json(candidate.points, kMetres);
        }
        candidates.push_back(one);
    }
    return {{"time", number(decision.time)},
            {"text", decision.text},
            {"candidates_known", number(decision.known)},
            {"candidates", candidates}};
}

Json json(const PageThreat& threat)
{
    return {{"name", threat.name},
            {"form", threat.form},
            {"radius", number(threat.radius)},
            {"half_height", number(threat.half_height)},
            {"half_extents", threat.half_extents},
            {"moves", threat.moves},
            {"first", threat.first},
            {"position", json(threat.position, kMetres)}};
}

/// Columns of one value for each path: time, kind, points; and of their points, one path after the other.
Json json(const std::vector<PageNominal>& nominal)
{
    Column times;
    Column kinds;
    Column sizes;
    Columns3 points;
    for (const PageNominal& one : nominal) {
        times.push_back(one.time);
        kinds.push_back(one.on_route ? 1.0 : 0.0);
        sizes.push_back(static_cast<double>(one.points.x.size()));
        points.x.insert(points.x.end(), one.points.x.begin(), one.points.x.end());
        points.y.insert(points.y.end(), one.points.y.begin(), one.points.y.end());
        points.z.insert(points.z.end(), one.points.z.begin(), one.points.z.end());
    }
    return {{"t", json(times, kSeconds)},
            {"on_route", json(kinds, 1.0)},
            {"sizes", json(sizes, 1.0)},
            {"points", json(points, kMetres)}};
}

/// Columns of one value for each shape.
Json json(const std::vector<PageShape>& shapes)
{
    constexpr double kTurn = 1e-4;
    const auto column = [&](double step, auto value_of) {
        Column values;
        values.reserve(shapes.size());
        for (const PageShape& shape : shapes) {
            values.push_back(value_of(shape));
        }
        return json(values, step);
    };
    const auto columns = [&](double step, auto member) {
        Json all = Json::array();
        for (std::size_t k = 0; k < (PageShape().*member).size(); ++k) {
            all.push_back(column(step, [&](const PageShape& shape) { return (shape.*member)[k]; }));
        }
        return all;
    };
    return {{"from", column(kSeconds, [](const PageShape& s) { return s.from; })},
            {"until", column(kSeconds, [](const PageShape& s) { return s.until; })},
            {"kind", column(1.0, [](const PageShape& s) { return static_cast<double>(s.kind); })},
            {"of_map", column(1.0, [](const PageShape& s) { return s.of_map ? 1.0 : 0.0; })},
            {"radius", column(kMetres, [](const PageShape& s) { return s.radius; })},
            {"centre", columns(kMetres, &PageShape::centre)},
            {"half", columns(kMetres, &PageShape::half)},
            {"turn", columns(kTurn, &PageShape::turn)},
            {"velocity", columns(kMetres, &PageShape::velocity)}};
}

Json json(const PageFlight& flight)
{
    Json phases = Json::array();
    for (const PagePhase& phase : flight.phases) {
        phases.push_back({{"from", number(phase.from)}, {"mode", phase.mode}, {"in_control", phase.in_control}});
    }
    Json events = Json::array();
    for (const PageEvent& event : flight.events) {
        events.push_back({{"time", number(event.time)}, {"kind", event.kind}, {"text", event.text}});
    }
    Json decisions = Json::array();
    for (const PageDecision& decision : flight.decisions) {
        decisions.push_back(json(decision));
    }
    Json threats = Json::array();
    for (const PageThreat& threat : flight.threats) {
        threats.push_back(json(threat));
    }
    return {{"name", flight.name},
            {"title", flight.title},
            {"origin", flight.origin},
            {"outcome", flight.outcome},
            {"complaints", flight.complaints},
            {"as_expected", flight.as_expected},
            {"safety_distance", number(flight.safety_distance)},
            {"safety_text", flight.safety_text},
            {"least", number(flight.least)},
            {"least_time", number(flight.least_time)},
            {"least_threat", flight.least_threat},
            {"alone", number(flight.alone)},
            {"planning_time", number(flight.planning_time)},
            {"mission", json(flight.mission, kMetres)},
            {"t", json(flight.t, kSeconds)},
            {"own", json(flight.own, kMetres)},
            {"velocity", json(flight.velocity, kMetres)},
            {"command", json(flight.command, kMetres)},
            {"separation", json(flight.separation, kMetres)},
            {"work", flight.work.empty() ? Json(nullptr) : json(flight.work, 1.0)},
            {"phases", phases},
            {"events", events},
            {"decisions", decisions},
            {"threats", threats},
            {"nominal", json(flight.nominal)},
            {"shapes", json(flight.shapes)}};
}

}  // namespace

std::string page_data(const std::vector<PageSource>& sources)
{
    Json all = Json::array();
    for (const PageSource& source : sources) {
        Json flights = Json::array();
        for (const PageFlight& flight : source.flights) {
            flights.push_back(json(flight));
        }
        all.push_back({{"name", source.name}, {"flights", flights}});
    }
    // Bytes that are no UTF-8 are replaced; "<" would end a script element.
    const std::string text = all.dump(-1, ' ', true, Json::error_handler_t::replace);
    std::string safe;
    safe.reserve(text.size());
    for (const char c : text) {
        if (c == '<') {
            safe += "\\u003c";
        } else {
            safe += c;
        }
    }
    return safe;
}

std::string make_page(std::string_view viewer, const std::vector<PageSource>& sources)
{
    const std::size_t at = viewer.find(kDataMark);
    if (at == std::string_view::npos) {
        throw BadFlight("the viewer has no place for flights: build it again");
    }
    std::string page(viewer.substr(0, at));
    page += page_data(sources);
    page += viewer.substr(at + kDataMark.size());
    return page;
}

}  // namespace jink::host
