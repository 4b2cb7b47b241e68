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
        : way_(way), pieces_(s, way, lookahead),
          limits_(widened(s.limits, pieces_.off())), situation_{s.now,       s.own,     limits_,     s.airframe,
                                                                s.reference, s.tracks,  s.obstacles, s.airspace,
                                                                s.flying,    s.k_sigma, s.own_id,    s.commanded}
    {
    }
    Course(const Course&) = delete;
    Course& operator=(const Course&) = delete;

    [[nodiscard]] bool meets_track(std::size_t index, WorkBudget& budget, Conflict& out) const noexcept
    {
        const auto position_at = [this](Seconds t) { return this->position_at(pieces_.way_at(t)); };
        if (!predict(situation_, pieces_, position_at, index, budget, out)) {
            return false;
        }
        out.way_at_closest = pieces_.way_at(out.time_to_closest);
        return true;
    }
    [[nodiscard]] bool meets_obstacle(std::size_t index, WorkBudget& budget, Conflict& out) const noexcept;
    [[nodiscard]] bool meets_barrel(std::size_t index, WorkBudget& budget, Conflict& out) const noexcept
    {
        const auto position_at = [this](Seconds t) { return this->position_at(pieces_.way_at(t)); };
        if (!detail::meets_barrel(situation_, pieces_, position_at, index, budget, out)) {
            return false;
        }
        out.way_at_closest = pieces_.way_at(out.time_to_closest);
        return true;
    }

private:
    [[nodiscard]] static vehicle::VehicleLimits widened(vehicle::VehicleLimits limits, float extra) noexcept
    {
        limits.half_extents += Vec3::Constant(extra);
        return limits;
    }
    [[nodiscard]] Vec3 position_at(float way) const noexcept
    {
        return path::point_of(way_.ahead, way_.origin, way_.direction, std::min(way, way_.length)).position;
    }
    void approach(std::size_t first, const Vec3& centre, Conflict& out) const noexcept;

    const Way& way_;
    RoutePieces pieces_;
    vehicle::VehicleLimits limits_;
    Situation situation_;
};

bool Course::meets_obstacle(std::size_t index, WorkBudget& budget, Conflict& out) const noexcept
{
    for (std::size_t i = 0; i < pieces_.size() && !budget.exhausted(); ++i) {
        const WayPiece& piece = pieces_[i];
        const float speed = piece.own.velocity.norm();
        const Seconds span = piece.end - piece.start;
        if (!(speed > 0.0F) || !(span > 0.0F)) {
            continue;
        }
        const Way straight{piece.own.position, piece.own.velocity / speed, speed, speed * span, {}};
        if (obstacle_conflict(situation_, straight, index, span, budget, out)) {
            out.time_to_loss += piece.start;
            approach(i, situation_.obstacles[index].shape.centre, out);
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

bool predict_conflict_along(const Situation& situation, const Way& way, std::size_t track, Seconds lookahead,
                            WorkBudget& budget, Conflict& out) noexcept
{
    return Course(situation, way, lookahead).meets_track(track, budget, out);
}

bool main_conflict_along(const Situation& situation, const Way& way, Seconds lookahead, WorkBudget& budget,
                         Conflict& out) noexcept
{
    static_cast<void>(budget.spend(units::kConflict * static_cast<std::uint32_t>(kWayPieces / 2)));
    const Course course(situation, way, lookahead);
    bool found = false;
    Conflict conflict;
    const std::size_t tracks = situation.tracks.size();
    const std::size_t moving = tracks + situation.airspace.barrels.size();
    for (std::size_t i = 0; i < moving + situation.obstacles.size(); ++i) {
        const bool meets = i < tracks   ? course.meets_track(i, budget, conflict)
                           : i < moving ? course.meets_barrel(i - tracks, budget, conflict)
                                        : course.meets_obstacle(i - moving, budget, conflict);
        if (meets && (!found || comes_first(conflict, out))) {
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
