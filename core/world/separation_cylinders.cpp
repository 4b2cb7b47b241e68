// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>
#include <limits>

#include "core/world/cylinder.hpp"
#include "core/world/separation_parts.hpp"

// Cylinders in the final check.

namespace jink::world::detail {
namespace {

/// A cylinder as the own box meets it, with what the escape rule takes off at first.
struct CylinderCheck {
    const Cylinder& cylinder;
    const Vec3& half;
    const EscapeRule& escape;
    ThreatRef ref;
    float extra = 0.0F;
    float start_margin = 0.0F;
    float shrunk = 0.0F;
    /// Until then the surface grows evenly, so that the margin stays a convex function of time; afterwards it stands.
    Seconds whole = 0.0F;

    CylinderCheck(const Vec3& half_extents, const Vec3& begin, const Threat& threat, const EscapeRule& rule) noexcept
        : cylinder(*threat.cylinder), half(half_extents), escape(rule), ref(threat.ref), extra(threat.growth.radius)
    {
        start_margin = cylinder_distance(half, begin, cylinder, 0.0F) - extra;
        shrunk = start_margin < 0.0F ? escape.slack - start_margin : 0.0F;
        if (shrunk > 0.0F) {
            whole = escape.speed > 0.0F ? shrunk / escape.speed : std::numeric_limits<Seconds>::infinity();
        }
    }

    [[nodiscard]] bool may_matter(const Bounds& chunk, float best) const noexcept
    {
        const Vec2 a = cylinder.circle.centre + cylinder.velocity * chunk.start;
        const Vec2 b = cylinder.circle.centre + cylinder.velocity * chunk.end;
        const Vec2 low = a.cwiseMin(b).array() - cylinder.circle.radius;
        const Vec2 high = a.cwiseMax(b).array() + cylinder.circle.radius;
        const float apart = boxes_apart(chunk.low - half, chunk.high + half, {low.x(), low.y(), cylinder.bottom},
                                        {high.x(), high.y(), cylinder.top});
        // Where they overlap it may be as deep as anything.
        return apart <= 0.0F || apart - extra - chunk.sagitta < best;
    }

    /// With the surface growing, then with the whole body.
    void against(const Piece& p, WorkBudget& budget, Separation& best) const noexcept
    {
        const Seconds end = p.start + p.duration;
        const Seconds middle = std::clamp(whole, p.start, end);
        for (const bool escapes : {true, false}) {
            const Seconds from = escapes ? p.start : middle;
            const Seconds span = (escapes ? middle : end) - from;
            if (!(span > 0.0F) && (escapes || p.duration > 0.0F)) {
                continue;
            }
            const float outset = extra + p.sagitta.any - shrink_at(shrunk, escape, from);
            const CylinderApproach approach(half, {p.from + p.velocity * (from - p.start), p.velocity}, cylinder, from,
                                            outset, escapes ? escape.speed : 0.0F);
            const geometry::Approach near = approach.least(span, best.margin, budget);
            consider(best, near.distance, from + near.when, ref);
            if (budget.exhausted()) {
                return;
            }
        }
    }
};

}  // namespace

void against_cylinder(const Vec3& half, const Flight& flight, const Threat& threat, const EscapeRule& escape,
                      WorkBudget& budget, Separation& best) noexcept
{
    const ThreatRef ref = threat.ref;
    if (!paid(budget, units::kThreat + flight.chunks().size() * units::kThreatChunk, best, 0.0F, ref)) {
        return;
    }
    const CylinderCheck check(half, flight.begin(), threat, escape);
    if (std::isnan(check.start_margin)) {
        consider(best, check.start_margin, 0.0F, ref);
        return;
    }
    for (const Bounds& chunk : flight.chunks()) {
        if (!check.may_matter(chunk, best.margin)) {
            continue;
        }
        if (!paid(budget, (chunk.last - chunk.first) * units::kThreatPiece, best, chunk.start, ref)) {
            return;
        }
        for (std::size_t i = chunk.first; i < chunk.last; ++i) {
            check.against(flight.piece(i), budget, best);
            if (budget.exhausted()) {
                return;
            }
        }
    }
}

}  // namespace jink::world::detail
