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
    Vec3 threat_at_closest = Vec3::Zero();  ///< threat's centre then [m]
    float radius_at_closest = 0.0F;         ///< threat's grown radius then [m]
};

/// The straight way that the vehicle takes when nothing is in it: from its position back to and along the leg at the
/// leg's speed.
struct Way {
    Vec3 origin = Vec3::Zero();      ///< own position [m]
    Vec3 direction = Vec3::UnitX();  ///< unit vector
    float speed = 0.0F;              ///< after climb and descent limits [m/s]
    float length = 0.0F;             ///< to the end of the leg [m]
};

/// Off the leg, the way aims at the point of the leg this far ahead of the abeam point, or its end where that is nearer
/// [m].
inline constexpr float kRejoinLookahead = 12.0F;

/// A way that starts inside a margin and leaves it like this, for good, is no conflict: nothing ahead on it could mend
/// the start. Gentler than what an own manoeuvre has to do, so that noise of a velocity does not make a conflict of
/// whatever passes by.
inline constexpr EscapeRule kDrawingApart{0.25F, 0.25F};

/// The way for a situation with a valid reference. Within 1e-3 m of the leg's end: the leg's direction, length 0. O(1).
[[nodiscard]] Way way_of(const Situation& situation) noexcept;

/// Conflict of one track with the way within `lookahead` seconds: exact closest approach and loss times with the radius
/// the threat has grown to (loss: with growth bounded piecewise over 0.5 s pieces, never later than the true one).
/// A budget that runs out means a conflict now. O(lookahead).
[[nodiscard]] bool predict_conflict(const Situation& situation, const Way& way, std::size_t track, Seconds lookahead,
                                    WorkBudget& budget, Conflict& out) noexcept;

/// The main threat: of all tracks and obstacles in conflict with the way within `lookahead`, the one whose loss of
/// separation comes first (ties: the smaller margin, then the smaller index). False when there is none. Airspace bounds
/// are no threats: candidates obey them, but a leg outside them is the mission's business. When the budget runs out,
/// the threat that it ran out at is the main one, its loss of separation now. O(tracks + obstacles).
[[nodiscard]] bool main_conflict(const Situation& situation, const Way& way, Seconds lookahead, WorkBudget& budget,
                                 Conflict& out) noexcept;

}  // namespace jink::world
