// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "core/base/work_units.hpp"
#include "core/geometry/sweep.hpp"
#include "core/world/barrel.hpp"
#include "core/world/conflict.hpp"

// What the search for conflicts does for a straight way and for one along a route. Private to this room.

namespace jink::world::detail {

/// Pieces in which a growing threat is compared with its size at the piece's end [s].
inline constexpr Seconds kPiece = 0.5F;
/// Pieces that one track is looked at in, inside a margin: 60 s of them at a quarter of a second, twice. Spent is a
/// conflict.
inline constexpr std::uint32_t kDrawingApartBudget = 480 * units::kBallPart;
/// The way in time: flown until its end, then hovering there.
struct Phase {
    geometry::Motion own;  ///< position at `start`
    Seconds start = 0.0F;
    Seconds end = 0.0F;
};

/// Flown to its end, then hovering there.
struct Phases : std::array<Phase, 2> {
    static constexpr std::size_t kMost = 2;
};

/// Closest approach of the two centres over all phases.
template <class Parts>
Seconds closest_time(const Parts& phases, const Threat& threat) noexcept
{
    Seconds best_time = 0.0F;
    float best = (threat.position - phases[0].own.position).squaredNorm();
    for (const auto& phase : phases) {
        const Vec3 gap = threat.position + threat.velocity * phase.start - phase.own.position;
        const Vec3 closing = threat.velocity - phase.own.velocity;
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
template <class Piece>
Seconds loss_within(const Vec3& half_extents, const Piece& phase, const Threat& threat, WorkBudget& budget) noexcept
{
    const Vec3 half = threat.box_against(half_extents);
    const Seconds span = phase.end - phase.start;
    const geometry::Motion motion{threat.position_at(phase.start), threat.velocity};
    if (span <= 0.0F || !geometry::contact_interval(half, phase.own, motion, threat.radius_at(phase.end), span)) {
        return -1.0F;
    }
    const int pieces = threat.grows ? static_cast<int>(std::ceil(span / kPiece)) : 1;
    const Seconds piece = span / static_cast<float>(pieces);
    for (int i = 0; i < pieces; ++i) {
        if (!budget.spend(units::kConflictPart)) {
            return 0.0F;
        }
        const Seconds t = piece * static_cast<float>(i);
        const geometry::Motion own{phase.own.position + phase.own.velocity * t, phase.own.velocity};
        const geometry::Motion other{motion.position + motion.velocity * t, motion.velocity};
        const float radius = threat.radius_at(phase.start + t + piece);
        if (const auto touch = geometry::contact_interval(half, own, other, radius, piece)) {
            return phase.start + t + touch->first;
        }
    }
    return -1.0F;
}

/// The way as points of a path: flown to its end, and hovered there until `until` where `hovers`.
template <class Parts>
auto path_of(const Parts& phases, bool hovers) noexcept
{
    StaticVector<path::PathPoint, Parts::kMost + 1> points;
    for (const auto& phase : phases) {
        if (phase.end > phase.start) {
            points.unchecked_push_back({phase.own.position, phase.own.velocity, phase.start});
        }
        if (!hovers) {
            break;
        }
    }
    const auto& last = phases[hovers ? phases.size() - 1 : 0];
    const Seconds span = last.end - last.start;
    points.unchecked_push_back({last.own.position + last.own.velocity * span, last.own.velocity, last.end});
    return points;
}

/// A way that starts inside a margin and draws apart from this one threat for good. Nothing on it could mend the start.
inline bool draws_apart(const Situation& situation, const Threat& threat, std::span<const path::PathPoint> points,
                        WorkBudget& budget) noexcept
{
    Situation alone = situation;
    alone.threats = {&threat, 1};
    const Cutoff sign_alone{0.0F, 0.0F, {}};
    return least_separation(alone, points, points.back().time, budget, kDrawingApart, sign_alone).margin >= 0.0F;
}

/// What could not be looked at to the end is met now. True.
inline bool met_now(const Conflict& conflict, Conflict& out) noexcept
{
    out = conflict;
    out.time_to_loss = 0.0F;
    out.margin = -kSeparationCap;
    return true;
}

inline bool comes_first(const Conflict& a, const Conflict& b) noexcept
{
    if (a.time_to_loss != b.time_to_loss) {
        return a.time_to_loss < b.time_to_loss;
    }
    return a.margin < b.margin;
}

/// Of one moving point with a way, flown as `phases` say, the own position on it at a time being `position_at`. Two
/// phases are a unit of units::kConflict.
template <class Parts, class PositionAt>
bool meets_point(const Situation& situation, const Parts& phases, const PositionAt& position_at, const Threat& threat,
                 WorkBudget& budget, Conflict& out) noexcept
{
    const Vec3& half = situation.limits.half_extents;
    const std::uint32_t cost = units::kConflict * static_cast<std::uint32_t>((phases.size() + 1) / 2);
    Seconds loss = budget.spend(cost) ? loss_within(half, phases[0], threat, budget) : 0.0F;
    for (std::size_t i = 1; i < phases.size() && loss < 0.0F; ++i) {
        loss = loss_within(half, phases[i], threat, budget);
    }
    if (loss < 0.0F) {
        return false;
    }
    const Seconds closest = closest_time(phases, threat);
    if (loss <= 0.0F) {
        WorkBudget apart(std::min(kDrawingApartBudget, budget.left()));
        const auto points = path_of(phases, true);
        const bool leaves = draws_apart(situation, threat, {points.data(), points.size()}, apart);
        static_cast<void>(budget.spend(apart.spent()));  // never more than was left
        if (leaves) {
            return false;
        }
    }
    out.threat = threat.ref;
    out.time_to_loss = loss;
    out.time_to_closest = std::max(closest, loss);
    out.own_at_closest = position_at(out.time_to_closest);
    out.threat_at_closest = threat.nearest_in_height(out.time_to_closest, out.own_at_closest.z());
    out.miss_distance = (out.threat_at_closest - out.own_at_closest).norm();
    out.radius_at_closest = threat_radius(situation, *threat.track, out.time_to_closest);
    out.margin = geometry::box_distance(half, out.threat_at_closest - out.own_at_closest) - out.radius_at_closest;
    return true;
}

/// Of one cylinder with a way, likewise: its body alone. It moves, so that hovering at the way's end counts too.
template <class Parts, class PositionAt>
bool meets_cylinder(const Situation& situation, const Parts& phases, const PositionAt& position_at,
                    const Threat& threat, WorkBudget& budget, Conflict& out) noexcept
{
    const Barrel& barrel = *threat.cylinder;
    const float extra = threat.growth.radius;
    out = {};
    out.threat = threat.ref;
    bool met = false;
    Seconds loss = 0.0F;
    for (const auto& phase : phases) {
        const Seconds span = phase.end - phase.start;
        if (!(span > 0.0F)) {
            continue;
        }
        const BarrelApproach approach(situation.limits.half_extents, phase.own, barrel, phase.start, extra, 0.0F);
        const bool paid_for = budget.spend(units::kConflictBarrel);
        const geometry::Approach near = approach.least(span, met ? out.margin : 0.0F, budget);
        if (!met && (!(near.distance > 0.0F) || !paid_for)) {
            met = true;
            loss = phase.start + approach.first_contact(near.when, budget);
            out.margin = near.distance;
            out.time_to_closest = phase.start + near.when;
        } else if (met && near.distance < out.margin) {
            out.margin = near.distance;
            out.time_to_closest = phase.start + near.when;
        }
        if (budget.exhausted()) {
            const Conflict so_far = out;
            return met_now(so_far, out);
        }
    }
    if (!met) {
        return false;
    }
    out.time_to_loss = loss;
    out.time_to_closest = std::max(out.time_to_closest, loss);
    out.own_at_closest = position_at(out.time_to_closest);
    const Vec3 centre = threat.position_at(out.time_to_closest);
    out.threat_at_closest = {centre.x(), centre.y(), std::clamp(out.own_at_closest.z(), barrel.bottom, barrel.top)};
    out.miss_distance = (out.threat_at_closest - out.own_at_closest).norm();
    out.radius_at_closest = barrel.circle.radius + extra;
    if (loss > 0.0F) {
        return true;
    }
    const auto points = path_of(phases, true);
    return !draws_apart(situation, threat, {points.data(), points.size()}, budget);
}

/// Of one threat at rest with a way, which is taken to be straight.
[[nodiscard]] bool meets_at_rest(const Situation& situation, const Way& way, const Threat& threat, Seconds lookahead,
                                 WorkBudget& budget, Conflict& out) noexcept;

/// conflict_with and main_conflict for ways with a route.
[[nodiscard]] bool conflict_along(const Situation& situation, const Way& way, const Threat& threat, Seconds lookahead,
                                  WorkBudget& budget, Conflict& out) noexcept;
[[nodiscard]] bool main_conflict_along(const Situation& situation, const Way& way, Seconds lookahead,
                                       WorkBudget& budget, Conflict& out) noexcept;

}  // namespace jink::world::detail
