// SPDX-License-Identifier: BSD-3-Clause
// Spheres, at rest or moving, and what is a sphere to a taller box.
#include <algorithm>
#include <cmath>

#include "core/base/work_units.hpp"
#include "core/geometric/clearance.hpp"
#include "core/geometry/quick_reject.hpp"
#include "core/geometry/sweep.hpp"

namespace jink::geometric::detail {

/// Segment `i`, the curve being `before` and `after` from the sphere's centre at its ends.
bool Clearance::touches(const Curve& curve, std::size_t i, const Sphere& sphere, float shrunk, const Vec3& before,
                        const Vec3& after, WorkBudget& budget) const noexcept
{
    // At its end and not shrunk the sphere is at its largest.
    const geometry::QuickReject whole =
        geometry::quick_reject(sphere.half, before, after, sphere.growth.at(curve.t[i + 1]));
    if (whole == geometry::QuickReject::apart) {
        return false;
    }
    const bool shrinks = shrink_at(shrunk, curve.t[i]) > 0.0F;
    return (!shrinks && whole == geometry::QuickReject::touches) ||
           touches_in_parts(curve, i, sphere, shrunk, before, after,
                            shrinks ? escape_parts(curve.t[i + 1] - curve.t[i]) : 1, budget);
}

bool Clearance::touches_in_parts(const Curve& curve, std::size_t i, const Sphere& sphere, float shrunk,
                                 const Vec3& before, const Vec3& after, int parts, WorkBudget& budget) const noexcept
{
    Vec3 from = before;
    for (int part = 1; part <= parts; ++part) {
        // The size at the part's end: never too small.
        const float share = static_cast<float>(part) / static_cast<float>(parts);
        const Vec3 to = before + share * (after - before);
        const Seconds end = curve.t[i] + share * (curve.t[i + 1] - curve.t[i]);
        const float radius = sphere.growth.at(end) - shrink_at(shrunk, end);
        if (!budget.spend(units::kSphereCheckPart)) {
            return true;
        }
        if (radius >= 0.0F && geometry::quick_reject(sphere.half, from, to, radius) != geometry::QuickReject::apart &&
            (!budget.spend(units::kSphereContact) ||
             geometry::contact_interval(sphere.half, {}, {-from, from - to}, radius, 1.0F))) {
            return true;
        }
        from = to;
    }
    return false;
}

bool Clearance::touches(const Curve& curve, const Sphere& sphere, float shrunk, WorkBudget& budget) const noexcept
{
    MotionBound room(curve.fastest, sphere.velocity.cwiseAbs().maxCoeff(), sphere.growth.at(curve.duration()),
                     curve.duration());
    std::size_t i = 0;
    Vec3 before = sphere.apart(curve, 0);
    bool near = false;
    while (i + 1 < curve.points) {
        // Where a segment before had no clearance to skip by, this one hardly has any.
        if (!near) {
            room.look(before, sphere.half, curve.t[i]);
            std::size_t next = i;
            while (next + 1 < curve.points && room.lasts_until(curve.t[next + 1])) {
                ++next;
            }
            if (next > i) {
                i = next;
                before = sphere.apart(curve, i);
                continue;
            }
        }
        near = !near;
        if (!budget.spend(units::kSphereCheck)) {
            return true;
        }
        const Vec3 after = sphere.apart(curve, i + 1);
        if (touches(curve, i, sphere, shrunk, before, after, budget)) {
            return true;
        }
        before = after;
        ++i;
    }
    return false;
}

bool Clearance::touches_swept(const Curve& curve, const Extent& extent, const Sphere& sphere, Seconds end,
                              WorkBudget& budget) const noexcept
{
    const Vec3 to = sphere.position + sphere.velocity * end;
    const float radius = sphere.growth.at(end);
    const Extent path = about(sphere.position, to);
    if (apart(path.low, path.high, extent.low, extent.high, sphere.half, radius)) {
        return false;
    }
    const float slack = kExtentRounding * (1.0F + path.low.cwiseAbs().cwiseMax(path.high.cwiseAbs()).maxCoeff());
    for (std::size_t i = 0; i + 1 < curve.points; ++i) {
        const Vec3 a = curve.position(i);
        const Vec3 b = curve.position(i + 1);
        const Extent piece = about(a, b);
        if (!budget.spend(units::kSphereCheckPart)) {
            return true;
        }
        if (!apart(path.low, path.high, piece.low, piece.high, sphere.half, radius) &&
            (!budget.spend(units::kCapsuleQuery) ||
             geometry::swept_distance(sphere.half, a, b, sphere.position, to) <= radius + slack)) {
            return true;
        }
    }
    return false;
}

}  // namespace jink::geometric::detail
