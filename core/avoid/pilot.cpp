// SPDX-License-Identifier: BSD-3-Clause
#include "core/avoid/pilot.hpp"

#include <algorithm>

#include "core/geometry/sweep.hpp"

namespace jink::avoid {
namespace {

/// Below this speed the vehicle counts as standing [m/s].
constexpr float kStanding = 0.3F;
/// A way that is free but narrow is trusted after this many times the settling time.
constexpr float kNarrowPatience = 3.0F;
/// Sides further apart than this (cosine) are opposite ones.
constexpr float kOppositeSide = -0.1F;

float cross_track(const world::Situation& s) noexcept
{
    return geometry::point_segment_distance(s.own.position, s.reference.leg.start, s.reference.leg.end);
}

/// The same situation for a vehicle with `extra` more to every side.
struct Wider {
    vehicle::VehicleLimits limits;
    world::Situation situation;

    Wider(const world::Situation& s, float extra) noexcept
        : limits(widened(s.limits, extra)), situation{s.now,    s.own,       limits,     s.airframe, s.reference,
                                                      s.tracks, s.obstacles, s.airspace, s.flying,   s.k_sigma}
    {
    }
    Wider(const Wider&) = delete;
    Wider& operator=(const Wider&) = delete;

    static vehicle::VehicleLimits widened(vehicle::VehicleLimits limits, float extra) noexcept
    {
        limits.half_extents += Vec3::Constant(extra);
        return limits;
    }
};

}  // namespace

struct Pilot::Tick {
    const world::Situation& s;
    bool in_control = false;
    const Ladder& ladder;
    WorkBudget budget;
    world::Way way;
    Guidance out;
    bool wide_clear = false;
    bool ran_out = false;  ///< of work, planning or altogether
};

bool Pilot::configure(const Settings& settings) noexcept
{
    if (!is_valid(settings)) {
        return false;
    }
    settings_ = settings;
    return true;
}

void Pilot::reset() noexcept
{
    state_ = State::watching;
    had_control_ = has_flying_ = has_fallback_ = standing_ = was_clear_ = was_free_ = false;
    ground_given_ = 0.0F;
}

/// Tracks get better and threats come nearer: what lies further ahead is planned for when it is known better.
bool Pilot::due(const Tick& tick, Seconds time_to_loss) const noexcept
{
    return time_to_loss <= settings_.commit || urgent(tick, time_to_loss);
}

/// Nearer than this, it is time to stop.
Seconds Pilot::last_moment(const Tick& tick) const noexcept
{
    return vehicle::stopping_time(tick.s.own.velocity.norm(), tick.s.limits) + settings_.reserve;
}

bool Pilot::urgent(const Tick& tick, Seconds time_to_loss) const noexcept { return time_to_loss <= last_moment(tick); }

/// Asks for a plan with room to spare; in a tight place for one without.
bool Pilot::plan(Tick& tick) noexcept
{
    const Wider wider(tick.s, settings_.room);
    WorkBudget planning(std::min(settings_.plan_budget, tick.budget.left()));
    float margin = 0.0F;
    bool found = false;
    for (const world::Situation* s : {&wider.situation, &tick.s}) {
        if (found || planning.exhausted()) {
            break;
        }
        ++diagnostics_.plans;
        tick.out.plan_status =
            tick.ladder.plan(tick.ladder.self, *s, settings_, planning, diagnostics_, answer_, margin);
        found = tick.out.plan_status == world::PlanStatus::found;
    }
    if (found) {
        ++diagnostics_.plans_found;
        tick.out.margin = margin;
    }
    tick.ran_out = tick.ran_out || planning.exhausted();
    static_cast<void>(tick.budget.spend(planning.spent()));  // never more than was left
    return found;
}

/// Makes the answer the manoeuvre that is flown (or offered, while not in control).
void Pilot::take(Tick& tick) noexcept
{
    if (tick.in_control) {
        if (has_flying_ && state_ == State::avoiding) {
            ++diagnostics_.replans;
            diagnostics_.flips += flying_.side.dot(answer_.side) < kOppositeSide ? 1U : 0U;
        } else {
            ++diagnostics_.manoeuvres;
        }
        state_ = State::avoiding;
        tick.out.new_manoeuvre = true;
    }
    flying_ = answer_;
    has_flying_ = true;
    has_fallback_ = false;
    tick.out.wants_control = true;
    tick.out.kind = flying_.kind;
    tick.out.velocity =
        path::follow(flying_.path, tick.s.now - flying_.start, tick.s.own.position, tick.s.limits, settings_.gains);
}

void Pilot::fall_back(Tick& tick) noexcept
{
    const Fallback chosen =
        choose_fallback(tick.s, tick.way, has_fallback_ ? &fallback_ : nullptr, settings_, tick.budget);
    if (tick.in_control) {
        diagnostics_.brakes += state_ != State::braking ? 1U : 0U;
        const bool moves = chosen.kind == world::ManoeuvreKind::velocity;
        const bool moved = has_fallback_ && fallback_.kind == world::ManoeuvreKind::velocity;
        diagnostics_.escapes += moves && !moved ? 1U : 0U;
        state_ = State::braking;
    }
    fallback_ = chosen;
    has_fallback_ = true;
    tick.out.wants_control = true;
    tick.out.kind = chosen.kind;
    tick.out.margin = chosen.margin;
    tick.out.velocity = chosen.kind == world::ManoeuvreKind::hold_turn
                            ? turn_command(tick.s.own, tick.s.limits, chosen.command.z())
                            : chosen.command;
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

void Pilot::watch(Tick& tick) noexcept
{
    if (!tick.out.has_conflict) {
        if (tick.in_control) {
            // Ours without a reason (granted late, or being given back): keep to the leg meanwhile.
            follow_way(tick);
            tick.out.wants_control = cross_track(tick.s) > 2.0F * settings_.on_leg;
            if (tick.out.wants_control) {
                enter_rejoining();
            }
            return;
        }
        if (way_clear_for(tick, settings_.settle)) {
            has_flying_ = false;
        }
        has_fallback_ = false;
        return;
    }
    const Seconds left = tick.out.conflict.time_to_loss;
    if (due(tick, left) && plan(tick)) {
        take(tick);
    } else if (urgent(tick, left)) {
        fall_back(tick);
    } else if (tick.in_control) {
        enter_rejoining();
        follow_way(tick);
    }
}

void Pilot::avoid(Tick& tick) noexcept
{
    const Seconds flown = tick.s.now - flying_.start;
    if (flown >= flying_.path.duration()) {
        enter_rejoining();
        rejoin(tick);
        return;
    }
    const world::Separation ahead = check_manoeuvre(tick.s, flying_, settings_, tick.budget);
    tick.out.margin = ahead.margin;
    tick.out.wants_control = true;
    tick.out.kind = flying_.kind;
    tick.out.velocity = path::follow(flying_.path, flown, tick.s.own.position, tick.s.limits, settings_.gains);
    if (ahead.margin < 0.0F) {
        if (plan(tick)) {
            take(tick);
        } else if (check_manoeuvre(tick.s, flying_, settings_, tick.budget, last_moment(tick)).margin < 0.0F) {
            // What counts is when the margin is entered; its worst instant may lie far behind that.
            fall_back(tick);
        }
        return;
    }
    if (way_clear_for(tick, settings_.settle)) {
        enter_rejoining();
        rejoin(tick);
    }
}

void Pilot::rejoin(Tick& tick) noexcept
{
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

/// Standing in front of something that stays: back off, so that there is room to plan around it.
void Pilot::give_ground(Tick& tick) noexcept
{
    const bool stands = tick.s.own.velocity.norm() < kStanding + settings_.give_ground_speed;
    if (!stands) {
        standing_ = false;
        return;
    }
    if (!standing_) {
        standing_ = true;
        standing_since_ = tick.s.now;
    }
    const bool patient = tick.s.now - standing_since_ < settings_.blocked_patience;
    if (patient || settings_.give_ground_speed <= 0.0F || ground_given_ >= settings_.give_ground_limit ||
        fallback_.kind != world::ManoeuvreKind::brake) {
        return;
    }
    const Vec3 back = vehicle::clamped_velocity(-tick.way.direction, settings_.give_ground_speed, tick.s.limits);
    if (command_margin(tick.s, back, settings_, tick.budget) >= 0.0F) {
        ground_given_ += std::clamp(tick.s.now - last_update_, 0.0F, 1.0F);
        tick.out.velocity = back;
        tick.out.kind = world::ManoeuvreKind::velocity;
    }
}

void Pilot::brake(Tick& tick) noexcept
{
    // A way that stays free, but with little to spare, is not waited at for ever: it is tried after a longer look.
    const bool narrow = was_free_ && tick.s.now - free_since_ >= kNarrowPatience * settings_.settle;
    if (way_clear_for(tick, settings_.settle) || narrow) {
        enter_rejoining();
        rejoin(tick);
        return;
    }
    if (tick.out.has_conflict && plan(tick)) {
        standing_ = false;
        take(tick);
        return;
    }
    fall_back(tick);
    give_ground(tick);
}

Guidance Pilot::update(const world::Situation& given, bool in_control, const Ladder& ladder) noexcept
{
    ++diagnostics_.updates;
    if (had_control_ && !in_control && state_ != State::watching) {
        ++diagnostics_.control_lost;
        reset();
    }
    had_control_ = in_control;

    world::Situation situation = given;
    situation.flying = has_flying_ ? &flying_ : nullptr;
    Tick tick{situation, in_control, ladder, WorkBudget(settings_.budget), world::way_of(situation), {}, false, false};
    tick.out.has_conflict =
        world::main_conflict(situation, tick.way, settings_.lookahead, tick.budget, tick.out.conflict);
    diagnostics_.conflicts += tick.out.has_conflict && !in_conflict_ ? 1U : 0U;
    if (!tick.out.has_conflict && in_conflict_) {
        ground_given_ = 0.0F;
    }
    in_conflict_ = tick.out.has_conflict;
    note_clearness(tick);

    switch (state_) {
    case State::watching: watch(tick); break;
    case State::avoiding: avoid(tick); break;
    case State::rejoining: rejoin(tick); break;
    case State::braking: brake(tick); break;
    }
    tick.out.state = state_;
    tick.out.work = tick.budget.spent();
    last_update_ = situation.now;
    diagnostics_.budget_spent += tick.budget.exhausted() || tick.ran_out ? 1U : 0U;
    diagnostics_.most_work = std::max(diagnostics_.most_work, tick.budget.spent());
    return tick.out;
}

}  // namespace jink::avoid
