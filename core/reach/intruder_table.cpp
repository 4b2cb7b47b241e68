// SPDX-License-Identifier: BSD-3-Clause
#include "core/reach/intruder_table.hpp"

#include <algorithm>
#include <limits>

namespace jink::reach {
namespace {

bool comes_before(const TableIntruder& a, const TableIntruder& b) noexcept
{
    return a.entry < b.entry || (!(b.entry < a.entry) && a.id < b.id);
}

}  // namespace

float entry_time(const Grid<float>& grid, const Intruder& intruder) noexcept
{
    const CellBall all{Vec3::Zero(), grid.distance()};
    const std::optional<Stay> stay = spread_in(all, intruder);
    return stay ? stay->from : std::numeric_limits<float>::infinity();
}

void IntruderTable::clear() noexcept
{
    kept_.clear();
    overflow_ = 0;
}

bool IntruderTable::add(const Grid<float>& grid, std::uint32_t id, const Intruder& intruder) noexcept
{
    const TableIntruder next{id, entry_time(grid, intruder), intruder};
    if (kept_.try_push_back(next)) {
        return true;
    }
    ++overflow_;
    TableIntruder* const last = std::max_element(kept_.begin(), kept_.end(), comes_before);
    if (comes_before(next, *last)) {
        *last = next;
    }
    return false;
}

}  // namespace jink::reach
