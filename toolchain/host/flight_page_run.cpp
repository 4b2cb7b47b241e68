// SPDX-License-Identifier: BSD-3-Clause
// Flights of jink-sim: run.json (tests/scenario/README.md describes its layout). Another format or version, a key that
// comes twice and a number beyond kMaxShown are refused, as is a value of another type; a flight may lack any key.
#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <set>
#include <sstream>

#include <nlohmann/json.hpp>

#include "firmware/linux/complaint.hpp"
#include "toolchain/host/flight_page.hpp"
#include "toolchain/host/json_document.hpp"

namespace jink::host {
namespace {

using nlohmann::json;

/// A value and its path, such as "flights[2].series.t[5]".
class Node {
public:
    Node(const json* value, const JsonDocument& document, std::string path = "")
        : value_(value), document_(&document), path_(std::move(path))
    {
    }

    /// Missing, or null.
    [[nodiscard]] bool is_absent() const { return value_ == nullptr || value_->is_null(); }
    [[noreturn]] void refuse(const std::string& what) const
    {
        document_->refuse(document_->find(path_), path_ + (path_.empty() ? "" : ": ") + what);
    }

    [[nodiscard]] Node operator[](const char* key) const
    {
        const std::string path = path_ + (path_.empty() ? "" : ".") + key;
        if (is_absent()) {
            return {nullptr, *document_, path};
        }
        if (!value_->is_object()) {
            refuse("expected an object");
        }
        const auto found = value_->find(key);
        return {found == value_->end() ? nullptr : &*found, *document_, path};
    }
    [[nodiscard]] std::vector<Node> items() const
    {
        std::vector<Node> all;
        if (is_absent()) {
            return all;
        }
        if (!value_->is_array()) {
            refuse("expected a list");
        }
        all.reserve(value_->size());
        for (std::size_t i = 0; i < value_->size(); ++i) {
            all.emplace_back(&(*value_)[i], *document_, path_ + "[" + std::to_string(i) + "]");
        }
        return all;
    }
    [[nodiscard]] double number(double absent = kUnknown) const
    {
        if (is_absent()) {
            return absent;
        }
        if (!value_->is_number()) {
            refuse("expected a number");
        }
        const auto value = value_->get<double>();
        if (!(std::abs(value) <= kMaxShown)) {
            refuse("expected a number from -1e7 to 1e7");
        }
        return value;
    }
    [[nodiscard]] std::string text(const std::string& absent = "") const
    {
        if (is_absent()) {
            return absent;
        }
        if (!value_->is_string()) {
            refuse("expected a text");
        }
        return value_->get<std::string>();
    }
    [[nodiscard]] bool flag(bool absent) const
    {
        if (is_absent()) {
            return absent;
        }
        if (!value_->is_boolean()) {
            refuse("expected true or false");
        }
        return value_->get<bool>();
    }
    /// Appends a point; null: unknown.
    void point(Columns3& into) const
    {
        if (is_absent()) {
            into.x.push_back(kUnknown);
            into.y.push_back(kUnknown);
            into.z.push_back(kUnknown);
            return;
        }
        const std::vector<Node> parts = items();
        if (parts.size() != 3) {
            refuse("expected three numbers");
        }
        into.x.push_back(parts[0].number());
        into.y.push_back(parts[1].number());
        into.z.push_back(parts[2].number());
    }
    [[nodiscard]] Columns3 points() const
    {
        Columns3 all;
        for (const Node& item : items()) {
            item.point(all);
        }
        return all;
    }
    [[nodiscard]] Column numbers() const
    {
        Column all;
        for (const Node& item : items()) {
            all.push_back(item.number());
        }
        return all;
    }
    /// Refuses a column that is there with another length than the time's.
    void expect_size(std::size_t size, std::size_t expected) const
    {
        if (!is_absent() && size != expected) {
            refuse(std::to_string(size) + " values, expected " + std::to_string(expected) + " as in series.t");
        }
    }

private:
    const json* value_;
    const JsonDocument* document_;
    std::string path_;
};

void read_series(const Node& series, PageFlight& flight)
{
    flight.t = series["t"].numbers();
    const std::size_t n = flight.t.size();
    for (std::size_t i = 0; i < n; ++i) {
        if (!(std::abs(flight.t[i]) <= kMaxShown) || (i > 0 && flight.t[i] < flight.t[i - 1])) {
            series["t"].items()[i].refuse("expected a time that is not before the last one");
        }
    }
    const auto read = [&](const char* key, Columns3& into) {
        into = series[key].points();
        series[key].expect_size(into.x.size(), n);
        if (into.x.empty()) {
            into = {Column(n, kUnknown), Column(n, kUnknown), Column(n, kUnknown)};
        }
    };
    read("position", flight.own);
    read("velocity", flight.velocity);
    read("setpoint", flight.command);
    flight.separation = series["separation"].numbers();
    series["separation"].expect_size(flight.separation.size(), n);
    flight.separation.resize(n, kUnknown);
    flight.work = series["work"].numbers();
    series["work"].expect_size(flight.work.size(), n);
    const std::vector<Node> modes = series["mode"].items();
    series["mode"].expect_size(modes.size(), n);
    for (std::size_t i = 0; i < modes.size(); ++i) {
        std::string mode = modes[i].text();
        if (flight.phases.empty() || flight.phases.back().mode != mode) {
            const bool in_control = mode == "external";
            flight.phases.push_back({flight.t[i], std::move(mode), in_control});
        }
    }
}

PageThreat read_threat(const Node& node, std::size_t samples)
{
    PageThreat threat;
    threat.name = node["name"].text("threat");
    threat.form = node["form"].text("sphere");
    if (threat.form != "sphere" && threat.form != "cylinder" && threat.form != "box") {
        node["form"].refuse("expected sphere, cylinder or box");
    }
    threat.radius = node["radius"].number(0.0);
    threat.half_height = node["half_height"].number(0.0);
    threat.half_extents = node["half_extents"].numbers();
    if (threat.form == "box" && threat.half_extents.size() != 3) {
        node["half_extents"].refuse("expected three numbers");
    }
    threat.moves = node["moves"].flag(true);
    threat.position = node["positions"].points();
    if (threat.moves) {
        node["positions"].expect_size(threat.position.x.size(), samples);
    }
    return threat;
}

Fate fate_of(const Node& status, bool has_cost, bool plan_found)
{
    const std::string name = status.text();
    if (name == "chosen") {
        return Fate::chosen;
    }
    if (name == "available") {
        return Fate::clear;
    }
    if (name == "not_flyable") {
        return Fate::not_flyable;
    }
    if (name == "hits_static" || name == "hits_moving" || name == "hits_airspace") {
        return Fate::contact;
    }
    if (name != "not_evaluated") {
        status.refuse("expected a candidate's status, not '" + name + "'");
    }
    return fate_of_unchecked(has_cost, plan_found, false);
}

geometric::CandidateShape shape_of(const Node& candidate)
{
    geometric::CandidateShape shape;
    const std::string name = candidate["family"].text();
    const auto* const family = std::find_if(geometric::kFamilies.begin(), geometric::kFamilies.end(),
                                            [&](geometric::Family one) { return to_string(one) == name; });
    if (family == geometric::kFamilies.end()) {
        candidate["family"].refuse("expected a candidate's family, not '" + name + "'");
    }
    shape.family = *family;
    shape.plane = static_cast<float>(candidate["plane"].number());
    shape.offset = static_cast<float>(candidate["offset"].number());
    return shape;
}

std::array<double, 3> place_of(const Node& node)
{
    Columns3 one;
    node.point(one);
    return {one.x[0], one.y[0], one.z[0]};
}

PageDecision read_decision(const Node& node)
{
    PageDecision decision;
    decision.time = node["t"].number();
    if (!(std::abs(decision.time) <= kMaxShown)) {
        node["t"].refuse("expected a time");
    }
    decision.text = node["text"].text();
    const std::array<double, 3> start = place_of(node["start"]);
    const std::array<double, 3> to = place_of(node["own_at_closest"]);
    const std::vector<Node> candidates = node["candidates"].items();
    const bool found = std::any_of(candidates.begin(), candidates.end(),
                                   [](const Node& one) { return one["status"].text() == "chosen"; });
    for (const Node& one : candidates) {
        PageCandidate& candidate = decision.candidates.emplace_back();
        const double cost = one["cost"].number(0.0);
        candidate.cost = cost > 0.0 ? cost : kUnknown;
        candidate.fate = fate_of(one["status"], cost > 0.0, found);
        candidate.points = flightlog::candidate_curve(shape_of(one), start, to);
    }
    decision.known = static_cast<double>(candidates.size());
    return decision;
}

void read_events(const Node& node, PageFlight& flight)
{
    std::set<std::string> said;
    for (const Node& item : node["link"]["texts"].items()) {
        const std::string text = item["text"].text();
        if (said.insert(text.substr(0, text.find(','))).second) {
            flight.events.push_back({item["t"].number(0.0), "text", text});
        }
    }
    for (const Node& item : node["threats"].items()) {
        if (const double appeared = item["appeared"].number(0.0); appeared > 0.0) {
            flight.events.push_back({appeared, "threat", item["name"].text("threat") + " comes into sight"});
        }
    }
    for (std::size_t i = 1; i < flight.phases.size(); ++i) {
        const PagePhase& now = flight.phases[i];
        const char* const change = now.in_control                    ? "jink has control: mode "
                                   : flight.phases[i - 1].in_control ? "jink has no longer control: mode "
                                                                     : "mode ";
        flight.events.push_back({now.from, "state", change + now.mode});
    }
    if (flight.least == flight.least && flight.least_time == flight.least_time) {
        flight.events.push_back({flight.least_time, "closest", "closest to " + flight.least_threat});
    }
    std::stable_sort(flight.events.begin(), flight.events.end(),
                     [](const PageEvent& a, const PageEvent& b) { return a.time < b.time; });
}

PageFlight read_flight(const Node& node)
{
    PageFlight flight;
    flight.name = node["name"].text("flight");
    flight.title = node["title"].text(flight.name);
    for (const char* key : {"stack", "transport"}) {
        const std::string part = node[key].text();
        flight.origin += (flight.origin.empty() || part.empty() ? "" : ", ") + part;
    }
    flight.outcome = node["outcome"].text();
    for (const char* key : {"unmet", "faults"}) {
        for (const Node& item : node[key].items()) {
            flight.complaints.push_back(item.text());
        }
    }
    flight.as_expected = node["as_expected"].flag(true);
    flight.safety_distance = node["promise"].number();
    flight.safety_text = "promised distance, centre to true surface";
    flight.least = node["least"]["surface"].number();
    flight.least_time = node["least"]["t"].number();
    flight.least_threat = node["least"]["threat"].text("threat");
    flight.alone = node["least"]["alone"].number();
    if (!node["judge"].is_absent() && flight.least < flight.safety_distance) {
        flight.complaints.emplace_back(node["judge"]["avoidable"].flag(false)
                                           ? "a manoeuvre that keeps the distance was found afterwards"
                                           : "no manoeuvre that was tried afterwards keeps the distance");
    }
    const double worst = node["inside"]["plan_steps"]["worst_us"].number();
    flight.planning_time = worst > 0.0 ? worst * 1e-3 : kUnknown;
    flight.mission = node["mission"].points();
    read_series(node["series"], flight);
    for (const Node& item : node["threats"].items()) {
        flight.threats.push_back(read_threat(item, flight.t.size()));
    }
    for (const Node& item : node["decisions"].items()) {
        flight.decisions.push_back(read_decision(item));
    }
    read_events(node, flight);
    return flight;
}

}  // namespace

PageSource read_run(const std::filesystem::path& file)
{
    std::ifstream in(file, std::ios::binary);
    if (!in || !std::filesystem::is_regular_file(file)) {
        throw BadFlight(file.string() + ": cannot be read; expected a run of jink-sim or a flight log of jinkd");
    }
    std::ostringstream text;
    text << in.rdbuf();
    const JsonDocument document{file.string(), std::move(text).str()};
    const json run = document.parse();
    const Node top(&run, document);
    if (run.is_object() && (!run.contains("format") || run["format"] != "jink-sim run")) {
        top["format"].refuse("expected 'jink-sim run'");
    }
    if (run.is_object() && (!run.contains("version") || run["version"] != 2)) {
        top["version"].refuse("expected 2");
    }
    if (!run.is_object() || !run.contains("flights") || !run["flights"].is_array()) {
        top.refuse("holds no list of flights");
    }
    PageSource source{file.string(), {}};
    for (const Node& item : top["flights"].items()) {
        if (item.is_absent()) {
            item.refuse("expected an object");
        }
        source.flights.push_back(read_flight(item));
    }
    return source;
}

}  // namespace jink::host
