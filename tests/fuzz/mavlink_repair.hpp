// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "firmware/link/mavlink/catalogue.hpp"
#include "firmware/link/mavlink/checksum.hpp"
#include "firmware/link/mavlink/frame.hpp"

namespace jink::fuzz {

/// Sets the correct checksum in everything in `bytes` that looks like a whole frame of a known message, left to right,
/// so that a fuzzer passes the checksum.
inline void repair_checksums(std::vector<std::byte>& bytes)
{
    using namespace link::mavlink;
    const auto at = [&](std::size_t i) { return std::to_integer<std::size_t>(bytes[i]); };
    for (std::size_t p = 0; p + kHeaderV2 < bytes.size(); ++p) {
        const bool v2 = bytes[p] == kStartV2;
        if (!v2 && bytes[p] != kStartV1) {
            continue;
        }
        const std::size_t end = p + (v2 ? kHeaderV2 : kHeaderV1) + at(p + 1);
        const auto id = static_cast<std::uint32_t>(v2 ? at(p + 7) + (at(p + 8) << 8U) + (at(p + 9) << 16U) : at(p + 5));
        const MessageInfo* const info = find_message(id);
        if (info == nullptr || end + kChecksumSize > bytes.size()) {
            continue;
        }
        Checksum checksum;
        checksum.add(std::span(bytes).subspan(p + 1, end - p - 1));
        checksum.add(std::byte{info->crc_extra});
        bytes[end] = static_cast<std::byte>(checksum.value() & 0xFFU);
        bytes[end + 1] = static_cast<std::byte>(checksum.value() >> 8U);
        p = end + 1;
    }
}

}  // namespace jink::fuzz
