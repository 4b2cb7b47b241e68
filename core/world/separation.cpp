// SPDX-License-Identifier: BSD-3-Clause
#include "core/world/separation.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "core/base/work_units.hpp"
#include "core/geometry/convex.hpp"
#include "core/geometry/quick_reject.hpp"
#include "core/geometry/sweep.hpp"
#include "core/world/cylinder.hpp"
#include "core/world/obstacle_distance.hpp"
#include "core/world/separation_parts.hpp"

namespace jink::world {
namespace {

using namespace detail;
using geometry::Motion;

/// No shorter, however small the slack [s].
constexpr Seconds kMinEscapePiece = 0.02F;
/// A growing threat is checked in pieces no longer than this, each with the size at its end [s].
constexpr Seconds kGrowthPiece = 0.25F;
constexpr Seconds kSolidEscapePiece = 0.2F;

/// While a shrunk surface grows back it is checked in pieces so short that it takes half the slack at most in each,
/// so that its size at their end may stand for it.
Seconds escape_piece(const EscapeRule& escape) noexcept
{
    return escape.speed > 0.0F ? std::max(kMinEscapePiece, 0.5F * escape.slack / escape.speed)
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
    return reach < 0.0F || geometry::quick_reject(half, from, to, reach) == geometry::QuickReject::apart;
}

/// A sphere in straight motion, or an upright capsule.
// NOLINTNEXTLINE(readability-function-cognitive-complexity): three nested loops, each of them paid for where it begins
void against_sphere(const Vec3& half_extents, const Flight& flight, const Threat& threat, const EscapeRule& escape,
                    WorkBudget& budget, Separation& best) noexcept
{
    const ThreatRef ref = threat.ref;
    const Vec3 half = threat.box_against(half_extents);
    if (!paid(budget, units::kThreat + flight.chunks().size() * units::kThreatChunk, best, 0.0F, ref)) {
        return;
    }
    const float start_margin = geometry::box_distance(half, threat.position - flight.begin()) - threat.radius_at(0.0F);
    const float shrunk = start_margin < 0.0F ? escape.slack - start_margin : 0.0F;
    const Seconds growth_piece = threat.grows ? kGrowthPiece : std::numeric_limits<Seconds>::infinity();
    for (const Bounds& chunk : flight.chunks()) {
        const Vec3 a = threat.position + threat.velocity * chunk.start;
        const Vec3 b = threat.position + threat.velocity * chunk.end;
        const float bound = boxes_apart(chunk.low - half, chunk.high + half, a.cwiseMin(b), a.cwiseMax(b)) -
                            threat.radius_at(chunk.end) - chunk.sagitta;
        if (bound >= best.margin) {
            continue;
        }
        if (!paid(budget, (chunk.last - chunk.first) * units::kThreatPiece, best, chunk.start, ref)) {
            return;
        }
        for (std::size_t i = chunk.first; i < chunk.last; ++i) {
            const Piece p = flight.piece(i);
            const Seconds end = p.start + p.duration;
            const Vec3 from = threat.position + threat.velocity * p.start - p.from;
            const Vec3 along = threat.velocity - p.velocity;
            // The surface is largest at the end of the piece: growth adds to it, and what was shrunk has grown back.
            if (stays_beyond(best.margin, half, from, from + along * p.duration,
                             threat.radius_at(end) + p.sagitta.any - shrink_at(shrunk, escape, end))) {
                continue;
            }
            const bool escapes = shrink_at(shrunk, escape, p.start) > 0.0F;
            const int parts =
                parts_of(p.duration, escapes ? std::min(growth_piece, escape_piece(escape)) : growth_piece);
            const Seconds length = p.duration / static_cast<float>(parts);
            for (int part = 0; part < parts; ++part) {
                const Seconds offset = length * static_cast<float>(part);
                const Seconds start = p.start + offset;
                if (!paid(budget, units::kSpherePart, best, start, ref)) {
                    return;
                }
                const Motion own{p.from + p.velocity * offset, p.velocity};
                const Motion other{threat.position + threat.velocity * start, threat.velocity};
                const float radius =
                    threat.radius_at(start + length) + p.sagitta.any - shrink_at(shrunk, escape, start + length);
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

/// The way from `from` to `to` keeps a box farther away than `margin`, as its own three axes say: a lower bound that
/// costs far less than a query.
bool stays_beyond_box(float margin, const Vec3& half, const Vec3& from, const Vec3& to, const geometry::Shape& box,
                      float extra) noexcept
{
    const Mat3 into = box.axes.transpose();
    const Vec3 a = into * (from - box.centre);
    const Vec3 b = into * (to - box.centre);
    const Vec3 near = a.cwiseMin(b).cwiseMax(-a.cwiseMax(b));
    const Vec3 apart = (near - box.half - into.cwiseAbs() * half).cwiseMax(0.0F);
    const float beyond = std::max(margin + extra, 0.0F);
    return apart.squaredNorm() > beyond * beyond;
}

/// Margins of solids are resolved no finer than kObstacleResolution, and one query costs hundreds of support calls:
/// the shrunk surface clears the start by that much more, and grows back in coarser pieces.
// NOLINTNEXTLINE(readability-function-cognitive-complexity): as above
void against_solid(const Vec3& half, const Flight& flight, const Threat& threat, const EscapeRule& escape,
                   WorkBudget& budget, Separation& best) noexcept
{
    const ThreatRef ref = threat.ref;
    const geometry::Shape& shape = *threat.solid;
    const float extra = threat.growth.radius;
    if (!paid(budget, units::kThreat + flight.chunks().size() * units::kThreatChunk, best, 0.0F, ref)) {
        return;
    }
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
                if (shape.kind == geometry::ShapeKind::box) {
                    if (!paid(budget, units::kBoxBound, best, start, ref)) {
                        return;
                    }
                    if (stays_beyond_box(best.margin, half, from, from + p.velocity * length, shape, grown)) {
                        continue;
                    }
                }
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

/// Margin of a position from a bound of the airspace. Bounds are kept like obstacles: the own position is known no
/// better towards them.
float bound_margin(const Threat& bound, const Vec3& half, const Vec3& p) noexcept
{
    const float extra = bound.growth.radius;
    switch (bound.form) {
    case ThreatForm::floor: return p.z() - (half.z() + extra) - bound.position.z();
    case ThreatForm::ceiling: return bound.position.z() - p.z() - (half.z() + extra);
    default: return bound.level_radius - (p - bound.position).head<2>().norm() - (half.head<2>().norm() + extra);
    }
}

/// Airspace bounds are convex sets: the least margin of a straight piece lies at one of its ends, or where a surface
/// that the escape rule has shrunk is back at its size.
void against_bound(const Vec3& half, const Flight& flight, const Threat& bound, const EscapeRule& escape,
                   Separation& best) noexcept
{
    const float start = bound_margin(bound, half, flight.begin());
    const float shrunk = start < 0.0F ? escape.slack - start : 0.0F;
    const Seconds whole = escape.speed > 0.0F ? shrunk / escape.speed : 0.0F;
    for (std::size_t i = 0; i < flight.size(); ++i) {
        const Piece p = flight.piece(i);
        const float sagitta = bound.form == ThreatForm::keep_in ? p.sagitta.any : p.sagitta.vertical;
        const auto judge = [&](Seconds t) {
            const float margin = bound_margin(bound, half, p.from + p.velocity * (t - p.start)) - sagitta;
            consider(best, margin + shrink_at(shrunk, escape, t), t, bound.ref);
        };
        judge(p.start);
        judge(p.start + p.duration);
        if (whole > p.start && whole < p.start + p.duration) {
            judge(whole);
        }
    }
}

void against(const Vec3& half, const Flight& flight, const Threat& threat, const EscapeRule& escape, WorkBudget& budget,
             Separation& best) noexcept
{
    switch (threat.form) {
    case ThreatForm::point: against_sphere(half, flight, threat, escape, budget, best); break;
    case ThreatForm::solid: against_solid(half, flight, threat, escape, budget, best); break;
    case ThreatForm::cylinder: against_cylinder(half, flight, threat, escape, budget, best); break;
    default: against_bound(half, flight, threat, escape, best); break;
    }
}

/// The threat with a share of its uncertainty. Of an obstacle the own vehicle's stays whole.
Threat with_share(const Threat& threat, float share) noexcept
{
    const bool is_track = threat.ref.kind == ThreatKind::track && threat.track != nullptr;
    const float uncertain = is_track ? threat.growth.radius - threat.track->radius : threat.slack;
    Threat likely = threat;
    likely.growth.radius -= (1.0F - share) * uncertain;
    likely.growth.rate *= share;
    likely.growth.acceleration *= share;
    if (likely.doubted) {
        likely.doubt *= share;
    }
    return likely;
}

/// Index of the threat that is checked before all others, or `threats`.size().
std::size_t place_of_first(std::span<const Threat> threats, std::size_t bounds, ThreatRef first) noexcept
{
    const std::size_t place = bounds + first.index;
    return first.kind == ThreatKind::track && place < threats.size() && threats[place].ref == first ? place
                                                                                                    : threats.size();
}

Separation separation_of(const Situation& situation, std::span<const path::PathPoint> points,
                         std::span<const path::Sagitta> sagittas, Seconds horizon, WorkBudget& budget,
                         const EscapeRule& escape, const Cutoff& cutoff) noexcept
{
    const std::span<const Threat> threats = situation.threats;
    if (threats.data() == nullptr) {
        return {-kSeparationCap, 0.0F, {}};
    }
    Separation best{cutoff.above, 0.0F, {}};
    if (points.empty()) {
        return best;
    }
    const Vec3& half = situation.limits.half_extents;
    std::size_t bounds = 0;
    while (bounds < threats.size() && threats[bounds].is_bound()) {
        ++bounds;
    }
    constexpr std::size_t kLook = 1;
    if (!paid(budget, kLook + points.size() * (units::kPathPiece + bounds * units::kBoundPiece), best, 0.0F, {})) {
        return best;
    }
    const Flight flight(points, sagittas, horizon);
    // The part of the flight that is checked against cooperative tracks.
    std::optional<Flight> shared;
    if (situation.shared_horizon < horizon) {
        shared.emplace(points, sagittas, situation.shared_horizon);
    }
    const auto check = [&](const Threat& threat) noexcept {
        const Flight& part = shared && threat.reciprocal ? *shared : flight;
        if (cutoff.uncertainty < 1.0F) {
            against(half, part, with_share(threat, cutoff.uncertainty), escape, budget, best);
        } else {
            against(half, part, threat, escape, budget, best);
        }
    };
    for (const Threat& bound : threats.first(bounds)) {
        check(bound);
    }
    const std::size_t first = place_of_first(threats, bounds, cutoff.first);
    if (first < threats.size()) {
        check(threats[first]);
    }
    for (std::size_t i = bounds; i < threats.size() && best.margin >= cutoff.below; ++i) {
        if (i != first) {
            check(threats[i]);
        }
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
    if (situation.threats.data() == nullptr) {
        return {-kSeparationCap, t, {}};
    }
    Separation best;
    const Vec3& half = situation.limits.half_extents;
    for (const Threat& threat : situation.threats) {
        if (threat.is_bound()) {
            consider(best, bound_margin(threat, half, position), t, threat.ref);
            continue;
        }
        if (!paid(budget, units::kThreat, best, t, threat.ref)) {
            return best;
        }
        const float grown = threat.radius_at(t);
        if (threat.form == ThreatForm::point) {
            const Vec3 apart = threat.position_at(t) - position;
            consider(best, geometry::box_distance(threat.box_against(half), apart) - grown, t, threat.ref);
        } else if (threat.form == ThreatForm::cylinder) {
            consider(best, cylinder_distance(half, position, *threat.cylinder, t) - grown, t, threat.ref);
        } else {
            const geometry::Shape& shape = *threat.solid;
            const float near =
                (position - shape.centre).norm() - geometry::bounding_radius(shape) - half.norm() - grown;
            if (!(near >= best.margin)) {  // also where a number is not finite
                consider(best, obstacle_margin(half, position, position, shape, budget, grown), t, threat.ref);
            }
        }
    }
    return best;
}

}  // namespace jink::world
