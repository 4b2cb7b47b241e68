// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace jink::link::mavlink {

/// CRC-16/MCRF4XX (polynomial 0x1021 reflected, start 0xFFFF, no final xor; "123456789" gives 0x6F91), without a
/// table: five shifts and six xors for two bytes.
class Checksum {
public:
    constexpr void add(std::byte data) noexcept
    {
        const unsigned mixed = std::to_integer<unsigned>(data) ^ crc_;
        const unsigned m = (mixed ^ (mixed << 4U)) & 0xFFU;
        crc_ = (crc_ >> 8U) ^ (m << 8U) ^ (m << 3U) ^ (m >> 4U);
    }
    constexpr void add(std::span<const std::byte> data) noexcept
    {
        std::size_t i = 0;
        for (; i + 1 < data.size(); i += 2) {
            add_pair(std::to_integer<unsigned>(data[i]) | std::to_integer<unsigned>(data[i + 1]) << 8U);
        }
        if (i < data.size()) {
            add(data[i]);
        }
    }
    [[nodiscard]] constexpr std::uint16_t value() const noexcept { return static_cast<std::uint16_t>(crc_); }

private:
    /// The remainder of x z^16 divided by P = z^16 + z^12 + z^5 + 1; bit 0 of x is the coefficient of z^15. The
    /// quotient is x (1 + z^-4 + z^-8 + z^-11 + z^-12) without fractions; the remainder is the quotient times P, below
    /// z^16.
    constexpr void add_pair(unsigned pair) noexcept
    {
        const unsigned x = pair ^ crc_;
        const unsigned two = x ^ (x << 4U);
        const unsigned quotient = (two ^ (two << 8U) ^ (x << 11U)) & 0xFFFFU;
        crc_ = quotient ^ (quotient >> 5U) ^ (quotient >> 12U);
    }

    std::uint32_t crc_ = 0xFFFF;  ///< 16 bits
};

}  // namespace jink::link::mavlink
