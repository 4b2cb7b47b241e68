// SPDX-License-Identifier: BSD-3-Clause
#include "core/avoid/objective.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <optional>

#include "core/base/work_units.hpp"
#include "core/world/cost_to_go.hpp"
#include "core/world/cylinder.hpp"
#include "core/world/passing_side.hpp"
#include "core/world/threat_set.hpp"

namespace jink::avoid {
namespace {

constexpr float kMinSpeed = 0.5F;         ///< of a reference whose delay is counted [m/s]
constexpr float kWayBack = 0.5F;          ///< share of the distance from the route that counts as way
constexpr float kDeviation = 0.2F;        ///< of the seconds that the greatest distance takes
constexpr float kMinSide = 0.3F;          ///< a flight nearer to the route than this has no side [m]
constexpr float kWantedMargin = 1.0F;     ///< [m]
constexpr Seconds kMethodChange = 1.0F;   ///< for a change of the method
constexpr Seconds kSideChange = 6.0F;     ///< for a change of the side
constexpr Seconds kAgainstRules = 6.0F;   ///< for the side on which two vehicles do not pass
constexpr Seconds kDeadEnd = 6.0F;        ///< for what is on the straight way back to the route
constexpr float kSideStep = 4.0F;         ///< to a closed area's side and back, at half the speed as from a stand
constexpr Seconds kSoft = 6.0F;           ///< for a way into a closed area's soft margin
constexpr float kSoftDepth = 10.0F;       ///< and so many times the flight of its depth
constexpr Seconds kShortestWay = 1e-3F;   ///< such a way takes no less
constexpr float kOppositeCosine = -0.1F;  ///< sides further apart than this (cosine) are opposite ones

/// What is left of the way to the route's end, and where the vehicle is beside it.
struct Place {
    float left = 0.0F;        ///< [m]
    Vec3 off = Vec3::Zero();  ///< from the route [m]
    float arc_length = 0.0F;  ///< of the route, abeam of the vehicle [m]
};

Place place_of(const path::RouteView& route, float length, const Vec3& position, std::size_t from) noexcept
{
    const path::Abeam abeam = route.abeam_of(position, from);
    return {length - abeam.arc_length + kWayBack * abeam.off, position - abeam.point.position, abeam.arc_length};
}

bool are_opposite(const Vec3& a, const Vec3& b) noexcept { return a.dot(b) < kOppositeCosine; }

/// From a manoeuvre's end straight back to the route.
struct WayBack {
    Vec3 from = Vec3::Zero();
    Vec3 to = Vec3::Zero();
    float speed = 0.0F;
    Seconds begins = 0.0F;  ///< after Situation::now

