// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>

#include "core/base/work_budget.hpp"
#include "core/reach/cell_spheres.hpp"
#include "core/reach/evaluation.hpp"
#include "core/reach/placed.hpp"
#include "core/world/world.hpp"

namespace jink::reach {

enum class RateStatus : std::uint8_t {
    rated,
    nothing_known,  ///< levels are unchanged
    blind,          ///< the sensor does not see: no cell may be flown into
    budget_spent,
};

/// Rates the cells of a placed set. An interface, so that an image without any cell source carries none of their code.
class CellSource {
public:
    /// Lowers levels of cells, never raises a level.
    /// @param lead    time from Situation::now until the path begins [s]
    /// @param blocks  level of each cell of the placed set
    [[nodiscard]] virtual RateStatus rate(const world::Situation& situation, const Placed& placed,
                                          const CellSpheres& spheres, Seconds lead, std::span<Level> blocks,
                                          WorkBudget& budget) noexcept = 0;

protected:
    ~CellSource() = default;
};

}  // namespace jink::reach
