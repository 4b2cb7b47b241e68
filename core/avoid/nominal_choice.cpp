// SPDX-License-Identifier: BSD-3-Clause
// Two nominal paths: which one counts, and when control may be given back.
#include "core/avoid/tick.hpp"

namespace jink::avoid {
namespace {

/// The other nominal path counts when its loss of separation comes first by more than this, and the one that counts
/// stays: no change for noise [s].
constexpr Seconds kClearlyFirst = 0.5F;

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

/// Not into a conflict of the other nominal path, and not before control has been kept for a while.
bool StateMachine::may_give_back(Tick& tick) noexcept
{
    if (control_since_ && tick.s.now - *control_since_ < settings_.least_control) {
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
