// SPDX-License-Identifier: BSD-3-Clause
// Two nominal paths: which one counts, when control may be given back, and when it is taken so that all can stop.
#include <algorithm>
#include <array>
#include <limits>

#include "core/avoid/common_stop.hpp"
#include "core/avoid/tick.hpp"

namespace jink::avoid {
namespace {

/// The other nominal path counts when its loss of separation comes first by more than this, and the one that counts
/// stays: no change for noise [s].
constexpr Seconds kClearlyFirst = 0.5F;
constexpr float kAnySpeed = std::numeric_limits<float>::infinity();

}  // namespace

/// Whether a conflict on the other nominal path counts by now.
bool StateMachine::counts(const Tick& tick, const world::Conflict& conflict) const noexcept
{
    return conflict.threat.kind == world::ThreatKind::track || conflict.time_to_loss <= time_to_stop(tick.s, settings_);
}

/// Searches the nominal path for conflicts, and while watching the other one too; `tick.out` and `tick.nominal` are
/// those of the path that counts.
void StateMachine::choose_nominal(Tick& tick) noexcept
{
    Guidance& out = tick.out;
    world::Conflict conflict;
    if (world::main_conflict(tick.s, tick.nominal, tick.s.rules.lookahead, tick.budget, conflict)) {
        out.conflict = conflict;
    }
    if (tick.in_control || tick.other == nullptr) {
        return;
    }
    const world::Way nominal = world::way_of(*tick.other);
    conflict = {};
    const bool found = world::main_conflict(*tick.other, nominal, tick.s.rules.lookahead, tick.budget, conflict) &&
                       counts(tick, conflict);
    const Seconds ahead = conflict_on_ == ConflictOn::other ? -kClearlyFirst : kClearlyFirst;
    const bool first = found && (!out.conflict || conflict.time_to_loss + ahead < out.conflict->time_to_loss);
    diagnostics_.on_other += first && conflict_on_ == ConflictOn::none ? 1U : 0U;
    if (first) {
        out.on_other = true;
        out.conflict = conflict;
        tick.nominal = nominal;
    }
}

/// Whether all vehicles that avoid each other can stop if this one flies its nominal path for `ahead` before it does,
/// or for less: in this time nobody holds it back, and who flies past another one may be clear of it at the end alone.
/// `tick.out` follows the nominal path.
bool StateMachine::leaves_stop(Tick& tick, Seconds ahead) noexcept
{
    follow_nominal(tick);
    const Vec3& wanted = tick.out.velocity;
    if (wanted.squaredNorm() == 0.0F) {
        return true;  // nothing is won by taking control of a vehicle that stays
    }
    constexpr std::array kShares{1.0F, 0.5F, 0.0F};
    tick.out.for_stop = std::ranges::any_of(kShares, [&](float share) noexcept {
        return stoppable_command(tick.s, wanted, kAnySpeed, tick.budget, false, share * ahead) != wanted;
    });
    diagnostics_.for_stop += tick.out.for_stop ? 1U : 0U;
    return !tick.out.for_stop;
}

/// Not into a conflict of the other nominal path, not where that leaves no stop, and not before control has been kept
/// for a while.
bool StateMachine::may_give_back(Tick& tick) noexcept
{
    if (control_since_ && tick.s.now - *control_since_ < settings_.least_control) {
        return false;
    }
    if (!leaves_stop(tick, settings_.reserve + settings_.settle)) {
        return false;
    }
    if (tick.other == nullptr) {
        return true;
    }
    world::Conflict conflict;
    const world::Way nominal = world::way_of(*tick.other);
    tick.out.other_conflict =
        world::main_conflict(*tick.other, nominal, tick.s.rules.lookahead, tick.budget, conflict) &&
        counts(tick, conflict);
    diagnostics_.kept_control += tick.out.other_conflict ? 1U : 0U;
    return !tick.out.other_conflict;
}

}  // namespace jink::avoid
