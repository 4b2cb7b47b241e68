// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "firmware/link/mavlink/field.hpp"

namespace jink::link::mavlink {

// v1: FE length sequence system component id payload checksum[2]
// v2: FD length incompatible compatible sequence system component id[3] payload checksum[2] (signature[13])
inline constexpr std::byte kStartV1{0xFE};
inline constexpr std::byte kStartV2{0xFD};
inline constexpr std::size_t kHeaderV1 = 6;
inline constexpr std::size_t kHeaderV2 = 10;
inline constexpr std::size_t kChecksumSize = 2;
/// Link id, 6 bytes of time, 6 bytes of hash.
inline constexpr std::size_t kSignatureSize = 13;
/// Longest frame: v2, 255 bytes of payload, signed.
inline constexpr std::size_t kMaxFrame = kHeaderV2 + kMaxPayload + kChecksumSize + kSignatureSize;
/// The only incompatibility flag that MAVLink defines; a frame with any other must be discarded.
inline constexpr std::byte kFlagSigned{0x01};

/// Sender, and the sender's running number (it counts all its frames, modulo 256).
struct Header {
    std::uint8_t system_id;
    std::uint8_t component_id;
    std::uint8_t sequence;
};

/// A frame with a correct checksum. `payload` belongs to the parser and is valid until its next call.
struct Frame {
    std::uint32_t message_id;
    std::uint8_t version;  ///< 1 or 2
    Header header;
    bool is_signed;
    std::uint8_t length;                              ///< payload bytes that were on the wire
    std::span<const std::byte, kMaxPayload> payload;  ///< these bytes, then zeros
};

}  // namespace jink::link::mavlink
