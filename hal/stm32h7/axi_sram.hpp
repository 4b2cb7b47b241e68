// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "hal/register_block.hpp"

namespace jink::hal::stm32h7 {

/// Has the bus matrix read the AXI SRAM one access at a time, where a read of several may give wrong data: revisions Z
/// and Y of the STM32H743 (ST ES0392, 2.2.9). Before the AXI SRAM is used. O(1).
///
/// @param debug   DBGMCU, which has the revision (ST RM0433, 60)
/// @param matrix  the AXI interconnect (2.2; ST's system_stm32h7xx.c sets the same)
template <RegisterBlock Debug, RegisterBlock Matrix>
void settle_axi_sram(Debug debug, Matrix matrix) noexcept
{
    constexpr std::uint32_t kIdentity = 0x00;
    constexpr std::uint32_t kRevisionX = 0x2001;
    constexpr std::uint32_t kTarget7 = 0x8108;  // AXI_TARG7_FN_MOD
    constexpr std::uint32_t kOneReadAtATime = 1;
    if (debug.read(kIdentity) >> 16U < kRevisionX) {
        matrix.write(kTarget7, kOneReadAtATime);
    }
}

}  // namespace jink::hal::stm32h7
