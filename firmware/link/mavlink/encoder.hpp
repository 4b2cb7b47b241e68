// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <span>

#include "firmware/link/mavlink/codec.hpp"
#include "firmware/link/mavlink/signing.hpp"

namespace jink::link::mavlink {

/// Properties of a message that an encoder needs beside its bytes.
struct Layout {
    MessageInfo info;
    std::span<const Field> fields;
};

/// Writes a v2 frame of the structure at `object`; signed when `signing` is given. See `encode`.
[[nodiscard]] std::size_t encode_v2(const std::byte* object, const Layout& layout, Header header, Signing* signing,
                                    std::span<std::byte> out) noexcept;
/// Writes `message` as a v2 frame: trailing zeros of the payload are cut, except its first byte.
///
/// @param out  kMaxFrame bytes hold any frame
/// @return bytes written; 0, with `out` unchanged, if `out` is too small for this frame
/// O(payload).
template <Message M>
[[nodiscard]] std::size_t encode(const M& message, Header header, std::span<std::byte> out) noexcept
{
    return encode_v2(reinterpret_cast<const std::byte*>(&message), {M::kInfo, M::kFields}, header, nullptr, out);
}

/// As `encode`, with a signature of 13 bytes after the frame.
template <Message M>
[[nodiscard]] std::size_t encode_signed(const M& message, Header header, Signing& signing,
                                        std::span<std::byte> out) noexcept
{
    return encode_v2(reinterpret_cast<const std::byte*>(&message), {M::kInfo, M::kFields}, header, &signing, out);
}

}  // namespace jink::link::mavlink
