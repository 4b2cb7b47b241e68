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

/// What a parser saw and refused, one counter per cause. Each wraps at 2^32.
///
/// Every input byte ends in exactly one place: an accepted frame, a frame that was refused whole (the four signing
/// causes), `noise_bytes`, or the bytes still pending.
struct ParserDiagnostics {
    std::uint32_t accepted = 0;
    std::uint32_t noise_bytes = 0;  ///< bytes between frames, those of rejected candidates included

    // A candidate is a start byte and what seems to follow it. These reject it, and the search goes on one byte behind.
    std::uint32_t incompatible_flags = 0;  ///< v2 with a flag other than kFlagSigned
    std::uint32_t unknown_message = 0;     ///< id not in the catalogue: the checksum cannot be known
    std::uint32_t too_short = 0;           ///< v1 with fewer bytes than the message has
    std::uint32_t too_long = 0;            ///< more bytes than the message has (v2: extensions included)
    std::uint32_t bad_checksum = 0;
    std::uint32_t cut = 0;  ///< given up incomplete by `flush`

    // Frames with the right checksum that are refused, and stepped over whole.
    std::uint32_t unsigned_refused = 0;  ///< not signed, and a key is set
    std::uint32_t wrong_signature = 0;
    std::uint32_t stale_signature = 0;    ///< replayed, or more than a minute behind
    std::uint32_t signature_streams = 0;  ///< no room to remember a further signing sender

    // Accepted frames whose sender is not proven.
    std::uint32_t signed_unchecked = 0;  ///< signed, and no key is set
    std::uint32_t unsigned_taken = 0;    ///< not signed, and a key is set: as Signing::take_unsigned says

    // Running numbers of accepted frames, per (system, component).
    std::uint32_t lost = 0;               ///< numbers skipped; a sender that restarts adds up to 255
    std::uint32_t repeated = 0;           ///< same number twice running
    std::uint32_t untracked_senders = 0;  ///< frames of senders beyond kMaxSenders, whose numbers are not followed

    std::uint32_t checksum_bytes = 0;  ///< work: bytes that went through the checksum
};

/// Senders whose running number is followed. 16 covers an autopilot's components, ground stations and neighbours on one
/// link; each costs 3 bytes. Frames of further ones are accepted all the same and counted in `untracked_senders`.
inline constexpr std::size_t kMaxSenders = 16;

/// What to do with a v2 frame that is longer than the message is known here, its checksum being right.
enum class LongerPayload : std::uint8_t {
    reject,  ///< count it as `too_long`
    /// Take the known fields and drop the rest: a later revision of the message may have gained extension fields.
    accept,
};

/// Finds MAVLink frames (v1 and v2) in a stream of bytes.
///
/// After noise, a cut frame or a false start byte the search goes on at the byte behind the rejected start byte, so a
/// good frame that lies inside what a bad one claimed is still found; the frames found are those of a left-to-right
/// scan of the whole stream. A frame of an unknown id cannot be checked and is searched in the same way
/// (docs/guides/mavlink_frames.md).
///
/// Work: each start byte is examined once; at most kMaxFrame - 1 bytes go through the checksum and one SHA-256 for each
/// byte of input, and at most one byte is moved. One call on top of that may scan again what was pending: less than
/// kMaxFrame bytes, so at most kMaxFrame^2 / 2 checksum bytes. Nothing is allocated.
/// Memory: 2 * kMaxFrame + kMaxPayload + 3 * kMaxSenders bytes and the counters.
class Parser {
public:
    /// @param signing  key and times to check signatures with; must outlive the parser. nullptr, or without a key:
    /// frames are taken as if they were not signed, as the official C library does.
    explicit Parser(Signing* signing = nullptr, LongerPayload longer = LongerPayload::reject) noexcept
        : signing_(signing), longer_(longer)
    {
    }

    /// The next frame, or nothing once `input` is used up. What was taken is removed from the front of `input`.
    ///
    ///     while (const auto frame = parser.next(input)) { handle(*frame); }
    [[nodiscard]] std::optional<Frame> next(std::span<const std::byte>& input) noexcept;

    /// For a line that has fallen silent in mid-frame: gives up the incomplete candidate in front and searches what it
    /// has swallowed. Repeat until nothing comes back; then nothing is pending.
    [[nodiscard]] std::optional<Frame> flush() noexcept;

    /// Bytes taken that are not yet part of a verdict; below kMaxFrame between calls that return nothing.
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
    std::array<std::byte, kMaxPayload> payload_{};
    std::array<std::byte, 2 * kMaxFrame> buffer_{};
};

}  // namespace jink::link::mavlink
