// SPDX-License-Identifier: BSD-3-Clause
#include "core/world/route_way.hpp"

#include <algorithm>
#include <cmath>

#include "core/base/angle.hpp"

namespace jink::world {
namespace {

/// Nearer than this, two points give no direction [m].
constexpr float kNoDistance = 1e-3F;
/// Cross-track error up to which the vehicle counts as being on a leg [m].
constexpr float kOnLeg = 0.25F;
/// The way aims at least this far ahead, past the end of a segment if need be [m].
constexpr float kMinAhead = 1.0F;
/// A piece that ends this close to the look-ahead ends with it: sums of times are rounded, and how many pieces there
/// are must not depend on that [s].
constexpr Seconds kSliver = 1e-4F;

/// A fixed wing aims so much of an arc's radius ahead: it cuts the arc by 3 % of the radius.
constexpr float kWingOnArc = 0.5F;

float ahead_of(const Situation& situation, const path::RouteSegment& segment, const path::Abeam& abeam,
               const Vec3& position) noexcept
{
    const bool wing = situation.limits.kind == vehicle::VehicleKind::fixed_wing;
    const float most =
        rejoin_lookahead(situation.limits, situation.reference.speed, position.z() - abeam.point.position.z());
    const bool on_leg = !segment.is_arc() && abeam.off <= kOnLeg;
    const float least = std::min(most, std::max(kMinAhead, 2.0F * abeam.off));
    const float on_arc = wing ? kWingOnArc * segment.radius : std::sqrt(segment.radius);
    const float wanted = on_leg ? abeam.left : segment.is_arc() ? std::min(most, on_arc + 2.0F * abeam.off) : most;
    return std::max(std::min(wanted, abeam.left), least);
}

}  // namespace

float rejoin_lookahead(const vehicle::VehicleLimits& limits, float speed, float height) noexcept
{
    constexpr Seconds kWingAhead = 4.0F;
    if (limits.kind == vehicle::VehicleKind::multirotor) {
        return kRejoinLookahead;
    }
    const Seconds climb = std::max(-height / limits.max_climb, height / limits.max_descent);
    return std::max(kRejoinLookahead, speed * std::max(kWingAhead, climb));
}

Way way_from(const Situation& situation, const Vec3& position) noexcept
{
    const Reference& reference = situation.reference;
    const path::RouteView route = reference.route();
    const path::Abeam abeam = route.abeam_of(position, reference.segment);
    const float length = route.length();
    const float joined =
        std::min(abeam.arc_length + ahead_of(situation, route.segments()[abeam.segment], abeam, position), length);
    const path::RoutePoint aim = route.at(joined);
    const Vec3 to_aim = aim.position - position;
    const float distance = to_aim.norm();
    Way way;
    way.origin = position;
    way.direction = distance > kNoDistance ? Vec3(to_aim / distance) : aim.along;
    way.length = distance > kNoDistance || joined < length ? distance + (length - joined) : 0.0F;
    way.speed = vehicle::clamped_velocity(way.direction, reference.speed, situation.limits).norm();
    way.ahead = {route, distance, joined};
    return way;
}

namespace detail {

RoutePieces::RoutePieces(const Situation& situation, const Way& way, Seconds lookahead) noexcept
    : way_(way), limits_(situation.limits), speed_(situation.reference.speed), lookahead_(lookahead)
{
    const std::span<const path::RouteSegment> segments = way.ahead.route.segments();
    // What is reached at most, and how far the way turns in it.
    const float reach = way.ahead.joined_at + std::max(0.0F, speed_ * lookahead - way.ahead.straight);
    float turn = 0.0F;
    float start = 0.0F;
    for (const path::RouteSegment& segment : segments) {
        const float from = std::clamp(way.ahead.joined_at - start, 0.0F, segment.length);
        const float to = std::clamp(reach - start, from, segment.length);
        turn += segment.is_arc() ? (to - from) / segment.radius : 0.0F;
        start += segment.length;
    }
    chord_angle_ = std::max(kChordAngle, turn * (1.001F / static_cast<float>(kWayChords)));

    add(way.origin, way.origin + way.direction * way.ahead.straight, way.ahead.straight);
    start = 0.0F;
    for (const path::RouteSegment& segment : segments) {
        const float from = std::clamp(way.ahead.joined_at - start, 0.0F, segment.length);
        if (now_ < lookahead_) {
            const float to = segment.is_arc() ? std::clamp(reach - start, from, segment.length) : segment.length;
            add_segment(segment, from, to);
        }
        start += segment.length;
    }
    if (now_ < lookahead_ && !pieces_.empty() && flown_ < way.length - 2.0F * kNoDistance) {
        pieces_.back().end = lookahead_;  // what was too short for a piece is missing at the end
    } else if (now_ < lookahead_ || pieces_.empty()) {
        const bool moves = way.length > 0.0F && !segments.empty();
        const Vec3 end = moves ? way.ahead.route.at(start).position : way.origin;
        pieces_.unchecked_push_back({{end, Vec3::Zero()}, now_, lookahead_, flown_, 0.0F});
    }
}

void RoutePieces::add_segment(const path::RouteSegment& segment, float from, float to) noexcept
{
    const float span = to - from;
    const int chords =
        segment.is_arc() ? std::max(1, static_cast<int>(std::ceil(span / (segment.radius * chord_angle_)))) : 1;
    const float chord = span / static_cast<float>(chords);
    Vec3 position = path::point_of(segment, from).position;
    for (int i = 1; i <= chords && now_ < lookahead_; ++i) {
        const Vec3 next = path::point_of(segment, from + chord * static_cast<float>(i)).position;
        add(position, next, chord);
        position = next;
    }
    if (segment.is_arc()) {
        const float half = sine_cosine(0.25F * chord / segment.radius).sine;
        off_ = std::max(off_, kChordSlack + 1.01F * segment.radius * 2.0F * half * half);
    }
}

/// Flown evenly in the time that `length` takes; shortened to end with the time that is looked ahead.
void RoutePieces::add(const Vec3& from, const Vec3& to, float length) noexcept
{
    const Vec3 span = to - from;
    if (!(length > kNoDistance) || !(span.squaredNorm() > 0.0F)) {
        flown_ += length;
        return;
    }
    const float speed = vehicle::clamped_velocity(span, speed_, limits_).norm();
    const Seconds duration = length / speed;
    const Seconds end = now_ + duration >= lookahead_ - kSliver ? lookahead_ : now_ + duration;
    pieces_.unchecked_push_back({{from, span / duration}, now_, end, flown_, duration});
    now_ = end;
    flown_ += length;
}

float RoutePieces::way_at(Seconds t) const noexcept
{
    std::size_t i = 0;
    while (i + 1 < pieces_.size() && t >= pieces_[i + 1].start) {
        ++i;
    }
    const WayPiece& piece = pieces_[i];
    const float next = i + 1 < pieces_.size() ? pieces_[i + 1].way : way_.length;
    if (piece.hovers()) {
        return piece.way;
    }
    const float speed = vehicle::clamped_velocity(piece.own.velocity, speed_, limits_).norm();
    return std::min(piece.way + speed * (t - piece.start), next);
}

}  // namespace detail
}  // namespace jink::world
