// SPDX-License-Identifier: BSD-3-Clause
// Keeping well clear of aircraft: they come before all that methods plan, and never before contact.
#include "core/avoid/give_way.hpp"
#include "core/avoid/tick.hpp"

namespace jink::avoid {
namespace {

/// A loss of the well clear volume nearer than this is acted on: to climb or descend out of it takes 25 s [s].
constexpr Seconds kActBefore = 45.0F;

}  // namespace

/// Looks for aircraft on the nominal path; whether the vehicle has to give way, or does so.
bool StateMachine::see_aircraft(Tick& tick) noexcept
{
    const bool gives = gives_way();
    world::Conflict conflict;
    WorkBudget budget = tick.budget.part(tick.budget.left() / 2);
    tick.out.alert = world::aircraft_conflict(tick.s, tick.nominal, gives, budget, conflict);
    tick.budget.charge(budget);
    const bool acts = tick.out.alert != world::Alert::none && (gives || conflict.time_to_loss <= kActBefore);
    if (acts && !tick.out.conflict) {
        tick.out.conflict = conflict;
    }
    return acts || gives;
}

/// False where nothing that gives way is safe: what contact asks for is done then.
bool StateMachine::give_way(Tick& tick) noexcept
{
    const bool gives = gives_way();
    if (gives && is_clear_for(tick, settings_.settle)) {
        flying_.reset();
        if (phase_ == Phase::avoiding) {
            enter(Phase::rejoining);
        }
        return false;
    }
    const Vec3 along = parallel_offset(tick.s).command;
    const Vec3* const previous = gives ? &flying_->command : nullptr;
    const std::uint32_t left = tick.budget.left();
    WorkBudget budget = tick.budget.part(left - left / 4);  // the rest for what is done where nothing gives way
    const std::optional<float> margin = choose_give_way(tick.s, along, previous, settings_, budget, answer_);
    tick.budget.charge(budget);
    tick.ran_out = tick.ran_out || budget.exhausted();
    if (!margin) {
        return false;
    }
    if (phase_ == Phase::given_up) {
        enter(Phase::watching);
    }
    if (tick.in_control && phase_ != Phase::avoiding && phase_ != Phase::braking) {
        control_since_ = phase_ == Phase::watching || phase_ == Phase::giving_back ? tick.s.now : control_since_;
        enter(Phase::rejoining);
    }
    if (gives) {
        flying_ = answer_;
        fly(answer_, tick);
        if (tick.in_control && phase_ != Phase::avoiding) {
            enter(Phase::avoiding);
        }
    } else {
        ++diagnostics_.gave_way;
        take(tick);
    }
    tick.out.margin = *margin;
    return true;
}

}  // namespace jink::avoid
