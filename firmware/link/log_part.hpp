// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace jink::link {

/// Bytes of a log that one part takes at most (LOGGING_DATA.data).
inline constexpr std::size_t kMaxLogPart = 249;
/// Bytes of a part on the line at most: head, payload, checksum and signature.
inline constexpr std::size_t kMaxLogFrame = 280;
/// LogPart::first_message where no message begins in the part.
inline constexpr std::uint8_t kNoMessageBegins = 255;

/// One part of a log that is streamed to a receiver.
struct LogPart {
    std::uint8_t to_system = 0;
    std::uint8_t to_component = 0;
    std::uint16_t sequence = 0;
    std::uint8_t first_message = kNoMessageBegins;  ///< where the first message begins in `bytes`
    bool is_acknowledged = false;                   ///< the receiver has to acknowledge this part
    std::span<const std::byte> bytes;               ///< kMaxLogPart at most
};

/// A receiver's acknowledgement of a part.
struct LogAck {
    std::uint16_t sequence = 0;
    std::uint8_t from_system = 0;
    std::uint8_t from_component = 0;
};

/// Version of the software, semantic.
struct Version {
    std::uint8_t major = 0;
    std::uint8_t minor = 0;
    std::uint8_t patch = 0;
};

}  // namespace jink::link
