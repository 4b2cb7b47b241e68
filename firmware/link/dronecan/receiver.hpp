// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/base/time.hpp"
#include "firmware/link/dronecan/checksum.hpp"
#include "firmware/link/dronecan/codec.hpp"

namespace jink::link::dronecan {

/// Streams of transfers that are followed at once: one per sender and type. 32 covers a status from ten nodes and 22
/// streams of sensors, traffic and requests; 24 bytes each. When full, the stream that has been silent for longest is
/// dropped. Only its last transfer id is lost: a repetition would count as new.
inline constexpr std::size_t kSessions = 32;
/// Transfers of several frames that are assembled at once, for senders that interleave. 8 covers each kind of long
/// message that is received from one sender, and a request; 400 bytes each. When full, the oldest is dropped.
inline constexpr std::size_t kAssemblies = 8;
static_assert(kSessions >= 1 && kSessions <= 128 && kAssemblies >= 1 && kAssemblies <= 64);

/// A transfer must be complete this long after its first frame; for as long the same transfer id is a repetition.
inline constexpr Seconds kTransferTimeout = 2.0F;

/// A complete payload.
struct Transfer {
    TypeInfo type{};
    std::uint8_t source = kAnonymous;
    std::uint8_t transfer = 0;  ///< transfer id
    std::uint8_t priority = 0;
    TimePoint stamp;  ///< arrival of the first frame
    std::span<const std::byte> payload;
};

/// Counters of frames. Each frame that is not used is counted under one cause.
struct ReceiverDiagnostics {
    std::uint32_t frames = 0;
    std::uint32_t transfers = 0;  ///< delivered
    std::uint32_t ignored = 0;    ///< types not wanted, services for others
    // Frames that are not DroneCAN frames:
    std::uint32_t standard_id = 0;  ///< 11 bits
    std::uint32_t remote = 0;
    std::uint32_t bad_length = 0;  ///< no byte, or more than eight
    std::uint32_t bad_id = 0;      ///< over 29 bits, or a service without source or destination
    // Frames that do not fit into a transfer; except for the first cause, the transfer under way is dropped:
    std::uint32_t missed_start = 0;
    std::uint32_t wrong_toggle = 0;  ///< a frame is missing, or Cyphal's
    std::uint32_t wrong_transfer = 0;
    std::uint32_t short_frame = 0;  ///< not full, though others follow, or without payload
    std::uint32_t too_long = 0;     ///< for its type
    std::uint32_t bad_crc = 0;
    std::uint32_t timed_out = 0;
    std::uint32_t interrupted = 0;        ///< a new transfer began before the end
    std::uint32_t anonymous_refused = 0;  ///< of more than one frame
    // Repetitions, ignored:
    std::uint32_t duplicates = 0;
    // Full pools:
    std::uint32_t sessions_evicted = 0;
    std::uint32_t assemblies_evicted = 0;
};

/// Assembles frames to transfers. A transfer is delivered once and exactly as sent, or not at all, with one limit of
/// the protocol. Two or more whole frames that are missing from (or exchanged within) one transfer are undetected if
/// toggle bits and the 16-bit CRC happen to match.
///
/// Memory: 24 * kSessions + 400 * kAssemblies bytes and some, 4.1 KiB in all. Nothing is allocated.
class Receiver {
public:
    /// @param wanted  types to deliver; the list must outlive the receiver
    explicit Receiver(std::span<const TypeInfo> wanted) noexcept : wanted_(wanted) {}

    /// Services are accepted for this node; none while it is kAnonymous.
    void set_node(std::uint8_t node) noexcept { node_ = node; }

    /// Processes one frame.
    ///
    /// @return the transfer that the frame completes, valid until the next call; nullptr: none
    /// O(wanted + kSessions + kAssemblies), and the checksum over the payload with its last frame.
    [[nodiscard]] const Transfer* accept(const Frame& frame, TimePoint now) noexcept;

    [[nodiscard]] const ReceiverDiagnostics& diagnostics() const noexcept { return diagnostics_; }

private:
    static constexpr std::uint8_t kNone = 255;

    /// Transfers of one type from one node.
    struct Session {
        bool used = false;
        bool heard = false;             ///< a transfer was delivered
        std::uint8_t transfer = 0;      ///< id of the last transfer delivered
        std::uint8_t assembly = kNone;  ///< index of the transfer being assembled
        std::uint32_t key = 0;
        TimePoint began;    ///< the last transfer delivered
        TimePoint touched;  ///< last frame
    };
    struct Assembly {
        bool used = false;
        bool toggle = false;  ///< expected in the next frame
        std::uint8_t transfer = 0;
        std::uint8_t session = 0;
        std::uint16_t length = 0;
        TimePoint began;
        std::array<std::byte, kMaxPayload + 2> bytes;  ///< CRC and payload
    };
    /// Properties of a frame before its session is known.
    struct Piece {
        const Frame& frame;
        const TypeInfo& type;
        FrameId id;
        Tail tail;
        TimePoint now;
        [[nodiscard]] std::span<const std::byte> payload() const noexcept
        {
            return std::span(frame.data).first(frame.length - 1U);
        }
    };

    [[nodiscard]] bool is_sound(const Frame& frame, const FrameId& id) noexcept;
    [[nodiscard]] const TypeInfo* find_type(const FrameId& id) const noexcept;
    [[nodiscard]] Session* find_session(std::uint32_t key) noexcept;
    [[nodiscard]] Session& make_session(std::uint32_t key, TimePoint now) noexcept;
    [[nodiscard]] Assembly& make_assembly(Session& session, TimePoint now) noexcept;
    void drop(Session& session) noexcept;
    [[nodiscard]] static bool is_repetition(const Session& session, const Piece& piece) noexcept;

    [[nodiscard]] const Transfer* accept_anonymous(const Piece& piece) noexcept;
    [[nodiscard]] const Transfer* begin(const Piece& piece) noexcept;
    /// Prepares the session for a new transfer; false if the transfer's first frame is refused.
    [[nodiscard]] bool make_way(Session& session, const Piece& piece) noexcept;
    [[nodiscard]] const Transfer* go_on(const Piece& piece) noexcept;
    [[nodiscard]] const Transfer* add(Session& session, Assembly& assembly, const Piece& piece) noexcept;
    [[nodiscard]] const Transfer* deliver(const Piece& piece, TimePoint began,
                                          std::span<const std::byte> payload) noexcept;

    std::span<const TypeInfo> wanted_;
    std::uint8_t node_ = kAnonymous;
    std::array<Session, kSessions> sessions_{};
    std::array<Assembly, kAssemblies> assemblies_{};
    std::array<std::byte, Frame::kBytes> single_{};
    Transfer transfer_;
    ReceiverDiagnostics diagnostics_;
};

}  // namespace jink::link::dronecan
