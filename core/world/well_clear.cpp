// SPDX-License-Identifier: BSD-3-Clause
#include "core/world/well_clear.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/base/work_units.hpp"
#include "core/world/route_way.hpp"
#include "core/world/threat_set.hpp"

namespace jink::world {
namespace {

/// An aircraft draws apart that gains so much of its volume in this time: 13 m/s level, 1.6 m/s up or down.
constexpr Seconds kSoon = 5.0F;
constexpr float kDrawsApart = 0.105F;
/// Multiples of the volume that end giving way.
constexpr float kClearAgain = 1.1F;

float nearness_at(const Vec3& gap, const Vec3& closing, const Volume& volume, Seconds t) noexcept
{
    const Vec3 at = gap + closing * t;
    return std::max(at.head<2>().norm() / volume.radius, std::abs(at.z()) / volume.height);
}

/// `volume`, larger by all that is possible of the positions of both. A track's growth holds its body too.
Volume grown(const Threat& aircraft, const Volume& volume) noexcept
{
    const float by = aircraft.growth.radius;
    return {volume.radius + by, volume.height + by + aircraft.half_height};
}

}  // namespace

Nearness nearest(const Vec3& gap, const Vec3& closing, const Volume& volume, Seconds span) noexcept
{
    // Both squares are polynomials of time: level is a t^2 + 2 b t + c, height the square of (e t + f).
    const float per_radius = 1.0F / volume.radius;
    const float x = gap.x() * per_radius;
    const float y = gap.y() * per_radius;
    const float u = closing.x() * per_radius;
    const float v = closing.y() * per_radius;
    const float e = closing.z() / volume.height;
    const float f = gap.z() / volume.height;
    const float a = u * u + v * v;
    const float b = x * u + y * v;
    constexpr float kNothing = 1e-12F;
    Nearness best{nearness_at(gap, closing, volume, 0.0F), 0.0F};
    const auto consider = [&](Seconds t) noexcept {
        if (!(t > 0.0F && t <= span)) {
            return;
        }
        const float value = nearness_at(gap, closing, volume, t);
        if (value < best.least) {
            best = {value, t};
        }
    };
    consider(span);
    if (a > kNothing) {
        consider(-b / a);
    }
    if (e * e > kNothing) {
        consider(-f / e);
    }
    // Where both are equal.
    const float p = a - e * e;
    const float q = b - e * f;
    const float r = x * x + y * y - f * f;
    const float root2 = q * q - p * r;
    if (root2 >= 0.0F) {
        // The stable form of both roots.
        const float s = -(q + std::copysign(std::sqrt(root2), q));
        if (std::abs(p) > kNothing) {
            consider(s / p);
        }
        if (std::abs(s) > kNothing) {
            consider(r / s);
        }
    }
    return best;
}

Seconds first_inside(const Vec3& gap, const Vec3& closing, const Volume& volume, Seconds span) noexcept
{
    constexpr Seconds kNever = -1.0F;
    Seconds from = 0.0F;
    Seconds to = span;
    const float a = closing.head<2>().squaredNorm();
    const float b = gap.head<2>().dot(closing.head<2>());
    const float c = gap.head<2>().squaredNorm() - volume.radius * volume.radius;
    if (a > 0.0F) {
        const float root2 = b * b - a * c;
        if (!(root2 > 0.0F)) {
            return kNever;
        }
        const float root = std::sqrt(root2);
        from = std::max(from, (-b - root) / a);
        to = std::min(to, (-b + root) / a);
    } else if (!(c < 0.0F)) {
        return kNever;
    }
    const float climb = closing.z();
    if (climb != 0.0F) {
        const float low = (-volume.height - gap.z()) / climb;
        const float high = (volume.height - gap.z()) / climb;
        from = std::max(from, std::min(low, high));
        to = std::min(to, std::max(low, high));
    } else if (!(std::abs(gap.z()) < volume.height)) {
        return kNever;
    }
    return from < to ? from : kNever;
}

bool is_aircraft(const Situation& situation, const Threat& threat) noexcept
{
    return situation.rules.well_clear.radius > 0.0F && threat.ref.kind == ThreatKind::track &&
           threat.track != nullptr && threat.track->manned;
}

Volume well_clear_of(const Situation& situation, const Threat& aircraft) noexcept
{
    const WellClear& rule = situation.rules.well_clear;
    return grown(aircraft, {rule.radius, rule.height});
}

Volume near_mid_air_of(const Threat& aircraft) noexcept { return grown(aircraft, kNearMidAir); }

TurnPieces turning_on(const Threat& aircraft) noexcept
{
    constexpr float kTurns = 0.015F;  // [rad/s]
    TurnPieces pieces;
    const float rate = aircraft.track != nullptr ? aircraft.track->turn_rate : 0.0F;
    if (std::abs(rate) < kTurns) {
        return pieces;
    }
    const float half = 0.5F * rate * kTurnPiece;
    const float chord = std::sin(half) / half;
    // From one chord to the next, and to the first one.
    const AircraftCourse turn{std::cos(2.0F * half), std::sin(2.0F * half)};
    const AircraftCourse first{chord * std::cos(half), chord * std::sin(half)};
    TurnPiece piece{aircraft.position, first.of(aircraft.velocity)};
    while (pieces.try_push_back(piece)) {
        piece.position += piece.velocity * kTurnPiece;
        piece.velocity = turn.of(piece.velocity);
    }
    return pieces;
}

namespace {

/// Whether even straight towards each other they do not come near within kAircraftAhead.
bool cannot_come_near(const Situation& s, const Threat& aircraft) noexcept
{
    const Volume clear = well_clear_of(s, aircraft);
    const Vec3 gap = aircraft.position - s.own.position;
    const float own_speed = std::max(s.reference.speed, s.own.velocity.norm());
    const float level = kAircraftAhead * (own_speed + aircraft.velocity.head<2>().norm());
    const float own_climb = std::max(s.limits.max_climb, s.limits.max_descent);
    const float height = kAircraftAhead * (own_climb + std::abs(aircraft.velocity.z()));
    return gap.head<2>().norm() > kClearAgain * clear.radius + level ||
           std::abs(gap.z()) > kClearAgain * clear.height + height;
}

/// What is found of one aircraft on the way.
struct Meeting {
    Alert level = Alert::none;
    Seconds loss = -1.0F;
    Seconds closest = 0.0F;

