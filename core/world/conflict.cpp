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

bool sphere_like_conflict(const Situation& situation, const Way& way, const geometry::Shape& shape, const Vec3& half,
                          float radius, Seconds lookahead, WorkBudget& budget, Conflict& out) noexcept
{
    if (!budget.spend(units::kConflictBall)) {
        return met_now({}, out);
    }
    const Phase phase = phases_of(way, lookahead)[0];
    const Motion still{shape.centre, Vec3::Zero()};
    const float grown = radius + situation.k_sigma * situation.own.sigma_position;
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

bool general_conflict(const Situation& situation, const Way& way, const geometry::Shape& shape, Seconds lookahead,
                      WorkBudget& budget, Conflict& out) noexcept
{
    if (!budget.spend(units::kConflictSolid)) {
        return met_now({}, out);
    }
    const Vec3& half = situation.limits.half_extents;
    const float extra = situation.k_sigma * situation.own.sigma_position;
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

/// Closed areas in the way, by its phases, which nobody else needs: apart from the rest, so that they cost nothing
/// where nothing is closed. False when the budget ran out.
template <class Consider>
[[gnu::noinline]] bool consider_barrels(const Situation& situation, const Way& way, Seconds lookahead,
                                        WorkBudget& budget, const Consider& consider, Conflict& conflict) noexcept
{
    const Phases phases = phases_of(way, lookahead);
    const auto position_at = [&way](Seconds t) { return way_position(way, t); };
    for (std::size_t i = 0; i < situation.airspace.barrels.size(); ++i) {
        if (detail::meets_barrel(situation, phases, position_at, i, budget, conflict)) {
            consider(conflict);
        }
        if (budget.exhausted()) {
            return false;
        }
    }
    return true;
}

}  // namespace

bool detail::obstacle_conflict(const Situation& situation, const Way& way, std::size_t index, Seconds lookahead,
                               WorkBudget& budget, Conflict& out) noexcept
{
    const geometry::Shape& shape = situation.obstacles[index].shape;
    Vec3 half;
    float radius = 0.0F;
    const bool found = as_sphere(shape, situation.limits.half_extents, half, radius)
                           ? sphere_like_conflict(situation, way, shape, half, radius, lookahead, budget, out)
                           : general_conflict(situation, way, shape, lookahead, budget, out);
    if (!found) {
        return false;
    }
    const float along = std::clamp((shape.centre - way.origin).dot(way.direction), 0.0F, way.length);
    out.threat = {ThreatKind::obstacle, static_cast<std::uint16_t>(index)};
    out.time_to_closest = way.speed > 0.0F ? std::max(along / way.speed, out.time_to_loss) : 0.0F;
    out.own_at_closest = way_position(way, out.time_to_closest);
    out.threat_at_closest = shape.centre;
    out.miss_distance = (shape.centre - out.own_at_closest).norm();
    if (out.time_to_loss > 0.0F) {
        return true;
    }
    const auto points = path_of(phases_of(way, lookahead), false);
    return !draws_apart(situation, {}, situation.obstacles.subspan(index, 1), {}, {points.data(), points.size()},
                        budget);
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

bool predict_conflict(const Situation& situation, const Way& way, std::size_t track_index, Seconds lookahead,
                      WorkBudget& budget, Conflict& out) noexcept
{
    if (way.ahead.route != nullptr) {
        return detail::predict_conflict_along(situation, way, track_index, lookahead, budget, out);
    }
    const auto position_at = [&way](Seconds t) { return way_position(way, t); };
    return detail::predict(situation, phases_of(way, lookahead), position_at, track_index, budget, out);
}

bool main_conflict(const Situation& situation, const Way& way, Seconds lookahead, WorkBudget& budget,
                   Conflict& out) noexcept
{
    if (way.ahead.route != nullptr) {
        return detail::main_conflict_along(situation, way, lookahead, budget, out);
    }
    bool found = false;
    const auto consider = [&](const Conflict& conflict) {
        if (!found || comes_first(conflict, out)) {
            out = conflict;
            found = true;
        }
    };
    Conflict conflict;
    for (std::size_t i = 0; i < situation.tracks.size(); ++i) {
        if (predict_conflict(situation, way, i, lookahead, budget, conflict)) {
            consider(conflict);
        }
        if (budget.exhausted()) {
            return met_now(conflict, out);
        }
    }
    if (!situation.airspace.barrels.empty()) [[unlikely]] {
        if (!consider_barrels(situation, way, lookahead, budget, consider, conflict)) {
            return met_now(conflict, out);
        }
    }
    for (std::size_t i = 0; i < situation.obstacles.size(); ++i) {
        if (detail::obstacle_conflict(situation, way, i, lookahead, budget, conflict)) {
            consider(conflict);
        }
        if (budget.exhausted()) {
            return met_now(conflict, out);
        }
    }
    return found;
}

}  // namespace jink::world
