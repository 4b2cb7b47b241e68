// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "hal/interrupt_serial_port.hpp"

namespace jink::hal::stm32f4 {

/// Serial port on a USART of the STM32F4 (ST RM0090, 30), fed by its interrupt in both directions
/// (hal/interrupt_serial_port.hpp).
///
/// The receiver holds one byte behind its shift register: at 921600 baud the handler must run within 10.8 us, or a byte
/// is lost and counted. Framing, noise and parity errors are counted in `line_errors`.
template <RegisterBlock Registers, InterruptWake Wake>
class Usart final : public InterruptSerialPort<Wake> {
    using Base = InterruptSerialPort<Wake>;

public:
    /// @param wake  raises the USART's interrupt
    Usart(Registers registers, Wake wake) noexcept : Base(wake), registers_(registers) {}

    /// 8N1 at `baud`, both directions. False, with the port left closed, if the divider does not give the rate within 2
    /// % or is below the hardware's least (16, oversampling by 16).
    [[nodiscard]] bool start(std::uint32_t peripheral_clock_hz, std::uint32_t baud) noexcept
    {
        const std::uint32_t divider = baud_divider(peripheral_clock_hz, baud, kMinDivider, kLargestDivider);
        if (divider == 0) {
            return false;
        }
        registers_.write(kBaudRate, divider);  // in sixteenths, the register's unit
        registers_.write(kControl3, 0);
        registers_.write(kControl2, 0);
        registers_.write(kControl1, kOn);
        this->opened();
        return true;
    }

    /// Called by the interrupt's handler. O(bytes received and sent), both rings' sizes at most: further bytes raise
    /// the interrupt again.
    void on_interrupt() noexcept
    {
        receive();
        transmit();
    }

    [[nodiscard]] static bool has_room(Registers& registers) noexcept
    {
        return (registers.read(kStatus) & kTransmitEmpty) != 0;
    }
    static void put(Registers& registers, std::byte byte) noexcept
    {
        registers.write(kData, std::to_integer<std::uint32_t>(byte));
    }

    /// send_waiting() on its own registers; bytes in the ring are not sent.
    void write_waiting(std::span<const std::byte> from, std::uint32_t patience) noexcept
    {
        static_cast<void>(send_waiting<Usart>(registers_, from, patience));
    }

private:
    static constexpr std::uint32_t kStatus = 0x00;
    static constexpr std::uint32_t kData = 0x04;
    static constexpr std::uint32_t kBaudRate = 0x08;
    static constexpr std::uint32_t kControl1 = 0x0C;
    static constexpr std::uint32_t kControl2 = 0x10;
    static constexpr std::uint32_t kControl3 = 0x14;
    static constexpr std::uint32_t kLineError = 0x7;  // of kStatus: parity, framing, noise
    static constexpr std::uint32_t kOverrun = 1U << 3U;
    static constexpr std::uint32_t kReceived = 1U << 5U;
    static constexpr std::uint32_t kTransmitEmpty = 1U << 7U;
    static constexpr std::uint32_t kTransmitInterrupt = 1U << 7U;  // of kControl1
    /// Receiver, transmitter, the receive interrupt, and the USART itself.
    static constexpr std::uint32_t kOn = 1U << 2U | 1U << 3U | 1U << 5U | 1U << 13U;
    static constexpr std::uint32_t kMinDivider = 16;
    static constexpr std::uint32_t kLargestDivider = 0xFFFF;

    /// Reading the data after the status clears the flags of both the byte and its errors.
    void receive() noexcept
    {
        for (std::size_t i = 0; i < Base::kReceiveBytes; ++i) {
            const std::uint32_t status = registers_.read(kStatus);
            if ((status & (kReceived | kOverrun)) == 0) {
                return;
            }
            const auto byte = static_cast<std::byte>(registers_.read(kData) & 0xFFU);
            if ((status & kOverrun) != 0) {
                this->count_overrun();  // the byte that came too early is lost, the one before it is still valid
            }
            if ((status & kReceived) == 0) {
                continue;
            }
            if ((status & kLineError) != 0) {
                this->count_line_error();  // its value is undefined, and the checksum of the layer above detects it
            }
            this->store(byte);
        }
    }

    void transmit() noexcept
    {
        std::byte byte{};
        for (std::size_t i = 0; i < Base::kTransmitBytes && has_room(registers_) && this->to_send().pop(byte); ++i) {
            put(registers_, byte);
        }
        // The interrupt comes again when the register is empty.
        registers_.write(kControl1, this->to_send().size() > 0 ? kOn | kTransmitInterrupt : kOn);
    }

    Registers registers_;
};

}  // namespace jink::hal::stm32f4
