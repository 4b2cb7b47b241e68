// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>

namespace jink::link::mavlink {

/// Longest payload, by the one-byte length of a frame.
inline constexpr std::size_t kMaxPayload = 255;

/// Element type of a field. `character` is one byte of text.
enum class FieldType : std::uint8_t { u8, i8, character, u16, i16, u32, i32, f32, u64, i64, f64 };

/// Bytes of one element.
[[nodiscard]] constexpr std::size_t element_size(FieldType type) noexcept
{
    if (type <= FieldType::character) {
        return 1;
    }
    if (type <= FieldType::i16) {
        return 2;
    }
    return type <= FieldType::f32 ? 4 : 8;
}

/// Position of one field in the C++ structure and in the payload. 6 bytes.
struct Field {
    std::uint16_t object_offset;  ///< first byte in the structure
    std::uint8_t wire_offset;     ///< first byte in the payload
    std::uint8_t count;           ///< elements, 1 for a scalar
    FieldType type;
};

/// Properties of a message that a parser needs to check a frame. 8 bytes.
struct MessageInfo {
    std::uint32_t id;
    std::uint8_t crc_extra;   ///< last byte of the checksum's input; changes with the message's definition
    std::uint8_t min_length;  ///< payload without extensions: the length of a v1 frame
    std::uint8_t max_length;  ///< payload with all known extensions
};

}  // namespace jink::link::mavlink
