// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "core/base/static_vector.hpp"
#include "firmware/link/mavlink/frame.hpp"

namespace jink::link::mavlink {

/// Verdict on the signature of a frame whose checksum is right.
enum class SignatureStatus : std::uint8_t {
    valid,
    wrong,         ///< hash does not match: other key or a forgery
    stale,         ///< not newer than the last one of its stream, or more than a minute behind: a replay
    streams_full,  ///< a new (system, component, link) and no room to remember its time
};

/// Senders whose last signature time is remembered. 16 covers an autopilot's components and two ground stations; each
/// costs 16 bytes. When full a new stream is refused, since a forgotten time would open the door to replays.
inline constexpr std::size_t kMaxSignedStreams = 16;

/// MAVLink 2 signing with one key: checks what comes in, signs what goes out.
///
/// Times count 10 us since 2015-01-01 UTC in 48 bits. Without a clock the owner gives the last value it has stored
/// plus a margin; the time must never go back over a restart, or peers take our frames for replays. `time()` rises with
/// every frame signed and with every valid frame of a peer that is ahead.
class Signing {
public:
    using Key = std::array<std::byte, 32>;

    Signing(const Key& key, std::uint8_t link_id, std::uint64_t time) noexcept
        : key_(key), time_(time), link_id_(link_id)
    {
    }

    /// Moves the time forward; an earlier one is ignored.
    void advance_to(std::uint64_t time) noexcept { time_ = time > time_ ? time : time_; }
    [[nodiscard]] std::uint64_t time() const noexcept { return time_; }

    /// Judges a whole signed v2 frame, signature at its end. Remembers its time when valid.
    /// O(frame): one SHA-256 over 32 bytes of key and all but 6 bytes of the frame.
    [[nodiscard]] SignatureStatus check(std::span<const std::byte> frame) noexcept;

    /// Fills the last 13 bytes of a v2 frame whose other bytes, kFlagSigned and checksum included, are complete.
    void sign(std::span<std::byte> frame) noexcept;

private:
    struct Stream {
        std::uint64_t time;
        std::uint8_t system_id, component_id, link_id;
    };
    using Hash = std::array<std::byte, 6>;

    [[nodiscard]] Hash hash(std::span<const std::byte> frame) const noexcept;

    Key key_;
    std::uint64_t time_;
    StaticVector<Stream, kMaxSignedStreams> streams_;
    std::uint8_t link_id_;
};

}  // namespace jink::link::mavlink
