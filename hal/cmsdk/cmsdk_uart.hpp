// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "hal/interrupt_serial_port.hpp"

namespace jink::hal {

/// Serial port on the CMSDK APB UART (ARM DDI 0479), fed by interrupts in both directions
/// (hal/interrupt_serial_port.hpp).
///
/// The UART holds one byte each way: at 921600 baud its receive handler must run within 10.8 us, or a byte is lost and
/// counted.
template <RegisterBlock Registers, InterruptWake Wake>
class CmsdkUart final : public InterruptSerialPort<Wake> {
    using Base = InterruptSerialPort<Wake>;

public:
    /// Bytes that the hardware holds after put().
    static constexpr std::size_t kHardwareBytes = 2;

    /// @param wake_transmit  raises the transmit interrupt
    CmsdkUart(Registers registers, Wake wake_transmit) noexcept : Base(wake_transmit), registers_(registers) {}

    /// Sets the baud rate and starts both directions. False, with the port left closed, if the divider does not give
    /// the rate within 2 % or is below the hardware's least (16).
    [[nodiscard]] bool start(std::uint32_t peripheral_clock_hz, std::uint32_t baud) noexcept
    {
        const std::uint32_t divider = baud_divider(peripheral_clock_hz, baud, kMinDivider, kLargestDivider);
        if (divider == 0) {
            return false;
        }
        registers_.write(kDivider, divider);
        registers_.write(kControl, kAllOn);
        this->opened();
        return true;
    }

    /// Called by the receive interrupt's handler. O(bytes received), kReceiveBytes at most: further bytes raise the
    /// interrupt again.
    void on_receive() noexcept
    {
        registers_.write(kInterrupts, kReceiveInterrupt);  // before the byte: a byte that arrives in between raises it
                                                           // again
        for (std::size_t i = 0; i < Base::kReceiveBytes && (registers_.read(kState) & kReceiveFull) != 0; ++i) {
            this->store(static_cast<std::byte>(registers_.read(kData) & 0xFFU));
        }
    }

    /// Called by the transmit interrupt's handler. O(bytes that fit).
    void on_transmit() noexcept
    {
        registers_.write(kInterrupts, kTransmitInterrupt);
        std::byte byte{};
        for (std::size_t i = 0; i < Base::kTransmitBytes && has_room(registers_) && this->to_send().pop(byte); ++i) {
            put(registers_, byte);
        }
    }

    /// Called by the overrun interrupt's handler. O(1).
    void on_overrun() noexcept
    {
        if ((registers_.read(kState) & kReceiveOverrun) != 0) {
            this->count_overrun();
        }
        registers_.write(kInterrupts, kOverrunInterrupts);
    }

    [[nodiscard]] static bool has_room(Registers& registers) noexcept
    {
        return (registers.read(kState) & kTransmitFull) == 0;
    }
    static void put(Registers& registers, std::byte byte) noexcept
    {
        registers.write(kData, std::to_integer<std::uint32_t>(byte));
    }

    /// send_waiting() on its own registers; bytes in the ring are not sent.
    void write_waiting(std::span<const std::byte> from, std::uint32_t patience) noexcept
    {
        static_cast<void>(send_waiting<CmsdkUart>(registers_, from, patience));
    }

private:
    static constexpr std::uint32_t kData = 0x00;
    static constexpr std::uint32_t kState = 0x04;
    static constexpr std::uint32_t kControl = 0x08;
    static constexpr std::uint32_t kInterrupts = 0x0C;  ///< cleared by writing ones
    static constexpr std::uint32_t kDivider = 0x10;
    static constexpr std::uint32_t kTransmitFull = 1U << 0U;  // of kState
    static constexpr std::uint32_t kReceiveFull = 1U << 1U;
    static constexpr std::uint32_t kReceiveOverrun = 1U << 3U;
    static constexpr std::uint32_t kTransmitInterrupt = 1U << 0U;  // of kInterrupts
    static constexpr std::uint32_t kReceiveInterrupt = 1U << 1U;
    static constexpr std::uint32_t kOverrunInterrupts = 3U << 2U;
    /// Both directions, their interrupts, and the receive overrun interrupt.
    static constexpr std::uint32_t kAllOn = 0x2F;
    static constexpr std::uint32_t kMinDivider = 16;
    static constexpr std::uint32_t kLargestDivider = 0xFFFFF;

    Registers registers_;
};

}  // namespace jink::hal
