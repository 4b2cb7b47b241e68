// SPDX-License-Identifier: BSD-3-Clause
#include "core/world/separation.hpp"

#include <algorithm>
#include <cmath>

#include "core/geometry/convex.hpp"
#include "core/geometry/sweep.hpp"
#include "core/world/obstacle_distance.hpp"

namespace jink::world {
namespace {

using geometry::Motion;

/// Segments that share one bounding box when far threats are passed over.
constexpr std::size_t kChunk = 8;
constexpr std::size_t kMaxChunks = (kMaxPathPoints + kChunk - 1) / kChunk;
/// A growing threat is looked at in pieces no longer than this, each with the size at its end [s].
constexpr Seconds kGrowthPiece = 0.25F;

struct Piece {
    Vec3 from;
    Vec3 velocity;
    Seconds start;
    Seconds duration;
};

struct Bounds {
    Vec3 low;
    Vec3 high;
    Seconds start;
    Seconds end;
    std::size_t first;
    std::size_t last;  ///< one past the last piece
};

struct Flight {
    StaticVector<Piece, kMaxPathPoints> pieces;
    StaticVector<Bounds, kMaxChunks + 1> chunks;
};

void cut_into_pieces(const path::TimedPath& path, Seconds horizon, Flight& flight) noexcept
{
    const auto& points = path.points;
    for (std::size_t i = 0; i + 1 < points.size() && points[i].time < horizon; ++i) {
        const Seconds end = std::min(points[i + 1].time, horizon);
        flight.pieces.unchecked_push_back(
            {points[i].position, points[i].velocity, points[i].time, end - points[i].time});
    }
    if (flight.pieces.empty() && !points.empty()) {
        flight.pieces.unchecked_push_back({points.front().position, Vec3::Zero(), 0.0F, 0.0F});
    }
    for (std::size_t first = 0; first < flight.pieces.size(); first += kChunk) {
        const std::size_t last = std::min(first + kChunk, flight.pieces.size());
        Bounds b{flight.pieces[first].from, flight.pieces[first].from, flight.pieces[first].start, 0.0F, first, last};
        for (std::size_t i = first; i < last; ++i) {
            const Piece& p = flight.pieces[i];
            const Vec3 to = p.from + p.velocity * p.duration;
            b.low = b.low.cwiseMin(p.from).cwiseMin(to);
            b.high = b.high.cwiseMax(p.from).cwiseMax(to);
            b.end = p.start + p.duration;
        }
        flight.chunks.unchecked_push_back(b);
    }
}

/// Distance between two boxes given by their corners.
float box_distance(const Vec3& low_a, const Vec3& high_a, const Vec3& low_b, const Vec3& high_b) noexcept
{
    return (low_a - high_b).cwiseMax(low_b - high_a).cwiseMax(0.0F).norm();
}

float shrink_at(float initial, const EscapeRule& escape, Seconds t) noexcept
{
    return initial > 0.0F ? std::max(0.0F, initial - escape.speed * t) : 0.0F;
}

void consider(Separation& best, float margin, Seconds when, ThreatKind kind, std::size_t index) noexcept
{
    if (margin < best.margin) {
        best = {margin, when, {kind, static_cast<std::uint16_t>(index)}};
    }
}

void against_track(const Situation& situation, const Flight& flight, std::size_t index, const EscapeRule& escape,
                   WorkBudget& budget, Separation& best) noexcept
{
    const Track& track = situation.tracks[index];
    const Vec3& half = situation.limits.half_extents;
    const Motion threat{track.position, track.velocity};
    const Piece& first = flight.pieces.front();
    const float start_margin =
        geometry::least_distance(half, {first.from, Vec3::Zero()}, {track.position, Vec3::Zero()}, 0.0F).distance -
        threat_radius(situation, track, 0.0F);
    const float shrunk = start_margin < 0.0F ? escape.slack - start_margin : 0.0F;
    const bool grows = track.sigma_velocity > 0.0F || track.max_acceleration > 0.0F;

    for (const Bounds& chunk : flight.chunks) {
        const Vec3 a = threat.position + threat.velocity * chunk.start;
        const Vec3 b = threat.position + threat.velocity * chunk.end;
        const float bound = box_distance(chunk.low - half, chunk.high + half, a.cwiseMin(b), a.cwiseMax(b)) -
                            threat_radius(situation, track, chunk.end);
        if (bound >= best.margin) {
            continue;
        }
        for (std::size_t i = chunk.first; i < chunk.last; ++i) {
            const Piece& p = flight.pieces[i];
            const int parts = grows ? std::max(1, static_cast<int>(std::ceil(p.duration / kGrowthPiece))) : 1;
            const Seconds length = p.duration / static_cast<float>(parts);
            for (int part = 0; part < parts; ++part) {
                const Seconds offset = length * static_cast<float>(part);
                const Seconds start = p.start + offset;
                if (!budget.spend()) {
                    consider(best, -kSeparationCap, start, ThreatKind::track, index);
                    return;
                }
                const Motion own{p.from + p.velocity * offset, p.velocity};
                const Motion other{threat.position + threat.velocity * start, threat.velocity};
                const geometry::Approach near = geometry::least_distance(half, own, other, length);
                const float radius = threat_radius(situation, track, start + length) - shrink_at(shrunk, escape, start);
                consider(best, near.distance - radius, start + near.when, ThreatKind::track, index);
            }
        }
    }
}

void against_obstacle(const Situation& situation, const Flight& flight, std::size_t index, const EscapeRule& escape,
                      WorkBudget& budget, Separation& best) noexcept
{
    const geometry::Shape& shape = situation.obstacles[index].shape;
    const Vec3& half = situation.limits.half_extents;
    const float extra = situation.k_sigma * situation.own.sigma_position;
    const float reach = geometry::bounding_radius(shape);
    float shrunk = -1.0F;  // found when the first piece near the obstacle is met

    for (const Bounds& chunk : flight.chunks) {
        const float bound =
            box_distance(chunk.low - half, chunk.high + half, shape.centre, shape.centre) - reach - extra;
        if (bound >= best.margin) {
            continue;
        }
        if (shrunk < 0.0F) {
            const float start =
                obstacle_margin(half, flight.pieces.front().from, flight.pieces.front().from, shape, budget) - extra;
            shrunk = start < 0.0F ? escape.slack - start : 0.0F;
        }
        for (std::size_t i = chunk.first; i < chunk.last; ++i) {
            const Piece& p = flight.pieces[i];
            const float margin = obstacle_margin(half, p.from, p.from + p.velocity * p.duration, shape, budget) -
                                 extra + shrink_at(shrunk, escape, p.start);
            consider(best, margin, p.start, ThreatKind::obstacle, index);
        }
    }
}

/// Airspace bounds are convex sets: the least margin of a straight piece lies at one of its ends.
void against_airspace(const Situation& situation, const Flight& flight, const EscapeRule& escape,
                      Separation& best) noexcept
{
    const Airspace& air = situation.airspace;
    const Vec3& half = situation.limits.half_extents;
    const float corner = std::hypot(half.x(), half.y());
    const auto floor_margin = [&](const Vec3& p) { return p.z() - half.z() - air.floor; };
    const auto ceiling_margin = [&](const Vec3& p) { return air.ceiling - p.z() - half.z(); };
    const auto keep_in_margin = [&](const Vec3& p) {
        return air.keep_in_radius - std::hypot(p.x() - air.home.x(), p.y() - air.home.y()) - corner;
    };
    const auto check = [&](bool active, const auto& margin_of, ThreatKind kind) {
        if (!active) {
            return;
        }
        const float start = margin_of(flight.pieces.front().from);
        const float shrunk = start < 0.0F ? escape.slack - start : 0.0F;
        for (const Piece& p : flight.pieces) {
            const Seconds end = p.start + p.duration;
            consider(best, margin_of(p.from) + shrink_at(shrunk, escape, p.start), p.start, kind, 0);
            consider(best, margin_of(p.from + p.velocity * p.duration) + shrink_at(shrunk, escape, end), end, kind, 0);
        }
    };
    check(air.has_floor, floor_margin, ThreatKind::floor);
    check(air.has_ceiling, ceiling_margin, ThreatKind::ceiling);
    check(air.has_keep_in, keep_in_margin, ThreatKind::keep_in);
}

}  // namespace

float threat_radius(const Situation& situation, const Track& track, Seconds t) noexcept
{
    const Seconds age = std::max(0.0F, (situation.now - track.stamp) + t);
    return track.radius +
           situation.k_sigma * (situation.own.sigma_position + track.sigma_position + track.sigma_velocity * age) +
           0.5F * track.max_acceleration * age * age;
}

Separation least_separation(const Situation& situation, const path::TimedPath& path, Seconds horizon,
                            WorkBudget& budget, const EscapeRule& escape) noexcept
{
    Separation best;
    if (path.points.empty()) {
        return best;
    }
    Flight flight;
    cut_into_pieces(path, horizon, flight);
    against_airspace(situation, flight, escape, best);
    for (std::size_t i = 0; i < situation.tracks.size(); ++i) {
        against_track(situation, flight, i, escape, budget, best);
    }
    for (std::size_t i = 0; i < situation.obstacles.size(); ++i) {
        against_obstacle(situation, flight, i, escape, budget, best);
    }
    return best;
}

Separation separation_at(const Situation& situation, const Vec3& position, Seconds t, WorkBudget& budget) noexcept
{
    Separation best;
    const Vec3& half = situation.limits.half_extents;
    for (std::size_t i = 0; i < situation.tracks.size(); ++i) {
        const Track& track = situation.tracks[i];
        const Vec3 centre = track.position + track.velocity * t;
        const float distance =
            geometry::least_distance(half, {position, Vec3::Zero()}, {centre, Vec3::Zero()}, 0.0F).distance;
        consider(best, distance - threat_radius(situation, track, t), t, ThreatKind::track, i);
    }
    for (std::size_t i = 0; i < situation.obstacles.size(); ++i) {
        const geometry::Shape& shape = situation.obstacles[i].shape;
        const float extra = situation.k_sigma * situation.own.sigma_position;
        const float near = (position - shape.centre).norm() - geometry::bounding_radius(shape) - half.norm() - extra;
        if (near < best.margin) {
            consider(best, obstacle_margin(half, position, position, shape, budget) - extra, t, ThreatKind::obstacle,
                     i);
        }
    }
    Flight flight;
    flight.pieces.unchecked_push_back({position, Vec3::Zero(), t, 0.0F});
    // No escape here: a speed and slack of zero leave the plain margin.
    against_airspace(situation, flight, {0.0F, 0.0F}, best);
    return best;
}

}  // namespace jink::world
