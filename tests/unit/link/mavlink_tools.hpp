// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <cctype>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/random.hpp"
#include "firmware/link/mavlink/catalogue.hpp"
#include "firmware/link/mavlink/checksum.hpp"
#include "firmware/link/mavlink/encoder.hpp"
#include "firmware/link/mavlink/messages.hpp"
#include "firmware/link/mavlink/parser.hpp"

namespace jink::link::mavlink::test {

using Bytes = std::vector<std::byte>;

inline Bytes from_hex(std::string_view hex)
{
    const auto digit = [](char c) {
        return static_cast<unsigned>(std::isdigit(static_cast<unsigned char>(c)) != 0 ? c - '0' : c - 'a' + 10);
    };
    Bytes bytes;
    for (std::size_t i = 0; i + 1 < hex.size(); i += 2) {
        bytes.push_back(static_cast<std::byte>(digit(hex[i]) * 16U + digit(hex[i + 1])));
    }
    return bytes;
}

inline std::string to_hex(std::span<const std::byte> bytes)
{
    constexpr std::string_view kDigits = "0123456789abcdef";
    std::string hex;
    for (const std::byte b : bytes) {
        hex += kDigits[std::to_integer<std::size_t>(b) >> 4U];
        hex += kDigits[std::to_integer<std::size_t>(b) & 15U];
    }
    return hex;
}

/// A copy of a frame: the parser's own frame is valid only until its next call.
struct Received {
    std::uint32_t message_id;
    std::uint8_t version;
    Header header;
    bool is_signed;
    std::uint8_t length;
    Bytes payload;

    [[nodiscard]] Frame frame() const
    {
        return {message_id, version, header, is_signed, length, std::span<const std::byte, kMaxPayload>(payload)};
    }
};

inline Received keep(const Frame& f)
{
    return {f.message_id, f.version, f.header, f.is_signed, f.length, Bytes(f.payload.begin(), f.payload.end())};
}

/// Feeds `stream` in pieces of `chunk` bytes and collects the frames; with `flush`, discards the incomplete end too.
inline std::vector<Received> parse(Parser& parser, std::span<const std::byte> stream, std::size_t chunk = 1U << 20U,
                                   bool flush = false)
{
    std::vector<Received> frames;
    while (!stream.empty()) {
        std::span<const std::byte> piece = stream.first(std::min(chunk, stream.size()));
        stream = stream.subspan(piece.size());
        while (const auto frame = parser.next(piece)) {
            frames.push_back(keep(*frame));
        }
    }
    while (flush) {
        const auto frame = parser.flush();
        if (!frame) {
            break;
        }
        frames.push_back(keep(*frame));
    }
    return frames;
}

template <Message M>
Bytes frame_of(const M& message, Header header = {1, 196, 0})
{
    Bytes bytes(kMaxFrame);
    bytes.resize(encode(message, header, bytes));
    return bytes;
}

/// Writes `message` as a v1 frame, which only peers send: base fields alone, nothing cut.
///
/// @return bytes written; 0, with `out` untouched, when it is too small or the id does not fit into v1's one byte
template <Message M>
std::size_t encode_legacy(const M& message, Header header, std::span<std::byte> out)
{
    const std::size_t length = M::kInfo.min_length;
    const std::size_t size = kHeaderV1 + length + kChecksumSize;
    if (M::kInfo.id > 0xFFU || size > out.size()) {
        return 0;
    }
    std::array<std::byte, kMaxPayload> payload;
    pack(reinterpret_cast<const std::byte*>(&message), M::kFields, payload);
    const std::array<std::byte, kHeaderV1> head{kStartV1,
                                                static_cast<std::byte>(length),
                                                std::byte{header.sequence},
                                                std::byte{header.system_id},
                                                std::byte{header.component_id},
                                                static_cast<std::byte>(M::kInfo.id & 0xFFU)};
    std::copy(head.begin(), head.end(), out.begin());
    std::copy_n(payload.begin(), length, out.subspan(kHeaderV1).begin());
    Checksum checksum;
    checksum.add(out.subspan(1, size - 1 - kChecksumSize));
    checksum.add(std::byte{M::kInfo.crc_extra});
    out[size - 2] = static_cast<std::byte>(checksum.value() & 0xFFU);
    out[size - 1] = static_cast<std::byte>(checksum.value() >> 8U);
    return size;
}

template <Message M>
Bytes legacy_frame_of(const M& message, Header header = {1, 196, 0})
{
    Bytes bytes(kMaxFrame);
    bytes.resize(encode_legacy(message, header, bytes));
    return bytes;
}

/// The payload that the wire would carry untrimmed.
template <Message M>
Bytes payload_of(const M& message)
{
    std::array<std::byte, kMaxPayload> payload{};
    pack(reinterpret_cast<const std::byte*>(&message), M::kFields, payload);
    return Bytes(payload.begin(), payload.begin() + M::kInfo.max_length);
}

template <Message M>
M from_payload(const Bytes& payload)
{
    std::array<std::byte, kMaxPayload> padded{};
    std::copy(payload.begin(), payload.end(), padded.begin());
    M message;
    unpack(padded, M::kFields, reinterpret_cast<std::byte*>(&message));
    return message;
}

inline Bytes random_bytes(Random& random, std::size_t n)
{
    Bytes bytes(n);
    for (std::byte& b : bytes) {
        b = static_cast<std::byte>(random.below(256));
    }
    return bytes;
}

template <Message M>
M random_message(Random& random)
{
    return from_payload<M>(random_bytes(random, M::kInfo.max_length));
}

/// Calls `f.template operator()<M>()` for every message of the table.
template <class F, class... Ms>
void for_each_message(MessageList<Ms...>, F f)
{
    (f.template operator()<Ms>(), ...);
}
template <class F>
void for_each_message(F f)
{
    for_each_message(AllMessages{}, f);
}

/// CRC-16/MCRF4XX bit by bit: another algorithm than the product's.
inline std::uint16_t reference_crc(std::span<const std::byte> data, std::uint8_t extra)
{
    unsigned crc = 0xFFFF;
    const auto add = [&crc](unsigned byte) {
        crc ^= byte;
        for (int i = 0; i < 8; ++i) {
            crc = (crc & 1U) != 0 ? (crc >> 1U) ^ 0x8408U : crc >> 1U;
        }
    };
    for (const std::byte b : data) {
        add(std::to_integer<unsigned>(b));
    }
    add(extra);
    return static_cast<std::uint16_t>(crc);
}

/// Any v1 or v2 frame with a correct checksum and arbitrary other errors.
struct RawFrame {
    unsigned version = 2;
    std::uint8_t incompatible = 0;
    std::uint8_t compatible = 0;
    Header header{1, 1, 0};
    std::uint32_t id = 0;
    Bytes payload;
    std::uint8_t crc_extra = 0;

    [[nodiscard]] Bytes bytes() const
    {
        Bytes frame;
        const auto put = [&frame](std::size_t value) { frame.push_back(static_cast<std::byte>(value & 0xFFU)); };
        put(version == 1 ? 0xFE : 0xFD);
        put(payload.size());
        if (version == 2) {
            put(incompatible);
            put(compatible);
        }
        put(header.sequence);
        put(header.system_id);
        put(header.component_id);
        put(id);
        if (version == 2) {
            put(id >> 8U);
            put(id >> 16U);
        }
        frame.insert(frame.end(), payload.begin(), payload.end());
        const std::uint16_t crc = reference_crc(std::span(frame).subspan(1), crc_extra);
        put(crc);
        put(crc >> 8U);
        return frame;
    }
};

}  // namespace jink::link::mavlink::test
