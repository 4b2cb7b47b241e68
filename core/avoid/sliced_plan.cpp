// SPDX-License-Identifier: BSD-3-Clause
#include "core/avoid/sliced_plan.hpp"

namespace jink::avoid {

void SlicedPlan::begin(const world::Situation& situation, const Planning& planning, const Settings& settings,
                       Diagnostics& diagnostics) noexcept
{
    snapshot_.take(situation);
    planning_ = planning;
    settings_ = settings;
    diagnostics_ = &diagnostics;
    choice_ = {};
    flow_.begin(&SlicedPlan::run, this);
}

bool SlicedPlan::advance(std::uint32_t units) noexcept
{
    slice_.begin(units);
    flow_.resume();
    spent_ = units - slice_.left();
    return !flow_.runs();
}

/// In the flow.
void SlicedPlan::run(void* self) noexcept
{
    SlicedPlan& plan = *static_cast<SlicedPlan*>(self);
    const world::Situation situation = plan.snapshot_.situation();
    const Inflated inflated(situation, situation.rules.clearance);
    WorkBudget budget(plan.settings_.plan_budget, plan.slice_);
    plan.choice_ = {};
    plan.status_ = plan.planning_.plan(plan.planning_.self, {inflated.situation, situation}, plan.settings_, budget,
                                       *plan.diagnostics_, plan.answer_, plan.choice_);
    plan.ran_out_ = budget.exhausted();
}

}  // namespace jink::avoid
