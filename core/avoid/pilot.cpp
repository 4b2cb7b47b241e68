// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>

#include "core/avoid/pilot_tick.hpp"

namespace jink::avoid {
namespace {

/// Below this speed the vehicle counts as standing [m/s].
constexpr float kStanding = 0.3F;
/// A way that is free but narrow is trusted after this many times the settling time.
constexpr float kNarrowPatience = 3.0F;
/// Sides further apart than this (cosine) are opposite ones.
constexpr float kOppositeSide = -0.1F;

/// A manoeuvre whose mean speed is below this share of the way's is a slow one: a better one is looked for now and
/// then.
constexpr float kSlow = 0.8F;
/// And taken when it is faster by this factor, and on the same side (cosine).
constexpr float kFaster = 1.3F;
constexpr float kSameSide = 0.5F;
/// Clear or not is all that is asked.
constexpr world::Cutoff kSignAlone{0.0F, 0.0F, {}};
/// Slower than this, a conflict lies too near for a plan around it [m/s].
constexpr float kCreeping = 1.5F;
/// Share of the fallback horizon that is left for getting out of the way: sooner, the fallback sees no need to.
constexpr float kGetGoing = 0.75F;
/// Time between two looks [s].
constexpr Seconds kLookAgain = 1.0F;

float mean_speed(const world::Manoeuvre& manoeuvre) noexcept
{
    const Seconds duration = manoeuvre.path.duration();
    return duration > 0.0F ? path::arc_length(manoeuvre.path) / duration : 0.0F;
}

}  // namespace

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
    had_control_ = has_flying_ = has_fallback_ = standing_ = beside_ = was_clear_ = was_free_ = has_commanded_ = false;
    gave_back_ = blocked_ = on_other_ = false;
    ground_given_ = 0.0F;
}

/// Tracks get better and threats come nearer: what lies further ahead is planned for when it is known better.
bool Pilot::due(const Tick& tick, Seconds time_to_loss) const noexcept
{
    return time_to_loss <= settings_.commit || urgent(tick, time_to_loss);
}

/// Nearer than this, it is time to stop; or to get going, where the vehicle as good as stands in the way of traffic:
/// stopping mends nothing then.
Seconds Pilot::last_moment(const Tick& tick) const noexcept
{
    const bool stays = tick.way.length <= settings_.on_leg || tick.way.speed < kCreeping;
    const bool traffic = tick.out.has_conflict && tick.out.conflict.threat.kind == world::ThreatKind::track;
    const Seconds stop = time_to_stop(tick.s, settings_);
    return stays && traffic ? std::max(stop, kGetGoing * settings_.fallback_horizon) : stop;
}

bool Pilot::urgent(const Tick& tick, Seconds time_to_loss) const noexcept { return time_to_loss <= last_moment(tick); }

/// Asks for a plan with room to spare; in a tight place for one without.
bool Pilot::plan(Tick& tick) noexcept
{
    const Wider wider(tick.s, settings_.room);
    WorkBudget planning(std::min(settings_.plan_budget, tick.budget.left()));
    float margin = 0.0F;
    tick.out.plan_status = tick.ladder.plan(tick.ladder.self, {wider.situation, tick.s}, settings_, planning,
                                            diagnostics_, answer_, margin);
    const bool found = tick.out.plan_status == world::PlanStatus::found;
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
    chosen_side_ = answer_.side;
    is_slow_ = flying_.kind != world::ManoeuvreKind::velocity && mean_speed(flying_) < kSlow * tick.way.speed;
    looked_at_ = tick.s.now;
    has_flying_ = true;
    has_fallback_ = beside_ = false;
    fly(tick);
}

/// The command of what is flown.
void Pilot::fly(Tick& tick) const noexcept
{
    tick.out.wants_control = true;
    tick.out.kind = flying_.kind;
    tick.out.velocity = flying_.kind == world::ManoeuvreKind::velocity
                            ? flying_.command
                            : path::follow(flying_.path, tick.s.now - flying_.start, tick.s.own.position, tick.s.limits,
                                           settings_.gains);
}

/// A velocity is good for a tick: the methods are asked again. False where they have no answer: what was flown is
/// looked at then.
bool Pilot::renew(Tick& tick) noexcept
{
    if (flying_.kind != world::ManoeuvreKind::velocity || !plan(tick)) {
        return false;
    }
    if (answer_.kind != world::ManoeuvreKind::velocity) {
        take(tick);
        return true;
    }
    flying_ = answer_;
    fly(tick);
    if (way_clear_for(tick, settings_.settle)) {
        enter_rejoining();
        rejoin(tick);
    }
    return true;
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
    beside_ = false;
    tick.out.wants_control = true;
    tick.out.kind = chosen.kind;
    tick.out.margin = chosen.margin;
    tick.out.velocity = chosen.kind == world::ManoeuvreKind::hold_turn
                            ? turn_command(tick.s.own, tick.s.limits, chosen.command.z())
                            : chosen.command;
}

