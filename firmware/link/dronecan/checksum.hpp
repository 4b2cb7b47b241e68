// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace jink::link::dronecan {

/// Bytes of a transfer's checksum on the bus.
inline constexpr std::size_t kCrcBytes = 2;

/// CRC-16/CCITT-FALSE (polynomial 0x1021, initial value 0xFFFF, not reflected, no final xor). DroneCAN includes the
/// eight bytes of a data type's signature first. No table.
class Checksum {
public:
    constexpr Checksum() noexcept = default;
    /// Continues from a state: the state after the signature, which is stored in place of the signature.
    explicit constexpr Checksum(std::uint16_t seed) noexcept : value_(seed) {}

    constexpr void add(std::byte byte) noexcept
    {
        // The eight shifts of the bitwise form folded into five operations.
        const std::uint32_t x = (value_ >> 8U ^ std::to_integer<std::uint32_t>(byte)) & 0xFFU;
        const std::uint32_t y = x ^ x >> 4U;
        value_ = static_cast<std::uint16_t>(static_cast<std::uint32_t>(value_) << 8U ^ y << 12U ^ y << 5U ^ y);
    }
    constexpr void add(std::span<const std::byte> bytes) noexcept
    {
        for (const std::byte byte : bytes) {
            add(byte);
        }
    }
    [[nodiscard]] constexpr std::uint16_t value() const noexcept { return value_; }

private:
    std::uint16_t value_ = 0xFFFF;
};

}  // namespace jink::link::dronecan
