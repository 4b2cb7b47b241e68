// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/world/separation.hpp"

namespace jink::world {

/// A predicted loss of separation on the way along the reference.
struct Conflict {
    ThreatRef threat;
    Seconds time_to_loss = 0.0F;     ///< until the own box touches the threat's grown surface [s]; 0: already
    Seconds time_to_closest = 0.0F;  ///< until the closest approach of the centres [s]
    float margin = 0.0F;             ///< at the closest approach; of a solid the least on the way [m]
    float miss_distance = 0.0F;      ///< between the centres (nearest point of an obstacle) at the closest approach [m]
    Vec3 own_at_closest = Vec3::Zero();     ///< the collision point: own position on the way then [m]
    Vec3 threat_at_closest = Vec3::Zero();  ///< threat's centre then, a cylinder's at the own height [m]
    float radius_at_closest = 0.0F;         ///< threat's grown radius then [m]
    float way_at_closest = 0.0F;            ///< along the way until then [m]
};

/// The nominal path: where the vehicle goes when nothing is in the way, straight from its position to the reference's
/// route and along it. Valid as long as the reference.
struct Way {
    Vec3 origin = Vec3::Zero();      ///< own position [m]
    Vec3 direction = Vec3::UnitX();  ///< unit vector at the start
    float speed = 0.0F;              ///< at the start, after climb and descent limits [m/s]
    float length = 0.0F;             ///< to the end of the route [m]
    path::RouteAhead ahead{};        ///< what comes after the straight beginning
};

/// Off a leg, the way aims at the point of the leg this far ahead of the abeam point, or its end where that is nearer
/// [m].
inline constexpr float kRejoinLookahead = 12.0F;

/// The same for a vehicle at `speed` [m/s], `height` [m] above or below the leg. A fixed wing comes back gently: 4 s of
/// flight ahead at least, and as far as its climb needs.
[[nodiscard]] float rejoin_lookahead(const vehicle::VehicleLimits& limits, float speed, float height) noexcept;

/// A way that starts inside a margin and leaves it like this, for good, is no conflict: nothing ahead on it could mend
/// the start. Gentler than what an own manoeuvre has to do, so that noise of a velocity does not make a conflict of
/// whatever passes by.
inline constexpr EscapeRule kDrawingApart{0.25F, 0.25F};

/// The way from `position` for a situation with a valid reference.
///
/// On a straight segment the way aims at the segment's end; off it, at the point rejoin_lookahead ahead; on an arc of
/// radius R, `off` metres beside it, at the point sqrt(R) + 2 off ahead, kRejoinLookahead at most. Near a segment's end
/// the way aims at that end, but 1 m or 2 off ahead at least. From where the way meets the route it is the route.
/// Within 1 mm of the route's end: the route's direction there, length 0. O(segments).
[[nodiscard]] Way way_from(const Situation& situation, const Vec3& position) noexcept;
/// From the own position.
[[nodiscard]] inline Way way_of(const Situation& situation) noexcept
{
    return way_from(situation, situation.own.position);
}

/// Conflict of one threat with the way within `lookahead` seconds. Of a track: exact closest approach and loss times
/// with the radius the threat has grown to (loss: with growth bounded piecewise over 0.5 s pieces, never later than the
/// true one). A budget that runs out means a conflict now. O(lookahead).
///
/// The way is taken in straight pieces, each at the speed that the climb limits leave it: legs as they are, corners and
/// all, arcs in chords, and the own box larger to every side by as much as they lie off the arc: 2 % of the radius at
/// most while the way turns by less than 4 rad in the time looked ahead (kWayPieces). At its end the vehicle hovers,
/// which counts for what moves.
[[nodiscard]] bool conflict_with(const Situation& situation, const Way& way, const Threat& threat, Seconds lookahead,
                                 WorkBudget& budget, Conflict& out) noexcept;

/// The main threat: of Situation::threats in conflict with the way within `lookahead`, the one whose loss of separation
/// comes first (ties: the smaller margin, then the order of the threats). False when there is none; threats that were
/// never collected are a conflict now. A cylinder is met when the own box enters its body, at the way's end too; its
/// margin does not count. Floor, ceiling and keep-in are no threats: candidates obey them, but a leg outside them is
/// the mission's business. When the budget runs out, the threat that it ran out at is the main one, its loss of
/// separation now. O(pieces * (tracks + cylinders + obstacles)).
[[nodiscard]] bool main_conflict(const Situation& situation, const Way& way, Seconds lookahead, WorkBudget& budget,
                                 Conflict& out) noexcept;

}  // namespace jink::world
