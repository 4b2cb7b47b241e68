// SPDX-License-Identifier: BSD-3-Clause
// The fallback, backing off from what blocks the nominal path, and giving up in front of it. What is cold here is rare,
// and small in flash rather than fast.
#include <algorithm>

#include "core/avoid/tick.hpp"
#include "core/world/threat_set.hpp"

namespace jink::avoid {
namespace {

/// Below this speed the vehicle counts as standing [m/s].
constexpr float kStanding = 0.3F;
/// A nominal path that is free but narrow is trusted after this many times the settling time.
constexpr float kNarrowPatience = 3.0F;
/// A vehicle that stays within this distance makes no progress: more than it backs off and comes forward again [m].
constexpr float kNoProgress = 15.0F;
/// Kept back from a fallback for what is checked after it (backing off, traffic that comes), at most a quarter of what
/// is left: of one prediction, and of each track against it [work units].
constexpr std::uint32_t kAfterwards = 400;
constexpr std::uint32_t kAfterwardsPerTrack = 100;

/// Whether traffic comes too near to a vehicle that stays here. The main conflict does not say: what blocks the nominal
/// path comes first there. Threats that were never collected count as traffic.
[[gnu::noinline, gnu::cold]] bool traffic_comes(const world::Situation& s, const Settings& settings,
                                                WorkBudget& budget) noexcept
{
    if (s.threats.data() == nullptr) {
        return true;
    }
    world::Situation alone = s;
    alone.threats = world::of_kind(s.threats, world::ThreatKind::track);
    return !alone.threats.empty() &&
           command_margin(alone, Vec3::Zero(), settings.fallback_horizon, settings, budget) < 0.0F;
}

}  // namespace

void StateMachine::fall_back(Tick& tick) noexcept
{
    const auto tracks = static_cast<std::uint32_t>(world::of_kind(tick.s.threats, world::ThreatKind::track).size());
    const std::uint32_t left = tick.budget.left();
    WorkBudget budget = tick.budget.part(left - std::min(left / 4, kAfterwards + kAfterwardsPerTrack * tracks));
    const Fallback chosen = choose_fallback(tick.s, tick.nominal, fallback_ ? &*fallback_ : nullptr, settings_, budget);
    tick.budget.charge(budget);
    tick.ran_out = tick.ran_out || budget.exhausted();
    if (tick.in_control) {
        diagnostics_.brakes += phase_ != Phase::braking ? 1U : 0U;
        const bool moves = chosen.kind == world::ManoeuvreKind::velocity;
        const bool moved = fallback_ && fallback_->kind == world::ManoeuvreKind::velocity;
        diagnostics_.escapes += moves && !moved ? 1U : 0U;
        enter(Phase::braking);
    }
    fallback_ = chosen;
    tick.out.wants_control = true;
    tick.out.kind = chosen.kind;
    tick.out.margin = chosen.margin;
    tick.out.velocity = chosen.kind == world::ManoeuvreKind::hold_turn
                            ? turn_command(tick.s.own, tick.s.limits, chosen.command.z())
                            : chosen.command;
}

/// Standing in front of something that stays: backs off, so that a plan around it has space.
[[gnu::cold]] void StateMachine::back_off(Tick& tick) noexcept
{
    if (!(tick.s.own.velocity.norm() < kStanding + settings_.back_off_speed)) {
        standing_since_.reset();
        return;
    }
    standing_since_ = standing_since_.value_or(tick.s.now);
    const bool patient = tick.s.now - *standing_since_ < settings_.blocked_patience;
    if (patient || settings_.back_off_speed <= 0.0F || backed_off_ >= settings_.back_off_limit ||
        tick.out.kind != world::ManoeuvreKind::brake) {
        return;
    }
    const Vec3 back = vehicle::clamped_velocity(-tick.nominal.direction, settings_.back_off_speed, tick.s.limits);
    if (command_margin(tick.s, back, settings_, tick.budget) >= 0.0F) {
        backed_off_ += std::clamp(tick.s.now - last_update_, 0.0F, 1.0F);
        tick.out.velocity = back;
        tick.out.kind = world::ManoeuvreKind::velocity;
    }
}

void StateMachine::brake(Tick& tick) noexcept
{
    // A path that stays free, but with little to spare, is tried after a longer wait.
    const bool narrow = free_since_ && tick.s.now - *free_since_ >= kNarrowPatience * settings_.settle;
    if ((is_clear_for(tick, settings_.settle) || narrow) && leads_back(tick)) {
        enter(Phase::rejoining);
        rejoin(tick);
        return;
    }
    if (tick.out.conflict && plan(tick, true)) {
        take(tick);
        return;
    }
    fall_back(tick);
    back_off(tick);
}

/// Given up, and no traffic comes: brakes until the autopilot holds.
[[gnu::cold]] bool StateMachine::stays_given_up(Tick& tick) noexcept
{
    if (phase_ != Phase::given_up) {
        return false;
    }
    if (traffic_comes(tick.s, settings_, tick.budget)) {
        control_since_ = tick.s.now;
        enter(Phase::watching);
        return false;
    }
    tick.out.blocked = true;
    tick.out.kind = world::ManoeuvreKind::brake;
    tick.out.velocity = Vec3::Zero();
    tick.out.wants_control = false;
    return true;
}

/// Gives up where static threats on the nominal path have kept the vehicle from any progress for too long.
void StateMachine::give_up_when_blocked(Tick& tick) noexcept
{
    const bool moves = tick.out.conflict && is_traffic(*tick.out.conflict);
    const Vec3& at = tick.s.own.position;
    if (!tick.in_control || moves || (at - block_at_).squaredNorm() > kNoProgress * kNoProgress) {
        block_at_ = at;
        block_since_ = tick.s.now;
        return;
    }
    // A path along the block may be flown in several manoeuvres, with stops between them: their time counts a quarter.
    if (phase_ != Phase::braking) {
        block_since_.us += 3 * (tick.s.now.us - last_update_.us) / 4;
    }
    const bool stands =
        tick.s.own.velocity.norm() < kStanding && tick.s.limits.kind == vehicle::VehicleKind::multirotor;
    const bool stuck = tick.out.conflict && stands && phase_ == Phase::braking;
    if (!stuck || settings_.patience <= 0.0F || tick.s.now - block_since_ < settings_.patience ||
        traffic_comes(tick.s, settings_, tick.budget)) {
        return;
    }
    ++diagnostics_.blocked;
    flying_.reset();
    enter(Phase::given_up);
    static_cast<void>(stays_given_up(tick));
}

}  // namespace jink::avoid
