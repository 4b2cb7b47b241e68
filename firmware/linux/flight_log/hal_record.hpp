// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <optional>
#include <span>
#include <vector>

#include "core/base/time.hpp"
#include "firmware/app/constraints.hpp"
#include "hal/can_port.hpp"
#include "hal/port_health.hpp"

// The record of one step: everything that enters and leaves the co-processor, in the order of the calls. A record is a
// row of entries. An entry is a byte (kind in the low four bits, port in the high four) and what EntryReader reads
// after it; counts are LEB128 numbers. docs/guides/flight_log.md has the table.

namespace jink::flightlog {

enum class Entry : std::uint8_t {
    none,
    begin,        ///< of a step: its time
    read,         ///< of a serial port: the bytes
    write,        ///< to a serial port: number of bytes accepted, and all bytes offered
    health,       ///< of a port, where it differs from the call before: see Health
    can_frame,    ///< received
    can_nothing,  ///< no frame waited
    can_sent,     ///< a frame was offered and accepted
    can_refused,  ///< a frame was offered and not accepted
    areas,        ///< all closed areas, set from outside of the link
    stored,       ///< the state file holds the parameters of this generation
    shut_down,    ///< the end of the run: its time
    key_removed,  ///< the bytes read before had a signing key in them, which is overwritten with zeros
};

enum class Port : std::uint8_t { line, cloud, can };
inline constexpr std::size_t kPorts = 3;

/// The counters of a health, in the order of a record.
template <class H>
inline constexpr auto kCountersOf = nullptr;
template <>
inline constexpr auto kCountersOf<hal::PortHealth> =
    std::to_array({&hal::PortHealth::bytes_in, &hal::PortHealth::bytes_out, &hal::PortHealth::bytes_refused,
                   &hal::PortHealth::overruns, &hal::PortHealth::line_errors, &hal::PortHealth::read_errors,
                   &hal::PortHealth::write_errors, &hal::PortHealth::open_failures, &hal::PortHealth::disconnects,
                   &hal::PortHealth::reconnects});
template <>
inline constexpr auto kCountersOf<hal::CanHealth> =
    std::to_array({&hal::CanHealth::frames_in, &hal::CanHealth::frames_out, &hal::CanHealth::frames_refused,
                   &hal::CanHealth::frames_bad, &hal::CanHealth::overruns, &hal::CanHealth::bus_errors,
                   &hal::CanHealth::bus_offs, &hal::CanHealth::restarts, &hal::CanHealth::read_errors,
                   &hal::CanHealth::write_errors, &hal::CanHealth::downs, &hal::CanHealth::ups});
static_assert(sizeof(hal::PortHealth) == (1 + kCountersOf<hal::PortHealth>.size()) * sizeof(std::uint64_t) &&
                  sizeof(hal::CanHealth) == (1 + kCountersOf<hal::CanHealth>.size()) * sizeof(std::uint64_t),
              "a counter is missing");

/// A port's health as numbers: the state, then the counters in their order.
inline constexpr std::size_t kHealthNumbers = 1 + kCountersOf<hal::CanHealth>.size();
using Health = std::array<std::uint64_t, kHealthNumbers>;
template <class H>
[[nodiscard]] Health to_numbers(const H& health) noexcept
{
    Health numbers{static_cast<std::uint64_t>(health.state)};
    for (std::size_t i = 0; i < kCountersOf<H>.size(); ++i) {
        numbers[i + 1] = health.*kCountersOf<H>[i];
    }
    return numbers;
}
[[nodiscard]] hal::PortHealth to_port_health(const Health& numbers) noexcept;
[[nodiscard]] hal::CanHealth to_can_health(const Health& numbers) noexcept;

/// Bit i: number i differs.
template <class H>
[[nodiscard]] unsigned differences(const H& before, const H& now) noexcept
{
    unsigned differs = now.state != before.state ? 1U : 0U;
    for (std::size_t i = 0; i < kCountersOf<H>.size(); ++i) {
        if (now.*kCountersOf<H>[i] != before.*kCountersOf<H>[i]) [[unlikely]] {
            differs |= 2U << i;
        }
    }
    return differs;
}

/// Writes entries into memory that is allocated once. A record that does not fit is `overflowed`.
class EntryWriter {
public:
    explicit EntryWriter(std::size_t capacity) : bytes_(capacity) {}

