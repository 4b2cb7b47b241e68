// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace jink::hal {

/// One CAN frame, classic or FD. 76 bytes.
struct CanFrame {
    static constexpr std::size_t kClassicBytes = 8;
    static constexpr std::size_t kFdBytes = 64;
    static constexpr std::uint32_t kStandardMask = 0x7FF;
    static constexpr std::uint32_t kExtendedMask = 0x1FFFFFFF;

    std::uint32_t id = 0;          ///< 11 or 29 bits
    bool extended = false;         ///< 29 bits
    bool remote = false;           ///< a remote frame: no data of its own
    bool fd = false;               ///< CAN FD: up to 64 bytes
    bool bit_rate_switch = false;  ///< FD: the data at the higher rate
    std::uint8_t length = 0;       ///< bytes; FD allows 0..8, 12, 16, 20, 24, 32, 48, 64 only
    std::array<std::byte, kFdBytes> data{};
};

/// Lengths that a frame may have on the wire.
[[nodiscard]] constexpr bool is_valid_length(bool fd, std::size_t length) noexcept
{
    if (length <= CanFrame::kClassicBytes) {
        return true;
    }
    return fd && (length == 12 || length == 16 || length == 20 || length == 24 || length == 32 || length == 48 ||
                  length == 64);
}

/// Whether id and length are in range.
[[nodiscard]] constexpr bool is_valid(const CanFrame& frame) noexcept
{
    return frame.id <= (frame.extended ? CanFrame::kExtendedMask : CanFrame::kStandardMask) &&
           is_valid_length(frame.fd, frame.length) && !(frame.fd && frame.remote) &&
           (frame.fd || !frame.bit_rate_switch);
}

enum class CanState : std::uint8_t {
    closed,         ///< not opened
    active,         ///< takes part in the bus
    error_passive,  ///< takes part, but after too many errors it may no longer send active error flags
    bus_off,        ///< the controller has left the bus; it returns by itself if so configured
    down,           ///< the interface is down or absent
};

/// Counters of a CAN port. They only grow.
struct CanHealth {
    CanState state = CanState::closed;
    std::uint64_t frames_in = 0;
    std::uint64_t frames_out = 0;      ///< accepted by send(), delivered or not
    std::uint64_t frames_refused = 0;  ///< refused by send(): queue full, not open, bus off
    std::uint64_t frames_bad = 0;      ///< refused by send(): invalid id or length, or FD on a classic bus
    std::uint64_t overruns = 0;        ///< received frames lost because the queue was full
    std::uint64_t bus_errors = 0;      ///< errors reported by the controller: bits, stuffing, acknowledgement, ...
    std::uint64_t bus_offs = 0;
    std::uint64_t restarts = 0;  ///< returns from bus off
    std::uint64_t read_errors = 0;
    std::uint64_t write_errors = 0;
    std::uint64_t downs = 0;  ///< times the interface was lost
    std::uint64_t ups = 0;    ///< times the interface returned
};

/// A CAN controller.
///
/// Nothing here blocks, throws or keeps a pointer to the caller's memory. `health()` counts all losses.
class CanPort {
public:
    /// Reads the oldest received frame; false if there is none. Own frames are not received. O(1).
    [[nodiscard]] virtual bool receive(CanFrame& frame) noexcept = 0;
    /// Queues a frame; false, and counted, if it cannot be accepted now. O(1).
    [[nodiscard]] virtual bool send(const CanFrame& frame) noexcept = 0;
    [[nodiscard]] virtual CanHealth health() const noexcept = 0;

protected:
    ~CanPort() = default;
};

}  // namespace jink::hal
