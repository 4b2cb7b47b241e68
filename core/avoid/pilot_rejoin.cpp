// SPDX-License-Identifier: BSD-3-Clause
// Back to the leg: when the way is clear, how it is flown, and what is flown while it is not.
#include <algorithm>
#include <cmath>
#include <limits>

#include "core/avoid/pilot_tick.hpp"
#include "core/geometry/sweep.hpp"

namespace jink::avoid {

float cross_track(const world::Situation& s) noexcept
{
    if (s.reference.route != nullptr) {
        return s.reference.route->abeam_of(s.own.position, s.reference.segment).off;
    }
    return geometry::point_segment_distance(s.own.position, s.reference.leg.start, s.reference.leg.end);
}

namespace {

/// Along the tangent where the vehicle is abeam of the route.
Beside beside_route(const world::Situation& s) noexcept
{
    const path::Route& route = *s.reference.route;
    const path::Abeam abeam = route.abeam_of(s.own.position, s.reference.segment);
    const Vec3 from_route = s.own.position - abeam.point.position;
    Beside beside;
    beside.left = route.length() - abeam.arc_length;
    beside.off = from_route - from_route.dot(abeam.point.along) * abeam.point.along;
    beside.command = vehicle::clamped_velocity(abeam.point.along, s.reference.leg.speed, s.limits);
    return beside;
}

/// Time in which what is left to a bound of the airspace is used up at most.
constexpr Seconds kBoundTime = 1.0F;

/// `velocity` without what would take the vehicle out of the airspace, or further out: where the leg itself lies
/// outside, the autopilot may go there, but not by our command.
Vec3 kept_inside(const world::Situation& s, const Vec3& velocity) noexcept
{
    const Vec3& at = s.own.position;
    const Vec3& half = s.limits.half_extents;
    Vec3 kept = velocity;
    float lowest = -std::numeric_limits<float>::infinity();
    for (const world::Threat& bound : s.threats) {
        const float extra = bound.growth.radius;
        if (bound.form == world::ThreatForm::floor) {
            lowest = std::min(0.0F, bound.position.z() - at.z() + half.z() + extra) / kBoundTime;
        } else if (bound.form == world::ThreatForm::ceiling) {
            kept.z() = std::min(kept.z(), std::max(0.0F, bound.position.z() - at.z() - half.z() - extra) / kBoundTime);
        } else if (bound.form == world::ThreatForm::keep_in) {
            const Vec3 from_home(at.x() - bound.position.x(), at.y() - bound.position.y(), 0.0F);
            const float off = from_home.norm();
            if (off > 0.0F) {
                const float left = bound.level_radius - off - half.head<2>().norm() - extra;
                const float outward = from_home.dot(kept) / off;
                const float most = std::max(0.0F, left) / kBoundTime;
                kept -= (std::max(0.0F, outward - most) / off) * from_home;
            }
        } else {
            break;
        }
    }
    // Between a floor and a ceiling that leave nothing, up.
    kept.z() = std::max(kept.z(), lowest);
    return kept;
}

}  // namespace

Beside beside_leg(const world::Situation& s) noexcept
{
    if (s.reference.route != nullptr) {
        return beside_route(s);
    }
    const world::Leg& leg = s.reference.leg;
    const Vec3 span = leg.end - leg.start;
    const float length = span.norm();
    Beside beside;
    if (length > 0.0F) {
        const Vec3 forward = span / length;
        const Vec3 from_start = s.own.position - leg.start;
        beside.left = length - from_start.dot(forward);
        beside.off = from_start - from_start.dot(forward) * forward;
        beside.command = vehicle::clamped_velocity(forward, leg.speed, s.limits);
    }
    return beside;
}

bool is_held(const world::Situation& s, const Vec3& taken, const Vec3& left, float on_leg) noexcept
{
    /// Slower than this nothing is gained by going on [m/s].
    constexpr float kStanding = 0.2F;
    const Vec3 off = beside_leg(s).off;
    const bool beside = off.head<2>().norm() > on_leg;
    return taken.head<2>().norm() > 0.0F || (taken.z() != 0.0F && (!beside || left.norm() < kStanding));
}

void Pilot::enter_rejoining() noexcept
{
    state_ = State::rejoining;
    has_fallback_ = false;
    standing_ = false;
}

/// Near enough to the leg for control to be given back. Held at a bound, the vehicle is as near to it as we may bring
/// it.
bool Pilot::is_back(const Tick& tick) const noexcept
{
    const float on_leg = settings_.on_leg;
    const bool held = is_held(tick.s, tick.taken, tick.out.velocity, on_leg);
    if (cross_track(tick.s) <= on_leg || tick.way.length <= on_leg || held) {
        return true;
    }
    // A fixed wing above or below its leg needs no turn to follow it; past its end nothing is left of it.
    const Beside beside = beside_leg(tick.s);
    return tick.s.limits.kind == vehicle::VehicleKind::fixed_wing &&
           (beside.off.head<2>().norm() <= on_leg || beside.left <= 0.0F);
}

void Pilot::follow_way(Tick& tick) noexcept
{
    tick.out.wants_control = true;
    tick.out.kind = world::ManoeuvreKind::velocity;
    const Vec3 wanted = tick.way.length > 0.0F ? Vec3(tick.way.direction * tick.way.speed) : Vec3(Vec3::Zero());
    tick.out.velocity = kept_inside(tick.s, wanted);
    tick.taken = wanted - tick.out.velocity;
}

/// The way back is not clear, but flying on beside the leg is: past what is slow, or until it has gone. Going back to
/// the leg behind it would only mean to go around it again.
bool Pilot::keep_beside(Tick& tick) noexcept
{
    const Beside beside = beside_leg(tick.s);
    if (!tick.out.has_conflict || tick.s.limits.kind != vehicle::VehicleKind::multirotor ||
        beside.off.norm() <= settings_.on_leg || beside.left <= world::kRejoinLookahead) {
        beside_ = false;
        return false;
    }
    const float margin = command_margin(tick.s, beside.command, settings_.lookahead, settings_, tick.budget);
    const bool keeps = margin >= (beside_ ? 0.0F : settings_.room);
    if (keeps) {
        diagnostics_.holds += beside_ ? 0U : 1U;
        tick.out.wants_control = true;
        tick.out.kind = world::ManoeuvreKind::velocity;
        tick.out.velocity = beside.command;
        tick.out.margin = margin;
    }
    beside_ = keeps;
    return keeps;
}

/// A fixed wing needs seconds to turn to its way, and flies a long arc meanwhile, which the way does not show. While
/// that arc is not clear the wing keeps its course; where that is not clear either, it falls back.
bool Pilot::keep_course(Tick& tick) noexcept
{
    /// A half turn at 30 degrees of bank and 18 m/s takes 10 s, a quarter 5 s.
    constexpr Seconds kTurning = 8.0F;
    if (tick.s.limits.kind != vehicle::VehicleKind::fixed_wing ||
        world::of_kind(tick.s.threats, world::ThreatKind::track).empty()) {
        return false;
    }
    const Seconds ahead = std::min(settings_.lookahead, kTurning);
    const Vec3 back = kept_inside(tick.s, tick.way.direction * tick.way.speed);
    if (command_margin(tick.s, back, ahead, settings_, tick.budget) >= 0.0F) {
        return false;
    }
    const Vec3 on = kept_inside(tick.s, {tick.s.own.velocity.x(), tick.s.own.velocity.y(), 0.0F});
    const float margin = command_margin(tick.s, on, ahead, settings_, tick.budget);
    if (!(margin >= 0.0F)) {
        fall_back(tick);
        return true;
    }
    tick.out.wants_control = true;
    tick.out.kind = world::ManoeuvreKind::velocity;
    tick.out.velocity = on;
    tick.out.margin = margin;
    return true;
}

/// How long the way has been clear, with something to spare.
void Pilot::note_clearness(Tick& tick) noexcept
{
    if (!tick.out.has_conflict) {
        const Wider wider(tick.s, settings_.clear_extra);
        world::Conflict unused;
        tick.wide_clear = !world::main_conflict(wider.situation, tick.way, settings_.lookahead, tick.budget, unused);
    }
    if (tick.wide_clear && !was_clear_) {
        clear_since_ = tick.s.now;
    }
    was_clear_ = tick.wide_clear;
    const bool free = !tick.out.has_conflict;
    free_since_ = free && !was_free_ ? tick.s.now : free_since_;
    was_free_ = free;
}

bool Pilot::way_clear_for(const Tick& tick, Seconds span) const noexcept
{
    return was_clear_ && tick.s.now - clear_since_ >= span;
}

void Pilot::rejoin(Tick& tick) noexcept
{
    if (keep_beside(tick)) {
        return;
    }
    if (tick.out.has_conflict) {
        if (due(tick, tick.out.conflict.time_to_loss) && plan(tick)) {
            take(tick);
            return;
        }
        if (urgent(tick, tick.out.conflict.time_to_loss)) {
            fall_back(tick);
            return;
        }
    }
    if (tick.in_control && keep_course(tick)) {
        return;
    }
    follow_way(tick);
    if (is_back(tick) && way_clear_for(tick, settings_.settle) && may_give_back(tick)) {
        ++diagnostics_.rejoined;
        state_ = State::watching;
        gave_back_ = true;
        has_flying_ = false;
        // The velocity stays valid: it is flown until the autopilot has its mode back.
        tick.out.wants_control = false;
    }
}

}  // namespace jink::avoid
