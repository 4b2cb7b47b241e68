// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <span>

#include "core/base/work_units.hpp"
#include "core/world/route_way.hpp"

// The search for conflicts of the nominal path, piece by piece. Private to this module.

namespace jink::world::detail {

/// A way in pieces, and the situation with the own box larger by what the pieces lie off the way.
class Course {
public:
    Course(const Situation& s, const Way& way, Seconds lookahead) noexcept
        : way_(way), pieces_(s, way, lookahead), limits_(vehicle::widened(s.limits, pieces_.off())),
          situation_(with_limits(s, limits_))
    {
    }
    Course(const Course&) = delete;
    Course& operator=(const Course&) = delete;

    [[nodiscard]] std::size_t pieces() const noexcept { return pieces_.size(); }
    /// conflict_with of one threat.
    [[nodiscard]] bool meets(const Threat& threat, WorkBudget& budget, Conflict& out) const noexcept;
    /// As if the threat were met where the vehicle is: what is said of a threat that was not checked to the end.
    [[nodiscard]] Conflict at_start(const Threat& threat) const noexcept
    {
        Conflict conflict;
        conflict.threat = threat.ref;
        conflict.own_at_closest = conflict.threat_at_closest = way_.origin;
        return conflict;
    }

private:
    [[nodiscard]] bool meets_point(const Threat& threat, WorkBudget& budget, Conflict& out) const noexcept;
    [[nodiscard]] bool meets_cylinder(const Threat& threat, WorkBudget& budget, Conflict& out) const noexcept;
    [[nodiscard]] bool meets_at_rest(const Threat& threat, WorkBudget& budget, Conflict& out) const noexcept;
    [[nodiscard]] bool meets_sphere(const WayPiece& piece, const Threat& threat, WorkBudget& budget,
                                    Conflict& out) const noexcept;
    [[nodiscard]] bool meets_solid(const WayPiece& piece, const Threat& threat, WorkBudget& budget,
                                   Conflict& out) const noexcept;
    void approach(std::size_t first, const Threat& threat, Conflict& out) const noexcept;
    [[nodiscard]] Seconds closest_time(const Threat& threat) const noexcept;
    [[nodiscard]] Vec3 position_at(Seconds t) const noexcept
    {
        const float on = std::min(pieces_.way_at(t), way_.length);
        return path::point_of(way_.ahead, way_.origin, way_.direction, on).position;
    }
    /// The way starts inside a margin and draws apart from this one threat for good: nothing on it could mend the
    /// start.
    [[nodiscard]] bool draws_apart(const Threat& threat, WorkBudget& budget) const noexcept;
    [[nodiscard]] bool draws_apart(const Threat& threat, std::span<const path::PathPoint> points,
                                   WorkBudget& budget) const noexcept;

    const Way& way_;
    RoutePieces pieces_;
    vehicle::VehicleLimits limits_;
    Situation situation_;
};

/// What could not be checked to the end is met now. True.
inline bool met_now(Conflict& out) noexcept
{
    out.time_to_loss = 0.0F;
    out.margin = -kSeparationCap;
    return true;
}

}  // namespace jink::world::detail
