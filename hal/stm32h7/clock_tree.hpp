// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "hal/stm32/clocks.hpp"

namespace jink::hal::stm32h7 {

/// What is on the oscillator's pins, of 8 MHz.
enum class ExternalClock : std::uint8_t {
    crystal,  ///< of the chip's own oscillator
    fed,      ///< a clock from elsewhere on OSC_IN: a Nucleo board's debugger makes one (ST UM2407)
};

/// Brings the STM32H743 to 400 MHz with its linear regulator at VOS1, or as far as possible: every wait is bounded, and
/// the result is returned. Buses: AXI and AHB 200 MHz, APB 100 MHz, timers 200 MHz (ST RM0433, 6.6, 8.5 and 4.3.8).
///
/// 400 MHz is what every revision of the chip does in its whole range of temperature. 480 MHz (VOS0) needs revision V
/// and a junction below 105 C (ST DS12110). Before the clock rises, the supply is chosen, the voltage is up, and the
/// flash has the wait states of 200 MHz at VOS1.
///
/// The chosen supply is locked until power-off; after another reset the write has no effect (RM0433, 6.8.4).
template <RegisterBlock Rcc, RegisterBlock Power, RegisterBlock Flash>
[[nodiscard]] stm32::Clocks start_clocks(Rcc rcc, Power power, Flash flash, ExternalClock external) noexcept
{
    using stm32::becomes;
    using stm32::ClockSource;
    constexpr std::uint32_t kPowerStatus = 0x04;  // PWR_CSR1
    constexpr std::uint32_t kVoltageReady = 1U << 13U;
    constexpr std::uint32_t kSupply = 0x0C;  // PWR_CR3
    constexpr std::uint32_t kSupplyMask = 7U;
    constexpr std::uint32_t kLinearRegulator = 2U;
    constexpr std::uint32_t kScale = 0x18;  // PWR_D3CR
    constexpr std::uint32_t kScale1 = 3U << 14U;
    constexpr std::uint32_t kScaleReady = 1U << 13U;
    constexpr std::uint32_t kControl = 0x00;  // RCC_CR
    constexpr std::uint32_t kExternalOn = 1U << 16U;
    constexpr std::uint32_t kExternalReady = 1U << 17U;
    constexpr std::uint32_t kExternalFed = 1U << 18U;
    constexpr std::uint32_t kPllOn = 1U << 24U;
    constexpr std::uint32_t kPllReady = 1U << 25U;
    constexpr std::uint32_t kConfiguration = 0x10;  // RCC_CFGR
    constexpr std::uint32_t kUsePll = 3U;
    constexpr std::uint32_t kUsedMask = 7U << 3U;
    constexpr std::uint32_t kPllUsed = 3U << 3U;
    constexpr std::uint32_t kDomain1 = 0x18;  // RCC_D1CFGR
    constexpr std::uint32_t kDomain2 = 0x1C;
    constexpr std::uint32_t kDomain3 = 0x20;
    constexpr std::uint32_t kPllSources = 0x28;  // RCC_PLLCKSELR
    constexpr std::uint32_t kPll1SourceMask = 0x3F3;
    constexpr std::uint32_t kPllSettings = 0x2C;  // RCC_PLLCFGR
    constexpr std::uint32_t kPll1SettingsMask = 0xF;
    constexpr std::uint32_t kInput4To8Megahertz = 2U << 2U;  // and the wide range of its oscillator, 192 to 836 MHz
    constexpr std::uint32_t kPll1Dividers = 0x30;
    constexpr std::uint32_t kTwoWaits = 2U | 2U << 4U;  // and the programming delay for above 185 MHz
    constexpr std::uint32_t kPatience = 400'000;        // polls: over 20 ms at 64 MHz, a crystal takes 2
    constexpr std::uint32_t kFull = 400'000'000;
    constexpr std::uint32_t kInternal = 64'000'000;
    constexpr stm32::Clocks kUnchanged{ClockSource::internal, kInternal, kInternal, kInternal, kInternal};

    power.write(kSupply, (power.read(kSupply) & ~kSupplyMask) | kLinearRegulator);
    if (!becomes(power, kPowerStatus, kVoltageReady, kVoltageReady, kPatience)) {
        return kUnchanged;
    }
    power.write(kScale, kScale1);
    if (!becomes(power, kScale, kScaleReady, kScaleReady, kPatience)) {
        return kUnchanged;
    }
    const std::uint32_t fed = external == ExternalClock::fed ? kExternalFed : 0U;
    rcc.write(kControl, (rcc.read(kControl) & ~kExternalFed) | fed);  // a reset may keep it
    rcc.write(kControl, rcc.read(kControl) | kExternalOn);
    const bool is_external = becomes(rcc, kControl, kExternalReady, kExternalReady, kPatience);
    // 4 MHz, times 200, halved; the other two outputs give 200 MHz and 400 MHz to nobody.
    const std::uint32_t source = is_external ? 2U | 2U << 4U : 16U << 4U;
    rcc.write(kPllSources, (rcc.read(kPllSources) & ~kPll1SourceMask) | source);
    rcc.write(kPllSettings, (rcc.read(kPllSettings) & ~kPll1SettingsMask) | kInput4To8Megahertz);
    rcc.write(kPll1Dividers, 199U | 1U << 9U | 3U << 16U | 1U << 24U);
    rcc.write(kControl, rcc.read(kControl) | kPllOn);
    if (!becomes(rcc, kControl, kPllReady, kPllReady, kPatience)) {
        return kUnchanged;
    }
    flash.write(0, kTwoWaits);
    if (flash.read(0) != kTwoWaits) {
        return kUnchanged;  // it keeps the wait states of the reset, which are for any clock
    }
    constexpr std::uint32_t kHalf = 4U;
    rcc.write(kDomain1, 8U | kHalf << 4U);
    rcc.write(kDomain2, kHalf << 4U | kHalf << 8U);
    rcc.write(kDomain3, kHalf << 4U);
    rcc.write(kConfiguration, kUsePll);
    if (!becomes(rcc, kConfiguration, kUsedMask, kPllUsed, kPatience)) {
        return {ClockSource::internal, kInternal, kInternal / 4U, kInternal / 4U, kInternal / 2U};
    }
    return {is_external ? ClockSource::crystal : ClockSource::internal_pll, kFull, kFull / 4U, kFull / 4U, kFull / 2U};
}

}  // namespace jink::hal::stm32h7
