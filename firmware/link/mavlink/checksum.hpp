// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace jink::link::mavlink {

/// CRC-16/MCRF4XX (polynomial 0x1021 reflected, start 0xFFFF, no final xor; "123456789" gives 0x6F91), without a table:
/// six shifts and four xors a byte.
class Checksum {
public:
    constexpr void add(std::byte data) noexcept
    {
        auto mixed = static_cast<std::uint8_t>(std::to_integer<unsigned>(data) ^ (crc_ & 0xFFU));
        mixed = static_cast<std::uint8_t>(mixed ^ (mixed << 4U));
        const unsigned m = mixed;
        crc_ = static_cast<std::uint16_t>((static_cast<unsigned>(crc_) >> 8U) ^ (m << 8U) ^ (m << 3U) ^ (m >> 4U));
    }
    constexpr void add(std::span<const std::byte> data) noexcept
    {
        for (const std::byte b : data) {
            add(b);
        }
    }
    [[nodiscard]] constexpr std::uint16_t value() const noexcept { return crc_; }

private:
    std::uint16_t crc_ = 0xFFFF;
};

}  // namespace jink::link::mavlink
