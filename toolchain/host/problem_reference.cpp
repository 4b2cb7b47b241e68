// SPDX-License-Identifier: BSD-3-Clause
// Readers of a problem file's reference (legs and arcs) and path frame.
#include <cmath>

#include "toolchain/host/problem_parts.hpp"

namespace jink::host::detail {
namespace {

using files::kNeed;
using files::YamlMap;
using path::RouteStatus;
constexpr float kDegree = kPi / 180.0F;

std::string words_of(RouteStatus status)
{
    switch (status) {
    case RouteStatus::ok: break;
    case RouteStatus::full: return "are more than " + std::to_string(kMaxRouteSegments);
    case RouteStatus::not_finite: return "leads too far away";
    case RouteStatus::too_short: return "has no length";
    case RouteStatus::bad_arc:
        return "is no arc: its start lies in the plane of the circle, 0.5 to 10000 m from the centre, and it turns by "
               "360 degrees at most";
    case RouteStatus::gap: return "does not begin where the one before ends";
    }
    return "";
}

/// One segment from `from` on: to a point, or about a centre.
void read_segment(YamlMap& map, const Vec3& from, path::Route& route, YamlMap& root)
{
    RouteStatus status = RouteStatus::ok;
    if (map.has("centre")) {
        if (map.has("to")) {
            map.complain("to", "does not go with `centre`");
        }
        const auto centre = map.vector("centre", kCoordinate, kNeed);
        const auto turn = map.number("turn", {-360.0F, 360.0F}, kNeed);
        const Vec3 axis = map.vector("axis", {-1.0F, 1.0F}).value_or(Vec3::UnitZ());
        status = centre && turn ? route.add_arc(from, *centre, axis, kDegree * *turn) : status;
    } else if (const auto to = map.vector("to", kCoordinate, kNeed)) {
        status = route.add_leg(from, *to);
    }
    if (status == RouteStatus::full) {
        root.complain("reference", "segments " + words_of(status));
    } else if (status != RouteStatus::ok) {
        map.complain(map.has("centre") ? "centre" : "to", words_of(status));
    }
    map.finish();
}

/// Distance of the centres at arc length `way` [m] while the vehicle flies along the reference at constant speed.
double apart_at(const ProblemFile& file, const geometry::Motion& motion, double way)
{
    const auto at = static_cast<float>(way);
    return static_cast<double>(
        (motion.position + at / file.speed * motion.velocity - file.route.at(at).position).norm());
}

}  // namespace

void read_reference(YamlMap& root, ProblemFile& out, files::Complaints& complaints)
{
    auto reference = root.map("reference");
    if (!reference) {
        return;
    }
    const auto start = reference->vector("start", kCoordinate, kNeed);
    out.speed = reference->number("speed", kSpeed).value_or(out.vehicle.limits.cruise_speed);
    const auto segments = reference->list("segments", kNeed);
    reference->finish();
    if (!start || !segments) {
        return;
    }
    out.start = *start;
    Vec3 from = *start;
    const std::size_t before = complaints.size();
    for (std::size_t i = 0; i < segments->size() && complaints.size() == before; ++i) {
        YamlMap map((*segments)[i], "reference.segments[" + std::to_string(i) + "]", root.file(), complaints);
        if (map.is_map()) {
            read_segment(map, from, out.route, root);
        }
        from = out.route.empty() ? from : out.route.at(out.route.length()).position;
    }
    if (out.route.empty()) {
        if (complaints.size() == before) {
            root.complain("reference", "has no segments");
        }
        return;
    }
    out.direction = out.route.at(0.0F).along;
}

void read_frame(YamlMap& root, ProblemFile& out)
{
    const auto across = root.vector("frame_y", {-1.0F, 1.0F});
    if (!across) {
        return;
    }
    constexpr float kMin = 1e-3F;
    const Vec3 y = *across - across->dot(out.direction) * out.direction;
    if (!(y.norm() >= kMin)) {
        root.complain("frame_y", "lies along the way: planes cannot be counted from it");
        return;
    }
    out.frame_y = y.normalized();
}

std::optional<float> nearest_on_reference(const ProblemFile& file, const geometry::Motion& motion)
{
    constexpr int kSteps = 4000;
    const double length = static_cast<double>(file.route.length());
    const double step = length / kSteps;
    int best = 0;
    for (int i = 1; i <= kSteps; ++i) {
        best = apart_at(file, motion, step * i) < apart_at(file, motion, step * best) ? i : best;
    }
    if (best == 0 || best == kSteps) {
        return std::nullopt;
    }
    double low = step * (best - 1);
    double high = step * (best + 1);
    for (int i = 0; i < 60; ++i) {
        const double third = (high - low) / 3.0;
        const bool before = apart_at(file, motion, low + third) < apart_at(file, motion, high - third);
        (before ? high : low) = before ? high - third : low + third;
    }
    return static_cast<float>(0.5 * (low + high));
}

}  // namespace jink::host::detail
