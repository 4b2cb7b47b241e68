// SPDX-License-Identifier: BSD-3-Clause
// Back to the leg: when the path is clear, how it is flown, and what is flown while it is not.
#include <algorithm>
#include <cmath>
#include <limits>

#include "core/avoid/tick.hpp"
#include "core/world/threat_set.hpp"

namespace jink::avoid {

float cross_track(const world::Situation& s) noexcept
{
    return s.reference.route().abeam_of(s.own.position, s.reference.segment).off;
}

namespace {

/// Speed towards a bound that is `left` away: that leaves a second at least until there, and as long as the vehicle
/// needs to come there without a swing past it; and from which it can still stop, its lag included [m/s].
float speed_to_bound(float left, float acceleration, const world::Situation& s) noexcept
{
    constexpr Seconds kBoundTime = 1.0F;
    constexpr Seconds kUntilNext = 0.05F;  // a command is flown until the next one
    const Seconds lag = s.limits.velocity_lag + s.rules.latency + kUntilNext;
    const float way = std::max(left, 0.0F);
    return std::min(way / std::max(kBoundTime, 4.0F * s.limits.velocity_lag),
                    acceleration * (std::sqrt(lag * lag + 2.0F * way / acceleration) - lag));
}

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
            const float left = at.z() - half.z() - extra - bound.position.z();
            lowest = -speed_to_bound(left, s.limits.max_vertical_acceleration, s);
        } else if (bound.form == world::ThreatForm::ceiling) {
            const float left = bound.position.z() - at.z() - half.z() - extra;
            kept.z() = std::min(kept.z(), speed_to_bound(left, s.limits.max_vertical_acceleration, s));
        } else if (bound.form == world::ThreatForm::keep_in) {
            const Vec3 from_home(at.x() - bound.position.x(), at.y() - bound.position.y(), 0.0F);
            const float off = from_home.norm();
            if (off > 0.0F) {
                const float left = bound.level_radius - off - half.head<2>().norm() - extra;
                const float outward = from_home.dot(kept) / off;
                const float most = speed_to_bound(left, s.limits.max_acceleration, s);
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

ParallelOffset parallel_offset(const world::Situation& s) noexcept
{
    const path::RouteView route = s.reference.route();
    const float length = route.length();
    ParallelOffset parallel;
    if (length > 0.0F) {
        const path::Abeam abeam = route.abeam_of(s.own.position, s.reference.segment);
        const Vec3 from_route = s.own.position - abeam.point.position;
        parallel.left = length - abeam.arc_length;
        parallel.off = from_route - from_route.dot(abeam.point.along) * abeam.point.along;
        parallel.command = vehicle::clamped_velocity(abeam.point.along, s.reference.speed, s.limits);
    }
    return parallel;
}

bool is_held_by_bounds(const world::Situation& s, const Vec3& removed, const Vec3& left, float on_leg) noexcept
{
    /// Slower than this nothing is gained by going on [m/s].
    constexpr float kNoGain = 0.2F;
    const Vec3 off = parallel_offset(s).off;
    const bool off_the_leg = off.head<2>().norm() > on_leg;
    return removed.head<2>().norm() > 0.0F || (removed.z() != 0.0F && (!off_the_leg || left.norm() < kNoGain));
}

/// Near enough to the leg for control to be given back. Held at a bound of the airspace, the vehicle is as
/// near to the leg as we may bring it. To measured motion nobody means to come back: beside it, as where wind keeps the
/// vehicle off, control is given back once nothing has been in the way for a while.
bool StateMachine::is_back(const Tick& tick) const noexcept
{
    constexpr Seconds kClearBeside = 5.0F;
    const float on_leg = settings_.on_leg;
    const bool beside = tick.s.reference.measured && is_clear_for(tick, kClearBeside);
    const bool held = is_held_by_bounds(tick.s, tick.removed, tick.out.velocity, on_leg);
    if (beside || cross_track(tick.s) <= on_leg || tick.nominal.length <= on_leg || held) {
        return true;
    }
    // A fixed wing above or below its leg needs no turn to follow it; past its end nothing is left of it.
    const ParallelOffset parallel = parallel_offset(tick.s);
    return tick.s.limits.kind == vehicle::VehicleKind::fixed_wing &&
           (parallel.off.head<2>().norm() <= on_leg || parallel.left <= 0.0F);
}

/// Along the nominal path, at its end a stop [m/s].
static Vec3 nominal_velocity(const world::Way& nominal) noexcept
{
    return nominal.length > 0.0F ? Vec3(nominal.direction * nominal.speed) : Vec3(Vec3::Zero());
}

void StateMachine::follow_nominal(Tick& tick) const noexcept
{
    tick.out.wants_control = true;
    tick.out.kind = world::ManoeuvreKind::velocity;
    const Vec3 wanted = nominal_velocity(tick.nominal);
    tick.out.velocity = kept_inside(tick.s, wanted);
    tick.removed = wanted - tick.out.velocity;
}

/// The path back is not clear, but flying parallel to the leg is: past slow threats, or until they have gone. Going
/// back to the leg behind such a threat would only mean to go around it again.
bool StateMachine::keep_parallel(Tick& tick) noexcept
{
    const ParallelOffset parallel = parallel_offset(tick.s);
    if (!tick.out.conflict || tick.s.limits.kind != vehicle::VehicleKind::multirotor ||
        parallel.off.norm() <= settings_.on_leg || parallel.left <= world::kRejoinLookahead) {
        return false;
    }
    const float margin = command_margin(tick.s, parallel.command, tick.s.rules.lookahead, settings_, tick.budget);
    const bool kept = phase_ == Phase::parallel_offset;
    if (!(margin >= (kept ? 0.0F : tick.s.rules.clearance))) {
        return false;
    }
    diagnostics_.holds += kept ? 0U : 1U;
    tick.out.wants_control = true;
    tick.out.kind = world::ManoeuvreKind::velocity;
    tick.out.velocity = parallel.command;
    tick.out.margin = margin;
    return true;
}

/// The flight back is another one than the straight nominal path that conflicts are searched on: until the vehicle has
/// turned to that, it goes on with what its velocity has across it, a fixed wing for seconds and on a long arc. So far
/// ahead the flight is checked; 0 where the vehicle stands or is on its way already.
Seconds StateMachine::time_to_turn(const Tick& tick) const noexcept
{
    /// A half turn at 30 degrees of bank and 18 m/s takes 10 s, a quarter 5 s.
    constexpr Seconds kTurning = 8.0F;
    /// Slower than this across the path, the flight is the path [m/s].
    constexpr float kAlong = 0.3F;
    const vehicle::VehicleLimits& limits = tick.s.limits;
    if (limits.kind == vehicle::VehicleKind::fixed_wing) {
        return std::min(tick.s.rules.lookahead, kTurning);
    }
    const Vec3& velocity = tick.s.own.velocity;
    const Vec3 across = velocity - std::max(velocity.dot(tick.nominal.direction), 0.0F) * tick.nominal.direction;
    if (across.norm() < kAlong) {
        return 0.0F;
    }
    return std::max(across.head<2>().norm() / limits.max_acceleration,
                    std::abs(across.z()) / limits.max_vertical_acceleration) +
           limits.velocity_lag + settings_.reserve;
}

/// Clear of all but the bounds of the airspace, which `kept_inside` keeps.
static float margin_inside(const world::Situation& s, const Vec3& command, Seconds ahead, const Settings& settings,
                           WorkBudget& budget) noexcept
{
    const auto is_bound = [](const world::Threat& t) {
        return t.form == world::ThreatForm::floor || t.form == world::ThreatForm::ceiling ||
               t.form == world::ThreatForm::keep_in;
    };
    world::Situation others = s;
    while (!others.threats.empty() && is_bound(others.threats.front())) {
        others.threats = {others.threats.data() + 1, others.threats.size() - 1};
    }
    return command_margin(others, command, ahead, settings, budget);
}

/// Whether that flight is clear.
bool StateMachine::leads_back(Tick& tick) const noexcept
{
    const Seconds ahead = time_to_turn(tick);
    if (!tick.back_margin && ahead > 0.0F) {
        const Vec3 back = kept_inside(tick.s, nominal_velocity(tick.nominal));
        tick.back_margin = margin_inside(tick.s, back, ahead, settings_, tick.budget);
    }
    return !tick.back_margin || *tick.back_margin >= 0.0F;
}

/// While the flight back is not clear the vehicle keeps its course; where the course is not clear either, it falls
/// back.
bool StateMachine::keep_course(Tick& tick) noexcept
{
    if (leads_back(tick)) {
        return false;
    }
    Vec3 on = tick.s.own.velocity;
    on.z() = tick.s.limits.kind == vehicle::VehicleKind::fixed_wing ? 0.0F : on.z();
    on = kept_inside(tick.s, on);
    const float margin = margin_inside(tick.s, on, time_to_turn(tick), settings_, tick.budget);
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

/// A bound of the airspace bends the command off the way back, along which conflicts were searched: whether it leads
/// into a conflict that there would be no time to stop for.
bool StateMachine::is_bent_into_conflict(Tick& tick) const noexcept
{
    const Vec3& command = tick.out.velocity;
    const float speed = command.norm();
    if (!tick.in_control || tick.removed == Vec3::Zero() || !(speed > 0.0F)) {
        return false;
    }
    const Seconds ahead = std::max(vehicle::stopping_time(command, tick.s.limits),
                                   vehicle::stopping_time(tick.s.own.velocity, tick.s.limits)) +
                          settings_.reserve;
    const Vec3& at = tick.s.own.position;
    const world::Reference along({at, at + tick.s.rules.lookahead * command, speed});
    const world::Situation bent = world::with_reference(tick.s, along);
    world::Conflict conflict;
    return world::main_conflict(bent, world::way_of(bent), ahead, tick.budget, conflict);
}

void StateMachine::rejoin(Tick& tick) noexcept
{
    if (keep_parallel(tick)) {
        enter(Phase::parallel_offset);
        return;
    }
    enter(Phase::rejoining);
    if (tick.out.conflict) {
        const bool urgent = is_urgent(tick, tick.out.conflict->time_to_loss);
        if (is_due(tick, tick.out.conflict->time_to_loss) && plan(tick, urgent)) {
            take(tick);
            return;
        }
        if (urgent) {
            fall_back(tick);
            return;
        }
    }
    if (tick.in_control && keep_course(tick)) {
        return;
    }
    follow_nominal(tick);
    if (is_bent_into_conflict(tick)) {
        fall_back(tick);
        return;
    }
    if (is_back(tick) && is_clear_for(tick, settings_.settle) && may_give_back(tick)) {
        ++diagnostics_.rejoined;
        flying_.reset();
        enter(Phase::giving_back);
        // The velocity stays valid: it is flown until the autopilot has its mode back.
        tick.out.wants_control = false;
    }
}

}  // namespace jink::avoid
