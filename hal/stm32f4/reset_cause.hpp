// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "hal/register_block.hpp"

namespace jink::hal::stm32f4 {

enum class ResetCause : std::uint8_t {
    unknown,               ///< no flag: an emulator
    power,                 ///< power-on or brown-out: RAM content is undefined
    pin,                   ///< the reset pin alone
    software,              ///< requested by software, as by the fault handler
    independent_watchdog,  ///< without warning
    other,                 ///< window watchdog, low power
};

/// Reads the cause of the last reset (ST RM0090, 7.3.21), and clears the flags for the next one. Every reset pulls the
/// pin as well, so the pin's flag counts only alone. O(1).
template <RegisterBlock Rcc>
[[nodiscard]] ResetCause take_reset_cause(Rcc rcc) noexcept
{
    constexpr std::uint32_t kControlStatus = 0x74;
    constexpr std::uint32_t kRemoveFlags = 1U << 24U;
    constexpr std::uint32_t kBrownOut = 1U << 25U;
    constexpr std::uint32_t kPin = 1U << 26U;
    constexpr std::uint32_t kPowerOn = 1U << 27U;
    constexpr std::uint32_t kSoftware = 1U << 28U;
    constexpr std::uint32_t kIndependentWatchdog = 1U << 29U;
    constexpr std::uint32_t kOthers = 3U << 30U;
    const std::uint32_t flags = rcc.read(kControlStatus);
    rcc.write(kControlStatus, flags | kRemoveFlags);
    if ((flags & (kPowerOn | kBrownOut)) != 0) {
        return ResetCause::power;
    }
    if ((flags & kIndependentWatchdog) != 0) {
        return ResetCause::independent_watchdog;
    }
    if ((flags & kSoftware) != 0) {
        return ResetCause::software;
    }
    if ((flags & kOthers) != 0) {
        return ResetCause::other;
    }
    return (flags & kPin) != 0 ? ResetCause::pin : ResetCause::unknown;
}

}  // namespace jink::hal::stm32f4
