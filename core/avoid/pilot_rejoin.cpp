// SPDX-License-Identifier: BSD-3-Clause
// Back to the leg: when the way is clear, how it is flown, and what is flown while it is not.
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

void Pilot::enter_rejoining() noexcept
{
    state_ = State::rejoining;
    has_fallback_ = false;
    standing_ = false;
}

void Pilot::follow_way(Tick& tick) noexcept
{
    tick.out.wants_control = true;
    tick.out.kind = world::ManoeuvreKind::velocity;
    tick.out.velocity = tick.way.length > 0.0F ? Vec3(tick.way.direction * tick.way.speed) : Vec3(Vec3::Zero());
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
    follow_way(tick);
    const bool back = cross_track(tick.s) <= settings_.on_leg || tick.way.length <= settings_.on_leg;
    if (back && way_clear_for(tick, settings_.settle)) {
        ++diagnostics_.rejoined;
        state_ = State::watching;
        has_flying_ = false;
        // The velocity stays valid: it is flown until the autopilot has its mode back.
        tick.out.wants_control = false;
    }
}

}  // namespace jink::avoid
