// SPDX-License-Identifier: BSD-3-Clause
#include "core/world/conflict.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/base/work_units.hpp"
#include "core/geometry/convex.hpp"
#include "core/geometry/sweep.hpp"
#include "core/world/obstacle_distance.hpp"

namespace jink::world {
namespace {

using geometry::Motion;

/// Pieces in which a growing threat is compared with its size at the piece's end [s].
constexpr Seconds kPiece = 0.5F;
/// Cross-track error up to which the vehicle counts as being on the leg [m].
constexpr float kOnLeg = 0.25F;
/// Pieces that one track is looked at in, inside a margin: 60 s of them at a quarter of a second, twice. Spent is a
/// conflict.
constexpr std::uint32_t kDrawingApartBudget = 480 * units::kBallPart;
/// Largest R handed on for shapes whose extent is not a radius: the source studied threats up to 3 m (Pinheiro
/// tab. 4.1).
constexpr float kLargestRadius = 3.0F;

/// The way in time: flown until its end, then hovering there.
struct Phase {
    Motion own;  ///< position at `start`
    Seconds start;
    Seconds end;
};

std::array<Phase, 2> phases_of(const Way& way, Seconds lookahead) noexcept
{
    const Seconds arrival = way.speed > 0.0F ? std::min(way.length / way.speed, lookahead) : 0.0F;
    const Vec3 velocity = way.direction * way.speed;
    const Vec3 end = way.origin + velocity * arrival;
    return {Phase{{way.origin, velocity}, 0.0F, arrival}, Phase{{end, Vec3::Zero()}, arrival, lookahead}};
}

Vec3 way_position(const Way& way, Seconds t) noexcept
{
    return way.origin + way.direction * std::min(way.speed * std::max(t, 0.0F), way.length);
}

/// Closest approach of the two centres over both phases.
Seconds closest_time(const std::array<Phase, 2>& phases, const Track& track) noexcept
{
    Seconds best_time = 0.0F;
    float best = (track.position - phases[0].own.position).squaredNorm();
    for (const Phase& phase : phases) {
        const Vec3 gap = track.position + track.velocity * phase.start - phase.own.position;
        const Vec3 closing = track.velocity - phase.own.velocity;
        const float speed2 = closing.squaredNorm();
        const Seconds t = speed2 > 1e-9F ? std::clamp(-gap.dot(closing) / speed2, 0.0F, phase.end - phase.start) : 0.0F;
        const float distance = (gap + closing * t).squaredNorm();
        if (distance < best) {
            best = distance;
            best_time = phase.start + t;
        }
    }
    return best_time;
}

/// First loss of separation within one phase; negative when there is none, 0 when the budget ran out.
Seconds loss_within(const Situation& situation, const Phase& phase, const Track& track, WorkBudget& budget) noexcept
{
    const Vec3& half = situation.limits.half_extents;
    const Seconds span = phase.end - phase.start;
    const Motion threat{track.position + track.velocity * phase.start, track.velocity};
    if (span <= 0.0F ||
        !geometry::contact_interval(half, phase.own, threat, threat_radius(situation, track, phase.end), span)) {
        return -1.0F;
    }
    const bool grows = track.sigma_velocity > 0.0F || track.max_acceleration > 0.0F;
    const int pieces = grows ? static_cast<int>(std::ceil(span / kPiece)) : 1;
    const Seconds piece = span / static_cast<float>(pieces);
    for (int i = 0; i < pieces; ++i) {
        if (!budget.spend(units::kConflictPart)) {
            return 0.0F;
        }
        const Seconds t = piece * static_cast<float>(i);
        const Motion own{phase.own.position + phase.own.velocity * t, phase.own.velocity};
        const Motion other{threat.position + threat.velocity * t, threat.velocity};
        const float radius = threat_radius(situation, track, phase.start + t + piece);
        if (const auto touch = geometry::contact_interval(half, own, other, radius, piece)) {
            return phase.start + t + touch->first;
        }
    }
    return -1.0F;
}

/// The way as a path: flown to its end, and hovered there until `until` where `hovers`.
path::TimedPath path_of(const std::array<Phase, 2>& phases, bool hovers) noexcept
{
    path::TimedPath path;
    for (const Phase& phase : phases) {
        if (phase.end > phase.start) {
            path.points.unchecked_push_back({phase.own.position, phase.own.velocity, phase.start});
        }
        if (!hovers) {
            break;
        }
    }
    const Phase& last = phases[hovers ? 1 : 0];
    const Vec3 velocity = path.points.empty() ? Vec3(Vec3::Zero()) : path.points.back().velocity;
    const Seconds span = last.end - last.start;
    path.points.unchecked_push_back({last.own.position + last.own.velocity * span, velocity, last.end});
    return path;
}

/// A way that starts inside a margin and draws apart from this one threat for good. Nothing on it could mend the start.
bool draws_apart(const Situation& situation, std::span<const Track> tracks, std::span<const Obstacle> obstacles,
                 const path::TimedPath& path, WorkBudget& budget) noexcept
{
    const Airspace open;
    const Situation alone{
        situation.now, situation.own, situation.limits, situation.airframe, situation.reference, tracks,
        obstacles,     open,          nullptr,          situation.k_sigma};
    const Cutoff sign_alone{0.0F, 0.0F, {}};
    return least_separation(alone, path, path.duration(), budget, kDrawingApart, sign_alone).margin >= 0.0F;
}

/// What could not be looked at to the end is met now. True.
bool met_now(const Conflict& conflict, Conflict& out) noexcept
{
    out = conflict;
    out.time_to_loss = 0.0F;
    out.margin = -kSeparationCap;
    return true;
}

bool sphere_like_conflict(const Situation& situation, const Way& way, const geometry::Shape& shape, const Vec3& half,
                          float radius, Seconds lookahead, WorkBudget& budget, Conflict& out) noexcept
{
    if (!budget.spend(units::kConflictBall)) {
        return met_now({}, out);
    }
    const Phase phase = phases_of(way, lookahead)[0];
    const Motion still{shape.centre, Vec3::Zero()};
    const float grown = radius + situation.k_sigma * situation.own.sigma_position;
    if (phase.end <= 0.0F) {
        return false;
    }
    const auto touch = geometry::contact_interval(half, phase.own, still, grown, phase.end);
    if (!touch) {
        return false;
    }
    if (!budget.spend(units::kConflictMet)) {
        return met_now({}, out);
    }
    const geometry::Approach near = geometry::least_distance(half, phase.own, still, phase.end);
    out.time_to_loss = touch->first;
    out.margin = near.distance - grown;
    out.radius_at_closest = grown;
    return true;
}

bool general_conflict(const Situation& situation, const Way& way, const geometry::Shape& shape, Seconds lookahead,
                      WorkBudget& budget, Conflict& out) noexcept
{
    if (!budget.spend(units::kConflictSolid)) {
        return met_now({}, out);
    }
    const Vec3& half = situation.limits.half_extents;
    const float extra = situation.k_sigma * situation.own.sigma_position;
    const Vec3 end = way_position(way, lookahead);
    if (geometry::swept_box_contact(half, way.origin, end, shape, extra, budget) == geometry::Contact::clear) {
        return false;
    }
    float clear = 0.0F;
    float touching = 1.0F;
    for (int i = 0; i < 8; ++i) {
        const float middle = 0.5F * (clear + touching);
        const bool is_clear = geometry::swept_box_contact(half, way.origin, way.origin + (end - way.origin) * middle,
                                                          shape, extra, budget) == geometry::Contact::clear;
        (is_clear ? clear : touching) = middle;
    }
    const float length = (end - way.origin).norm();
    out.time_to_loss = way.speed > 0.0F ? clear * length / way.speed : 0.0F;
    out.margin = obstacle_margin(half, way.origin, end, shape, budget, extra);
    out.radius_at_closest = std::min(geometry::bounding_radius(shape), kLargestRadius) + extra;
    return true;
}

bool obstacle_conflict(const Situation& situation, const Way& way, std::size_t index, Seconds lookahead,
                       WorkBudget& budget, Conflict& out) noexcept
{
    const geometry::Shape& shape = situation.obstacles[index].shape;
    Vec3 half;
    float radius = 0.0F;
    const bool found = as_sphere(shape, situation.limits.half_extents, half, radius)
                           ? sphere_like_conflict(situation, way, shape, half, radius, lookahead, budget, out)
                           : general_conflict(situation, way, shape, lookahead, budget, out);
    if (!found) {
        return false;
    }
    const float along = std::clamp((shape.centre - way.origin).dot(way.direction), 0.0F, way.length);
    out.threat = {ThreatKind::obstacle, static_cast<std::uint16_t>(index)};
    out.time_to_closest = way.speed > 0.0F ? std::max(along / way.speed, out.time_to_loss) : 0.0F;
    out.own_at_closest = way_position(way, out.time_to_closest);
    out.threat_at_closest = shape.centre;
    out.miss_distance = (shape.centre - out.own_at_closest).norm();
    if (out.time_to_loss > 0.0F) {
        return true;
    }
    const path::TimedPath path = path_of(phases_of(way, lookahead), false);
    return !draws_apart(situation, {}, situation.obstacles.subspan(index, 1), path, budget);
}

bool comes_first(const Conflict& a, const Conflict& b) noexcept
{
    if (a.time_to_loss != b.time_to_loss) {
        return a.time_to_loss < b.time_to_loss;
    }
    return a.margin < b.margin;
}

}  // namespace

Way way_of(const Situation& situation) noexcept
{
    const Leg& leg = situation.reference.leg;
    const Vec3& own = situation.own.position;
    const Vec3 span = leg.end - leg.start;
    const float length = span.norm();
    const Vec3 forward = length > 1e-3F ? Vec3(span / length) : Vec3::UnitX();
    const float along = std::clamp((own - leg.start).dot(forward), 0.0F, length);
    const float off = (own - (leg.start + forward * along)).norm();

    Way way;
    way.origin = own;
    const Vec3 aim = off <= kOnLeg ? leg.end : Vec3(leg.start + forward * std::min(along + kRejoinLookahead, length));
    const Vec3 to_aim = aim - own;
    const float distance = to_aim.norm();
    way.direction = distance > 1e-3F ? Vec3(to_aim / distance) : forward;
    way.length = distance > 1e-3F ? distance + (leg.end - aim).norm() : 0.0F;
    way.speed = vehicle::clamped_velocity(way.direction, leg.speed, situation.limits).norm();
    return way;
}

bool predict_conflict(const Situation& situation, const Way& way, std::size_t track_index, Seconds lookahead,
                      WorkBudget& budget, Conflict& out) noexcept
{
    const Track& track = situation.tracks[track_index];
    const std::array<Phase, 2> phases = phases_of(way, lookahead);
    Seconds loss = budget.spend(units::kConflict) ? loss_within(situation, phases[0], track, budget) : 0.0F;
    if (loss < 0.0F) {
        loss = loss_within(situation, phases[1], track, budget);
    }
    if (loss < 0.0F) {
        return false;
    }
    const Seconds closest = closest_time(phases, track);
    if (loss <= 0.0F) {
        WorkBudget apart(std::min(kDrawingApartBudget, budget.left()));
        const bool leaves =
            draws_apart(situation, situation.tracks.subspan(track_index, 1), {}, path_of(phases, true), apart);
        static_cast<void>(budget.spend(apart.spent()));  // never more than was left
        if (leaves) {
            return false;
        }
    }
    out.threat = {ThreatKind::track, static_cast<std::uint16_t>(track_index)};
    out.time_to_loss = loss;
    out.time_to_closest = std::max(closest, loss);
    out.own_at_closest = way_position(way, out.time_to_closest);
    out.threat_at_closest = track.position + track.velocity * out.time_to_closest;
    out.miss_distance = (out.threat_at_closest - out.own_at_closest).norm();
    out.radius_at_closest = threat_radius(situation, track, out.time_to_closest);
    out.margin = geometry::box_distance(situation.limits.half_extents, out.threat_at_closest - out.own_at_closest) -
                 out.radius_at_closest;
    return true;
}

bool main_conflict(const Situation& situation, const Way& way, Seconds lookahead, WorkBudget& budget,
                   Conflict& out) noexcept
{
    bool found = false;
    const auto consider = [&](const Conflict& conflict) {
        if (!found || comes_first(conflict, out)) {
            out = conflict;
            found = true;
        }
    };
    Conflict conflict;
    for (std::size_t i = 0; i < situation.tracks.size(); ++i) {
        if (predict_conflict(situation, way, i, lookahead, budget, conflict)) {
            consider(conflict);
        }
        if (budget.exhausted()) {
            return met_now(conflict, out);
        }
    }
    for (std::size_t i = 0; i < situation.obstacles.size(); ++i) {
        if (obstacle_conflict(situation, way, i, lookahead, budget, conflict)) {
            consider(conflict);
        }
        if (budget.exhausted()) {
            return met_now(conflict, out);
        }
    }
    return found;
}

}  // namespace jink::world
