// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
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

/// A port's health as numbers: the state, then the counters in their order.
inline constexpr std::size_t kHealthNumbers = 13;
using Health = std::array<std::uint64_t, kHealthNumbers>;
[[nodiscard]] inline Health to_numbers(const hal::PortHealth& h) noexcept
{
    return {static_cast<std::uint64_t>(h.state),
            h.bytes_in,
            h.bytes_out,
            h.bytes_refused,
            h.overruns,
            h.line_errors,
            h.read_errors,
            h.write_errors,
            h.open_failures,
            h.disconnects,
            h.reconnects};
}
[[nodiscard]] inline Health to_numbers(const hal::CanHealth& h) noexcept
{
    return {static_cast<std::uint64_t>(h.state),
            h.frames_in,
            h.frames_out,
            h.frames_refused,
            h.frames_bad,
            h.overruns,
            h.bus_errors,
            h.bus_offs,
            h.restarts,
            h.read_errors,
            h.write_errors,
            h.downs,
            h.ups};
}
[[nodiscard]] hal::PortHealth to_port_health(const Health& numbers) noexcept;
[[nodiscard]] hal::CanHealth to_can_health(const Health& numbers) noexcept;

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
    void count(std::uint64_t value) noexcept
    {
        for (; value >= 0x80U; value >>= 7U) {
            byte(static_cast<unsigned>(value & 0x7FU) | 0x80U);
        }
        byte(static_cast<unsigned>(value));
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
    void health(const Health& before, const Health& now) noexcept;

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
