// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace jink::link::dronecan {

/// One classic CAN frame between a port and the DroneCAN codec; images copy it from and to their platform's type.
///
/// A length above 8 (CAN FD) can be represented, so that the receiver can refuse and count the frame. 16 bytes.
struct Frame {
    static constexpr std::size_t kBytes = 8;

    std::uint32_t id = 0;  ///< 29 bits, or 11 where not `extended`
    bool extended = true;
    bool remote = false;
    std::uint8_t length = 0;
    std::array<std::byte, kBytes> data{};

    friend bool operator==(const Frame&, const Frame&) = default;
};

/// Node ids: 0 is "none yet" (anonymous) and, as destination in a tunnel, everyone.
inline constexpr std::uint8_t kAnonymous = 0;
inline constexpr std::uint8_t kMaxNode = 127;

enum class TransferKind : std::uint8_t { message, request, response };

/// 5 bits; lower values have precedence on the bus. Levels of the protocol: highest 0, high 8, medium 16, low 24,
/// lowest 31.
enum class Priority : std::uint8_t { highest = 0, high = 8, medium = 16, low = 24, lowest = 31 };

/// Fields of the 29-bit identifier.
struct FrameId {
    TransferKind kind = TransferKind::message;
    std::uint8_t priority = 16;
    std::uint16_t type = 0;  ///< 16 bits for a message, 8 for a service; for an anonymous message the lowest 2
    std::uint8_t source = kAnonymous;
    std::uint8_t destination = 0;     ///< services only
    std::uint16_t discriminator = 0;  ///< anonymous messages only: 14 bits that keep two senders apart

    friend bool operator==(const FrameId&, const FrameId&) = default;
};

/// message   priority[28:24] type[23:8] 0[7] source[6:0]; anonymous: priority discriminator[23:10] type[9:8] 0 0
/// service   priority[28:24] type[23:16] request[15] destination[14:8] 1[7] source[6:0]
[[nodiscard]] constexpr std::uint32_t pack(const FrameId& id) noexcept
{
    const std::uint32_t common = static_cast<std::uint32_t>(id.priority & 31U) << 24U | (id.source & 127U);
    if (id.kind != TransferKind::message) {
        const std::uint32_t request = id.kind == TransferKind::request ? 1U : 0U;
        return common | (id.type & 255U) << 16U | request << 15U | (id.destination & 127U) << 8U | 128U;
    }
    if (id.source == kAnonymous) {
        return common | (id.discriminator & 0x3FFFU) << 10U | (id.type & 3U) << 8U;
    }
    return common | static_cast<std::uint32_t>(id.type) << 8U;
}

[[nodiscard]] constexpr FrameId unpack(std::uint32_t bits) noexcept
{
    FrameId id;
    id.priority = static_cast<std::uint8_t>(bits >> 24U & 31U);
    id.source = static_cast<std::uint8_t>(bits & 127U);
    if ((bits & 128U) != 0) {
        id.kind = (bits & 0x8000U) != 0 ? TransferKind::request : TransferKind::response;
        id.type = static_cast<std::uint16_t>(bits >> 16U & 255U);
        id.destination = static_cast<std::uint8_t>(bits >> 8U & 127U);
    } else if (id.source == kAnonymous) {
        id.type = static_cast<std::uint16_t>(bits >> 8U & 3U);
        id.discriminator = static_cast<std::uint16_t>(bits >> 10U & 0x3FFFU);
    } else {
        id.type = static_cast<std::uint16_t>(bits >> 8U & 0xFFFFU);
    }
    return id;
}

inline constexpr unsigned kTransferIds = 32;

/// Last byte of every frame.
struct Tail {
    bool start = true;
    bool end = true;
    bool toggle = false;  ///< false in the first frame (Cyphal's is true), then alternating
    std::uint8_t transfer = 0;

    friend bool operator==(const Tail&, const Tail&) = default;
};

[[nodiscard]] constexpr std::byte pack(const Tail& tail) noexcept
{
    return static_cast<std::byte>((tail.start ? 128U : 0U) | (tail.end ? 64U : 0U) | (tail.toggle ? 32U : 0U) |
                                  (tail.transfer & 31U));
}

[[nodiscard]] constexpr Tail unpack(std::byte bits) noexcept
{
    const unsigned b = std::to_integer<unsigned>(bits);
    return {(b & 128U) != 0, (b & 64U) != 0, (b & 32U) != 0, static_cast<std::uint8_t>(b & 31U)};
}

}  // namespace jink::link::dronecan
