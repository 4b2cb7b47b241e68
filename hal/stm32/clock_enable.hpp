// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "hal/register_block.hpp"

namespace jink::hal::stm32 {

/// Starts the clock of a peripheral: sets `bits` in the enable register at `offset` of RCC. The read at the end waits
/// until the clock runs: two bus cycles (ST RM0090, 7.3; RM0433, 8.5). O(1).
template <RegisterBlock Rcc>
void enable_clock(Rcc rcc, std::uint32_t offset, std::uint32_t bits) noexcept
{
    rcc.write(offset, rcc.read(offset) | bits);
    static_cast<void>(rcc.read(offset));
}

}  // namespace jink::hal::stm32
