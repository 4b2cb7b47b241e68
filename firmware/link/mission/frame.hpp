// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "core/base/time.hpp"
#include "firmware/link/mavlink/codec.hpp"
#include "firmware/link/mission/messages.hpp"

// The frame of the mission line; little-endian, offsets in bytes:
//
//    0  u8[2]  0x6A 0xC9
//    2  u8     version, 1
//    3  u8     message (MessageType)
//    4  u16    sender
//    6  u16    running number of the sender's frames
//    8  u8     bytes of the payload: those of the message, neither more nor less
//    9  payload
//    n  u16    checksum of all bytes from 2 on, CRC-16/MCRF4XX as MAVLink's
//
// A frame of its own and not MAVLink's TUNNEL: that carries 128 bytes, of which none says what they are, so that this
// header would be needed all the same, and the broadcast of a vehicle (182 bytes) would have to be taken apart; and the
// line is a radio between vehicles, of which the autopilot's bus need know nothing. A message that gains fields becomes
// another message, or the version another one: nothing is read half.

namespace jink::link::mission {

inline constexpr std::array<std::byte, 2> kSync{std::byte{0x6A}, std::byte{0xC9}};
inline constexpr std::uint8_t kVersion = 1;
inline constexpr std::size_t kHeaderSize = 9;
inline constexpr std::size_t kChecksumSize = 2;
inline constexpr std::size_t kMaxFrame = kHeaderSize + mavlink::kMaxPayload + kChecksumSize;

[[nodiscard]] constexpr std::size_t frame_size(std::size_t payload) noexcept
{
    return kHeaderSize + payload + kChecksumSize;
}

/// A message that is on its way, its payload padded with zeros.
struct Frame {
    MessageType type = MessageType::task_upload;
    std::uint16_t sender = 0;
    std::uint16_t sequence = 0;
    std::array<std::byte, mavlink::kMaxPayload> payload{};
};

template <class M>
[[nodiscard]] Frame pack(const M& message) noexcept
{
    Frame frame;
    frame.type = M::kType;
    mavlink::pack(reinterpret_cast<const std::byte*>(&message), M::kFields, frame.payload);
    return frame;
}
/// `frame` carries an M.
template <class M>
[[nodiscard]] M unpack(const Frame& frame) noexcept
{
    M message;
    mavlink::unpack(frame.payload, M::kFields, reinterpret_cast<std::byte*>(&message));
    return message;
}

/// @return bytes written; 0 where `out` is too small or there is no such message. O(payload).
[[nodiscard]] std::size_t write_frame(const Frame& frame, std::span<std::byte> out) noexcept;

/// Takes whole frames.
class FrameSink {
public:
    virtual void take(const Frame& frame, TimePoint now) noexcept = 0;

protected:
    ~FrameSink() = default;
};

/// Every byte taken ends in `frame_bytes`, in `noise_bytes` or among those still pending.
struct ReceiverDiagnostics {
    std::uint64_t frame_bytes = 0;
    std::uint64_t noise_bytes = 0;
    std::uint32_t frames = 0;
    std::uint32_t unknown = 0;  ///< version or message, or a length that is not the message's
    std::uint32_t bad_checksum = 0;
    std::uint32_t cut = 0;  ///< given up incomplete, the line being silent
};

/// Finds frames in a stream of bytes. Behind what is none the search goes on one byte behind its start, so that a good
/// frame within what a bad one claimed is found.
///
/// Work: kMaxFrame bytes through a checksum per false start, of which a header that could be true is one: at most every
/// kHeaderSize-th byte. Memory: 2 kMaxFrame and 60 bytes. Nothing is allocated.
class Receiver {
public:
    /// Takes bytes that arrived. Call it without any while the line is silent: it notices that. O(bytes * kMaxFrame).
    void receive(std::span<const std::byte> bytes, TimePoint now, FrameSink& sink) noexcept;

    [[nodiscard]] std::size_t pending() const noexcept { return end_ - begin_; }
    [[nodiscard]] const ReceiverDiagnostics& diagnostics() const noexcept { return diagnostics_; }

private:
    void search(TimePoint now, FrameSink& sink) noexcept;
    [[nodiscard]] bool judge(TimePoint now, FrameSink& sink) noexcept;
    void pass_over(std::size_t n) noexcept;

    ReceiverDiagnostics diagnostics_;
    std::size_t begin_ = 0;
    std::size_t end_ = 0;
    TimePoint last_byte_;
    std::array<std::byte, 2 * kMaxFrame> buffer_{};
};

}  // namespace jink::link::mission
