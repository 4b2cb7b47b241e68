// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>

#include "core/world/conflict_parts.hpp"
#include "core/world/route_way.hpp"

// Conflicts with a way along a route: piece by piece, the own box larger by what the pieces lie off the way.

namespace jink::world::detail {
namespace {

/// A way in pieces, and the situation with the larger box.
class Course {
public:
    Course(const Situation& s, const Way& way, Seconds lookahead) noexcept
        : way_(way), pieces_(s, way, lookahead), limits_(vehicle::widened(s.limits, pieces_.off())),
          situation_(with_limits(s, limits_))
    {
    }
    Course(const Course&) = delete;
    Course& operator=(const Course&) = delete;

    [[nodiscard]] bool meets(const Threat& threat, WorkBudget& budget, Conflict& out) const noexcept
    {
        const auto position_at = [this](Seconds t) { return this->position_at(pieces_.way_at(t)); };
        switch (threat.ref.kind) {
        case ThreatKind::track:
            if (!meets_point(situation_, pieces_, position_at, threat, budget, out)) {
                return false;
            }
            break;
        case ThreatKind::barrel:
            if (!meets_cylinder(situation_, pieces_, position_at, threat, budget, out)) {
                return false;
            }
            break;
        case ThreatKind::obstacle: return meets_at_rest(threat, budget, out);
        default: return false;
        }
        out.way_at_closest = pieces_.way_at(out.time_to_closest);
        return true;
    }

private:
    [[nodiscard]] Vec3 position_at(float way) const noexcept
    {
        return path::point_of(way_.ahead, way_.origin, way_.direction, std::min(way, way_.length)).position;
    }
    [[nodiscard]] bool meets_at_rest(const Threat& threat, WorkBudget& budget, Conflict& out) const noexcept;
    void approach(std::size_t first, const Vec3& centre, Conflict& out) const noexcept;

    const Way& way_;
    RoutePieces pieces_;
    vehicle::VehicleLimits limits_;
    Situation situation_;
};

bool Course::meets_at_rest(const Threat& threat, WorkBudget& budget, Conflict& out) const noexcept
{
    for (std::size_t i = 0; i < pieces_.size() && !budget.exhausted(); ++i) {
        const WayPiece& piece = pieces_[i];
        const float speed = piece.own.velocity.norm();
        const Seconds span = piece.end - piece.start;
        if (!(speed > 0.0F) || !(span > 0.0F)) {
            continue;
        }
        const Way straight{piece.own.position, piece.own.velocity / speed, speed, speed * span, {}};
        if (detail::meets_at_rest(situation_, straight, threat, span, budget, out)) {
            out.time_to_loss += piece.start;
            approach(i, threat.position, out);
            return true;
        }
    }
    return false;
}

/// The way's first approach to an obstacle's centre from piece `first` on, no sooner than the loss of separation.
void Course::approach(std::size_t first, const Vec3& centre, Conflict& out) const noexcept
{
    for (std::size_t i = first; i < pieces_.size(); ++i) {
        const geometry::Motion& own = pieces_[i].own;
        const float speed2 = own.velocity.squaredNorm();
        if (!(speed2 > 0.0F)) {
            break;
        }
        const Seconds span = pieces_[i].end - pieces_[i].start;
        const Seconds t = std::clamp((centre - own.position).dot(own.velocity) / speed2, 0.0F, span);
        const Seconds when = std::max(pieces_[i].start + t, out.time_to_loss);
        const Vec3 position = position_at(pieces_.way_at(when));
        const float miss = (centre - position).norm();
        if (i > first && miss >= out.miss_distance) {
            break;
        }
        out.time_to_closest = when;
        out.way_at_closest = pieces_.way_at(when);
        out.own_at_closest = position;
        out.miss_distance = miss;
    }
}

}  // namespace

bool conflict_along(const Situation& situation, const Way& way, const Threat& threat, Seconds lookahead,
                    WorkBudget& budget, Conflict& out) noexcept
{
    return Course(situation, way, lookahead).meets(threat, budget, out);
}

bool main_conflict_along(const Situation& situation, const Way& way, Seconds lookahead, WorkBudget& budget,
                         Conflict& out) noexcept
{
    static_cast<void>(budget.spend(units::kConflict * static_cast<std::uint32_t>(kWayPieces / 2)));
    const Course course(situation, way, lookahead);
    bool found = false;
    Conflict conflict;
    for (const Threat& threat : situation.threats) {
        if (threat.is_bound()) {
            continue;
        }
        if (course.meets(threat, budget, conflict) && (!found || comes_first(conflict, out))) {
            out = conflict;
            found = true;
        }
        if (budget.exhausted()) {
            return met_now(conflict, out);
        }
    }
    return found;
}

}  // namespace jink::world::detail
