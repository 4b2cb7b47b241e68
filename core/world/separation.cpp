// SPDX-License-Identifier: BSD-3-Clause
#include "core/world/separation.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "core/base/work_units.hpp"
#include "core/geometry/convex.hpp"
#include "core/geometry/glance.hpp"
#include "core/geometry/sweep.hpp"
#include "core/world/barrel.hpp"
#include "core/world/growing_radius.hpp"
#include "core/world/obstacle_distance.hpp"
#include "core/world/separation_parts.hpp"

namespace jink::world {
namespace {

using namespace detail;
using geometry::Motion;

/// No shorter, however small the slack [s].
constexpr Seconds kLeastEscapePiece = 0.02F;
/// A growing threat is looked at in pieces no longer than this, each with the size at its end [s].
constexpr Seconds kGrowthPiece = 0.25F;
constexpr Seconds kSolidEscapePiece = 0.2F;

/// While a shrunk surface grows back it is looked at in pieces so short that it takes half the slack at most in each,
/// so that its size at their end may stand for it.
Seconds escape_piece(const EscapeRule& escape) noexcept
{
    return escape.speed > 0.0F ? std::max(kLeastEscapePiece, 0.5F * escape.slack / escape.speed)
                               : std::numeric_limits<Seconds>::infinity();
}

int parts_of(Seconds duration, Seconds longest) noexcept
{
    return std::max(1, static_cast<int>(std::ceil(duration / longest)));
}

/// Whether a sphere of `radius` that goes from `from` to `to`, seen from the own box, certainly stays farther off than
/// `margin`.
bool stays_beyond(float margin, const Vec3& half, const Vec3& from, const Vec3& to, float radius) noexcept
{
    const float reach = margin + radius;
    return reach < 0.0F || geometry::glance(half, from, to, reach) == geometry::Glance::apart;
}

/// A sphere in straight motion, as large as `radius_at` says at an instant.
template <class RadiusAt>
// NOLINTNEXTLINE(readability-function-cognitive-complexity): three nested loops, each of them paid for where it begins
void against_ball(const Flight& flight, const Vec3& half, const Motion& ball, bool grows, const RadiusAt& radius_at,
                  ThreatRef ref, const EscapeRule& escape, WorkBudget& budget, Separation& best) noexcept
{
    if (!paid(budget, units::kThreat + flight.chunks().size() * units::kThreatChunk, best, 0.0F, ref)) {
        return;
    }
    const float start_margin = geometry::box_distance(half, ball.position - flight.begin()) - radius_at(0.0F);
    const float shrunk = start_margin < 0.0F ? escape.slack - start_margin : 0.0F;
    const Seconds growth_piece = grows ? kGrowthPiece : std::numeric_limits<Seconds>::infinity();
    for (const Bounds& chunk : flight.chunks()) {
        const Vec3 a = ball.position + ball.velocity * chunk.start;
        const Vec3 b = ball.position + ball.velocity * chunk.end;
        const float bound = boxes_apart(chunk.low - half, chunk.high + half, a.cwiseMin(b), a.cwiseMax(b)) -
                            radius_at(chunk.end) - chunk.sagitta;
        if (bound >= best.margin) {
            continue;
        }
        if (!paid(budget, (chunk.last - chunk.first) * units::kThreatPiece, best, chunk.start, ref)) {
            return;
        }
        for (std::size_t i = chunk.first; i < chunk.last; ++i) {
            const Piece p = flight.piece(i);
            const Seconds end = p.start + p.duration;
            const Vec3 from = ball.position + ball.velocity * p.start - p.from;
            const Vec3 along = ball.velocity - p.velocity;
            // The surface is largest at the end of the piece: growth adds to it, and what was shrunk has grown back.
            if (stays_beyond(best.margin, half, from, from + along * p.duration,
                             radius_at(end) + p.sagitta.any - shrink_at(shrunk, escape, end))) {
                continue;
            }
            const bool escapes = shrink_at(shrunk, escape, p.start) > 0.0F;
            const int parts =
                parts_of(p.duration, escapes ? std::min(growth_piece, escape_piece(escape)) : growth_piece);
            const Seconds length = p.duration / static_cast<float>(parts);
            for (int part = 0; part < parts; ++part) {
                const Seconds offset = length * static_cast<float>(part);
                const Seconds start = p.start + offset;
                if (!paid(budget, units::kBallPart, best, start, ref)) {
                    return;
                }
                const Motion own{p.from + p.velocity * offset, p.velocity};
                const Motion other{ball.position + ball.velocity * start, ball.velocity};
                const float radius =
                    radius_at(start + length) + p.sagitta.any - shrink_at(shrunk, escape, start + length);
                if (parts > 1 &&
                    stays_beyond(best.margin, half, from + along * offset, from + along * (offset + length), radius)) {
                    continue;
                }
                const geometry::Approach near = geometry::least_distance(half, own, other, length);
                consider(best, near.distance - radius, start + near.when, ref);
            }
        }
    }
}

void against_track(const Situation& situation, const Flight& flight, std::size_t index, const EscapeRule& escape,
                   WorkBudget& budget, Separation& best) noexcept
{
    const Track& track = situation.tracks[index];
    const bool grows = track.sigma_velocity > 0.0F || track.max_acceleration > 0.0F;
    const GrowingRadius radius_at(situation, track);
    against_ball(flight, box_against(situation, track), {track.position, track.velocity}, grows, radius_at,
                 {ThreatKind::track, static_cast<std::uint16_t>(index)}, escape, budget, best);
}

/// Margins of solids are told apart no finer than kObstacleResolution, and one query costs hundreds of support calls:
/// the shrunk surface clears the start by that much more, and grows back in coarser pieces.
// NOLINTNEXTLINE(readability-function-cognitive-complexity): as above
void against_solid(const Situation& situation, const Flight& flight, const geometry::Shape& shape, float extra,
                   ThreatRef ref, const EscapeRule& escape, WorkBudget& budget, Separation& best) noexcept
{
    if (!paid(budget, units::kThreat + flight.chunks().size() * units::kThreatChunk, best, 0.0F, ref)) {
        return;
    }
    const Vec3& half = situation.limits.half_extents;
    const float reach = geometry::bounding_radius(shape);
    float shrunk = -1.0F;  // found when the first piece near the obstacle is met
    const auto shrunk_at_start = [&] {
        const Vec3& begin = flight.begin();
        const float start = obstacle_margin(half, begin, begin, shape, budget, extra);
        const float slack = escape.slack + kObstacleResolution + escape.speed * kSolidEscapePiece;
        return start < 0.0F ? slack - start : 0.0F;
    };
    for (const Bounds& chunk : flight.chunks()) {
        const float bound = boxes_apart(chunk.low - half, chunk.high + half, shape.centre, shape.centre) - reach -
                            extra - chunk.sagitta;
        if (bound >= best.margin) {
            continue;
        }
        if (!paid(budget, (chunk.last - chunk.first) * units::kThreatPiece, best, chunk.start, ref)) {
            return;
        }
        for (std::size_t i = chunk.first; i < chunk.last; ++i) {
            const Piece p = flight.piece(i);
            const Vec3 to_centre = shape.centre - p.from;
            const float grown = extra + p.sagitta.any;
            if (stays_beyond(best.margin, half, to_centre, to_centre - p.velocity * p.duration, reach + grown)) {
                continue;
            }
            if (shrunk < 0.0F) {
                shrunk = shrunk_at_start();
            }
            const bool escapes = shrink_at(shrunk, escape, p.start) > 0.0F;
            const int parts = escapes ? parts_of(p.duration, kSolidEscapePiece) : 1;
            const Seconds length = p.duration / static_cast<float>(parts);
            for (int part = 0; part < parts; ++part) {
                const Seconds offset = length * static_cast<float>(part);
                const Seconds start = p.start + offset;
                const Vec3 from = p.from + p.velocity * offset;
                const float margin = obstacle_margin(half, from, from + p.velocity * length, shape, budget, grown);
                if (budget.exhausted()) {
                    consider(best, -kSeparationCap, start, ref);
                    return;
                }
                consider(best, margin + shrink_at(shrunk, escape, start + length), start, ref);
            }
        }
    }
}

void against_obstacle(const Situation& situation, const Flight& flight, std::size_t index, const EscapeRule& escape,
                      WorkBudget& budget, Separation& best) noexcept
{
    const geometry::Shape& shape = situation.obstacles[index].shape;
    const float extra = situation.k_sigma * situation.own.sigma_position;
    const ThreatRef ref{ThreatKind::obstacle, static_cast<std::uint16_t>(index)};
    Vec3 half;
    float radius = 0.0F;
    if (as_sphere(shape, situation.limits.half_extents, half, radius)) {
        against_ball(
            flight, half, {shape.centre, Vec3::Zero()}, false, [&](Seconds) { return radius + extra; }, ref, escape,
            budget, best);
    } else {
        against_solid(situation, flight, shape, extra, ref, escape, budget, best);
    }
}

/// Calls `judge(margin of a position, kind)` for each bound that is set. Bounds are kept like obstacles: the own
/// position is known no better towards them.
template <class Judge>
void for_each_bound(const Situation& situation, const Judge& judge) noexcept
{
    const Airspace& air = situation.airspace;
    const Vec3& half = situation.limits.half_extents;
    const float extra = situation.k_sigma * situation.own.sigma_position;
    const float height = half.z() + extra;
    if (air.has_floor) {
        judge([&](const Vec3& p) { return p.z() - height - air.floor; }, ThreatKind::floor);
    }
    if (air.has_ceiling) {
        judge([&](const Vec3& p) { return air.ceiling - p.z() - height; }, ThreatKind::ceiling);
    }
    if (air.has_keep_in) {
        const float corner = half.head<2>().norm() + extra;
        judge([&](const Vec3& p) { return air.keep_in_radius - (p - air.home).head<2>().norm() - corner; },
              ThreatKind::keep_in);
    }
}

/// Airspace bounds are convex sets: the least margin of a straight piece lies at one of its ends, or where a surface
/// that the escape rule has shrunk is back at its size.
void against_airspace(const Situation& situation, const Flight& flight, const EscapeRule& escape,
                      Separation& best) noexcept
{
    for_each_bound(situation, [&](const auto& margin_of, ThreatKind kind) {
        const float start = margin_of(flight.begin());
        const float shrunk = start < 0.0F ? escape.slack - start : 0.0F;
        const Seconds whole = escape.speed > 0.0F ? shrunk / escape.speed : 0.0F;
        for (std::size_t i = 0; i < flight.size(); ++i) {
            const Piece p = flight.piece(i);
            const float sagitta = kind == ThreatKind::keep_in ? p.sagitta.any : p.sagitta.vertical;
            const auto judge = [&](Seconds t) {
                const float margin = margin_of(p.from + p.velocity * (t - p.start)) - sagitta;
                consider(best, margin + shrink_at(shrunk, escape, t), t, {kind, 0});
            };
            judge(p.start);
            judge(p.start + p.duration);
            if (whole > p.start && whole < p.start + p.duration) {
                judge(whole);
            }
        }
    });
}

Separation separation_of(const Situation& situation, std::span<const path::PathPoint> points,
                         std::span<const path::Sagitta> sagittas, Seconds horizon, WorkBudget& budget,
                         const EscapeRule& escape, const Cutoff& cutoff) noexcept
{
    Separation best{cutoff.above, 0.0F, {}};
    if (points.empty()) {
        return best;
    }
    const Airspace& air = situation.airspace;
    const std::size_t bounds = (air.has_floor ? 1U : 0U) + (air.has_ceiling ? 1U : 0U) + (air.has_keep_in ? 1U : 0U);
    constexpr std::size_t kLook = 1;
    if (!paid(budget, kLook + points.size() * (units::kPathPiece + bounds * units::kBoundPiece), best, 0.0F, {})) {
        return best;
    }
    const Flight flight(points, sagittas, horizon);
    // What is looked at of those that share the reaction.
    std::optional<Flight> shared;
    if (situation.shared_horizon < horizon) {
        shared.emplace(points, sagittas, situation.shared_horizon);
    }
    const auto flight_for = [&](std::size_t index) noexcept -> const Flight& {
        return shared && situation.tracks[index].cooperative ? *shared : flight;
    };
    against_airspace(situation, flight, escape, best);
    const bool track_first = cutoff.first.kind == ThreatKind::track && cutoff.first.index < situation.tracks.size();
    if (track_first) {
        against_track(situation, flight_for(cutoff.first.index), cutoff.first.index, escape, budget, best);
    }
    for (std::size_t i = 0; i < situation.tracks.size() && best.margin >= cutoff.below; ++i) {
        if (!track_first || i != cutoff.first.index) {
            against_track(situation, flight_for(i), i, escape, budget, best);
        }
    }
    for (std::size_t i = 0; i < air.barrels.size() && best.margin >= cutoff.below; ++i) {
        against_barrel(situation, flight, i, escape, budget, best);
    }
    for (std::size_t i = 0; i < situation.obstacles.size() && best.margin >= cutoff.below; ++i) {
        against_obstacle(situation, flight, i, escape, budget, best);
    }
    return best;
}

}  // namespace

Separation least_separation(const Situation& situation, std::span<const path::PathPoint> points, Seconds horizon,
                            WorkBudget& budget, const EscapeRule& escape, const Cutoff& cutoff) noexcept
{
    return separation_of(situation, points, {}, horizon, budget, escape, cutoff);
}

Separation least_separation(const Situation& situation, const path::Prediction& flight, Seconds horizon,
                            WorkBudget& budget, const EscapeRule& escape, const Cutoff& cutoff) noexcept
{
    return separation_of(situation, {flight.path.points.data(), flight.path.points.size()},
                         {flight.sagittas.data(), flight.sagittas.size()}, horizon, budget, escape, cutoff);
}

Separation separation_at(const Situation& situation, const Vec3& position, Seconds t, WorkBudget& budget) noexcept
{
    Separation best;
    const Vec3& half = situation.limits.half_extents;
    for (std::size_t i = 0; i < situation.tracks.size(); ++i) {
        const Track& track = situation.tracks[i];
        const ThreatRef ref{ThreatKind::track, static_cast<std::uint16_t>(i)};
        if (!paid(budget, units::kThreat, best, t, ref)) {
            return best;
        }
        const Vec3 centre = track.position + track.velocity * t;
        consider(best,
                 geometry::box_distance(box_against(situation, track), centre - position) -
                     threat_radius(situation, track, t),
                 t, ref);
    }
    for (std::size_t i = 0; i < situation.obstacles.size(); ++i) {
        const geometry::Shape& shape = situation.obstacles[i].shape;
        const ThreatRef ref{ThreatKind::obstacle, static_cast<std::uint16_t>(i)};
        if (!paid(budget, units::kThreat, best, t, ref)) {
            return best;
        }
        const float extra = situation.k_sigma * situation.own.sigma_position;
        const float near = (position - shape.centre).norm() - geometry::bounding_radius(shape) - half.norm() - extra;
        if (!(near >= best.margin)) {  // also where a number is not finite
            consider(best, obstacle_margin(half, position, position, shape, budget, extra), t, ref);
        }
    }
    for (std::size_t i = 0; i < situation.airspace.barrels.size(); ++i) {
        const ThreatRef ref{ThreatKind::barrel, static_cast<std::uint16_t>(i)};
        if (!paid(budget, units::kThreat, best, t, ref)) {
            return best;
        }
        const float extra = situation.k_sigma * situation.own.sigma_position;
        consider(best, barrel_distance(half, position, situation.airspace.barrels[i], t) - extra, t, ref);
    }
    for_each_bound(situation, [&](const auto& margin_of, ThreatKind kind) {
        consider(best, margin_of(position), t, {kind, 0});
    });
    return best;
}

}  // namespace jink::world
