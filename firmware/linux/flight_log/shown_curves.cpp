// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/linux/flight_log/shown_curves.hpp"

#include <algorithm>
#include <cmath>

#include "core/base/angle.hpp"

namespace jink::flightlog {
namespace {

void add_point(Columns3& points, const Vec3& at)
{
    points.x.push_back(static_cast<double>(at.x()));
    points.y.push_back(static_cast<double>(at.y()));
    points.z.push_back(static_cast<double>(at.z()));
}

Vec3 vector_of(const Xyz& v) { return {v[0], v[1], v[2]}; }

bool is_unit(const Vec3& v) { return std::abs(v.squaredNorm() - 1.0F) < 1e-2F; }

}  // namespace

std::string_view name_of(Fate fate) noexcept
{
    switch (fate) {
    case Fate::chosen: return "chosen";
    case Fate::clear: return "clear";
    case Fate::contact: return "contact";
    case Fate::not_flyable: return "not_flyable";
    case Fate::more_expensive: return "more_expensive";
    case Fate::budget_spent: return "budget_spent";
    }
    return "?";
}

Fate fate_of_unchecked(bool has_cost, bool plan_found, bool above_max_cost) noexcept
{
    return has_cost && (plan_found || above_max_cost) ? Fate::more_expensive : Fate::budget_spent;
}

Fate fate_of(geometric::CandidateStatus status) noexcept
{
    using geometric::CandidateStatus;
    switch (status) {
    case CandidateStatus::available: return Fate::clear;
    case CandidateStatus::chosen: return Fate::chosen;
    case CandidateStatus::hits_static:
    case CandidateStatus::hits_moving:
    case CandidateStatus::hits_airspace: return Fate::contact;
    case CandidateStatus::not_flyable: return Fate::not_flyable;
    case CandidateStatus::not_evaluated: break;
    }
    return Fate::budget_spent;
}

Columns3 candidate_curve(const geometric::CandidateShape& shape, const std::array<double, 3>& start,
                         const std::array<double, 3>& to)
{
    constexpr int kCurvePoints = 24;
    const auto vector = [](const std::array<double, 3>& p) {
        return Vec3(static_cast<float>(p[0]), static_cast<float>(p[1]), static_cast<float>(p[2]));
    };
    Columns3 points;
    const Vec3 direction = vector(to) - vector(start);
    const float distance = direction.norm();
    if (!(distance > 0.0F) || !std::isfinite(distance) || !std::isfinite(shape.plane + shape.offset)) {
        return points;
    }
    const geometric::PathFrame frame = geometric::make_path_frame(vector(start), direction);
    const float length = geometric::curve_length_x(shape.family, distance);
    for (int k = 0; k <= kCurvePoints; ++k) {
        const float s = length * static_cast<float>(k) / static_cast<float>(kCurvePoints);
        const float y = geometric::curve_offset(shape, distance, s);
        add_point(points, frame.origin + frame.axes * Vec3(s, y * std::cos(shape.plane), y * std::sin(shape.plane)));
    }
    return points;
}

bool add_segment(NominalRoute& route, const NominalTopic& topic)
{
    path::RouteSegment segment;
    segment.start = vector_of(topic.start);
    segment.along = vector_of(topic.along);
    segment.towards = vector_of(topic.towards);
    segment.radius = topic.radius;
    segment.length = topic.length;
    const bool is_shape = is_unit(segment.along) && (!segment.is_arc() || is_unit(segment.towards)) &&
                          segment.start.cwiseAbs().maxCoeff() <= path::Route::kFarthest && segment.length >= 0.0F &&
                          segment.length <= 10.0F * path::Route::kFarthest && segment.radius >= 0.0F &&
                          segment.radius <= path::Route::kLargestRadius && topic.speed > 0.0F && topic.speed <= 1e4F;
    const bool is_arc_whole =
        !segment.is_arc() || (segment.radius >= path::Route::kMinRadius && segment.length <= 7.0F * segment.radius);
    const bool follows = route.segments.empty() || topic.segment == route.last + 1U;
    if (!is_shape || !is_arc_whole || !follows) {
        return false;
    }
    route.segments.push_back(segment);
    route.speed = topic.speed;
    route.last = topic.segment;
    return true;
}

Columns3 nominal_curve(const NominalRoute& route, const Vec3& own, Seconds ahead)
{
    constexpr float kArcStep = kPi / 12.0F;
    Columns3 points;
    if (route.segments.empty()) {
        return points;
    }
    const path::RouteView view(route.segments);
    float at = is_finite(own) ? view.abeam_of(own).arc_length : 0.0F;
    const float to = std::min(view.length(), at + route.speed * ahead);
    add_point(points, view.at(at).position);
    float begin = 0.0F;  // of the segment
    for (const path::RouteSegment& segment : route.segments) {
        const float end = std::min(begin + segment.length, to);
        const float step = segment.is_arc() ? kArcStep * segment.radius : segment.length;
        while (at < end && points.x.size() + 1 < kMaxNominalPoints) {
            at = std::min(at + step, end);
            add_point(points, path::point_of(segment, at - begin).position);
        }
        begin += segment.length;
    }
    if (points.x.size() == 1 || at < to) {
        add_point(points, view.at(to).position);
    }
    return points;
}

}  // namespace jink::flightlog
