// SPDX-License-Identifier: BSD-3-Clause
#include "core/world/conflict.hpp"

#include <algorithm>
#include <array>

#include "core/geometry/convex.hpp"
#include "core/world/conflict_parts.hpp"
#include "core/world/obstacle_distance.hpp"
#include "core/world/route_way.hpp"

namespace jink::world {
namespace {

using detail::comes_first;
using detail::met_now;
using detail::Phase;
using detail::Phases;
using geometry::Motion;

/// Largest R handed on for shapes whose extent is not a radius: the source studied threats up to 3 m (Pinheiro
/// tab. 4.1).
constexpr float kLargestRadius = 3.0F;

Phases phases_of(const Way& way, Seconds lookahead) noexcept
{
    const Seconds arrival = way.speed > 0.0F ? std::min(way.length / way.speed, lookahead) : 0.0F;
    const Vec3 velocity = way.direction * way.speed;
    const Vec3 end = way.origin + velocity * arrival;
    return {{Phase{{way.origin, velocity}, 0.0F, arrival}, Phase{{end, Vec3::Zero()}, arrival, lookahead}}};
}

Vec3 way_position(const Way& way, Seconds t) noexcept
{
    return way.origin + way.direction * std::min(way.speed * std::max(t, 0.0F), way.length);
}

bool meets_sphere(const Situation& situation, const Way& way, const Threat& threat, Seconds lookahead,
                  WorkBudget& budget, Conflict& out) noexcept
{
    if (!budget.spend(units::kConflictBall)) {
        return met_now({}, out);
    }
    const Vec3 half = threat.box_against(situation.limits.half_extents);
    const float grown = threat.growth.radius;
    const Phase phase = phases_of(way, lookahead)[0];
    const Motion still{threat.position, Vec3::Zero()};
    if (phase.end <= 0.0F) {
        return false;
    }
    const auto touch = geometry::contact_interval(half, phase.own, still, grown, phase.end);
    if (!touch) {
        return false;
    }
    if (!budget.spend(units::kConflictMet)) {
        return met_now({}, out);
    }
    const geometry::Approach near = geometry::least_distance(half, phase.own, still, phase.end);
    out.time_to_loss = touch->first;
    out.margin = near.distance - grown;
    out.radius_at_closest = grown;
    return true;
}

bool meets_solid(const Situation& situation, const Way& way, const Threat& threat, Seconds lookahead,
                 WorkBudget& budget, Conflict& out) noexcept
{
    if (!budget.spend(units::kConflictSolid)) {
        return met_now({}, out);
    }
    const geometry::Shape& shape = *threat.solid;
    const Vec3& half = situation.limits.half_extents;
    const float extra = threat.growth.radius;
    const Vec3 end = way_position(way, lookahead);
    if (geometry::swept_box_contact(half, way.origin, end, shape, extra, budget) == geometry::Contact::clear) {
        return false;
    }
    float clear = 0.0F;
    float touching = 1.0F;
    for (int i = 0; i < 8; ++i) {
        const float middle = 0.5F * (clear + touching);
        const bool is_clear = geometry::swept_box_contact(half, way.origin, way.origin + (end - way.origin) * middle,
                                                          shape, extra, budget) == geometry::Contact::clear;
        (is_clear ? clear : touching) = middle;
    }
    const float length = (end - way.origin).norm();
    out.time_to_loss = way.speed > 0.0F ? clear * length / way.speed : 0.0F;
    out.margin = obstacle_margin(half, way.origin, end, shape, budget, extra);
    out.radius_at_closest = std::min(geometry::bounding_radius(shape), kLargestRadius) + extra;
    return true;
}

}  // namespace

bool detail::meets_at_rest(const Situation& situation, const Way& way, const Threat& threat, Seconds lookahead,
                           WorkBudget& budget, Conflict& out) noexcept
{
    const bool found = threat.form == ThreatForm::point ? meets_sphere(situation, way, threat, lookahead, budget, out)
                                                        : meets_solid(situation, way, threat, lookahead, budget, out);
    if (!found) {
        return false;
    }
    const float along = std::clamp((threat.position - way.origin).dot(way.direction), 0.0F, way.length);
    out.threat = threat.ref;
    out.time_to_closest = way.speed > 0.0F ? std::max(along / way.speed, out.time_to_loss) : 0.0F;
    out.own_at_closest = way_position(way, out.time_to_closest);
    out.threat_at_closest = threat.position;
    out.miss_distance = (threat.position - out.own_at_closest).norm();
    if (out.time_to_loss > 0.0F) {
        return true;
    }
    const auto points = path_of(phases_of(way, lookahead), false);
    return !draws_apart(situation, threat, {points.data(), points.size()}, budget);
}

float rejoin_lookahead(const vehicle::VehicleLimits& limits, float speed, float height) noexcept
{
    constexpr Seconds kWingAhead = 4.0F;
    if (limits.kind == vehicle::VehicleKind::multirotor) {
        return kRejoinLookahead;
    }
    const Seconds climb = std::max(-height / limits.max_climb, height / limits.max_descent);
    return std::max(kRejoinLookahead, speed * std::max(kWingAhead, climb));
}

Way way_of(const Situation& situation) noexcept
{
    if (situation.reference.route != nullptr) {
        return way_along(situation, situation.own.position);
    }
    const Leg& leg = situation.reference.leg;
    const Vec3& own = situation.own.position;
    const Vec3 span = leg.end - leg.start;
    const float length = span.norm();
    const Vec3 forward = length > 1e-3F ? Vec3(span / length) : Vec3::UnitX();
    const float along = std::clamp((own - leg.start).dot(forward), 0.0F, length);
    const Vec3 from_leg = own - (leg.start + forward * along);
    const float off = from_leg.norm();
    const float ahead = rejoin_lookahead(situation.limits, leg.speed, from_leg.z());

    Way way;
    way.origin = own;
    const Vec3 aim = off <= detail::kOnLeg ? leg.end : Vec3(leg.start + forward * std::min(along + ahead, length));
    const Vec3 to_aim = aim - own;
    const float distance = to_aim.norm();
    way.direction = distance > 1e-3F ? Vec3(to_aim / distance) : forward;
    way.length = distance > 1e-3F ? distance + (leg.end - aim).norm() : 0.0F;
    way.speed = vehicle::clamped_velocity(way.direction, leg.speed, situation.limits).norm();
    return way;
}

bool conflict_with(const Situation& situation, const Way& way, const Threat& threat, Seconds lookahead,
                   WorkBudget& budget, Conflict& out) noexcept
{
    if (way.ahead.route != nullptr) {
        return detail::conflict_along(situation, way, threat, lookahead, budget, out);
    }
    const auto position_at = [&way](Seconds t) { return way_position(way, t); };
    switch (threat.ref.kind) {
    case ThreatKind::track:
        return detail::meets_point(situation, phases_of(way, lookahead), position_at, threat, budget, out);
    case ThreatKind::barrel:
        return detail::meets_cylinder(situation, phases_of(way, lookahead), position_at, threat, budget, out);
    case ThreatKind::obstacle: return detail::meets_at_rest(situation, way, threat, lookahead, budget, out);
    default: return false;
    }
}

bool main_conflict(const Situation& situation, const Way& way, Seconds lookahead, WorkBudget& budget,
                   Conflict& out) noexcept
{
    if (situation.threats.data() == nullptr) {
        return met_now({}, out);
    }
    if (way.ahead.route != nullptr) {
        return detail::main_conflict_along(situation, way, lookahead, budget, out);
    }
    bool found = false;
    Conflict conflict;
    for (const Threat& threat : situation.threats) {
        if (threat.is_bound()) {
            continue;
        }
        if (conflict_with(situation, way, threat, lookahead, budget, conflict) &&
            (!found || comes_first(conflict, out))) {
            out = conflict;
            found = true;
        }
        if (budget.exhausted()) {
            return met_now(conflict, out);
        }
    }
    return found;
}

}  // namespace jink::world
