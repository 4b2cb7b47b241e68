// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>

#include "core/base/work_budget.hpp"
#include "core/path/timed_path.hpp"
#include "core/world/separation.hpp"

namespace jink::avoid {

/// What a checked manoeuvre costs: one objective for all methods, out of the flight that is predicted and not out of
/// what the method says. Every term in seconds, as if they were lost on the way.
struct ManoeuvreCost {
    /// Later at the end of the route than by the route itself. From the manoeuvre's end on the vehicle goes on along
    /// the route at the reference's speed, and takes half as long for the way back to it.
    Seconds delay = 0.0F;
    Seconds deviation = 0.0F;  ///< a fifth of the flight of the greatest distance from the route
    Seconds effort = 0.0F;     ///< all changes of velocity, at the greatest level acceleration
    /// The flight of what is missing to a margin of 1 m; where the soft margin of a closed area is entered, 6 more and
    /// ten times the flight of the depth.
    Seconds clearance = 0.0F;
    Seconds consistency = 0.0F;  ///< 1 for another method than the flown one's, and 6 for the other side
    Seconds rules = 0.0F;  ///< 6 where it passes a vehicle that avoids us too on the wrong side (passing_side.hpp)
    /// What obstacles cost from the manoeuvre's end on (CostToGo). Where that is not known: 6 where an obstacle or a
    /// closed area blocks the straight way from there to the route, FlightRules::lookahead farther along than abeam of
    /// that end (at the route's end at most); of an area also the flight to its side and back at half the speed, as
    /// deep as the way goes into its circle, where that is then. Unknown, as the budget has ended: blocked.
    Seconds dead_end = 0.0F;
    Vec3 side = Vec3::Zero();  ///< unit vector from the route to the farthest point; zero within 0.3 m of the route

    [[nodiscard]] Seconds total() const noexcept
    {
        return delay + deviation + effort + clearance + consistency + rules + dead_end;
    }
};

/// `manoeuvre` as it is flown: `flight`, from Situation::now until its end, not empty, without what follows the end.
/// `separation`: its least one; it and `situation` are of the vehicle as it is. Exact but for rounding: within 1e-3 of
/// each term and of 1 s for coordinates up to 1 km; a way within that of an obstacle may count as blocked or not.
/// Without a route, and where the budget ends before all points are costed, the delay is infinite. O(points * segments
/// of the route + points * closed areas + obstacles).
[[nodiscard]] ManoeuvreCost cost_of(const world::Situation& situation, const world::Manoeuvre& manoeuvre,
                                    std::span<const path::PathPoint> flight, const world::Separation& separation,
                                    WorkBudget& budget) noexcept;

}  // namespace jink::avoid
