// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <span>
#include <type_traits>

#include "firmware/link/mavlink/frame.hpp"

namespace jink::link::mavlink {

/// A structure of messages.hpp.
template <class M>
concept Message = std::is_standard_layout_v<M> && std::is_trivially_copyable_v<M> && requires
{
    {
        M::kInfo
        } -> std::convertible_to<const MessageInfo&>;
    {
        M::kFields.size()
        } -> std::convertible_to<std::size_t>;
};

/// Copies the fields of the structure at `object` into `payload` in wire order, little-endian.
///
/// @param fields   the structure's own table; writes max_length bytes
/// Bit patterns pass unchanged, NaN payloads included. Any alignment, any byte order. O(bytes).
void pack(const std::byte* object, std::span<const Field> fields, std::span<std::byte, kMaxPayload> payload) noexcept;

/// The reverse of `pack`: fills the structure at `object` from a payload padded with zeros.
void unpack(std::span<const std::byte, kMaxPayload> payload, std::span<const Field> fields, std::byte* object) noexcept;

/// Reads `frame` into `message`; false, with `message` unchanged, if the frame carries another message.
template <Message M>
[[nodiscard]] bool decode(const Frame& frame, M& message) noexcept
{
    if (frame.message_id != M::kInfo.id) {
        return false;
    }
    unpack(frame.payload, M::kFields, reinterpret_cast<std::byte*>(&message));
    return true;
}

}  // namespace jink::link::mavlink