    void note(Seconds inside, Seconds start, Alert found) noexcept
    {
        if (inside >= 0.0F) {
            loss = loss < 0.0F ? start + inside : std::min(loss, start + inside);
            level = std::max(level, found);
        }
    }
};

/// On the courses that are not straight on.
void meets_turning(const detail::RoutePieces& pieces, const Threat& aircraft, const Volume& volume,
                   Meeting& out) noexcept
{
    for (const detail::WayPiece& piece : pieces) {
        const Seconds span = std::min(piece.end, kTurnAhead) - piece.start;
        for (const AircraftCourse& course : kAircraftCourses) {
            if (!course.straight && span > 0.0F) {
                const Vec3 velocity = course.of(aircraft.velocity);
                const Vec3 gap = aircraft.position + velocity * piece.start - piece.own.position;
                out.note(first_inside(gap, velocity - piece.own.velocity, volume, span), piece.start, Alert::low);
            }
        }
    }
}

/// On its way if it goes on turning.
void meets_turning_on(const detail::RoutePieces& pieces, const Threat& aircraft, const Volume& volume,
                      Meeting& out) noexcept
{
    Seconds begin = 0.0F;
    for (const TurnPiece& chord : turning_on(aircraft)) {
        for (const detail::WayPiece& piece : pieces) {
            const Seconds from = std::max(begin, piece.start);
            const Seconds span = std::min(begin + kTurnPiece, piece.end) - from;
            if (span > 0.0F) {
                const Vec3 its = chord.position + chord.velocity * (from - begin);
                const Vec3 own = piece.own.position + piece.own.velocity * (from - piece.start);
                out.note(first_inside(its - own, chord.velocity - piece.own.velocity, volume, span), from, Alert::low);
            }
        }
        begin += kTurnPiece;
    }
}

/// Straight on: the first instant nearest of all, if it is nearer than `wanted`; its time is below 0 else.
Nearness meets_ahead(const detail::RoutePieces& pieces, const Threat& aircraft, const Volume& clear, float wanted,
                     Meeting& out) noexcept
{
    const Volume volume{clear.radius * wanted, clear.height * wanted};
    const Volume near_mid_air = near_mid_air_of(aircraft);
    Nearness least{wanted, -1.0F};
    for (const detail::WayPiece& piece : pieces) {
        if (!(piece.span() > 0.0F)) {
            continue;
        }
        const Vec3 gap = aircraft.position_at(piece.start) - piece.own.position;
        const Vec3 closing = aircraft.velocity - piece.own.velocity;
        const Nearness near = nearest(gap, closing, clear, piece.span());
        if (near.least < least.least) {
            least = {near.least, piece.start + near.when};
        }
        out.note(first_inside(gap, closing, volume, piece.span()), piece.start, Alert::low);
        out.note(first_inside(gap, closing, near_mid_air, piece.span()), piece.start, Alert::medium);
    }
    return least;
}

Meeting meeting_with(const Situation& situation, const detail::RoutePieces& pieces, const Threat& aircraft,
                     bool gives_way) noexcept
{
    const Volume clear = well_clear_of(situation, aircraft);
    const Volume near_mid_air = near_mid_air_of(aircraft);
    const Volume larger{clear.radius * kClearAgain, clear.height * kClearAgain};
    Meeting out;
    meets_turning_on(pieces, aircraft, gives_way ? larger : clear, out);
    meets_turning(pieces, aircraft, gives_way ? larger : near_mid_air, out);
    const bool may_turn = out.loss >= 0.0F;
    const Nearness least = meets_ahead(pieces, aircraft, clear, gives_way ? kClearAgain : 1.0F, out);
    const Vec3 now = aircraft.position - situation.own.position;
    const Vec3 change = aircraft.velocity - pieces[0].own.velocity;
    const float present = nearness_at(now, change, clear, 0.0F);
    // Nearest at present, it draws apart: nothing ahead could mend that. Inside the volume it has to do so clearly; a
    // vehicle that gives way does not trust it.
    const bool leaves = nearness_at(now, change, clear, kSoon) - present >= kDrawsApart;
    if (out.loss < 0.0F || (!gives_way && !may_turn && !(least.when > 0.0F) && (present >= 1.0F || leaves))) {
        return {};
    }
    out.level = present < 1.0F ? Alert::high : out.level;
    out.level = nearness_at(now, change, near_mid_air, 0.0F) < 1.0F ? Alert::critical : out.level;
    out.closest = std::max(least.when, out.loss);
    return out;
}

}  // namespace

Alert aircraft_conflict(const Situation& situation, const Way& way, bool gives_way, WorkBudget& budget,
                        Conflict& out) noexcept
{
    const std::span<const Threat> tracks = of_kind(situation.threats, ThreatKind::track);
    const auto is_one = [&](const Threat& threat) noexcept { return is_aircraft(situation, threat); };
    if (std::none_of(tracks.begin(), tracks.end(), is_one)) {
        return Alert::none;
    }
    static_cast<void>(budget.spend(units::kConflictLook));
    const detail::RoutePieces pieces(situation, way, kAircraftAhead);
    Alert alert = Alert::none;
    for (const Threat& threat : tracks) {
        if (!is_one(threat) || (budget.spend(1) && cannot_come_near(situation, threat))) {
            continue;
        }
        const bool paid_for = budget.spend(units::kAircraftLook * static_cast<std::uint32_t>(pieces.size()));
        const Meeting meeting = paid_for ? meeting_with(situation, pieces, threat, gives_way)
                                         : Meeting{.level = Alert::low, .loss = 0.0F, .closest = 0.0F};
        const bool first = alert == Alert::none || meeting.loss < out.time_to_loss;
        alert = std::max(alert, meeting.level);
        if (meeting.level == Alert::none || !first) {
            continue;
        }
        const Volume clear = well_clear_of(situation, threat);
        out = {};
        out.threat = threat.ref;
        out.time_to_loss = meeting.loss;
        out.time_to_closest = meeting.closest;
        out.way_at_closest = pieces.way_at(out.time_to_closest);
        out.own_at_closest =
            path::point_of(way.ahead, way.origin, way.direction, std::min(out.way_at_closest, way.length)).position;
        out.threat_at_closest = threat.nearest_in_height(out.time_to_closest, out.own_at_closest.z());
        const Vec3 miss = out.threat_at_closest - out.own_at_closest;
        out.miss_distance = miss.norm();
        out.radius_at_closest = clear.radius;
        out.margin = std::max(miss.head<2>().norm() - clear.radius, std::abs(miss.z()) - clear.height);
    }
    return alert;
}

}  // namespace jink::world
