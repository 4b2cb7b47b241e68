// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <concepts>
#include <cstdint>

#include "core/base/work_budget.hpp"

// Work without a deadline. It gets work units that a step has left, behind everything else.

namespace jink {

enum class Progress : std::uint8_t {
    running,
    done,    ///< to its end; goes on anew with the next call
    failed,  ///< and stays so
};

/// Goes on by as much as the budget allows. Its results do not depend on how its work is divided.
template <class S>
concept BackgroundService = requires(S& service, WorkBudget& budget)
{
    {
        service.advance(budget)
    }
    noexcept->std::same_as<Progress>;
};

}  // namespace jink
