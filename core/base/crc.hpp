// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <bit>
#include <cstdint>

// Checksum of stored tables.

namespace jink {

/// CRC-32 (IEEE 802.3), four bits at a time by a look-up table of 64 bytes. Numbers are added low byte first on every
/// machine.
class Crc {
public:
    void add(std::uint8_t byte) noexcept
    {
        value_ ^= byte;
        value_ = (value_ >> 4U) ^ kOfNibble[value_ & 15U];
        value_ = (value_ >> 4U) ^ kOfNibble[value_ & 15U];
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
    static constexpr std::array<std::uint32_t, 16> kOfNibble = [] {
        std::array<std::uint32_t, 16> table{};
        for (std::uint32_t nibble = 0; nibble < table.size(); ++nibble) {
            std::uint32_t value = nibble;
            for (int bit = 0; bit < 4; ++bit) {
                value = (value >> 1U) ^ ((value & 1U) != 0 ? 0xEDB88320U : 0U);
            }
            table[nibble] = value;
        }
        return table;
    }();

    std::uint32_t value_ = 0xFFFFFFFFU;
};

}  // namespace jink
