// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <bit>
#include <cstdint>

// Checksum of stored tables.

namespace jink {

/// CRC-32 (IEEE 802.3), bit by bit. Tables are checked once, when an image starts; a CRC look-up table would cost 1
/// KiB. Numbers are added low byte first on every machine.
class Crc {
public:
    void add(std::uint8_t byte) noexcept
    {
        value_ ^= byte;
        for (int bit = 0; bit < 8; ++bit) {
            value_ = (value_ >> 1U) ^ ((value_ & 1U) != 0 ? 0xEDB88320U : 0U);
        }
    }
    void add16(std::uint16_t number) noexcept
    {
        add(static_cast<std::uint8_t>(number & 0xFFU));
        add(static_cast<std::uint8_t>(number >> 8U));
    }
    void add32(std::uint32_t number) noexcept
    {
        add16(static_cast<std::uint16_t>(number & 0xFFFFU));
        add16(static_cast<std::uint16_t>(number >> 16U));
    }
    void add(float number) noexcept { add32(std::bit_cast<std::uint32_t>(number)); }
    [[nodiscard]] std::uint32_t value() const noexcept { return ~value_; }

private:
    std::uint32_t value_ = 0xFFFFFFFFU;
};

}  // namespace jink
