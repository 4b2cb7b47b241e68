// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "hal/register_block.hpp"
#include "hal/ring.hpp"
#include "hal/serial_port.hpp"

namespace jink::hal {

/// The divider for `baud` from a UART's clock; 0 if no divider within [least, largest] is within 2 %. The two ends of
/// an asynchronous line may differ by 4 %, and the other end needs half of that. O(1).
[[nodiscard]] constexpr std::uint32_t baud_divider(std::uint32_t clock_hz, std::uint32_t baud, std::uint32_t least,
                                                   std::uint32_t largest) noexcept
{
    constexpr std::uint32_t kTolerance = 50;  // inverse of the permitted relative error
    const std::uint32_t divider = baud > 0 ? (clock_hz + baud / 2U) / baud : 0;
    if (divider < least || divider > largest) {
        return 0;
    }
    const std::uint32_t rate = clock_hz / divider;
    const std::uint32_t error = rate > baud ? rate - baud : baud - rate;
    return error > baud / kTolerance ? 0 : divider;
}

/// Sends by polling for space, at most `patience` polls per byte: for a fault handler, when nothing else runs any more.
/// False, with the rest unsent, if the line accepts nothing. O(from.size() * patience).
template <class Uart, RegisterBlock Registers>
[[nodiscard]] bool send_waiting(Registers registers, std::span<const std::byte> from, std::uint32_t patience) noexcept
{
    for (const std::byte byte : from) {
        std::uint32_t looks = 0;
        while (!Uart::has_room(registers)) {
            if (++looks > patience) {
                return false;
            }
        }
        Uart::put(registers, byte);
    }
    return true;
}

/// Common part of the serial ports that are fed by interrupts: a ring each way, and their counters. A driver derives
/// from it, and adds the registers, `start`, its handlers, and for send_waiting() the static `has_room` and `put`.
///
/// Only a driver's handlers access its data register; read() and write() access the rings alone, so neither disables
/// interrupts. The rings hold 4 KiB in and 1 KiB out: 44 ms and 11 ms of a full line at 921600 baud. Overruns of the
/// hardware and bytes that find the ring full are counted in `overruns`. Memory: 5.2 KiB.
template <InterruptWake Wake>
class InterruptSerialPort : public SerialPort {
public:
    static constexpr std::size_t kReceiveBytes = 4096;
    static constexpr std::size_t kTransmitBytes = 1024;

    /// @param wake_transmit  raises the interrupt that sends
    explicit InterruptSerialPort(Wake wake_transmit) noexcept : wake_transmit_(wake_transmit) {}

    [[nodiscard]] std::size_t read(std::span<std::byte> into) noexcept final
    {
        const std::size_t n = received_.pop(into);
        health_.bytes_in += n;
        return n;
    }

    [[nodiscard]] std::size_t write(std::span<const std::byte> from) noexcept final
    {
        const std::size_t n = health_.state == PortState::open ? to_send_.push(from) : 0;
        health_.bytes_out += n;
        health_.bytes_refused += from.size() - n;
        if (n > 0) {
            wake_transmit_();
        }
        return n;
    }

    [[nodiscard]] PortHealth health() const noexcept final
    {
        PortHealth health = health_;
        health.overruns = overruns_.load(std::memory_order_relaxed);
        health.line_errors = line_errors_.load(std::memory_order_relaxed);
        return health;
    }

    /// Bytes waiting to be sent. For the driver's handlers, and for a fault handler with interrupts off.
    [[nodiscard]] ByteRing<kTransmitBytes>& to_send() noexcept { return to_send_; }

protected:
    ~InterruptSerialPort() = default;

    void opened() noexcept { health_.state = PortState::open; }
    /// Called by a handler: stores a received byte.
    void store(std::byte byte) noexcept
    {
        if (!received_.push(byte)) {
            count_overrun();
        }
    }
    /// Several handlers of one priority may call these.
    void count_overrun() noexcept { count(overruns_); }
    void count_line_error() noexcept { count(line_errors_); }

private:
    static void count(std::atomic<std::uint32_t>& counter) noexcept
    {
        counter.store(counter.load(std::memory_order_relaxed) + 1U, std::memory_order_relaxed);
    }

    Wake wake_transmit_;
    ByteRing<kReceiveBytes> received_;
    ByteRing<kTransmitBytes> to_send_;
    PortHealth health_;  ///< the main program's part
    std::atomic<std::uint32_t> overruns_{0};
    std::atomic<std::uint32_t> line_errors_{0};
};

}  // namespace jink::hal
