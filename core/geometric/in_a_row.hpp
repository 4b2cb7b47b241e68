// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/geometric/planner.hpp"

namespace jink::geometric::detail {

/// Consecutive collision points (Pinheiro 6.2), two-stage: replans along the avoidance path. First from the start to
/// beside the main threat, the top of a symmetric curve; then from there, as `solve`, around what is first in the
/// straight way back to the leg. Where the second part fails, both once more with the first one on another side. The
/// whole is flown and checked as one path, escape rule and all, before it is taken.
///
/// `result`: of the second part, but for the path, the duration and the side, which are of the whole; its cost is that
/// of the more expensive part, and it is cut short where any part or the check of a whole was. At most kMaxPathPoints
/// points. O(two times two `solve` and one flight), at most 4 Settings::check_units for checks, and as much for the
/// flights of the whole.
[[nodiscard]] world::PlanStatus solve_in_a_row(const Problem& problem, const Settings& settings,
                                               const vehicle::VehicleLimits& limits, const vehicle::Airframe& airframe,
                                               WorkBudget& budget, Workspace& workspace, Result& result) noexcept;

}  // namespace jink::geometric::detail
