// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/geometric/planner.hpp"

// One attempt of several at the same threats. Private to this module.

namespace jink::geometric::detail {

/// Threats that are valid and within the capacities, and a main threat that is there. False as well when the budget is
/// too small. O(threats + vertices of hulls).
[[nodiscard]] bool has_valid_threats(const Problem& problem, WorkBudget& budget) noexcept;

/// `solve` for threats, limits and an airframe that are known to be valid: settings and the problem's numbers are
/// checked here.
[[nodiscard]] world::PlanStatus solve_valid(const Problem& problem, const Settings& settings,
                                            const vehicle::VehicleLimits& limits, const vehicle::Airframe& airframe,
                                            WorkBudget& budget, Workspace& workspace, Result& result) noexcept;

/// Without candidates, path or any other result.
inline void clear(Result& result) noexcept
{
    result.candidates.clear();
    result.path.points.clear();
    result.side = Vec3::Zero();
    result.chosen = result.attempt = 0;
    result.cut_short = false;
}

/// The result of input that is refused, or of a budget that does not reach for looking at it.
[[nodiscard]] inline world::PlanStatus refused(const WorkBudget& budget, Result& result) noexcept
{
    clear(result);
    result.cut_short = budget.exhausted();
    return result.cut_short ? world::PlanStatus::budget_spent : world::PlanStatus::bad_input;
}

}  // namespace jink::geometric::detail
