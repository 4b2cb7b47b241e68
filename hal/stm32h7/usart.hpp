// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "hal/stm32/usart.hpp"

namespace jink::hal::stm32h7 {

/// USART of the STM32H7 (ST RM0433, 48) with its FIFOs on, 16 bytes each way: at 921600 baud the handler must run
/// within 173 us of the first byte, or bytes are lost and counted. A handler takes all that is there.
struct UsartLayout {
    static constexpr std::uint32_t kControl1 = 0x00;
    static constexpr std::uint32_t kControl2 = 0x04;
    static constexpr std::uint32_t kControl3 = 0x08;
    static constexpr std::uint32_t kBaudRate = 0x0C;
    static constexpr std::uint32_t kStatus = 0x1C;
    static constexpr std::uint32_t kClear = 0x20;
    static constexpr std::uint32_t kReceivedData = 0x24;
    static constexpr std::uint32_t kTransmitData = 0x28;
    /// The USART itself, receiver, transmitter, the receive interrupt, FIFOs.
    static constexpr std::uint32_t kOn = 1U << 0U | 1U << 2U | 1U << 3U | 1U << 5U | 1U << 29U;
    static constexpr std::size_t kHardwareBytes = 17;  // FIFO and shift register

    /// The receiver stays stopped until its overrun is cleared. Parity, framing and noise are those of the byte that is
    /// read next.
    template <RegisterBlock Registers>
    static void clear_errors(Registers& registers, std::uint32_t status) noexcept
    {
        constexpr std::uint32_t kErrors = 0xF;
        if ((status & kErrors) != 0) {
            registers.write(kClear, status & kErrors);
        }
    }
};

template <RegisterBlock Registers, InterruptWake Wake>
using Usart = stm32::Usart<UsartLayout, Registers, Wake>;

}  // namespace jink::hal::stm32h7
