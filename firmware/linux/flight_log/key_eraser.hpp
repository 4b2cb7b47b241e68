// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <span>

#include "firmware/link/mavlink/frame.hpp"

namespace jink::flightlog {

/// Finds SETUP_SIGNING (message 256) in received bytes and overwrites its payload, which holds a signing key, with
/// zeros. Payloads of a later revision, which are longer, count too, as the receiver takes them. Every byte that could
/// begin such a frame counts, whatever the receiver makes of it; the frame may be split over reads. O(bytes).
class KeyEraser {
public:
    /// @return whether anything was overwritten
    [[nodiscard]] bool erase(std::span<std::byte> bytes) noexcept;
    /// Bytes are missing before the next ones: the next kUnknown bytes are overwritten, because the header of their
    /// frame may be among the missing ones.
    void forget() noexcept;

    /// A key ends at most 51 bytes behind missing bytes: 9 of its header, and 42 of the payload, however long that is.
    /// The rest covers a DroneCAN transfer whose first frame is missing too, so that bytes of its own head pass for
    /// tunnelled ones.
    static constexpr std::size_t kUnknown = 64;

private:
    /// Version 1 cannot carry this message.
    static constexpr std::size_t kHeader = link::mavlink::kHeaderV2;
    static constexpr std::size_t kTail = kHeader - 1;

    std::array<std::byte, kTail> tail_{};  ///< of the reads before
    bool may_go_on_ = false;               ///< a frame may begin in the tail
    std::size_t secret_ = 0;               ///< bytes of the present frame still to be overwritten
};

}  // namespace jink::flightlog
