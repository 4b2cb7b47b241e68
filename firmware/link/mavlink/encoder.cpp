// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/link/mavlink/encoder.hpp"

#include <algorithm>
#include <array>

#include "firmware/link/mavlink/checksum.hpp"

namespace jink::link::mavlink {
namespace {

/// Writes the checksum of `frame` (start byte excluded, `crc_extra` included) to its last two bytes.
void close(std::span<std::byte> frame, std::uint8_t crc_extra) noexcept
{
    Checksum checksum;
    checksum.add(frame.subspan(1, frame.size() - 1 - kChecksumSize));
    checksum.add(std::byte{crc_extra});
    frame[frame.size() - 2] = static_cast<std::byte>(checksum.value() & 0xFFU);
    frame[frame.size() - 1] = static_cast<std::byte>(checksum.value() >> 8U);
}

}  // namespace

std::size_t encode_v2(const std::byte* object, const Layout& layout, Header header, Signing* signing,
                      std::span<std::byte> out) noexcept
{
    std::array<std::byte, kMaxPayload> payload;
    pack(object, layout.fields, payload);
    std::size_t length = layout.info.max_length;
    while (length > 1 && payload[length - 1] == std::byte{0}) {
        --length;
    }
    const std::size_t unsigned_size = kHeaderV2 + length + kChecksumSize;
    const std::size_t size = unsigned_size + (signing != nullptr ? kSignatureSize : 0);
    if (size > out.size()) {
        return 0;
    }
    const std::array<std::byte, kHeaderV2> head{
        kStartV2,
        static_cast<std::byte>(length),
        signing != nullptr ? kFlagSigned : std::byte{0},
        std::byte{0},
        std::byte{header.sequence},
        std::byte{header.system_id},
        std::byte{header.component_id},
        static_cast<std::byte>(layout.info.id & 0xFFU),
        static_cast<std::byte>((layout.info.id >> 8U) & 0xFFU),
        static_cast<std::byte>((layout.info.id >> 16U) & 0xFFU),
    };
    std::copy(head.begin(), head.end(), out.begin());
    std::copy_n(payload.begin(), length, out.subspan(kHeaderV2).begin());
    close(out.first(unsigned_size), layout.info.crc_extra);
    if (signing != nullptr) {
        signing->sign(out.first(size));
    }
    return size;
}

}  // namespace jink::link::mavlink
