// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

// DSDL's order of bits: a value is sent least significant byte first, its last byte with only the remaining bits. The
// bits of each of these bytes are sent most significant first.

namespace jink::link::dronecan {

/// Writes values of 1 to 64 bits in sequence. The owner must zero the bytes before.
class BitWriter {
public:
    explicit constexpr BitWriter(std::span<std::byte> out) noexcept : out_(out) {}

    /// Writes the lowest `bits` of `value`; false, with nothing written, if the span is too short. O(bits).
    constexpr bool put(std::uint64_t value, unsigned bits) noexcept
    {
        if (position_ + bits > out_.size() * 8) {
            return false;
        }
        while (bits > 0) {
            const unsigned n = bits < 8 ? bits : 8;
            put_chunk(static_cast<unsigned>(value) & ((1U << n) - 1U), n);
            value >>= 8U;
            bits -= n;
        }
        return true;
    }

    /// Bytes used, including a partly filled last byte.
    [[nodiscard]] constexpr std::size_t bytes() const noexcept { return (position_ + 7) / 8; }

private:
    constexpr void put_chunk(unsigned chunk, unsigned n) noexcept
    {
        const std::size_t byte = position_ / 8;
        const unsigned used = static_cast<unsigned>(position_ % 8);
        const unsigned two = chunk << (16U - used - n);  // its position in this byte and the next
        out_[byte] |= static_cast<std::byte>(two >> 8U);
        if (used + n > 8) {
            out_[byte + 1] |= static_cast<std::byte>(two & 0xFFU);
        }
        position_ += n;
    }

    std::span<std::byte> out_;
    std::size_t position_ = 0;
};

/// Reads the format of BitWriter.
class BitReader {
public:
    explicit constexpr BitReader(std::span<const std::byte> in) noexcept : in_(in) {}

    /// False, with nothing read, if fewer bits are left. O(bits).
    constexpr bool get(std::uint64_t& value, unsigned bits) noexcept
    {
        if (bits > left()) {
            return false;
        }
        value = 0;
        for (unsigned shift = 0; shift < bits; shift += 8) {
            const unsigned n = bits - shift < 8 ? bits - shift : 8;
            value |= static_cast<std::uint64_t>(get_chunk(n)) << shift;
        }
        return true;
    }

    [[nodiscard]] constexpr std::size_t left() const noexcept { return in_.size() * 8 - position_; }

private:
    constexpr unsigned get_chunk(unsigned n) noexcept
    {
        const std::size_t byte = position_ / 8;
        const unsigned used = static_cast<unsigned>(position_ % 8);
        unsigned two = std::to_integer<unsigned>(in_[byte]) << 8U;
        if (used + n > 8) {
            two |= std::to_integer<unsigned>(in_[byte + 1]);
        }
        position_ += n;
        return two >> (16U - used - n) & ((1U << n) - 1U);
    }

    std::span<const std::byte> in_;
    std::size_t position_ = 0;
};

}  // namespace jink::link::dronecan