    void clear() noexcept
    {
        size_ = 0;
        overflowed_ = false;
    }
    void entry(Entry kind, Port port = Port::line) noexcept
    {
        byte(static_cast<unsigned>(kind) | static_cast<unsigned>(port) << 4U);
    }
    /// The same, and a count.
    void entry(Entry kind, Port port, std::uint64_t value) noexcept
    {
        entry(kind, port);
        count(value);
    }
    void count(std::uint64_t value) noexcept
    {
        if (bytes_.size() - size_ < kLongestCount) [[unlikely]] {
            count_at_end(value);
            return;
        }
        std::byte* at = bytes_.data() + size_;
        for (; value >= 0x80U; value >>= 7U) {
            *at++ = static_cast<std::byte>(static_cast<unsigned>(value & 0x7FU) | 0x80U);
        }
        *at++ = static_cast<std::byte>(value);
        size_ = static_cast<std::size_t>(at - bytes_.data());
    }
    void bytes(std::span<const std::byte> bytes) noexcept
    {
        if (bytes.size() > bytes_.size() - size_) {
            overflowed_ = true;
        } else if (!bytes.empty()) {
            std::memcpy(bytes_.data() + size_, bytes.data(), bytes.size());
            size_ += bytes.size();
        }
    }
    template <class T>
    void put(T value) noexcept
    {
        bytes(std::as_bytes(std::span(&value, 1)));
    }
    void frame(const hal::CanFrame& frame) noexcept;
    void area(const app::Constraint& area) noexcept;
    /// The numbers that differ from `before`.
    /// @param differs  of `differences`
    template <class H>
    void health(unsigned differs, const H& before, const H& now) noexcept
    {
        put(static_cast<std::uint16_t>(differs));
        if ((differs & 1U) != 0) {
            count(static_cast<std::uint64_t>(now.state) - static_cast<std::uint64_t>(before.state));
        }
        for (unsigned rest = differs & ~1U; rest != 0; rest &= rest - 1) {
            const auto counter = kCountersOf<H>[static_cast<std::size_t>(std::countr_zero(rest)) - 1];
            count(now.*counter - before.*counter);  // modulo 2^64: a counter that is smaller takes ten bytes
        }
    }

    /// The newest n bytes, to be changed.
    [[nodiscard]] std::span<std::byte> newest(std::size_t n) noexcept
    {
        return overflowed_ ? std::span<std::byte>() : std::span(bytes_).subspan(size_ - n, n);
    }
    [[nodiscard]] std::span<const std::byte> record() const noexcept { return std::span(bytes_).first(size_); }
    [[nodiscard]] bool overflowed() const noexcept { return overflowed_; }

private:
    void byte(unsigned value) noexcept
    {
        if (size_ < bytes_.size()) {
            bytes_[size_++] = static_cast<std::byte>(value);
        } else {
            overflowed_ = true;
        }
    }

    /// Byte by byte, because the record is nearly full.
    void count_at_end(std::uint64_t value) noexcept;

    static constexpr std::size_t kLongestCount = 10;  ///< of 64 bits, 7 to a byte

    std::vector<std::byte> bytes_;
    std::size_t size_ = 0;
    bool overflowed_ = false;
};

/// Reads entries. Whatever the bytes are, it stays within them: what is missing is zero, and `is_good` is false.
class EntryReader {
public:
    explicit EntryReader(std::span<const std::byte> record = {}) noexcept : rest_(record) {}

    [[nodiscard]] bool empty() const noexcept { return rest_.empty(); }
    [[nodiscard]] bool is_good() const noexcept { return good_; }
    /// The next entry's kind and port, which stay.
    [[nodiscard]] Entry kind() const noexcept;
    [[nodiscard]] Port port() const noexcept;
    void pass() noexcept { static_cast<void>(number<std::uint8_t>()); }

    [[nodiscard]] std::uint64_t count() noexcept;
    [[nodiscard]] std::span<const std::byte> bytes(std::uint64_t n) noexcept;
    template <class T>
    [[nodiscard]] T number() noexcept
    {
        T value{};
        const std::span<const std::byte> from = bytes(sizeof value);
        std::copy(from.begin(), from.end(), std::as_writable_bytes(std::span(&value, 1)).begin());
        return value;
    }
    [[nodiscard]] hal::CanFrame frame() noexcept;
    [[nodiscard]] app::Constraint area() noexcept;
    void health(Health& numbers) noexcept;

private:
    std::span<const std::byte> rest_;
    bool good_ = true;
};

}  // namespace jink::flightlog
