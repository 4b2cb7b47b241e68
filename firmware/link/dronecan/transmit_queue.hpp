// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "firmware/link/dronecan/codec.hpp"

namespace jink::link::dronecan {

/// Frames that wait for the port. 128 hold the longest transfer (GetNodeInfo's response at its limit, 55 frames) twice,
/// or the tunnel's answer to a full serial buffer; 16 bytes each.
inline constexpr std::size_t kTransmitFrames = 128;
/// Frames of the longest transfer: two bytes of CRC come first, seven bytes of payload fit in each frame.
inline constexpr std::size_t kMaxFramesOfTransfer = (kMaxPayload + 2 + 6) / 7;
static_assert(kTransmitFrames >= kMaxFramesOfTransfer && kTransmitFrames <= 1024);

/// Type, sender and receiver of a transfer.
struct TransferHead {
    TypeInfo type{};
    Priority priority = Priority::medium;
    std::uint8_t source = kAnonymous;
    std::uint8_t destination = 0;  ///< services only
    std::uint8_t transfer = 0;     ///< transfer id, 0 .. 31
};

struct TransmitDiagnostics {
    std::uint32_t transfers = 0;          ///< queued
    std::uint32_t frames = 0;             ///< taken by the port
    std::uint32_t transfers_dropped = 0;  ///< for lack of space for newer ones, or on a lost port
    std::uint32_t transfers_refused = 0;  ///< too long, or an anonymous transfer of more than a frame
};

/// Frames of whole transfers, first in first out.
///
/// When full, the oldest transfers are dropped, each with all of its frames. If part of a dropped transfer has been
/// sent already, the receivers get an incomplete transfer, which they drop. The newest transfer is never dropped for
/// older ones. Memory: 16 bytes * kTransmitFrames.
class TransmitQueue {
public:
    /// Cuts `payload` into frames; false, and counted, if it cannot be sent at all. O(payload + kTransmitFrames).
    bool push(const TransferHead& head, std::span<const std::byte> payload) noexcept;

    /// The frame to send next; it stays until `pop`.
    [[nodiscard]] const Frame* front() const noexcept { return size_ > 0 ? &frames_[first_] : nullptr; }
    void pop() noexcept;
    /// Drops everything queued: on a lost port no outdated frame may be sent later.
    void clear() noexcept;

    [[nodiscard]] std::size_t size() const noexcept { return size_; }
    [[nodiscard]] const TransmitDiagnostics& diagnostics() const noexcept { return diagnostics_; }

private:
    void append(const Frame& frame) noexcept;
    void drop_oldest() noexcept;

    std::array<Frame, kTransmitFrames> frames_{};
    std::size_t first_ = 0;
    std::size_t size_ = 0;
    TransmitDiagnostics diagnostics_;
};

}  // namespace jink::link::dronecan
