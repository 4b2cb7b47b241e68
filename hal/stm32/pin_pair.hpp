// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "hal/stm32/clock_enable.hpp"

namespace jink::hal::stm32 {

/// Two neighbouring pins for a peripheral: both of 0 .. 7, or both of 8 .. 15. The ports of the STM32F4 and H7 have the
/// same registers (ST RM0090, 8.4; RM0433, 11.4).
struct PinPair {
    std::uint32_t port_enable;    ///< offset of the port's clock register in RCC
    std::uint32_t port_on;        ///< in that register
    std::uint32_t enable;         ///< offset of the peripheral's clock register in RCC
    std::uint32_t peripheral_on;  ///< in that register
    std::uint32_t first;          ///< the lower pin, not 7; the other is the next
    std::uint32_t alternate;      ///< function of both
    std::uint32_t pulled_up;      ///< the pin with a pull-up, high while it is not driven
};

/// Connects the pins to the peripheral, and starts the clocks of both. O(1).
template <RegisterBlock Rcc, RegisterBlock Port>
void start_pins(Rcc rcc, Port port, const PinPair& pins) noexcept
{
    constexpr std::uint32_t kMode = 0x00;
    constexpr std::uint32_t kPull = 0x0C;
    const std::uint32_t alternate = pins.first < 8U ? 0x20 : 0x24;  // a register for each half of the pins
    const std::uint32_t at = 2U * pins.first;                       // two bits a pin
    const std::uint32_t at_alternate = 4U * (pins.first % 8U);      // four bits a pin
    const std::uint32_t functions = (pins.alternate * 0x11U) << at_alternate;
    enable_clock(rcc, pins.port_enable, pins.port_on);
    enable_clock(rcc, pins.enable, pins.peripheral_on);
    port.write(alternate, (port.read(alternate) & ~(0xFFU << at_alternate)) | functions);
    port.write(kPull, (port.read(kPull) & ~(0xFU << at)) | 1U << (2U * pins.pulled_up));
    port.write(kMode, (port.read(kMode) & ~(0xFU << at)) | 0xAU << at);
}

}  // namespace jink::hal::stm32
