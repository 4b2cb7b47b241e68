// SPDX-License-Identifier: BSD-3-Clause
// MAVLink parser, decoder and encoder on arbitrary bytes. First input byte: 1 repair checksums, 2 a signing key is set,
// 4 longer payloads accepted, 8 feed byte by byte. Checked: every byte is accounted for, work is bounded, chunks do not
// matter, and every decoded message encodes to a frame that decodes to the same bytes.
#include <cstdint>
#include <cstring>
#include <vector>

#include "firmware/link/mavlink/encoder.hpp"
#include "firmware/link/mavlink/messages.hpp"
#include "firmware/link/mavlink/parser.hpp"
#include "tests/fuzz/check.hpp"
#include "tests/fuzz/mavlink_repair.hpp"

using namespace jink::link::mavlink;

namespace {

template <Message M>
void round_trip(const Frame& frame)
{
    M message;
    if (!decode(frame, message)) {
        return;
    }
    std::byte wire[kMaxFrame];
    const std::size_t size = encode(message, frame.header, wire);
    JINK_FUZZ_CHECK(size > 0);
    Parser parser;
    std::span<const std::byte> input(wire, size);
    const auto again = parser.next(input);
    JINK_FUZZ_CHECK(again.has_value() && again->message_id == frame.message_id);
    JINK_FUZZ_CHECK(std::memcmp(again->payload.data(), frame.payload.data(), M::kInfo.max_length) == 0);
    JINK_FUZZ_CHECK(input.empty() && parser.pending() == 0);
}

template <class... Ms>
void round_trip_any(const Frame& frame, MessageList<Ms...>)
{
    (round_trip<Ms>(frame), ...);
}

struct Outcome {
    std::size_t frames = 0;
    std::size_t frame_bytes = 0;
    std::uint32_t digest = 0;
};

void consider(const Frame& frame, Outcome& outcome)
{
    ++outcome.frames;
    outcome.frame_bytes += (frame.version == 1 ? kHeaderV1 : kHeaderV2) + frame.length + kChecksumSize +
                           (frame.is_signed ? kSignatureSize : 0);
    for (const std::byte b : frame.payload) {
        outcome.digest = outcome.digest * 31 + std::to_integer<std::uint32_t>(b);
    }
    for (std::size_t i = frame.length; i < kMaxPayload; ++i) {
        JINK_FUZZ_CHECK(frame.payload[i] == std::byte{0});
    }
    round_trip_any(frame, AllMessages{});
}

Outcome run(Parser& parser, std::span<const std::byte> bytes, std::size_t chunk)
{
    Outcome outcome;
    const std::size_t total = bytes.size();
    while (!bytes.empty()) {
        std::span<const std::byte> piece = bytes.first(std::min(chunk, bytes.size()));
        bytes = bytes.subspan(piece.size());
        while (const auto frame = parser.next(piece)) {
            consider(*frame, outcome);
        }
        JINK_FUZZ_CHECK(piece.empty() && parser.pending() < kMaxFrame);
    }
    while (const auto frame = parser.flush()) {
        consider(*frame, outcome);
    }
    const ParserDiagnostics& d = parser.diagnostics();
    JINK_FUZZ_CHECK(parser.pending() == 0);
    JINK_FUZZ_CHECK(d.accepted == outcome.frames);
    JINK_FUZZ_CHECK(d.noise_bytes + outcome.frame_bytes <= total);
    const bool refused_whole = d.unsigned_refused + d.wrong_signature + d.stale_signature + d.signature_streams > 0;
    JINK_FUZZ_CHECK(refused_whole || d.noise_bytes + outcome.frame_bytes == total);
    JINK_FUZZ_CHECK(d.checksum_bytes <= total * (kMaxFrame - 1));
    return outcome;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size)
{
    if (size == 0) {
        return 0;
    }
    const unsigned options = data[0];
    std::vector<std::byte> bytes(size - 1);
    if (size > 1) {
        std::memcpy(bytes.data(), data + 1, size - 1);
    }
    if ((options & 1U) != 0) {
        jink::fuzz::repair_checksums(bytes);
    }
    const LongerPayload longer = (options & 4U) != 0 ? LongerPayload::accept : LongerPayload::reject;
    Signing signing_a({}, 0, 0);
    Signing signing_b({}, 0, 0);
    const bool sign = (options & 2U) != 0;
    Parser whole(sign ? &signing_a : nullptr, longer);
    Parser pieces(sign ? &signing_b : nullptr, longer);
    const Outcome a = run(whole, bytes, bytes.size() + 1);
    const Outcome b = run(pieces, bytes, (options & 8U) != 0 ? 1 : 1 + (options >> 4U));
    JINK_FUZZ_CHECK(a.frames == b.frames && a.digest == b.digest);
    JINK_FUZZ_CHECK(whole.diagnostics().noise_bytes == pieces.diagnostics().noise_bytes);
    JINK_FUZZ_CHECK(whole.diagnostics().checksum_bytes == pieces.diagnostics().checksum_bytes);
    return 0;
}
