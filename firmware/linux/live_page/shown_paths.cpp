// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/linux/live_page/shown_paths.hpp"

#include <algorithm>
#include <limits>
#include <utility>

#include "firmware/linux/live_page/json_text.hpp"

namespace jink::livepage {
namespace {

using flightlog::CandidateTopic;
using geometric::CandidateStatus;

bool is_chosen(const CandidateTopic& c) { return static_cast<CandidateStatus>(c.status) == CandidateStatus::chosen; }

std::array<double, 3> place_of(const flightlog::Xyz& v)
{
    return {static_cast<double>(v[0]), static_cast<double>(v[1]), static_cast<double>(v[2])};
}

flightlog::Columns3 curve_of(const CandidateTopic& c, const flightlog::DecisionTopic& decision)
{
    if (c.family >= geometric::kFamilies.size()) {
        return {};
    }
    geometric::CandidateShape shape;
    shape.family = geometric::kFamilies[c.family];
    shape.plane = c.plane;
    shape.offset = c.offset;
    return flightlog::candidate_curve(shape, place_of(decision.start), place_of(decision.own_at_closest));
}

}  // namespace

void ShownPaths::take(const flightlog::DecisionTopic& decision)
{
    growing_.emplace();
    growing_->topic = decision;
}

void ShownPaths::take(const CandidateTopic& candidate)
{
    if (!growing_ || growing_->topic.decision != candidate.decision) {
        return;
    }
    ++growing_->known;
    if (growing_->candidates.size() < kMaxCandidates) {
        growing_->candidates.push_back(candidate);
    } else if (is_chosen(candidate)) {
        growing_->candidates.back() = candidate;
    }
}

void ShownPaths::end_decision()
{
    if (growing_) {
        newest_ = std::move(growing_);
        growing_.reset();
        is_new_ = true;
    }
}

/// All segments of a time come together.
void ShownPaths::take(const flightlog::NominalTopic& segment)
{
    if (nominal_time_ != segment.timestamp) {
        nominal_time_ = segment.timestamp;
        nominal_.fill({});
    }
    if (segment.path < nominal_.size()) {
        flightlog::NominalRoute& route = nominal_[segment.path];
        if (route.segments.size() < kMaxRouteSegments && flightlog::add_segment(route, segment)) {
            route.on_route = segment.on_route;
        }
    }
}

std::optional<std::uint64_t> ShownPaths::decision_time() const noexcept
{
    return newest_ ? std::optional(newest_->topic.timestamp) : std::nullopt;
}

void ShownPaths::add_decision(std::string& out, double time, float max_cost) const
{
    const std::vector<CandidateTopic>& all = newest_->candidates;
    const bool found = std::any_of(all.begin(), all.end(), is_chosen);
    add(out, "{\"number\":%u,\"time\":%.3f,\"candidates_known\":%u,\"candidates\":[", newest_->topic.decision, time,
        newest_->known);
    const char* separator = "";
    for (const CandidateTopic& c : all) {
        const auto status = static_cast<CandidateStatus>(c.status);
        const bool has_cost = c.time > 0.0F;
        const flightlog::Fate fate = status == CandidateStatus::not_evaluated
                                         ? flightlog::fate_of_unchecked(has_cost, found, c.cost > max_cost)
                                         : flightlog::fate_of(status);
        out += separator;
        out += "{\"fate\":";
        add_string(out, name_of(fate));
        out += ",\"cost\":";
        add_number(out, has_cost ? static_cast<double>(c.cost) : std::numeric_limits<double>::quiet_NaN());
        out += ",\"points\":";
        add_columns(out, curve_of(c, newest_->topic));
        out += '}';
        separator = ",";
    }
    out += "]}";
}

void ShownPaths::add_nominal(std::string& out, const Vec3& own, Seconds lookahead) const
{
    out += '[';
    const char* separator = "";
    for (const flightlog::NominalRoute& route : nominal_) {
        if (route.segments.empty()) {
            continue;
        }
        out += separator;
        add(out, "{\"kind\":\"%s\",\"speed\":", route.on_route ? "route" : "motion");
        add_number(out, static_cast<double>(route.speed));
        out += ",\"points\":";
        add_columns(out, flightlog::nominal_curve(route, own, lookahead));
        out += '}';
        separator = ",";
    }
    out += ']';
}

}  // namespace jink::livepage
