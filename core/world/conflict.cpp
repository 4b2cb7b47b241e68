// SPDX-License-Identifier: BSD-3-Clause
#include "core/world/conflict.hpp"

#include <algorithm>
#include <array>

#include "core/geometry/convex.hpp"
#include "core/world/conflict_parts.hpp"
#include "core/world/obstacle_distance.hpp"

namespace jink::world {
namespace {

/// Largest R handed on for shapes whose extent is not a radius: Pinheiro studied threats up to 3 m (tab. 4.1).
constexpr float kLargestRadius = 3.0F;

bool comes_first(const Conflict& a, const Conflict& b) noexcept
{
    if (a.time_to_loss != b.time_to_loss) {
        return a.time_to_loss < b.time_to_loss;
    }
    return a.margin < b.margin;
}

}  // namespace

namespace detail {

bool Course::meets_sphere(const WayPiece& piece, const Threat& threat, WorkBudget& budget, Conflict& out) const noexcept
{
    if (!budget.spend(units::kConflictSphere)) {
        return met_now(out);
    }
    const Vec3 half = threat.box_against(limits_.half_extents);
    const float grown = threat.growth.radius;
    const geometry::Motion still{threat.position, Vec3::Zero()};
    const auto touch = geometry::contact_interval(half, piece.own, still, grown, piece.span());
    if (!touch) {
        return false;
    }
    if (!budget.spend(units::kConflictMet)) {
        return met_now(out);
    }
    out.time_to_loss = touch->first;
    out.margin = geometry::least_distance(half, piece.own, still, piece.span()).distance - grown;
    out.radius_at_closest = grown;
    return true;
}

bool Course::meets_solid(const WayPiece& piece, const Threat& threat, WorkBudget& budget, Conflict& out) const noexcept
{
    if (!budget.spend(units::kConflictSolid)) {
        return met_now(out);
    }
    const geometry::Shape& shape = *threat.solid;
    const Vec3& half = limits_.half_extents;
    const float extra = threat.growth.radius;
    const Vec3& start = piece.own.position;
    const Vec3 end = piece.last();
    if (geometry::swept_box_contact(half, start, end, shape, extra, budget) == geometry::Contact::clear) {
        return false;
    }
    float clear = 0.0F;
    float touching = 1.0F;
    for (int i = 0; i < 8; ++i) {
        const float middle = 0.5F * (clear + touching);
        const bool is_clear = geometry::swept_box_contact(half, start, start + (end - start) * middle, shape, extra,
                                                          budget) == geometry::Contact::clear;
        (is_clear ? clear : touching) = middle;
    }
    out.time_to_loss = clear * piece.span();
    out.margin = obstacle_margin(half, start, end, shape, budget, extra);
    out.radius_at_closest = std::min(geometry::bounding_radius(shape), kLargestRadius) + extra;
    return true;
}

/// Piece by piece, but for hovering: nothing on the way could mend that.
bool Course::meets_at_rest(const Threat& threat, WorkBudget& budget, Conflict& out) const noexcept
{
    out = at_start(threat);
    for (std::size_t i = 0; i < pieces_.size(); ++i) {
        const WayPiece& piece = pieces_[i];
        if (piece.hovers() || !(piece.span() > 0.0F)) {
            continue;
        }
        bool met = threat.form == ThreatForm::point ? meets_sphere(piece, threat, budget, out)
                                                    : meets_solid(piece, threat, budget, out);
        if (met && !(out.time_to_loss > 0.0F)) {
            const std::array<path::PathPoint, 2> points{
                {{piece.own.position, piece.own.velocity, 0.0F}, {piece.last(), piece.own.velocity, piece.span()}}};
            met = !draws_apart(threat, points, budget);
        }
        if (budget.exhausted()) {
            out = at_start(threat);
            return met_now(out);
        }
        if (met) {
            out.time_to_loss += piece.start;
            approach(i, threat, out);
            return true;
        }
    }
    return false;
}

/// The way's first approach to an obstacle's centre from piece `first` on, no sooner than the loss of separation.
void Course::approach(std::size_t first, const Threat& threat, Conflict& out) const noexcept
{
    out.threat_at_closest = threat.position;
    for (std::size_t i = first; i < pieces_.size(); ++i) {
        const WayPiece& piece = pieces_[i];
        const float speed2 = piece.own.velocity.squaredNorm();
        if (!(speed2 > 0.0F)) {
            break;
        }
        const float nearest = (threat.position - piece.own.position).dot(piece.own.velocity) / speed2;
        const Seconds when = std::max(piece.start + std::clamp(nearest, 0.0F, piece.whole), out.time_to_loss);
        const Vec3 position = position_at(when);
        const float miss = (threat.position - position).norm();
        if (i > first && miss >= out.miss_distance) {
            break;
        }
        out.time_to_closest = when;
        out.way_at_closest = pieces_.way_at(when);
        out.own_at_closest = position;
        out.miss_distance = miss;
    }
}

bool Course::draws_apart(const Threat& threat, std::span<const path::PathPoint> points,
                         WorkBudget& budget) const noexcept
{
    Situation alone = situation_;
    alone.threats = {&threat, 1};
    const Cutoff sign_alone{0.0F, 0.0F, {}};
    return least_separation(alone, points, points.back().time, budget, kDrawingApart, sign_alone).margin >= 0.0F;
}

bool Course::meets(const Threat& threat, WorkBudget& budget, Conflict& out) const noexcept
{
    switch (threat.ref.kind) {
    case ThreatKind::track: return meets_point(threat, budget, out);
    case ThreatKind::cylinder: return meets_cylinder(threat, budget, out);
    case ThreatKind::obstacle: return meets_at_rest(threat, budget, out);
    default: return false;
    }
}

}  // namespace detail

bool conflict_with(const Situation& situation, const Way& way, const Threat& threat, Seconds lookahead,
                   WorkBudget& budget, Conflict& out) noexcept
{
    return detail::Course(situation, way, lookahead).meets(threat, budget, out);
}

bool main_conflict(const Situation& situation, const Way& way, Seconds lookahead, WorkBudget& budget,
                   Conflict& out) noexcept
{
    if (situation.threats.data() == nullptr) {
        out = {};
        return detail::met_now(out);
    }
    static_cast<void>(budget.spend(units::kConflictLook));
    const detail::Course course(situation, way, lookahead);
    // Each check of a threat pays for two pieces by itself.
    static_cast<void>(budget.spend(units::kConflict * static_cast<std::uint32_t>((course.pieces() - 1) / 2)));
    bool found = false;
    Conflict conflict;
    for (const Threat& threat : situation.threats) {
        if (threat.is_bound()) {
            continue;
        }
        const bool met = course.meets(threat, budget, conflict);
        if (budget.exhausted()) {
            out = met ? conflict : course.at_start(threat);
            return detail::met_now(out);
        }
        if (met && (!found || comes_first(conflict, out))) {
            out = conflict;
            found = true;
        }
    }
    return found;
}

}  // namespace jink::world
