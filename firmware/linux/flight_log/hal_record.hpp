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
// row of entries. An entry is a byte (kind in the low four bits, port in the three above, kKeyOverwritten) and what
// EntryReader reads after it; counts are LEB128 numbers. docs/guides/flight_log.md has the table.

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
};
/// Of an entry's first byte: what was read had a part of a signing key in it, which is overwritten with zeros.
inline constexpr std::byte kKeyOverwritten{0x80};

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

// What a call makes of the health before it, if nothing else happens: recorder and replay count alike, and a record has
// only what differs from that.
inline void count_read(hal::PortHealth& health, std::size_t bytes) noexcept { health.bytes_in += bytes; }
inline void count_write(hal::PortHealth& health, std::size_t offered, std::size_t accepted) noexcept
{
    health.bytes_out += accepted;
    health.bytes_refused += offered - accepted;
}
inline void count_received(hal::CanHealth& health) noexcept { ++health.frames_in; }
inline void count_sent(hal::CanHealth& health, bool accepted) noexcept
{
    ++(accepted ? health.frames_out : health.frames_refused);
}

/// Whether state and all counters are the same. In each call of a port's health: without a branch for each counter.
template <class H>
[[nodiscard]] bool is_same(const H& a, const H& b) noexcept
{
    constexpr std::size_t kCounters = sizeof(H) - sizeof(std::uint64_t);  // behind the state
    const std::byte* const of_a = std::as_bytes(std::span(&a, 1)).last(kCounters).data();
    const std::byte* const of_b = std::as_bytes(std::span(&b, 1)).last(kCounters).data();
    std::uint64_t differs = a.state != b.state ? 1U : 0U;
    for (std::size_t i = 0; i < kCounters; i += sizeof(std::uint64_t)) {
        std::uint64_t in_a = 0;
        std::uint64_t in_b = 0;
        std::memcpy(&in_a, of_a + i, sizeof in_a);
        std::memcpy(&in_b, of_b + i, sizeof in_b);
        differs |= in_a ^ in_b;
    }
    return differs == 0;
}
/// Bit 0: the state differs; bit i + 1: counter i does.
template <class H>
[[nodiscard]] unsigned differences(const H& before, const H& now) noexcept
{
    unsigned differs = now.state != before.state ? 1U : 0U;
    for (std::size_t i = 0; i < kCountersOf<H>.size(); ++i) {
        differs |= now.*kCountersOf<H>[i] != before.*kCountersOf<H>[i] ? 2U << i : 0U;
    }
    return differs;
}

/// Writes entries into memory that is allocated once. A record that does not fit is `overflowed`.
class EntryWriter {
public:
    /// @param before, behind  bytes of memory() that are not the record's
    explicit EntryWriter(std::size_t capacity, std::size_t before = 0, std::size_t behind = 0)
        : bytes_(before + capacity + behind), begin_(bytes_.data() + before), end_(begin_ + capacity)
    {
    }
    EntryWriter(const EntryWriter&) = delete;
    EntryWriter& operator=(const EntryWriter&) = delete;

    void clear() noexcept
    {
        at_ = begin_;
        overflowed_ = false;
    }
    void entry(Entry kind, Port port = Port::line) noexcept { byte(first_byte(kind, port)); }
    /// The same, and a count.
    void entry(Entry kind, Port port, std::uint64_t value) noexcept
    {
        if (left() <= kLongestCount) [[unlikely]] {
            entry(kind, port);
            count_at_end(value);
            return;
        }
        *at_ = static_cast<std::byte>(first_byte(kind, port));
        at_ = put_count(at_ + 1, value);
    }
    void count(std::uint64_t value) noexcept
    {
        if (left() < kLongestCount) [[unlikely]] {
            count_at_end(value);
            return;
        }
        at_ = put_count(at_, value);
    }
    void bytes(std::span<const std::byte> bytes) noexcept
    {
        if (bytes.size() > left()) [[unlikely]] {
            overflowed_ = true;
        } else if (!bytes.empty()) {
            std::byte* const at = at_;
            at_ += bytes.size();
            std::memcpy(at, bytes.data(), bytes.size());
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

    [[nodiscard]] std::span<const std::byte> record() const noexcept { return {begin_, at_}; }
    /// The record with the bytes before and behind it, for one who needs the record no more.
    [[nodiscard]] std::span<std::byte> memory() noexcept { return bytes_; }
    [[nodiscard]] bool overflowed() const noexcept { return overflowed_; }

private:
    void byte(unsigned value) noexcept
    {
        if (left() > 0) [[likely]] {
            *at_++ = static_cast<std::byte>(value);
        } else {
            overflowed_ = true;
        }
    }
    [[nodiscard]] static unsigned first_byte(Entry kind, Port port) noexcept
    {
        return static_cast<unsigned>(kind) | static_cast<unsigned>(port) << 4U;
    }
    /// @return behind the count
    static std::byte* put_count(std::byte* at, std::uint64_t value) noexcept
    {
        for (; value >= 0x80U; value >>= 7U) {
            *at++ = static_cast<std::byte>(static_cast<unsigned>(value & 0x7FU) | 0x80U);
        }
        *at = static_cast<std::byte>(value);
        return at + 1;
    }
    [[nodiscard]] std::size_t left() const noexcept { return static_cast<std::size_t>(end_ - at_); }

    /// Byte by byte, because the record is nearly full.
    void count_at_end(std::uint64_t value) noexcept;

    static constexpr std::size_t kLongestCount = 10;  ///< of 64 bits, 7 to a byte

    std::vector<std::byte> bytes_;
    std::byte* begin_;
    std::byte* end_;
    std::byte* at_ = begin_;  ///< where the next entry goes
    bool overflowed_ = false;
};

/// Reads entries. Whatever the bytes are, it stays within them: what is missing is zero, and `is_good` is false.
class EntryReader {
public:
    explicit EntryReader(std::span<const std::byte> record = {}) noexcept : rest_(record) {}

    [[nodiscard]] bool empty() const noexcept { return rest_.empty(); }
    /// Bytes that are not read yet.
    [[nodiscard]] std::size_t left() const noexcept { return rest_.size(); }
    [[nodiscard]] bool is_good() const noexcept { return good_; }
    /// The next entry's kind, port and kKeyOverwritten, which stay.
    [[nodiscard]] Entry kind() const noexcept;
    [[nodiscard]] Port port() const noexcept;
    [[nodiscard]] bool lost_key() const noexcept;
    void pass() noexcept { static_cast<void>(number<std::uint8_t>()); }
    /// The content of an entry of this kind. @return false: there is no such kind, or bytes are missing
    bool pass_content(Entry kind) noexcept;

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
    /// Changes `health` by what was recorded.
    template <class H>
    void health(H& health) noexcept
    {
        const unsigned differs = number<std::uint16_t>();
        if ((differs & 1U) != 0) {
            health.state = static_cast<decltype(health.state)>(static_cast<std::uint64_t>(health.state) + count());
        }
        for (std::size_t i = 0; i < kCountersOf<H>.size(); ++i) {
            health.*kCountersOf<H>[i] += (differs >> (i + 1) & 1U) != 0 ? count() : 0U;
        }
        good_ = good_ && differs >> (kCountersOf<H>.size() + 1) == 0;
    }

private:
    std::span<const std::byte> rest_;
    bool good_ = true;
};

}  // namespace jink::flightlog
