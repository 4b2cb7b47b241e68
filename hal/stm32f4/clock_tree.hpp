// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "hal/stm32/clocks.hpp"

namespace jink::hal::stm32f4 {

/// Brings the STM32F405 to 168 MHz from a crystal of 8 MHz, or as far as possible: every wait is bounded, and the
/// result is returned. The flash gets its wait states before the clock rises (ST RM0090, 3.5 and 7).
///
/// The control register never reads zero on the chip (the internal oscillator is on after a reset). If it reads zero,
/// the code runs on an emulator without clock control, and nothing is set.
template <RegisterBlock Rcc, RegisterBlock Flash>
[[nodiscard]] stm32::Clocks start_clocks(Rcc rcc, Flash flash) noexcept
{
    using stm32::becomes;
    using stm32::ClockSource;
    constexpr std::uint32_t kControl = 0x00;
    constexpr std::uint32_t kPll = 0x04;
    constexpr std::uint32_t kConfiguration = 0x08;
    constexpr std::uint32_t kCrystalOn = 1U << 16U;
    constexpr std::uint32_t kCrystalReady = 1U << 17U;
    constexpr std::uint32_t kPllOn = 1U << 24U;
    constexpr std::uint32_t kPllReady = 1U << 25U;
    constexpr std::uint32_t kUseCrystal = 1U << 22U;
    constexpr std::uint32_t kFiveWaitsAndCaches = 0x705;
    constexpr std::uint32_t kUsePll = 2;
    constexpr std::uint32_t kPllUsed = 2U << 2U;
    constexpr std::uint32_t kPllMask = 3U << 2U;
    constexpr std::uint32_t kApb1By4Apb2By2 = 5U << 10U | 4U << 13U;
    constexpr std::uint32_t kPatience = 200'000;  // polls: over 20 ms at 16 MHz, a crystal takes 2
    constexpr std::uint32_t kFull = 168'000'000;
    constexpr std::uint32_t kInternal = 16'000'000;
    constexpr std::uint32_t kEmulatedTimer = 1'000'000'000;  // qemu's

    if (rcc.read(kControl) == 0) {
        return {ClockSource::emulator, kFull, kFull / 4U, kFull / 2U, kEmulatedTimer};
    }
    rcc.write(kControl, rcc.read(kControl) | kCrystalOn);
    const bool crystal = becomes(rcc, kControl, kCrystalReady, kCrystalReady, kPatience);
    // 336 MHz from 1 MHz steps (the input divided by 8 or 16), halved; 48 MHz for peripherals that need it.
    const std::uint32_t divider = crystal ? 8U : 16U;
    rcc.write(kPll, divider | 336U << 6U | 7U << 24U | (crystal ? kUseCrystal : 0U));
    rcc.write(kControl, rcc.read(kControl) | kPllOn);
    if (!becomes(rcc, kControl, kPllReady, kPllReady, kPatience)) {
        return {ClockSource::internal, kInternal, kInternal, kInternal, kInternal};
    }
    flash.write(0, kFiveWaitsAndCaches);
    if (!(flash.read(0) == kFiveWaitsAndCaches)) {
        return {ClockSource::internal, kInternal, kInternal, kInternal, kInternal};  // the flash does not accept the
                                                                                     // wait states for a faster clock
    }
    rcc.write(kConfiguration, kApb1By4Apb2By2);
    rcc.write(kConfiguration, kApb1By4Apb2By2 | kUsePll);
    if (!becomes(rcc, kConfiguration, kPllMask, kPllUsed, kPatience)) {
        return {ClockSource::internal, kInternal, kInternal / 4U, kInternal / 2U, kInternal / 2U};
    }
    return {crystal ? ClockSource::crystal : ClockSource::internal_pll, kFull, kFull / 4U, kFull / 2U, kFull / 2U};
}

}  // namespace jink::hal::stm32f4