    [[nodiscard]] Seconds duration() const noexcept { return std::max(kShortestWay, (to - from).norm() / speed); }
};

/// Whether any threat of a situation blocks it.
bool is_blocked(const world::Situation& s, const WayBack& way, WorkBudget& budget) noexcept
{
    constexpr world::Cutoff kClearOrNot{0.0F, 0.0F, {}};
    const Seconds duration = way.duration();
    const Vec3 velocity = (way.to - way.from) / duration;
    const std::array<path::PathPoint, 2> points{path::PathPoint{way.from, velocity, 0.0F},
                                                path::PathPoint{way.to, velocity, duration}};
    return world::least_separation(s, points, duration, budget, s.rules.escape, kClearOrNot).margin < 0.0F;
}

/// How far a straight flight goes into a circle of `radius` about the origin [m], >= 0.
float depth_of(const world::Vec2& from, const world::Vec2& to, float radius) noexcept
{
    const world::Vec2 along = to - from;
    const float length2 = along.squaredNorm();
    const float share = length2 > 0.0F ? std::clamp(-from.dot(along) / length2, 0.0F, 1.0F) : 0.0F;
    return std::max(0.0F, radius - (from + share * along).norm());
}

/// How far a piece of a flight that began at `start` goes into the soft margin of an area [m], at most all of it.
float soft_depth(const path::PathPoint& from, const path::PathPoint& to, Seconds start,
                 const world::Cylinder& area) noexcept
{
    const bool passes = std::max(from.position.z(), to.position.z()) < area.bottom ||
                        std::min(from.position.z(), to.position.z()) > area.top;
    const auto beside = [&](const path::PathPoint& point) -> world::Vec2 {
        return point.position.head<2>() - area.circle.centre - area.velocity * (point.time - start);
    };
    return passes ? 0.0F : std::min(area.margin, depth_of(beside(from), beside(to), area.circle.radius + area.margin));
}

/// What obstacles and closed areas cost on the way back, out of their own sizes.
Seconds dead_end_of(const world::Situation& s, const WayBack& way, std::uint32_t units, WorkBudget& budget) noexcept
{
    world::Situation fixed = s;
    const auto blocked = [&] { return !budget.spend(units) || is_blocked(fixed, way, budget); };
    fixed.threats = world::of_kind(s.threats, world::ThreatKind::obstacle);
    Seconds most = !fixed.threats.empty() && blocked() ? kDeadEnd : 0.0F;
    for (const world::Threat& area : world::of_kind(s.threats, world::ThreatKind::cylinder)) {
        world::Cylinder then = *area.cylinder;
        then.circle.centre += then.velocity * way.begins;
        const world::Threat threat = world::cylinder_threat(area.ref.index, then, area.growth.radius);
        fixed.threats = {&threat, 1};
        if (blocked()) {
            const world::Vec2 from = way.from.head<2>() - then.circle.centre;
            const world::Vec2 to = way.to.head<2>() - then.circle.centre - then.velocity * way.duration();
            most = std::max(most, kDeadEnd + kSideStep * depth_of(from, to, then.circle.radius) / way.speed);
        }
    }
    return most;
}

/// What obstacles cost on the way from `place`, where that is known.
std::optional<Seconds> lost_from(const world::Situation& s, const Vec3& place, WorkBudget& budget) noexcept
{
    return s.cost_to_go != nullptr && budget.spend(units::kLost) ? s.cost_to_go->lost_from(place) : std::nullopt;
}

}  // namespace

ManoeuvreCost cost_of(const world::Situation& s, const world::Manoeuvre& manoeuvre,
                      std::span<const path::PathPoint> flight, const world::Separation& separation,
                      WorkBudget& budget) noexcept
{
    ManoeuvreCost cost;
    const path::RouteView route = s.reference.route();
    std::uint32_t point_units = units::kObjectivePoint;
    for (const path::RouteSegment& segment : route.segments()) {
        point_units += segment.is_arc() ? units::kObjectiveArc : units::kObjectivePoint;
    }
    std::span areas = world::of_kind(s.threats, world::ThreatKind::cylinder);
    if (std::none_of(areas.begin(), areas.end(), [](const auto& area) { return area.cylinder->margin > 0.0F; })) {
        areas = {};  // nothing is soft
    }
    point_units += static_cast<std::uint32_t>(areas.size()) * units::kObjectivePoint;
    bool paid = s.reference.valid && budget.spend(units::kObjective);
    const float speed = std::max(kMinSpeed, s.reference.speed);
    const float length = route.length();
    Vec3 farthest = Vec3::Zero();
    Vec3 velocity = s.own.velocity;
    float changes = 0.0F;
    float soft = 0.0F;
    const path::PathPoint* before = flight.data();
    Place first;
    Place place;
    for (const path::PathPoint& point : flight) {
        paid = paid && budget.spend(point_units);
        if (!paid) {
            cost.delay = std::numeric_limits<float>::infinity();
            return cost;
        }
        place = place_of(route, length, point.position, s.reference.segment);
        farthest = place.off.squaredNorm() > farthest.squaredNorm() ? place.off : farthest;
        changes += (point.velocity - velocity).norm();
        velocity = point.velocity;
        first = &point == flight.data() ? place : first;
        for (const world::Threat& area : areas) {
            soft = std::max(soft, soft_depth(*before, point, flight.front().time, *area.cylinder));
        }
        before = &point;
    }
    cost.delay = flight.back().time - flight.front().time + (place.left - first.left) / speed;
    const float most = farthest.norm();
    cost.side = most > kMinSide ? Vec3(farthest / most) : cost.side;
    cost.deviation = kDeviation * most / speed;
    cost.effort = changes / s.limits.max_acceleration;
    cost.clearance =
        (std::max(0.0F, kWantedMargin - separation.margin) + kSoftDepth * soft) / speed + (soft > 0.0F ? kSoft : 0.0F);
    if (s.flying != nullptr) {
        cost.consistency = (s.flying->by != manoeuvre.by ? kMethodChange : 0.0F) +
                           (are_opposite(s.flying->side, cost.side) ? kSideChange : 0.0F);
    }
    const std::span tracks = world::of_kind(s.threats, world::ThreatKind::track);
    if (separation.against.kind == world::ThreatKind::track && separation.against.index < tracks.size() &&
        are_opposite(world::passing_side(s, tracks[separation.against.index]), cost.side)) {
        cost.rules = kAgainstRules;
    }
    const float ahead = std::min(place.arc_length + s.rules.lookahead * speed, length);
    const std::optional<Seconds> lost = lost_from(s, flight.back().position, budget);
    const WayBack back{flight.back().position, route.at(ahead).position, speed,
                       flight.back().time - flight.front().time};
    cost.dead_end = lost ? *lost : dead_end_of(s, back, point_units, budget);
    return cost;
}

}  // namespace jink::avoid
