// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "hal/register_block.hpp"

namespace jink::hal::stm32 {

/// Offset of a timer's counter.
inline constexpr std::uint32_t kTimerCount = 0x24;

/// Has a timer of 32 bits (TIM2, TIM5) count microseconds, for hal::CounterClock (ST RM0090, 18.4; RM0433, 39.4).
/// SysTick would not do: it loses a tick if its interrupt is delayed for a millisecond. O(1).
///
/// @param clock_hz  the timer's clock: a multiple of 1 MHz, 65536 MHz at most
template <RegisterBlock Timer>
void start_microseconds(Timer timer, std::uint32_t clock_hz) noexcept
{
    constexpr std::uint32_t kControl = 0x00;
    constexpr std::uint32_t kEvent = 0x14;
    constexpr std::uint32_t kPrescaler = 0x28;
    constexpr std::uint32_t kReload = 0x2C;
    timer.write(kPrescaler, clock_hz / 1'000'000U - 1U);
    timer.write(kReload, 0xFFFFFFFF);
    timer.write(kEvent, 1);  // loads the prescaler
    timer.write(kControl, 1);
}

}  // namespace jink::hal::stm32
