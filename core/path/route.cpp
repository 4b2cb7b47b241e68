// SPDX-License-Identifier: BSD-3-Clause
#include "core/path/route.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "core/base/angle.hpp"

namespace jink::path {
namespace {

bool is_near(const Vec3& point) noexcept { return is_finite(point) && point.cwiseAbs().maxCoeff() <= Route::kFarthest; }

/// Arc length of the point of a segment that is nearest to `position`.
float nearest_on(const RouteSegment& segment, const Vec3& position) noexcept
{
    if (!segment.is_arc()) {
        return std::clamp((position - segment.start).dot(segment.along), 0.0F, segment.length);
    }
    const Vec3 from_centre = position - segment.start - segment.radius * segment.towards;
    const float turned = direction_angle(from_centre.dot(segment.along), -from_centre.dot(segment.towards));
    const float angle = turned < 0.0F ? turned + 2.0F * kPi : turned;
    const float whole = segment.length / segment.radius;
    if (angle <= whole) {
        return std::min(angle * segment.radius, segment.length);
    }
    return angle - whole < 2.0F * kPi - angle ? segment.length : 0.0F;
}

}  // namespace

RoutePoint point_of(const RouteSegment& segment, float arc_length) noexcept
{
    const float on = std::clamp(arc_length, 0.0F, segment.length);
    if (!segment.is_arc() || arc_length < 0.0F) {
        return {segment.start + segment.along * arc_length, segment.along};
    }
    const SineCosine half = sine_cosine(0.5F * (on / segment.radius));
    const float sine = 2.0F * half.sine * half.cosine;
    const float rise = 2.0F * half.sine * half.sine;  // 1 - cosine, without cancellation
    const Vec3 along = (1.0F - rise) * segment.along + sine * segment.towards;
    const Vec3 position = segment.start + segment.radius * (sine * segment.along + rise * segment.towards);
    return {position + (arc_length - on) * along, along};
}

RouteSegment straight_segment(const Vec3& start, const Vec3& end) noexcept
{
    /// Nearer than this, two points give no direction [m].
    constexpr float kNoLength = 1e-3F;
    const Vec3 span = end - start;
    const float length = span.norm();
    RouteSegment segment;
    segment.start = end;
    if (length > kNoLength) {
        segment.start = start;
        segment.along = span / length;
        segment.length = length;
    }
    return segment;
}

bool Route::meets_end(const Vec3& start) const noexcept
{
    return segments_.empty() || (point_of(segments_.back(), segments_.back().length).position - start).norm() <= kJoin;
}

RouteStatus Route::add(const RouteSegment& segment) noexcept
{
    if (!is_near(point_of(segment, segment.length).position)) {
        return RouteStatus::not_finite;
    }
    if (!(segment.length >= kShortest)) {
        return RouteStatus::too_short;
    }
    segments_.unchecked_push_back(segment);  // callers have checked the capacity
    return RouteStatus::ok;
}

RouteStatus Route::add_leg(const Vec3& start, const Vec3& end) noexcept
{
    if (segments_.full()) {
        return RouteStatus::full;
    }
    if (!is_near(start) || !is_near(end)) {
        return RouteStatus::not_finite;
    }
    if (!meets_end(start)) {
        return RouteStatus::gap;
    }
    return add(straight_segment(
        segments_.empty() ? start : point_of(segments_.back(), segments_.back().length).position, end));
}

RouteStatus Route::add_arc(const Vec3& start, const Vec3& centre, const Vec3& axis, float angle) noexcept
{
    if (segments_.full()) {
        return RouteStatus::full;
    }
    if (!is_near(start) || !is_near(centre) || !is_finite(axis) || !std::isfinite(angle)) {
        return RouteStatus::not_finite;
    }
    if (!meets_end(start)) {
        return RouteStatus::gap;
    }
    constexpr float kWhole = 2.0F * kPi * (1.0F + 1e-6F);
    const float most = axis.cwiseAbs().maxCoeff();
    if (!(most > 0.0F) || !(std::abs(angle) <= kWhole)) {
        return RouteStatus::bad_arc;
    }
    const Vec3 up = (axis / most).normalized();
    const Vec3 inwards = centre - start;
    const float above = inwards.dot(up);
    const Vec3 level = inwards - above * up;
    RouteSegment segment;
    segment.radius = level.norm();
    if (!(segment.radius >= kMinRadius && segment.radius <= kLargestRadius) || !(std::abs(above) <= kJoin)) {
        return RouteStatus::bad_arc;
    }
    segment.start = segments_.empty() ? start : point_of(segments_.back(), segments_.back().length).position;
    segment.towards = level / segment.radius;
    segment.along = std::copysign(1.0F, angle) * segment.towards.cross(up);
    segment.length = segment.radius * std::min(std::abs(angle), 2.0F * kPi);
    return add(segment);
}

float RouteView::length() const noexcept
{
    float length = 0.0F;
    for (const RouteSegment& segment : segments_) {
        length += segment.length;
    }
    return length;
}

RoutePoint RouteView::at(float arc_length) const noexcept
{
    std::size_t i = 0;
    while (i + 1 < segments_.size() && arc_length >= segments_[i].length) {
        arc_length -= segments_[i].length;
        ++i;
    }
    return point_of(segments_[i], arc_length);
}

Abeam RouteView::abeam_of(const Vec3& position, std::size_t from) const noexcept
{
    const std::size_t first = std::min(from, segments_.size() - 1);
    Abeam best;
    float before = 0.0F;
    for (std::size_t i = 0; i < segments_.size(); ++i) {
        const RouteSegment& segment = segments_[i];
        if (i >= first) {
            const float on = nearest_on(segment, position);
            const RoutePoint point = point_of(segment, on);
            const float off = (position - point.position).norm();
            if (i > first && off > best.off) {
                break;
            }
            best = {i, before + on, off, segment.length - on, point};
        }
        before += segment.length;
    }
    return best;
}

RoutePoint point_of(const RouteAhead& ahead, const Vec3& origin, const Vec3& direction, float way) noexcept
{
    if (ahead.route.empty() || way < ahead.straight) {
        return {origin + way * direction, direction};
    }
    return ahead.route.at(ahead.joined_at + (way - ahead.straight));
}

Vec3 carried(const Vec3& side, const Vec3& from, const Vec3& to) noexcept
{
    constexpr float kOpposite = 1e-4F;
    const float both = 1.0F + from.dot(to);
    return both > kOpposite ? Vec3(side - (side.dot(to) / both) * (from + to)) : side;
}

}  // namespace jink::path
