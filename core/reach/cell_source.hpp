// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>

#include "core/base/work_budget.hpp"
#include "core/reach/cell_balls.hpp"
#include "core/reach/evaluation.hpp"
#include "core/reach/placed.hpp"
#include "core/world/world.hpp"

namespace jink::reach {

enum class RateStatus : std::uint8_t {
    rated,
    nothing_known,  ///< levels are as they were
    blind,          ///< what should see does not: nothing may be flown into
    budget_spent,
};

/// What rates the cells of a placed set. Behind an interface, so that an image without any carries none of it.
class CellSource {
public:
    /// Lowers levels of cells, never raises one.
    /// @param lead    the path begins so long after Situation::now [s]
    /// @param blocks  of each cell of the placed set
    [[nodiscard]] virtual RateStatus rate(const world::Situation& situation, const Placed& placed,
                                          const CellBalls& balls, Seconds lead, std::span<Level> blocks,
                                          WorkBudget& budget) noexcept = 0;

protected:
    ~CellSource() = default;
};

}  // namespace jink::reach
