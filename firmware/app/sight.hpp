// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/base/work_budget.hpp"
#include "core/reach/cell_source.hpp"
#include "core/world/cost_to_go.hpp"

namespace jink::app {

/// What a sensor that looks around tells a decision beside obstacles. An interface, so that an image without such a
/// sensor carries none of its code.
class Sight {
public:
    /// Which cells of a reach set are hit, and which are seen.
    [[nodiscard]] virtual reach::CellSource& cells() noexcept = 0;
    /// The way past the obstacles of a situation, as far as it is known. It does not change while a plan runs.
    [[nodiscard]] virtual const world::CostToGo& way_of(const world::Situation& situation, bool plan_runs) noexcept = 0;
    /// Goes on with finding that way.
    virtual void advance(WorkBudget& budget) noexcept = 0;
    /// The way is not known any more.
    virtual void forget_way() noexcept = 0;

protected:
    ~Sight() = default;
};

}  // namespace jink::app
