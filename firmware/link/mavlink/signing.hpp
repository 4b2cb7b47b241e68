// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "core/base/static_vector.hpp"
#include "firmware/link/mavlink/frame.hpp"

namespace jink::link::mavlink {

/// Result of checking the signature of a frame with a correct checksum.
enum class SignatureStatus : std::uint8_t {
    valid,
    wrong,         ///< hash does not match: other key or a forgery
    stale,         ///< not newer than the last one of its stream, or more than a minute late: a replay
    streams_full,  ///< a new (system, component, link) and no capacity for its time
};

/// Senders whose last signature time is kept. 16 covers an autopilot's components and two ground stations; each costs
/// 16 bytes. When full, a sender more than a minute behind our time is dropped: its frames are stale anyway. If there
/// is none, a new sender is refused, since dropping a valid time would allow replays.
inline constexpr std::size_t kMaxSignedStreams = 16;

/// Messages whose unsigned frames are accepted although a key is set. 8 exceeds the number of any stack (PX4: 3).
inline constexpr std::size_t kMaxUnsignedMessages = 8;

/// The unsigned frames that are accepted although a key is set. By default: none.
struct UnsignedFrames {
    bool all = false;  ///< the link as a whole
    StaticVector<std::uint32_t, kMaxUnsignedMessages> messages;
};

/// MAVLink 2 signing with one key: checks incoming and signs outgoing frames. Without a key it does neither.
///
/// Times count 10 us since 2015-01-01 UTC in 48 bits. At the start the owner gives the later of its clock's time and
/// the stored time plus kRestartMargin. The owner stores `time()` whenever it has moved by kStoreStep: the time must
/// never go back over a restart, or peers treat our frames as replays. `time()` increases with the clock, with every
/// frame signed and with every valid frame of a peer that is ahead; the value of 48 ones is never exceeded.
///
/// The margin is kStoreStep, plus a minute by which the first frame of a sender may be late, plus half a minute: no
/// frame received before a restart is accepted after it. Peers that are behind then follow our first frame.
///
/// Source: mavlink.io, guide/message_signing. ArduPilot's GCS_Signing.cpp stores every 30 s and adds one minute.
class Signing {
public:
    using Key = std::array<std::byte, 32>;
    static constexpr std::uint64_t kLatestTime = (std::uint64_t{1} << 48U) - 1U;  ///< in 2104
    /// Latest initial time, in 2098: at the very end of the scale no further frame could be signed.
    static constexpr std::uint64_t kLatestStart = kLatestTime - (std::uint64_t{1} << 44U);
    static constexpr std::uint64_t kStoreStep = 3'000'000;       ///< 30 s
    static constexpr std::uint64_t kRestartMargin = 12'000'000;  ///< two minutes

    /// No key.
    Signing() noexcept = default;
    Signing(const Key& key, std::uint8_t link_id, std::uint64_t time) noexcept
        : key_(key), time_(time), link_id_(link_id), has_key_(true)
    {
    }

    [[nodiscard]] bool has_key() const noexcept { return has_key_; }
    [[nodiscard]] const Key& key() const noexcept { return key_; }
    /// Increases with each change of the key: the stored key is then outdated.
    [[nodiscard]] std::uint32_t generation() const noexcept { return generation_; }
    /// Sets the key. The senders' times stay, so that replays stay replays.
    void set_key(const Key& key, std::uint64_t time) noexcept;
    void remove_key() noexcept;

    /// Whether the owner stores keys. If not, a key from the link is refused: after a restart it would be missing.
    void let_keys_be_set(bool stored) noexcept { keys_are_stored_ = stored; }
    [[nodiscard]] bool keys_can_be_set() const noexcept { return keys_are_stored_; }

    void take_unsigned(const UnsignedFrames& frames) noexcept { unsigned_ = frames; }
    [[nodiscard]] bool takes_unsigned(std::uint32_t message_id) const noexcept;

    /// Moves the time forward; an earlier one is ignored.
    void advance_to(std::uint64_t time) noexcept
    {
        time = time < kLatestTime ? time : kLatestTime;
        time_ = time > time_ ? time : time_;
    }
    /// Moves the time forward with the owner's monotonic clock [us]. The first call sets the reference.
    void follow_clock(std::int64_t now_us) noexcept;
    [[nodiscard]] std::uint64_t time() const noexcept { return time_; }

    /// Checks a whole signed v2 frame, signature at its end. Stores its time if valid.
    /// O(frame): one SHA-256 over 32 bytes of key and all but 6 bytes of the frame.
    [[nodiscard]] SignatureStatus check(std::span<const std::byte> frame) noexcept;

    /// Fills the last 13 bytes of a v2 frame. All other bytes, kFlagSigned and checksum included, are complete.
    void sign(std::span<std::byte> frame) noexcept;

private:
    struct Stream {
        std::uint64_t time;
        std::uint8_t system_id, component_id, link_id;
    };
    using Hash = std::array<std::byte, 6>;

    [[nodiscard]] Hash hash(std::span<const std::byte> frame) const noexcept;
    [[nodiscard]] bool remember(const Stream& stream) noexcept;

    Key key_{};
    std::uint64_t time_ = 0;
    std::uint64_t clock_time_ = 0;  ///< time that belongs to clock_us_
    std::int64_t clock_us_ = 0;
    StaticVector<Stream, kMaxSignedStreams> streams_;
    UnsignedFrames unsigned_;
    std::uint32_t generation_ = 0;
    std::uint8_t link_id_ = 0;
    bool has_key_ = false;
    bool has_clock_ = false;
    bool keys_are_stored_ = false;
};

}  // namespace jink::link::mavlink
