// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/link/mavlink/codec.hpp"

#include <bit>

namespace jink::link::mavlink {
namespace {

static_assert(std::endian::native == std::endian::little || std::endian::native == std::endian::big);

/// Position of byte `i` (0 = least significant) of an element in memory.
[[nodiscard]] constexpr std::size_t native_index(std::size_t i, std::size_t size) noexcept
{
    return std::endian::native == std::endian::little ? i : size - 1 - i;
}

}  // namespace

void pack(const std::byte* object, std::span<const Field> fields, std::span<std::byte, kMaxPayload> payload) noexcept
{
    for (const Field& field : fields) {
        const std::size_t size = element_size(field.type);
        for (std::size_t e = 0; e < field.count; ++e) {
            const std::byte* from = object + field.object_offset + e * size;
            const std::size_t to = field.wire_offset + e * size;
            for (std::size_t i = 0; i < size; ++i) {
                payload[to + i] = from[native_index(i, size)];
            }
        }
    }
}

void unpack(std::span<const std::byte, kMaxPayload> payload, std::span<const Field> fields, std::byte* object) noexcept
{
    for (const Field& field : fields) {
        const std::size_t size = element_size(field.type);
        for (std::size_t e = 0; e < field.count; ++e) {
            std::byte* to = object + field.object_offset + e * size;
            const std::size_t from = field.wire_offset + e * size;
            for (std::size_t i = 0; i < size; ++i) {
                to[native_index(i, size)] = payload[from + i];
            }
        }
    }
}

}  // namespace jink::link::mavlink
