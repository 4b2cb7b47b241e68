// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/geometric/clearance.hpp"
#include "core/geometric/curve.hpp"
#include "core/geometric/planner.hpp"
#include "core/world/conflict.hpp"

// Candidates along a reference that is not straight. Private to this module.
//
// With b the reference ahead by arc length, its corners rounded, and n a side that is carried along it without twist, a
// candidate is p(s) = b(s) + w f(s / D) n(s): the family's curve as it is along a straight leg, f being 0 at both ends.

namespace jink::geometric::detail {

/// A corner is rounded by a parabola on which the turn takes this share of the acceleration limits; the rest is the
/// candidate's.
inline constexpr float kCornerShare = 0.5F;

/// The reference ahead of a manoeuvre that ends `end` [m] along it, about its start. Corners before the end are rounded
/// by parabolas (linear segments with parabolic blends: R. P. Paul, Robot Manipulators, MIT Press 1981, ch. 5), which
/// begin and end as far along from the corner as the speed asks for, but neither before the start nor past the end:
/// where there is no space, the turn is too sharp and the candidate not flyable. 24 bytes per corner.
class ReferenceAhead {
public:
    ReferenceAhead(const Problem& problem, const vehicle::VehicleLimits& limits, float end) noexcept;

    /// About the start [m]. O(segments).
    [[nodiscard]] Vec3 position(float way) const noexcept;
    /// Of the reference itself, whose corners are none of the end's. O(segments).
    [[nodiscard]] Vec3 along(float way) const noexcept;

private:
    struct Corner {
        float way;    ///< where it lies [m]
        float half;   ///< from there to either end of the parabola [m], > 0
        Vec3 change;  ///< of the unit tangent
    };
    void round(float way, const Vec3& change, float speed, const vehicle::VehicleLimits& limits) noexcept;

    const Problem& problem_;
    const float end_;
    StaticVector<Corner, kMaxRouteSegments + 1> corners_;
};

/// ReferenceAhead at the waypoints of a family's curve. Entries past the curve's points hold nothing.
// NOLINTNEXTLINE(cppcoreguidelines-pro-type-member-init): as in UnitCurve
struct BaseCurve {
    float end = 0.0F;  ///< of the reference ahead [m]; 0: not made
    Vec3 rejoin;       ///< unit tangent there, or of the leg
    Coordinates x, y, z;
    Coordinates half_x, half_y, half_z;  ///< half way from the tangent before to the one here, as long as sqrt(2)

    [[nodiscard]] Vec3 position(std::size_t i) const noexcept { return {x[i], y[i], z[i]}; }
    /// Turns a side across the tangent before as path::carried does: by reflection, as it is across that tangent.
    [[nodiscard]] Vec3 carried(const Vec3& side, std::size_t i) const noexcept
    {
        const Vec3 half(half_x[i], half_y[i], half_z[i]);
        return side - side.dot(half) * half;
    }
};
/// Nothing is done where `base` ends with the curve already. O(waypoints * segments).
void make_base(const UnitCurve& unit, const Problem& problem, const vehicle::VehicleLimits& limits,
               BaseCurve& base) noexcept;

/// make_curve about `base`, with the side at its start. O(waypoints).
void make_curve_along(const UnitCurve& unit, const BaseCurve& base, const Vec3& side, float offset, float speed,
                      const vehicle::VehicleLimits& limits, Curve& out) noexcept;

/// The curve of a candidate: about the straight leg, or about `base` along the route, which is made where it is not
/// yet. `base.rejoin` is where both lead back. O(waypoints), the first along a route O(waypoints * segments).
void make_candidate(const UnitCurve& unit, const Problem& problem, const vehicle::VehicleLimits& limits,
                    const Vec3& side, float offset, BaseCurve& base, Curve& out) noexcept;

/// Bends a curve that was made along the x axis to follow the reference ahead. O(points * segments).
void bend_along(const ReferenceAhead& ahead, Curve& curve) noexcept;

/// The problem as it is seen from a straight leg through the collision point, its planes turned as they are when they
/// get there: what offsets are chosen for. O(segments).
[[nodiscard]] Problem seen_at_collision(const Problem& problem, const vehicle::VehicleLimits& limits) noexcept;

/// `reach` and `longest` of curves up to `length` along the reference, `widest` beside it. O(waypoints * segments).
void reach_along(const Problem& problem, float length, float widest, float slowest, Extent& reach,
                 Seconds& longest) noexcept;

/// A route of one straight segment.
[[nodiscard]] inline bool is_leg(const path::RouteView& route) noexcept
{
    return route.segments().size() == 1 && !route.segments().front().is_arc();
}
/// Makes `problem`, of a straight way, one along the way's route, unless any manoeuvre ends before the way bends. To a
/// conflict on a leg that the way leads back to, the curves are about the straight line from the start.
void follow_route(const world::Situation& situation, const world::Way& way, const world::Conflict& conflict,
                  Problem& problem) noexcept;
/// Moves the start of a problem along a route by `by`, if it is left with `least` > 0 to the collision point [m].
[[nodiscard]] bool move_start_along(const world::Situation& situation, const Vec3& by, float least,
                                    Problem& problem) noexcept;

}  // namespace jink::geometric::detail
