// SPDX-License-Identifier: BSD-3-Clause
// Two nominal paths: which one counts, when control may be given back, and when it is given up in front of what stands.
#include <algorithm>

#include "core/avoid/pilot_tick.hpp"

namespace jink::avoid {
namespace {

/// The other nominal path counts when its loss of separation comes first by more than this, and the one that counts
/// stays: no change for noise [s].
constexpr Seconds kClearlyFirst = 0.5F;
/// Within this distance the vehicle gets nowhere: more than it backs off and comes forward again [m].
constexpr float kNowhere = 15.0F;
/// Slower than this, nothing is under way that could still lead past [m/s].
constexpr float kAtRest = 0.3F;

/// Whether the conflict is with traffic: one that stands may move on.
bool is_traffic(const world::Conflict& conflict) noexcept { return conflict.threat.kind == world::ThreatKind::track; }

/// Whether traffic comes too near to a vehicle that stays here. The main conflict does not say: what blocks the way is
/// met first.
bool traffic_comes(const world::Situation& s, const Settings& settings, WorkBudget& budget) noexcept
{
    world::Situation alone = s;
    alone.threats = world::of_kind(s.threats, world::ThreatKind::track);
    return !alone.threats.empty() &&
           command_margin(alone, Vec3::Zero(), settings.fallback_horizon, settings, budget) < 0.0F;
}

}  // namespace

/// What is decided is decided: control is kept for a while, or kept after all.
void Pilot::keep_control(TimePoint now) noexcept
{
    gave_back_ = false;
    control_since_ = now;
}

void Pilot::note_control(TimePoint now, bool in_control) noexcept
{
    if (had_control_ && !in_control && state_ != State::watching) {
        ++diagnostics_.control_lost;
        reset();
    }
    if (in_control != had_control_) {
        keep_control(now);
        blocked_ = false;
    }
    had_control_ = in_control;
}

/// Whether a conflict on the other nominal path counts by now.
bool Pilot::counts(const Tick& tick, const world::Conflict& conflict) const noexcept
{
    return conflict.threat.kind == world::ThreatKind::track || conflict.time_to_loss <= time_to_stop(tick.s, settings_);
}

/// Looks at the nominal path, and while watching at the other one too; `tick.out` and `tick.way` are those of the path
/// that counts.
void Pilot::choose_nominal(Tick& tick) noexcept
{
    Guidance& out = tick.out;
    out.has_conflict = world::main_conflict(tick.s, tick.way, settings_.lookahead, tick.budget, out.conflict);
    if (tick.in_control || tick.other == nullptr) {
        on_other_ = false;
        return;
    }
    const world::Way way = world::way_of(*tick.other);
    world::Conflict conflict;
    const bool found =
        world::main_conflict(*tick.other, way, settings_.lookahead, tick.budget, conflict) && counts(tick, conflict);
    const Seconds ahead = on_other_ ? -kClearlyFirst : kClearlyFirst;
    const bool first = found && (!out.has_conflict || conflict.time_to_loss + ahead < out.conflict.time_to_loss);
    diagnostics_.on_other += first && !in_conflict_ ? 1U : 0U;
    on_other_ = first;
    if (first) {
        out.has_conflict = out.on_other = true;
        out.conflict = conflict;
        tick.way = way;
    }
}

/// Not into a conflict of the other nominal path, and not before control has been kept for a while.
bool Pilot::may_give_back(Tick& tick) noexcept
{
    if (tick.s.now - control_since_ < settings_.least_control) {
        return false;
    }
    if (tick.other == nullptr) {
        return true;
    }
    world::Conflict conflict;
    const world::Way way = world::way_of(*tick.other);
    tick.out.other_conflict =
        world::main_conflict(*tick.other, way, settings_.lookahead, tick.budget, conflict) && counts(tick, conflict);
    diagnostics_.kept_control += tick.out.other_conflict ? 1U : 0U;
    return !tick.out.other_conflict;
}

/// Given up, and nothing else has come up: brakes until the autopilot holds.
bool Pilot::stays_given_up(Tick& tick) noexcept
{
    if (!blocked_) {
        return false;
    }
    if (traffic_comes(tick.s, settings_, tick.budget)) {
        blocked_ = false;
        keep_control(tick.s.now);
        return false;
    }
    tick.out.blocked = true;
    tick.out.kind = world::ManoeuvreKind::brake;
    tick.out.velocity = Vec3::Zero();
    tick.out.wants_control = false;
    return true;
}

/// Gives up where what stands on the nominal path has kept the vehicle from getting anywhere for too long.
void Pilot::note_block(Tick& tick) noexcept
{
    const bool moves = tick.out.has_conflict && is_traffic(tick.out.conflict);
    const Vec3& at = tick.s.own.position;
    if (!tick.in_control || moves || (at - block_at_).squaredNorm() > kNowhere * kNowhere) {
        block_at_ = at;
        block_since_ = tick.s.now;
        return;
    }
    const bool stands = tick.s.own.velocity.norm() < kAtRest && tick.s.limits.kind == vehicle::VehicleKind::multirotor;
    const bool stuck = tick.out.has_conflict && stands && state_ == State::braking;
    if (!stuck || blocked_ || settings_.patience <= 0.0F || tick.s.now - block_since_ < settings_.patience ||
        traffic_comes(tick.s, settings_, tick.budget)) {
        return;
    }
    ++diagnostics_.blocked;
    state_ = State::watching;
    has_flying_ = has_fallback_ = standing_ = false;
    gave_back_ = blocked_ = true;
    static_cast<void>(stays_given_up(tick));
}

}  // namespace jink::avoid
