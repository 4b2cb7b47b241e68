// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <random>
#include <span>
#include <string>
#include <vector>

#include "firmware/link/mavlink/checksum.hpp"
#include "firmware/link/mavlink/encoder.hpp"
#include "firmware/link/mavlink/messages.hpp"
#include "firmware/link/mavlink/signing.hpp"

// A SETUP_SIGNING frame, and how much of its key is in a log.

namespace jink::test {

/// 32 bytes that occur nowhere else.
inline link::mavlink::Signing::Key secret()
{
    link::mavlink::Signing::Key key;
    std::mt19937 random(77);
    std::generate(key.begin(), key.end(), [&] { return static_cast<std::byte>(1 + random() % 200); });
    return key;
}

/// @param payload  its length [bytes]: 42, or more as in a later revision of the message
inline std::vector<std::byte> setup_signing_frame(std::size_t payload = link::mavlink::SetupSigning::kInfo.max_length)
{
    link::mavlink::SetupSigning message;
    message.target_system = 1;
    message.target_component = 196;
    const auto key = secret();
    std::transform(key.begin(), key.end(), message.secret_key.begin(),
                   [](std::byte b) { return static_cast<std::uint8_t>(b); });
    message.initial_timestamp = 12345;
    std::array<std::byte, link::mavlink::kMaxFrame> frame{};
    const std::size_t n = link::mavlink::encode(message, {255, 190, 3}, frame);
    std::vector<std::byte> bytes(frame.begin(), frame.begin() + static_cast<std::ptrdiff_t>(n));
    bytes[1] = static_cast<std::byte>(payload);
    bytes.resize(link::mavlink::kHeaderV2 + payload, std::byte{0x77});
    std::fill(bytes.begin() + static_cast<std::ptrdiff_t>(n - link::mavlink::kChecksumSize), bytes.end(),
              std::byte{0x77});
    link::mavlink::Checksum checksum;
    checksum.add(std::span(bytes).subspan(1));
    checksum.add(std::byte{link::mavlink::SetupSigning::kInfo.crc_extra});
    bytes.push_back(static_cast<std::byte>(checksum.value() & 0xFFU));
    bytes.push_back(static_cast<std::byte>(checksum.value() >> 8U));
    return bytes;
}

/// Longest part of a key that `bytes` contain.
inline std::size_t longest_part(std::span<const std::byte> bytes, std::span<const std::byte> key)
{
    std::array<std::vector<std::size_t>, 256> places;  // of each byte in the key
    for (std::size_t k = 0; k < key.size(); ++k) {
        places[static_cast<std::size_t>(key[k])].push_back(k);
    }
    std::size_t longest = 0;
    for (std::size_t i = 0; i < bytes.size(); ++i) {
        for (const std::size_t k : places[static_cast<std::size_t>(bytes[i])]) {
            std::size_t n = 1;
            while (i + n < bytes.size() && k + n < key.size() && bytes[i + n] == key[k + n]) {
                ++n;
            }
            longest = std::max(longest, n);
        }
    }
    return longest;
}

inline std::size_t longest_part(const std::string& log)
{
    const auto key = secret();
    return longest_part(std::as_bytes(std::span(log)), key);
}

}  // namespace jink::test
