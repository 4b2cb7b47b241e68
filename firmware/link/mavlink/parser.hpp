// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "core/base/static_vector.hpp"
#include "firmware/link/mavlink/frame.hpp"
#include "firmware/link/mavlink/signing.hpp"

namespace jink::link::mavlink {

/// Counters of received and refused frames, one per cause. Each wraps at 2^32.
///
/// Every input byte is counted exactly once: in an accepted frame, in a frame refused whole (the four signing causes),
/// in `noise_bytes`, or among the bytes still pending.
struct ParserDiagnostics {
    std::uint32_t accepted = 0;
    std::uint32_t noise_bytes = 0;  ///< bytes between frames, those of rejected candidates included

    // A candidate is a start byte and its following bytes. These causes reject it, and the search continues one byte
    // later.
    std::uint32_t incompatible_flags = 0;  ///< v2 with a flag other than kFlagSigned
    std::uint32_t unknown_message = 0;     ///< id not in the catalogue: the checksum is unknown
    std::uint32_t too_short = 0;           ///< v1 with fewer bytes than the message has
    std::uint32_t too_long = 0;            ///< more bytes than the message has (v2: extensions included)
    std::uint32_t bad_checksum = 0;
    std::uint32_t cut = 0;  ///< discarded incomplete by `flush`

    // Frames with a correct checksum that are refused, and skipped whole.
    std::uint32_t unsigned_refused = 0;  ///< not signed, and a key is set
    std::uint32_t wrong_signature = 0;
    std::uint32_t stale_signature = 0;    ///< replayed, or more than a minute behind
    std::uint32_t signature_streams = 0;  ///< no capacity for a further signing sender

    // Accepted frames whose sender is not proven.
    std::uint32_t signed_unchecked = 0;  ///< signed, and no key is set
    std::uint32_t unsigned_taken = 0;    ///< not signed, and a key is set: accepted by Signing::take_unsigned

    // Running numbers of accepted frames, per (system, component).
    std::uint32_t lost = 0;               ///< numbers skipped; a sender that restarts adds up to 255
    std::uint32_t repeated = 0;           ///< same number twice in succession
    std::uint32_t untracked_senders = 0;  ///< frames of senders beyond kMaxSenders, whose numbers are not tracked

    std::uint32_t checksum_bytes = 0;  ///< work: bytes included in the checksum
};

/// Senders whose running number is tracked. 16 covers an autopilot's components, ground stations and neighbours on one
/// link; each costs 3 bytes. Frames of further senders are accepted too and counted in `untracked_senders`.
inline constexpr std::size_t kMaxSenders = 16;

/// Handling of a v2 frame with a correct checksum that is longer than the known message.
enum class LongerPayload : std::uint8_t {
    reject,  ///< count it as `too_long`
    /// Use the known fields and drop the rest: a later revision of the message may have gained extension fields.
    accept,
};

/// Finds MAVLink frames (v1 and v2) in a stream of bytes.
///
/// After noise, a cut frame or a false start byte the search continues at the byte after the rejected start byte. So a
/// good frame inside the bytes that a bad one claimed is still found; the frames found are those of a left-to-right
/// scan of the whole stream. A frame of an unknown id cannot be checked and is searched in the same way
/// (docs/guides/mavlink_frames.md).
///
/// Work: each start byte is examined once. At most kMaxFrame - 1 bytes go through the checksum and one SHA-256 for each
/// byte of input, and at most one byte is moved. One call may in addition scan the pending bytes again: less than
/// kMaxFrame bytes, so at most kMaxFrame^2 / 2 checksum bytes. Nothing is allocated. Memory: 2 * kMaxFrame +
/// kMaxPayload + 3 * kMaxSenders bytes and the counters.
class Parser {
public:
    /// @param signing  key and times to check signatures with; must outlive the parser. nullptr, or without a key:
    ///                 frames are accepted as if they were not signed, as in the official C library.
    explicit Parser(Signing* signing = nullptr, LongerPayload longer = LongerPayload::reject) noexcept
        : signing_(signing), longer_(longer)
    {
    }

    /// The next frame, or nothing once `input` is used up. Consumed bytes are removed from the front of `input`.
    ///
    ///     while (const auto frame = parser.next(input)) { handle(*frame); }
    [[nodiscard]] std::optional<Frame> next(std::span<const std::byte>& input) noexcept;

    /// For a line that has fallen silent in mid-frame: discards the incomplete candidate in front and searches its
    /// bytes. Repeat until nothing is returned; then nothing is pending.
    [[nodiscard]] std::optional<Frame> flush() noexcept;

    /// Received bytes that are not yet classified; below kMaxFrame between calls that return nothing.
    [[nodiscard]] std::size_t pending() const noexcept { return end_ - begin_; }
    [[nodiscard]] const ParserDiagnostics& diagnostics() const noexcept { return diagnostics_; }

private:
    enum class Verdict : std::uint8_t { incomplete, rejected, refused, accepted };
    struct Candidate {
        std::uint8_t version;
        std::size_t header_size;
        std::size_t length;
        std::size_t size;  ///< whole frame
        bool is_signed;
        std::uint32_t message_id;
        Header header;
    };
    struct Sender {
        std::uint8_t system_id, component_id, sequence;
    };

    [[nodiscard]] std::optional<Frame> scan() noexcept;
    [[nodiscard]] Verdict examine(Candidate& candidate) noexcept;
    [[nodiscard]] Verdict read_header(Candidate& candidate) noexcept;
    [[nodiscard]] Verdict check_length(const Candidate& candidate, const MessageInfo& info) noexcept;
    [[nodiscard]] Verdict check_signature(const Candidate& candidate) noexcept;
    [[nodiscard]] bool checksum_matches(const Candidate& candidate, const MessageInfo& info) noexcept;
    void follow_sequence(const Header& header) noexcept;
    [[nodiscard]] Frame deliver(const Candidate& candidate) noexcept;
    void skip_noise() noexcept;
    void take(std::span<const std::byte>& input) noexcept;
    [[nodiscard]] std::uint8_t byte_at(std::size_t i) const noexcept
    {
        return std::to_integer<std::uint8_t>(buffer_[begin_ + i]);
    }
    [[nodiscard]] Verdict reject(std::uint32_t& counter) noexcept
    {
        ++counter;
        return Verdict::rejected;
    }

    Signing* signing_;
    LongerPayload longer_;
    std::size_t begin_ = 0;
    std::size_t end_ = 0;
    ParserDiagnostics diagnostics_;
    StaticVector<Sender, kMaxSenders> senders_;
    std::size_t payload_length_ = 0;  ///< behind these bytes the payload is zero
    std::array<std::byte, kMaxPayload> payload_{};
    std::array<std::byte, 2 * kMaxFrame> buffer_{};
};

}  // namespace jink::link::mavlink
