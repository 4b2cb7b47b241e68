// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "hal/register_block.hpp"

namespace jink::hal::stm32 {

enum class ResetCause : std::uint8_t {
    unknown,               ///< no flag: an emulator
    power,                 ///< power-on or brown-out: RAM content is undefined
    pin,                   ///< the reset pin alone
    software,              ///< requested by software, as by the fault handler
    independent_watchdog,  ///< without warning
    other,                 ///< window watchdog, low power
};

/// Where a chip keeps the flags of its resets.
struct ResetFlags {
    std::uint32_t offset;  ///< of their register in RCC
    std::uint32_t remove;  ///< written to it: clears them
    std::uint32_t power;   ///< power-on, brown-out
    std::uint32_t pin;
    std::uint32_t software;
    std::uint32_t independent_watchdog;
    std::uint32_t other;
};

/// Reads the cause of the last reset, and clears the flags for the next one. Every reset pulls the pin as well, so the
/// pin's flag counts only alone. O(1).
template <RegisterBlock Rcc>
[[nodiscard]] ResetCause take_reset_cause(Rcc rcc, const ResetFlags& kept) noexcept
{
    const std::uint32_t flags = rcc.read(kept.offset);
    rcc.write(kept.offset, flags | kept.remove);
    if ((flags & kept.power) != 0) {
        return ResetCause::power;
    }
    if ((flags & kept.independent_watchdog) != 0) {
        return ResetCause::independent_watchdog;
    }
    if ((flags & kept.software) != 0) {
        return ResetCause::software;
    }
    if ((flags & kept.other) != 0) {
        return ResetCause::other;
    }
    return (flags & kept.pin) != 0 ? ResetCause::pin : ResetCause::unknown;
}

}  // namespace jink::hal::stm32