void Pilot::watch(Tick& tick) noexcept
{
    if (stays_given_up(tick)) {
        return;
    }
    if (tick.in_control && !gave_back_) {
        // Ours, whether the conflict is still there or not: control is given back by rejoining alone.
        enter_rejoining();
        rejoin(tick);
        return;
    }
    if (!tick.out.has_conflict) {
        if (tick.in_control) {
            // Being given back: keep to the leg meanwhile.
            follow_way(tick);
            tick.out.wants_control = cross_track(tick.s) > 2.0F * settings_.on_leg &&
                                     !is_held(tick.s, tick.taken, tick.out.velocity, settings_.on_leg);
            if (tick.out.wants_control) {
                keep_control(tick.s.now);
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
    if (tick.in_control) {
        keep_control(tick.s.now);
        enter_rejoining();
        rejoin(tick);
        return;
    }
    const Seconds left = tick.out.conflict.time_to_loss;
    if (due(tick, left) && plan(tick)) {
        take(tick);
    } else if (urgent(tick, left)) {
        fall_back(tick);
    }
}

/// What was planned slowly, because nothing faster was clear then, is not flown to its end when something faster is.
bool Pilot::find_faster(Tick& tick) noexcept
{
    if (!is_slow_ || !tick.out.has_conflict || tick.s.now - looked_at_ < kLookAgain) {
        return false;
    }
    looked_at_ = tick.s.now;
    const float margin = tick.out.margin;
    if (plan(tick) && mean_speed(answer_) > kFaster * mean_speed(flying_) &&
        (flying_.side == Vec3::Zero() || flying_.side.dot(answer_.side) >= kSameSide)) {
        take(tick);
        return true;
    }
    tick.out.margin = margin;
    return false;
}

/// What is flown is not clear to its end. Another one on its side is taken at once. The other side, of what was chosen
/// or of where the vehicle is, is held to be noise as long as there is time: it is taken, or the last rung, when the
/// margin would be entered before the last moment; its worst instant may lie far behind that.
void Pilot::replace(Tick& tick) noexcept
{
    const float margin = tick.out.margin;
    const bool found = plan(tick);
    const bool turns_over =
        found && (flying_.side.dot(answer_.side) < kOppositeSide || chosen_side_.dot(answer_.side) < kOppositeSide);
    if (found && !turns_over) {
        take(tick);
        return;
    }
    if (check_manoeuvre(tick.s, flying_, settings_, tick.budget, last_moment(tick), kSignAlone).margin >= 0.0F) {
        tick.out.margin = margin;
        return;
    }
    if (found) {
        take(tick);
    } else {
        fall_back(tick);
    }
}

void Pilot::avoid(Tick& tick) noexcept
{
    if (renew(tick)) {
        return;
    }
    if (tick.s.now - flying_.start >= flying_.path.duration()) {
        enter_rejoining();
        rejoin(tick);
        return;
    }
    const world::Separation ahead = check_manoeuvre(tick.s, flying_, settings_, tick.budget);
    tick.out.margin = ahead.margin;
    fly(tick);
    const bool heads_back = tick.out.velocity.dot(beside_leg(tick.s).off) < 0.0F;
    if ((ahead.margin < 0.0F || heads_back || is_slow_) && keep_beside(tick)) {
        enter_rejoining();
        return;
    }
    if (ahead.margin < 0.0F) {
        replace(tick);
        return;
    }
    if (find_faster(tick)) {
        return;
    }
    if (way_clear_for(tick, settings_.settle)) {
        enter_rejoining();
        rejoin(tick);
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

Guidance Pilot::update(const world::Situation& given, const world::Reference* other, bool in_control,
                       const Ladder& ladder) noexcept
{
    ++diagnostics_.updates;
    note_control(given.now, in_control);
    world::Situation first = given;
    static_cast<void>(threats_.collect(given));
    first.threats = threats_.all();
    first.flying = has_flying_ ? &flying_ : nullptr;
    first.commanded = in_control && has_commanded_ ? &commanded_ : nullptr;
    const world::Situation second = world::with_reference(first, other != nullptr ? *other : given.reference);
    Tick looked{first,
                other != nullptr ? &second : nullptr,
                in_control,
                ladder,
                WorkBudget(settings_.budget),
                world::way_of(first),
                {},
                false,
                Vec3::Zero(),
                false};
    choose_nominal(looked);
    Tick tick{looked.out.on_other ? second : first,
              looked.other,
              in_control,
              ladder,
              looked.budget,
              looked.way,
              looked.out,
              false,
              Vec3::Zero(),
              false};
    const Vec3 off = has_flying_ ? beside_leg(tick.s).off : Vec3(Vec3::Zero());
    const float far = off.norm();
    if (far > settings_.on_leg) {
        flying_.side = off / far;
    }
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
    note_block(tick);
    tick.out.state = state_;
    tick.out.work = tick.budget.spent();
    last_update_ = given.now;
    has_commanded_ = in_control && tick.out.wants_control;
    commanded_ = {tick.out.velocity, given.now};
    diagnostics_.budget_spent += tick.budget.exhausted() || tick.ran_out ? 1U : 0U;
    diagnostics_.most_work = std::max(diagnostics_.most_work, tick.budget.spent());
    return tick.out;
}

}  // namespace jink::avoid
