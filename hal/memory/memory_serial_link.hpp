// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "hal/clock.hpp"
#include "hal/serial_port.hpp"

namespace jink::hal {

/// Capacity for bytes in transit in one direction. 4096 is a Linux pty's buffer; each costs 16 bytes. Further bytes are
/// refused or overrun, see `LineFaults::back_pressure`.
inline constexpr std::size_t kMemoryLineCapacity = 4096;

/// Capacity for stalls of one line; `MemoryLine::try_add_stall` refuses further ones.
inline constexpr std::size_t kMaxStalls = 8;

/// Half-open interval [from_us, until_us) on the line's clock [us].
struct StallWindow {
    std::int64_t from_us = 0;
    std::int64_t until_us = 0;
};

/// Faults of one direction of a line.
struct LineFaults {
    std::uint32_t loss_per_million = 0;          ///< chance that a byte vanishes, 0 .. 1'000'000
    std::uint32_t corruption_per_million = 0;    ///< chance that one bit of a byte is flipped, 0 .. 1'000'000
    std::int64_t latency_us = 0;                 ///< time from write to readable [us], >= 0
    std::size_t capacity = kMemoryLineCapacity;  ///< bytes in transit at once, 0 .. kMemoryLineCapacity
    bool back_pressure = true;  ///< full: write accepts less (pty, USB); false: bytes are overrun as on a bare UART
};

/// Counters of the bytes of one direction. taken = delivered + lost + overrun + discarded + queued, always.
struct LineCounters {
    std::uint64_t taken = 0;      ///< accepted from the writer
    std::uint64_t delivered = 0;  ///< handed to the reader
    std::uint64_t lost = 0;       ///< vanished by `loss_per_million`
    std::uint64_t overrun = 0;    ///< arrived when the buffer was full, without back pressure
    std::uint64_t discarded = 0;  ///< were in transit when the line was cut
    std::uint64_t queued = 0;     ///< are in transit
    std::uint64_t corrupted = 0;  ///< of those queued or delivered: bytes with a flipped bit
};

/// One direction: a ring of bytes, each with the time from which it may be read.
///
/// The same seed, faults and calls give the same bytes. About 16 * kMemoryLineCapacity bytes; allocation-free.
class MemoryLine {
public:
    /// @param clock  outlives this line
    MemoryLine(Clock& clock, std::uint64_t seed) noexcept : clock_(clock), random_state_(seed) {}

    /// Applies to bytes written from now on; those in transit keep their delay.
    void set_faults(const LineFaults& faults) noexcept;
    /// Nothing is delivered during [from_us, until_us); bytes wait. False if kMaxStalls are set already.
    [[nodiscard]] bool try_add_stall(StallWindow stall) noexcept;

    /// O(from.size()).
    [[nodiscard]] std::size_t write(std::span<const std::byte> from) noexcept;
    /// O(into.size()).
    [[nodiscard]] std::size_t read(std::span<std::byte> into) noexcept;
    /// Discards the bytes in transit.
    void cut() noexcept;

    [[nodiscard]] LineCounters counters() const noexcept;

private:
    struct Item {
        std::int64_t due_us = 0;
        std::byte value{};
    };

    [[nodiscard]] std::uint64_t random() noexcept;
    [[nodiscard]] bool chance(std::uint32_t per_million) noexcept;
    [[nodiscard]] bool stalled(std::int64_t now_us) const noexcept;

    Clock& clock_;
    std::uint64_t random_state_;
    LineFaults faults_{};
    std::array<StallWindow, kMaxStalls> stalls_{};
    std::size_t stall_count_ = 0;
    std::array<Item, kMemoryLineCapacity> ring_{};
    std::size_t head_ = 0;
    std::size_t size_ = 0;
    LineCounters counters_{};
};

/// A cable between two serial ports in memory, with faults on demand. Starts connected.
///
/// Not thread-safe. Ports and lines are part of the link: it is neither copied nor moved.
class MemorySerialLink {
public:
    class Port final : public SerialPort {
    public:
        [[nodiscard]] std::size_t read(std::span<std::byte> into) noexcept override;
        [[nodiscard]] std::size_t write(std::span<const std::byte> from) noexcept override;
        [[nodiscard]] PortHealth health() const noexcept override;

    private:
        friend class MemorySerialLink;
        Port(const MemorySerialLink& link, MemoryLine& out, MemoryLine& in) noexcept : link_(link), out_(out), in_(in)
        {
        }

        const MemorySerialLink& link_;
        MemoryLine& out_;
        MemoryLine& in_;
        std::uint64_t bytes_refused_ = 0;
    };

    /// @param clock  outlives this link
    /// @param seed   of both directions' random numbers
    MemorySerialLink(Clock& clock, std::uint64_t seed) noexcept;
    MemorySerialLink(const MemorySerialLink&) = delete;
    MemorySerialLink& operator=(const MemorySerialLink&) = delete;

    [[nodiscard]] Port& a() noexcept { return a_; }
    [[nodiscard]] Port& b() noexcept { return b_; }
    [[nodiscard]] MemoryLine& a_to_b() noexcept { return a_to_b_; }
    [[nodiscard]] MemoryLine& b_to_a() noexcept { return b_to_a_; }

    /// Disconnects the cable: both ports are lost, and bytes in transit are discarded. No effect if disconnected
    /// already.
    void disconnect() noexcept;
    /// Reconnects the cable. No effect if connected already.
    void reconnect() noexcept;

private:
    MemoryLine a_to_b_;
    MemoryLine b_to_a_;
    Port a_;
    Port b_;
    bool connected_ = true;
    std::uint64_t disconnects_ = 0;
    std::uint64_t reconnects_ = 0;
};

}  // namespace jink::hal
