// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace jink::link::mavlink {

/// SHA-256 (FIPS 180-4), for frame signatures only: written for size, 112 bytes of state, one block at a time.
class Sha256 {
public:
    using Digest = std::array<std::byte, 32>;

    /// O(bytes / 64) blocks of 64 rounds.
    void add(std::span<const std::byte> data) noexcept;
    /// Closes the message; the object must not be used afterwards.
    [[nodiscard]] Digest finish() noexcept;

private:
    void compress() noexcept;

    std::array<std::uint32_t, 8> state_{0x6A09E667, 0xBB67AE85, 0x3C6EF372, 0xA54FF53A,
                                        0x510E527F, 0x9B05688C, 0x1F83D9AB, 0x5BE0CD19};
    std::array<std::byte, 64> block_{};
    std::size_t used_ = 0;
    std::uint64_t bits_ = 0;
};

}  // namespace jink::link::mavlink
