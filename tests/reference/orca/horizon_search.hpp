// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>

#include "core/orca/program.hpp"

// Alejo's alternative for contradicting half-spaces, for comparison: a shorter horizon instead of yielding half-spaces
// (Alejo 7.1). Shorter horizons permit nearer collisions, and may all be infeasible. The product uses solve().

namespace jink::orca {

/// Result of a search.
struct HorizonFound {
    float horizon = 0.0F;  ///< [s] the longest feasible horizon found; 0: none
    Solution solution;     ///< for `horizon`; if none is feasible, for the shortest
};

/// Searches the longest feasible horizon in [least, longest], to a 256th of the difference.
///
/// @param build  (float horizon) -> std::span<const HalfSpace>: all half-spaces with this horizon, by level, valid
/// until
///               the next call
/// @param problem  all but its half-spaces
/// At most ten programs.
template <class Build>
[[nodiscard]] HorizonFound longest_horizon(Build&& build, Problem problem, float least, float longest,
                                           ScratchView scratch, WorkBudget& budget) noexcept
{
    constexpr int kHalvings = 8;
    const auto solve_with = [&](float horizon) {
        problem.planes = build(horizon);
        return HorizonFound{horizon, solve(problem, scratch, budget)};
    };
    HorizonFound out = solve_with(longest);
    if (out.solution.status == 0) {
        return out;
    }
    out = solve_with(least);
    if (out.solution.status != 0) {
        out.horizon = 0.0F;
        return out;
    }
    float high = longest;
    for (int i = 0; i < kHalvings; ++i) {
        const HorizonFound middle = solve_with(0.5F * (out.horizon + high));
        if (middle.solution.status == 0) {
            out = middle;
        } else {
            high = middle.horizon;
        }
    }
    return out;
}

}  // namespace jink::orca
