// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>

#include "core/avoid/sliced_plan.hpp"
#include "firmware/app/fiber_flow.hpp"

namespace jink::app {

/// What a plan needs that goes on over several steps: its stack, and its snapshot of the situation. The stack comes
/// first: at the start of a memory, an overflow leaves it and faults.
struct PlanMemory {
#ifdef __linux__
    static constexpr std::size_t kStack = 256U * 1024U;  ///< space for instrumented code
#else
    /// Deeper than the call graph of a plan with the deepest interrupt on top (docs/evidence/memory).
    static constexpr std::size_t kStack = 8U * 1024U;
#endif

    alignas(16) std::array<std::byte, kStack> stack;
    FiberFlow flow{stack};
    avoid::SlicedPlan plan{flow};
};

}  // namespace jink::app
