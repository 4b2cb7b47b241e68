// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "hal/register_block.hpp"
#include "hal/ring.hpp"
#include "hal/serial_port.hpp"

namespace jink::hal {

/// Serial port on the CMSDK APB UART (ARM DDI 0479), fed by interrupts in both directions.
///
/// The UART holds one byte each way: at 921600 baud its receive handler has to run within 10.8 us, or a byte is lost
/// and counted in `overruns`, as is one that finds the ring full. The rings hold 4 KiB in and 1 KiB out: 44 ms and 11
/// ms of a full line at 921600 baud.
///
/// Only the handlers touch the data register; read() and write() touch the rings alone, so neither needs interrupts to
/// be off. Memory: 5.2 KiB.
template <RegisterBlock Registers, InterruptWake Wake>
class CmsdkUart final : public SerialPort {
public:
    static constexpr std::size_t kReceiveBytes = 4096;
    static constexpr std::size_t kTransmitBytes = 1024;

    /// @param wake_transmit  raises the transmit interrupt
    CmsdkUart(Registers registers, Wake wake_transmit) noexcept : registers_(registers), wake_transmit_(wake_transmit)
    {
    }

    /// Sets the baud rate and starts both directions. False, and the port stays closed, where the divider does not give
    /// the rate within 2 % or is below the hardware's least (16).
    [[nodiscard]] bool start(std::uint32_t peripheral_clock_hz, std::uint32_t baud) noexcept
    {
        const std::uint32_t divider = baud > 0 ? (peripheral_clock_hz + baud / 2U) / baud : 0;
        if (divider < kLeastDivider) {
            return false;
        }
        const std::uint32_t rate = peripheral_clock_hz / divider;
        const std::uint32_t error = rate > baud ? rate - baud : baud - rate;
        if (error > baud / kBaudTolerance) {
            return false;
        }
        registers_.write(kDivider, divider);
        registers_.write(kControl, kAllOn);
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
            wake_transmit_();
        }
        return n;
    }

    [[nodiscard]] PortHealth health() const noexcept override
    {
        PortHealth health = health_;
        health.overruns = overruns_.load(std::memory_order_relaxed);
        return health;
    }

    /// From the receive interrupt's handler. O(bytes there), kReceiveBytes at most: what is left raises it again.
    void on_receive() noexcept
    {
        registers_.write(kInterrupts, kReceiveInterrupt);  // before the byte: one that comes in between raises it again
        for (std::size_t i = 0; i < kReceiveBytes && (registers_.read(kState) & kReceiveFull) != 0; ++i) {
            if (!received_.push(static_cast<std::byte>(registers_.read(kData) & 0xFFU))) {
                count_overrun();
            }
        }
    }

    /// From the transmit interrupt's handler. O(bytes that find room).
    void on_transmit() noexcept
    {
        registers_.write(kInterrupts, kTransmitInterrupt);
        std::byte byte{};
        for (std::size_t i = 0;
             i < kTransmitBytes && (registers_.read(kState) & kTransmitFull) == 0 && to_send_.pop(byte); ++i) {
            registers_.write(kData, std::to_integer<std::uint32_t>(byte));
        }
    }

    /// From the overrun interrupt's handler. O(1).
    void on_overrun() noexcept
    {
        if ((registers_.read(kState) & kReceiveOverrun) != 0) {
            count_overrun();
        }
        registers_.write(kInterrupts, kOverrunInterrupts);
    }

    /// Writes by waiting for room, `patience` looks per byte at most: for a fault handler, when nothing else runs any
    /// more. What is in the ring is left out. O(from.size() * patience).
    void write_waiting(std::span<const std::byte> from, std::uint32_t patience) noexcept
    {
        for (const std::byte byte : from) {
            for (std::uint32_t i = 0; i < patience && (registers_.read(kState) & kTransmitFull) != 0; ++i) {
            }
            registers_.write(kData, std::to_integer<std::uint32_t>(byte));
        }
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
    /// Both directions, their interrupts, and the one of a receive overrun.
    static constexpr std::uint32_t kAllOn = 0x2F;
    static constexpr std::uint32_t kLeastDivider = 16;
    /// One part in so many: the two ends of an asynchronous line may be 4 % apart, and the other end needs half of it.
    static constexpr std::uint32_t kBaudTolerance = 50;

    /// Two handlers may do so, of one priority.
    void count_overrun() noexcept
    {
        overruns_.store(overruns_.load(std::memory_order_relaxed) + 1U, std::memory_order_relaxed);
    }

    Registers registers_;
    Wake wake_transmit_;
    ByteRing<kReceiveBytes> received_;
    ByteRing<kTransmitBytes> to_send_;
    PortHealth health_;  ///< the main program's side of it
    std::atomic<std::uint32_t> overruns_{0};
};

}  // namespace jink::hal
