// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "hal/register_block.hpp"

namespace jink::hal::cortex_m {

/// Turns on both caches of a Cortex-M7, empty (ARMv7-M Architecture Reference Manual, B2.2.7, B3.2 and B4.8). To be
/// called once after a reset, while they are off: their content is then undefined.
///
/// @param system   the block at kSystemControl
/// @param barrier  waits for all accesses, and has the processor fetch anew (DSB, ISB)
/// O(lines): 512 for 16 KiB.
template <RegisterBlock System, class Barrier>
void start_caches(System system, Barrier barrier) noexcept
{
    constexpr std::uint32_t kConfiguration = 0xD14;       // CCR
    constexpr std::uint32_t kCacheSize = 0xD80;           // CCSIDR
    constexpr std::uint32_t kCacheSelection = 0xD84;      // CSSELR
    constexpr std::uint32_t kForgetInstructions = 0xF50;  // ICIALLU
    constexpr std::uint32_t kForgetSet = 0xF60;           // DCISW
    constexpr std::uint32_t kDataOn = 1U << 16U;
    constexpr std::uint32_t kInstructionsOn = 1U << 17U;

    system.write(kForgetInstructions, 0);
    system.write(kCacheSelection, 0);  // data, level 1
    barrier();
    const std::uint32_t size = system.read(kCacheSize);
    const std::uint32_t last_set = size >> 13U & 0x7FFFU;
    const std::uint32_t last_way = size >> 3U & 0x3FFU;
    const std::uint32_t set_shift = (size & 7U) + 4U;  // log2 of a line [bytes]
    std::uint32_t way_shift = 32;                      // the ways are the top bits
    for (std::uint32_t ways = last_way; ways > 0; ways >>= 1U) {
        --way_shift;
    }
    for (std::uint32_t set = 0; set <= last_set; ++set) {
        for (std::uint32_t way = 0; way <= last_way; ++way) {
            system.write(kForgetSet, (way_shift < 32 ? way << way_shift : 0U) | set << set_shift);
        }
    }
    barrier();
    system.write(kConfiguration, system.read(kConfiguration) | kDataOn | kInstructionsOn);
    barrier();
}

}  // namespace jink::hal::cortex_m
