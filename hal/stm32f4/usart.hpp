// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "hal/stm32/usart.hpp"

namespace jink::hal::stm32f4 {

/// USART of the STM32F4 (ST RM0090, 30). The receiver holds one byte behind its shift register: at 921600 baud the
/// handler must run within 10.8 us, or a byte is lost and counted.
struct UsartLayout {
    static constexpr std::uint32_t kStatus = 0x00;
    static constexpr std::uint32_t kReceivedData = 0x04;
    static constexpr std::uint32_t kTransmitData = 0x04;
    static constexpr std::uint32_t kBaudRate = 0x08;
    static constexpr std::uint32_t kControl1 = 0x0C;
    static constexpr std::uint32_t kControl2 = 0x10;
    static constexpr std::uint32_t kControl3 = 0x14;
    /// Receiver, transmitter, the receive interrupt, and the USART itself.
    static constexpr std::uint32_t kOn = 1U << 2U | 1U << 3U | 1U << 5U | 1U << 13U;
    static constexpr std::size_t kHardwareBytes = 2;

    /// A read of the data after the status clears the flags of the byte and of its errors. The driver reads the data of
    /// a received byte; without one, this does.
    template <RegisterBlock Registers>
    static void clear_errors(Registers& registers, std::uint32_t status) noexcept
    {
        constexpr std::uint32_t kReceived = 1U << 5U;
        if ((status & kReceived) == 0) {
            static_cast<void>(registers.read(kReceivedData));
        }
    }
};

template <RegisterBlock Registers, InterruptWake Wake>
using Usart = stm32::Usart<UsartLayout, Registers, Wake>;

}  // namespace jink::hal::stm32f4
