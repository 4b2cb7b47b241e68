// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <concepts>
#include <cstdint>

#include "core/base/work_budget.hpp"
#include "core/world/world.hpp"

namespace jink::world {

/// What a supervisor has to know of a method before it asks.
struct MethodTraits {
    std::uint8_t id;       ///< by which orders name it; unique among the methods of a supervisor, not 0
    bool reactive;         ///< answers with a velocity that is good for one update
    bool keeps_clearance;  ///< keeps a clearance buffer by itself: needs no plan for an inflated vehicle first
    bool needs_sets;       ///< answers out of reach sets that were computed for one vehicle
};

/// An avoidance method: any type with these `kTraits` and this `plan`. `out` is written only on PlanStatus::found. No
/// base class: the supervisor asks methods in order, tests hold them to one oracle, benchmarks line them up.
template <class M>
concept AvoidanceMethod = requires(M& method, const Situation& situation, WorkBudget& budget, Manoeuvre& out)
{
    {
        M::kTraits
    }
    noexcept->std::convertible_to<MethodTraits>;
    {
        method.plan(situation, budget, out)
    }
    noexcept->std::same_as<PlanStatus>;
};

}  // namespace jink::world
