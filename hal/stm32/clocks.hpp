// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "hal/register_block.hpp"

namespace jink::hal::stm32 {

enum class ClockSource : std::uint8_t {
    crystal,       ///< full speed from the crystal, or from the clock fed to its pin: the normal case
    internal_pll,  ///< without it: full speed from the internal oscillator, good to 1 % around 25 C
    internal,      ///< no PLL either: the internal oscillator alone
    emulator,      ///< no clock control: an emulator's own clock, full speed
};

/// The resulting clocks [Hz].
struct Clocks {
    ClockSource source = ClockSource::internal;
    std::uint32_t processor = 0;
    std::uint32_t apb1 = 0;
    std::uint32_t apb2 = 0;
    std::uint32_t timer = 0;  ///< of the timers on APB1: twice the bus clock if that is divided
};

/// Whether the register at `offset` reads as `value` under `mask` within `patience` polls.
template <RegisterBlock Registers>
[[nodiscard]] bool becomes(Registers& registers, std::uint32_t offset, std::uint32_t mask, std::uint32_t value,
                           std::uint32_t patience) noexcept
{
    for (std::uint32_t i = 0; i < patience; ++i) {
        if ((registers.read(offset) & mask) == value) {
            return true;
        }
    }
    return false;
}

}  // namespace jink::hal::stm32
