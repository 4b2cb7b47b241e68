// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>

#include "core/geometry/sweep.hpp"
#include "core/world/conflict_parts.hpp"
#include "core/world/cylinder.hpp"

// Conflicts of the nominal path with tracks and moving cylinders, hovering at its end included.

namespace jink::world::detail {
namespace {

/// Pieces in which a growing threat is compared with its size at the piece's end [s].
constexpr Seconds kGrowthPiece = 0.5F;
/// Pieces in which one track is checked, inside a margin: 60 s of them at a quarter of a second, twice. Spent is a
/// conflict.
constexpr std::uint32_t kDrawingApartBudget = 480 * units::kSpherePart;

/// First loss of separation within one piece; negative when there is none, 0 when the budget ran out.
Seconds loss_within(const Vec3& half_extents, const WayPiece& piece, const Threat& threat, WorkBudget& budget) noexcept
{
    const Vec3 half = threat.box_against(half_extents);
    const Seconds span = piece.span();
    const geometry::Motion motion{threat.position_at(piece.start), threat.velocity};
    if (span <= 0.0F || !geometry::contact_interval(half, piece.own, motion, threat.radius_at(piece.end), span)) {
        return -1.0F;
    }
    const int parts = threat.grows ? static_cast<int>(std::ceil(span / kGrowthPiece)) : 1;
    const Seconds part = span / static_cast<float>(parts);
    for (int i = 0; i < parts; ++i) {
        if (!budget.spend(units::kConflictPart)) {
            return 0.0F;
        }
        const Seconds t = part * static_cast<float>(i);
        const geometry::Motion own{piece.own.position + piece.own.velocity * t, piece.own.velocity};
        const geometry::Motion other{motion.position + motion.velocity * t, motion.velocity};
        const float radius = threat.radius_at(piece.start + t + part);
        if (const auto touch = geometry::contact_interval(half, own, other, radius, part)) {
            return piece.start + t + touch->first;
        }
    }
    return -1.0F;
}

}  // namespace

/// Closest approach of the two centres over all pieces.
Seconds Course::closest_time(const Threat& threat) const noexcept
{
    Seconds best_time = 0.0F;
    float best = (threat.position - pieces_[0].own.position).squaredNorm();
    for (const WayPiece& piece : pieces_) {
        const Vec3 gap = threat.position + threat.velocity * piece.start - piece.own.position;
        const Vec3 closing = threat.velocity - piece.own.velocity;
        const float speed2 = closing.squaredNorm();
        const Seconds t = speed2 > 1e-9F ? std::clamp(-gap.dot(closing) / speed2, 0.0F, piece.span()) : 0.0F;
        const float distance = (gap + closing * t).squaredNorm();
        if (distance < best) {
            best = distance;
            best_time = piece.start + t;
        }
    }
    return best_time;
}

bool Course::draws_apart(const Threat& threat, WorkBudget& budget) const noexcept
{
    StaticVector<path::PathPoint, RoutePieces::kMax + 1> points;
    for (const WayPiece& piece : pieces_) {
        if (piece.end > piece.start) {
            points.unchecked_push_back({piece.own.position, piece.own.velocity, piece.start});
        }
    }
    const WayPiece& last = pieces_[pieces_.size() - 1];
    points.unchecked_push_back({last.last(), last.own.velocity, last.end});
    return draws_apart(threat, {points.data(), points.size()}, budget);
}

/// Of one moving point. Two pieces are a unit of units::kConflict.
bool Course::meets_point(const Threat& threat, WorkBudget& budget, Conflict& out) const noexcept
{
    const Vec3& half = limits_.half_extents;
    const std::uint32_t cost = units::kConflict * static_cast<std::uint32_t>((pieces_.size() + 1) / 2);
    Seconds loss = budget.spend(cost) ? loss_within(half, pieces_[0], threat, budget) : 0.0F;
    for (std::size_t i = 1; i < pieces_.size() && loss < 0.0F; ++i) {
        loss = loss_within(half, pieces_[i], threat, budget);
    }
    if (loss < 0.0F) {
        return false;
    }
    const Seconds closest = closest_time(threat);
    if (loss <= 0.0F) {
        WorkBudget apart = budget.part(kDrawingApartBudget);
        const bool leaves = draws_apart(threat, apart);
        budget.charge(apart);
        if (leaves) {
            return false;
        }
    }
    out.threat = threat.ref;
    out.time_to_loss = loss;
    out.time_to_closest = std::max(closest, loss);
    out.way_at_closest = pieces_.way_at(out.time_to_closest);
    out.own_at_closest = position_at(out.time_to_closest);
    out.threat_at_closest = threat.nearest_in_height(out.time_to_closest, out.own_at_closest.z());
    out.miss_distance = (out.threat_at_closest - out.own_at_closest).norm();
    out.radius_at_closest = threat_radius(situation_, *threat.track, out.time_to_closest);
    out.margin = geometry::box_distance(half, out.threat_at_closest - out.own_at_closest) - out.radius_at_closest;
    return true;
}

/// Of one cylinder, likewise: its body alone.
bool Course::meets_cylinder(const Threat& threat, WorkBudget& budget, Conflict& out) const noexcept
{
    const Cylinder& cylinder = *threat.cylinder;
    const float extra = threat.growth.radius;
    out = at_start(threat);
    bool met = false;
    Seconds loss = 0.0F;
    for (const WayPiece& piece : pieces_) {
        const Seconds span = piece.span();
        if (!(span > 0.0F)) {
            continue;
        }
        const CylinderApproach approach(limits_.half_extents, piece.own, cylinder, piece.start, extra, 0.0F);
        const bool paid_for = budget.spend(units::kConflictCylinder);
        const geometry::Approach near = approach.least(span, met ? out.margin : 0.0F, budget);
        if (!met && (!(near.distance > 0.0F) || !paid_for)) {
            met = true;
            loss = piece.start + approach.first_contact(near.when, budget);
            out.margin = near.distance;
            out.time_to_closest = piece.start + near.when;
        } else if (met && near.distance < out.margin) {
            out.margin = near.distance;
            out.time_to_closest = piece.start + near.when;
        }
        if (budget.exhausted()) {
            return met_now(out);
        }
    }
    if (!met) {
        return false;
    }
    out.time_to_loss = loss;
    out.time_to_closest = std::max(out.time_to_closest, loss);
    out.way_at_closest = pieces_.way_at(out.time_to_closest);
    out.own_at_closest = position_at(out.time_to_closest);
    const Vec3 centre = threat.position_at(out.time_to_closest);
    out.threat_at_closest = {centre.x(), centre.y(), std::clamp(out.own_at_closest.z(), cylinder.bottom, cylinder.top)};
    out.miss_distance = (out.threat_at_closest - out.own_at_closest).norm();
    out.radius_at_closest = cylinder.circle.radius + extra;
    return loss > 0.0F || !draws_apart(threat, budget);
}

}  // namespace jink::world::detail
