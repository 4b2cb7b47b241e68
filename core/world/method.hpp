// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <concepts>

#include "core/base/work_budget.hpp"
#include "core/world/world.hpp"

namespace jink::world {

/// An avoidance method: any type with this `plan`. `out` is written only on PlanStatus::found. No base class: the
/// supervisor ladders through methods, tests hold them to one oracle, benchmarks line them up.
template <class M>
concept AvoidanceMethod = requires(M& method, const Situation& situation, WorkBudget& budget, Manoeuvre& out)
{
    {
        method.plan(situation, budget, out)
    }
    noexcept->std::same_as<PlanStatus>;
};

}  // namespace jink::world
