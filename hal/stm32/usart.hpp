// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "hal/interrupt_serial_port.hpp"

namespace jink::hal::stm32 {

/// Serial port on a USART of an STM32, fed by its interrupt in both directions (hal/interrupt_serial_port.hpp).
/// Framing, noise and parity errors are counted in `line_errors`.
///
/// @tparam Layout  offsets of the registers and what to write to them: hal/stm32f4/usart.hpp, hal/stm32h7/usart.hpp.
/// The
///                 bits of the status are the same on both chips.
template <class Layout, RegisterBlock Registers, InterruptWake Wake>
class Usart final : public InterruptSerialPort<Wake> {
    using Base = InterruptSerialPort<Wake>;

public:
    /// Bytes that the hardware holds after put().
    static constexpr std::size_t kHardwareBytes = Layout::kHardwareBytes;

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
        registers_.write(Layout::kControl1, 0);        // the rate can be set only while it is off
        registers_.write(Layout::kBaudRate, divider);  // in sixteenths, the register's unit
        registers_.write(Layout::kControl3, 0);
        registers_.write(Layout::kControl2, 0);
        registers_.write(Layout::kControl1, Layout::kOn);
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
        return (registers.read(Layout::kStatus) & kTransmitEmpty) != 0;
    }
    static void put(Registers& registers, std::byte byte) noexcept
    {
        registers.write(Layout::kTransmitData, std::to_integer<std::uint32_t>(byte));
    }

    /// send_waiting() on its own registers; bytes in the ring are not sent.
    void write_waiting(std::span<const std::byte> from, std::uint32_t patience) noexcept
    {
        static_cast<void>(send_waiting<Usart>(registers_, from, patience));
    }

private:
    static constexpr std::uint32_t kLineError = 0x7;  // of the status: parity, framing, noise
    static constexpr std::uint32_t kOverrun = 1U << 3U;
    static constexpr std::uint32_t kReceived = 1U << 5U;
    static constexpr std::uint32_t kTransmitEmpty = 1U << 7U;      // there is space for a byte
    static constexpr std::uint32_t kTransmitInterrupt = 1U << 7U;  // of kControl1
    static constexpr std::uint32_t kMinDivider = 16;
    static constexpr std::uint32_t kLargestDivider = 0xFFFF;

    void receive() noexcept
    {
        for (std::size_t i = 0; i < Base::kReceiveBytes; ++i) {
            const std::uint32_t status = registers_.read(Layout::kStatus);
            if ((status & (kReceived | kOverrun)) == 0) {
                return;
            }
            if ((status & kOverrun) != 0) {
                this->count_overrun();  // the byte that came too early is lost, those before it are still valid
            }
            Layout::clear_errors(registers_, status);
            if ((status & kReceived) == 0) {
                continue;
            }
            if ((status & kLineError) != 0) {
                this->count_line_error();  // its value is undefined, and the checksum of the layer above detects it
            }
            this->store(static_cast<std::byte>(registers_.read(Layout::kReceivedData) & 0xFFU));
        }
    }

    void transmit() noexcept
    {
        std::byte byte{};
        for (std::size_t i = 0; i < Base::kTransmitBytes && has_room(registers_) && this->to_send().pop(byte); ++i) {
            put(registers_, byte);
        }
        // The interrupt comes again when there is space.
        registers_.write(Layout::kControl1,
                         this->to_send().size() > 0 ? Layout::kOn | kTransmitInterrupt : Layout::kOn);
    }

    Registers registers_;
};

}  // namespace jink::hal::stm32
