// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "hal/register_block.hpp"
#include "hal/watchdog.hpp"

namespace jink::hal::stm32 {

/// The independent watchdog of the STM32F4 and H7 (ST RM0090, 21; the H7 has the same registers, and a window, which
/// stays open: ST's stm32h743xx.h). It runs on an oscillator of its own: 17 to 47 kHz on the F4 (ST DS8626), so that
/// its time-out is known to a factor of 1.5 only. The H7's is better: 29.4 to 33.6 kHz on the STM32H730 (ST DS13315,
/// table 41), and nothing here needs that. Once started only a reset stops it.
template <RegisterBlock Registers>
class IndependentWatchdog final : public Watchdog {
public:
    explicit IndependentWatchdog(Registers registers) noexcept : registers_(registers) {}

    /// @param milliseconds  1..4095, at the oscillator's nominal 32 kHz: the real time is between 0.68 and 1.9 of it
    void start(std::uint32_t milliseconds) noexcept
    {
        registers_.write(kKey, kStart);
        registers_.write(kKey, kUnlock);
        registers_.write(kPrescaler, kDivideBy32);
        registers_.write(kReload, milliseconds & kLargestReload);
        // Both values reach the slow clock's domain within five of its ticks; the wait is limited to that.
        for (std::uint32_t i = 0; i < kPatience && registers_.read(kStatus) != 0; ++i) {
        }
        registers_.write(kKey, kFeed);
    }

    void feed() noexcept override { registers_.write(kKey, kFeed); }

private:
    static constexpr std::uint32_t kKey = 0x00;
    static constexpr std::uint32_t kPrescaler = 0x04;
    static constexpr std::uint32_t kReload = 0x08;
    static constexpr std::uint32_t kStatus = 0x0C;
    static constexpr std::uint32_t kStart = 0xCCCC;
    static constexpr std::uint32_t kUnlock = 0x5555;
    static constexpr std::uint32_t kFeed = 0xAAAA;
    static constexpr std::uint32_t kDivideBy32 = 3;
    static constexpr std::uint32_t kLargestReload = 0xFFF;
    static constexpr std::uint32_t kPatience = 100'000;

    Registers registers_;
};

}  // namespace jink::hal::stm32
