// SPDX-License-Identifier: BSD-3-Clause
// Flying a checked manoeuvre: how long it is kept, and what replaces it.
#include "core/avoid/tick.hpp"
#include "core/world/passing_side.hpp"
#include "core/world/threat_set.hpp"

namespace jink::avoid {
namespace {

/// Sides further apart than this (cosine) are opposite ones.
constexpr float kOppositeSide = -0.1F;
/// A manoeuvre whose mean speed is below this share of the nominal path's is slow: a better one is sought now and then.
constexpr float kSlow = 0.8F;
/// And taken when it is faster by this factor, and on the same side (cosine).
constexpr float kFaster = 1.3F;
constexpr float kSameSide = 0.5F;
/// Time between two searches [s].
constexpr Seconds kSeekAgain = 1.0F;

float mean_speed(const world::Manoeuvre& manoeuvre) noexcept
{
    const Seconds duration = manoeuvre.path.duration();
    return duration > 0.0F ? path::arc_length(manoeuvre.path) / duration : 0.0F;
}

/// Whether a manoeuvre leads to the side on which both vehicles pass.
bool passes_by_rule(const world::Situation& s, const world::ThreatRef& against,
                    const world::Manoeuvre& manoeuvre) noexcept
{
    const std::span tracks = world::of_kind(s.threats, world::ThreatKind::track);
    return against.kind == world::ThreatKind::track && against.index < tracks.size() &&
           world::passing_side(s, tracks[against.index]).dot(manoeuvre.side) > -kOppositeSide;
}

}  // namespace

/// Makes the answer the manoeuvre that is flown (or offered, while not in control).
void StateMachine::take(Tick& tick) noexcept
{
    if (tick.in_control) {
        if (phase_ == Phase::avoiding) {
            ++diagnostics_.replans;
            diagnostics_.flips += flying_->side.dot(answer_.side) < kOppositeSide ? 1U : 0U;
        } else {
            ++diagnostics_.manoeuvres;
        }
        enter(Phase::avoiding);
        tick.out.new_manoeuvre = true;
    }
    flying_ = answer_;
    chosen_side_ = answer_.side;
    all_asked_at_ = tick.s.now;
    faster_sought_at_.reset();
    if (answer_.kind != world::ManoeuvreKind::velocity && mean_speed(answer_) < kSlow * tick.nominal.speed) {
        faster_sought_at_ = tick.s.now;
    }
    fallback_.reset();
    fly(answer_, tick);
}

/// The command of what is flown.
void StateMachine::fly(const world::Manoeuvre& manoeuvre, Tick& tick) const noexcept
{
    tick.out.wants_control = true;
    tick.out.kind = manoeuvre.kind;
    tick.out.by = manoeuvre.by;
    tick.out.velocity = manoeuvre.kind == world::ManoeuvreKind::velocity
                            ? manoeuvre.command
                            : path::follow(manoeuvre.path, tick.s.now - manoeuvre.start, tick.s.own.position,
                                           tick.s.limits, tick.s.rules.gains);
}

/// A velocity is good for one update: its method is asked again, and now and then all of them. False where there is no
/// answer: then the flown velocity is checked, and all are asked next.
bool StateMachine::renew(Tick& tick) noexcept
{
    if (flying_->kind != world::ManoeuvreKind::velocity) {
        return false;
    }
    const bool alone = all_asked_at_ && tick.s.now - *all_asked_at_ < kSeekAgain;
    if (!alone && !plan_runs()) {
        all_asked_at_ = tick.s.now;
    }
    if (!plan(tick, false, alone ? flying_->by : 0)) {
        if (tick.out.plan_status != world::PlanStatus::running) {
            all_asked_at_.reset();
        }
        return false;
    }
    if (answer_.kind != world::ManoeuvreKind::velocity) {
        take(tick);
        return true;
    }
    flying_ = answer_;
    fly(answer_, tick);
    if (is_clear_for(tick, settings_.settle) && leads_back(tick)) {
        enter(Phase::rejoining);
        rejoin(tick);
    }
    return true;
}

/// A manoeuvre that was slow, because nothing faster was clear then, is not flown to its end when something faster is.
bool StateMachine::find_faster(Tick& tick) noexcept
{
    if (!faster_sought_at_ || !tick.out.conflict) {
        return false;
    }
    if (!plan_runs()) {
        if (tick.s.now - *faster_sought_at_ < kSeekAgain) {
            return false;
        }
        faster_sought_at_ = tick.s.now;
    }
    const float margin = tick.out.margin;
    const Vec3& side = flying_->side;
    if (plan(tick, false) && mean_speed(answer_) > kFaster * mean_speed(*flying_) &&
        (side == Vec3::Zero() || side.dot(answer_.side) >= kSameSide)) {
        take(tick);
        return true;
    }
    tick.out.margin = margin;
    return false;
}

/// The flown manoeuvre is not clear to its end. An answer on its side is taken at once; so is one that goes over to the
/// side on which two vehicles pass that avoid each other: of two that have chosen the same side, one has to go over.
/// Any other answer on the other side, of what was chosen or of where the vehicle is, counts as noise as long as there
/// is time. That answer, or else the fallback, is taken when the margin would be entered before the latest manoeuvre
/// time; its worst instant may lie far behind that.
void StateMachine::replace(Tick& tick, const world::ThreatRef& against) noexcept
{
    const float margin = tick.out.margin;
    const bool found = plan(tick, true);
    const bool turns_over =
        found && (flying_->side.dot(answer_.side) < kOppositeSide || chosen_side_.dot(answer_.side) < kOppositeSide);
    if (found && (!turns_over || passes_by_rule(tick.s, against, answer_))) {
        take(tick);
        return;
    }
    const Seconds latest = latest_manoeuvre_time(tick);
    if (check_manoeuvre(tick.s, *flying_, settings_, tick.budget, latest, kSignAlone).margin >= 0.0F) {
        tick.out.margin = margin;
        return;
    }
    if (found) {
        take(tick);
    } else {
        fall_back(tick);
    }
}

void StateMachine::avoid(Tick& tick) noexcept
{
    if (renew(tick)) {
        return;
    }
    if (tick.s.now - flying_->start >= flying_->path.duration()) {
        enter(Phase::rejoining);
        rejoin(tick);
        return;
    }
    const world::Separation ahead = check_manoeuvre(tick.s, *flying_, settings_, tick.budget);
    tick.out.margin = ahead.margin;
    fly(*flying_, tick);
    const bool heads_back = tick.out.velocity.dot(parallel_offset(tick.s).off) < 0.0F;
    if ((ahead.margin < 0.0F || heads_back || faster_sought_at_) && keep_parallel(tick)) {
        enter(Phase::parallel_offset);
        return;
    }
    if (ahead.margin < 0.0F) {
        replace(tick, ahead.against);
        return;
    }
    if (find_faster(tick)) {
        return;
    }
    if (is_clear_for(tick, settings_.settle) && leads_back(tick)) {
        enter(Phase::rejoining);
        rejoin(tick);
    }
}

}  // namespace jink::avoid
