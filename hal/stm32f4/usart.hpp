// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "hal/register_block.hpp"
#include "hal/ring.hpp"
#include "hal/serial_port.hpp"

namespace jink::hal::stm32f4 {

/// Serial port on a USART of the STM32F4 (ST RM0090, 30), fed by its interrupt in both directions.
///
/// The receiver holds one byte behind its shift register: at 921600 baud the handler has to run within 10.8 us, or a
/// byte is lost. Overruns of the receiver and bytes that find the ring full are counted in `overruns`, framing, noise
/// and parity errors in `line_errors`. The rings hold 4 KiB in and 1 KiB out.
///
/// Only the handler touches the USART after start(); read() and write() touch the rings alone. Memory: 5.2 KiB.
template <RegisterBlock Registers, InterruptWake Wake>
class Usart final : public SerialPort {
public:
    static constexpr std::size_t kReceiveBytes = 4096;
    static constexpr std::size_t kTransmitBytes = 1024;

    /// @param wake  raises the USART's interrupt
    Usart(Registers registers, Wake wake) noexcept : registers_(registers), wake_(wake) {}

    /// 8N1 at `baud`, both directions. False, and the port stays closed, where the divider does not give the rate
    /// within 2 % or is below the hardware's least (16, oversampling by 16).
    [[nodiscard]] bool start(std::uint32_t peripheral_clock_hz, std::uint32_t baud) noexcept
    {
        const std::uint32_t divider = baud > 0 ? (peripheral_clock_hz + baud / 2U) / baud : 0;
        if (divider < kLeastDivider || divider > kLargestDivider) {
            return false;
        }
        const std::uint32_t rate = peripheral_clock_hz / divider;
        const std::uint32_t error = rate > baud ? rate - baud : baud - rate;
        if (error > baud / kBaudTolerance) {
            return false;
        }
        registers_.write(kBaudRate, divider);  // sixteenths, as the register counts them
        registers_.write(kControl3, 0);
        registers_.write(kControl2, 0);
        registers_.write(kControl1, kOn);
        health_.state = PortState::open;
        return true;
    }

    [[nodiscard]] std::size_t read(std::span<std::byte> into) noexcept override
    {
        const std::size_t n = received_.pop(into);
        health_.bytes_in += n;
        return n;
    }

    [[nodiscard]] std::size_t write(std::span<const std::byte> from) noexcept override
    {
        const std::size_t n = health_.state == PortState::open ? to_send_.push(from) : 0;
        health_.bytes_out += n;
        health_.bytes_refused += from.size() - n;
        if (n > 0) {
            wake_();
        }
        return n;
    }

    [[nodiscard]] PortHealth health() const noexcept override
    {
        PortHealth health = health_;
        health.overruns = overruns_.load(std::memory_order_relaxed);
        health.line_errors = line_errors_.load(std::memory_order_relaxed);
        return health;
    }

    /// From the interrupt's handler. O(bytes that come and go), both rings' sizes at most: what is left raises it
    /// again.
    void on_interrupt() noexcept
    {
        receive();
        transmit();
    }

    /// Writes by waiting for room, `patience` looks per byte at most: for a fault handler, when nothing else runs any
    /// more. What is in the ring is left out. O(from.size() * patience).
    void write_waiting(std::span<const std::byte> from, std::uint32_t patience) noexcept
    {
        for (const std::byte byte : from) {
            for (std::uint32_t i = 0; i < patience && (registers_.read(kStatus) & kTransmitEmpty) == 0; ++i) {
            }
            registers_.write(kData, std::to_integer<std::uint32_t>(byte));
        }
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
    static constexpr std::uint32_t kLeastDivider = 16;
    static constexpr std::uint32_t kLargestDivider = 0xFFFF;
    /// One part in so many: the two ends of an asynchronous line may be 4 % apart, and the other end needs half of it.
    static constexpr std::uint32_t kBaudTolerance = 50;

    static void count(std::atomic<std::uint32_t>& counter) noexcept
    {
        counter.store(counter.load(std::memory_order_relaxed) + 1U, std::memory_order_relaxed);
    }

    /// Reading the data after the status clears the flags of both byte and errors.
    void receive() noexcept
    {
        for (std::size_t i = 0; i < kReceiveBytes; ++i) {
            const std::uint32_t status = registers_.read(kStatus);
            if ((status & (kReceived | kOverrun)) == 0) {
                return;
            }
            const auto byte = static_cast<std::byte>(registers_.read(kData) & 0xFFU);
            if ((status & kOverrun) != 0) {
                count(overruns_);  // the byte that came too early is lost, the one before it is still good
            }
            if ((status & kReceived) == 0) {
                continue;
            }
            if ((status & kLineError) != 0) {
                count(line_errors_);  // its value is anybody's guess, and the checksum above will say so
            }
            if (!received_.push(byte)) {
                count(overruns_);
            }
        }
    }

    void transmit() noexcept
    {
        std::byte byte{};
        for (std::size_t i = 0;
             i < kTransmitBytes && (registers_.read(kStatus) & kTransmitEmpty) != 0 && to_send_.pop(byte); ++i) {
            registers_.write(kData, std::to_integer<std::uint32_t>(byte));
        }
        // The next byte asks for itself when the register is empty again.
        registers_.write(kControl1, to_send_.size() > 0 ? kOn | kTransmitInterrupt : kOn);
    }

    Registers registers_;
    Wake wake_;
    ByteRing<kReceiveBytes> received_;
    ByteRing<kTransmitBytes> to_send_;
    PortHealth health_;  ///< the main program's side of it
    std::atomic<std::uint32_t> overruns_{0};
    std::atomic<std::uint32_t> line_errors_{0};
};

}  // namespace jink::hal::stm32f4
