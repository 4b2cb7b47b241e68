// SPDX-License-Identifier: BSD-3-Clause
// The parser against a brute-force search over the whole stream, and its promised bound on work. Streams mix noise full
// of false start bytes, good frames, and frames with every kind of damage.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <gtest/gtest.h>
#include <string>

#include "tests/unit/link/mavlink_tools.hpp"

namespace jink::link::mavlink {
namespace {

using namespace test;

std::uint64_t parser_seed()
{
    const char* const given = std::getenv("JINK_SEED");
    return given != nullptr ? std::strtoull(given, nullptr, 0) : 20260101;
}

struct Place {
    std::size_t position, size;
    bool is_signed;
    friend bool operator==(const Place&, const Place&) = default;
};

/// Is there a whole frame with a right checksum at `p`? Written from the format's description, nothing shared with the
/// parser but the table of ids.
bool frame_at(std::span<const std::byte> s, std::size_t p, Place& place)
{
    const auto at = [&](std::size_t i) { return std::to_integer<unsigned>(s[p + i]); };
    const std::size_t left = s.size() - p;
    if (left < 8 || (at(0) != 0xFE && at(0) != 0xFD)) {
        return false;
    }
    const bool v2 = at(0) == 0xFD;
    const std::size_t header = v2 ? 10 : 6;
    const std::size_t length = at(1);
    const bool is_signed = v2 && at(2) == 1;
    if ((v2 && at(2) > 1) || left < header + length + 2 + (is_signed ? 13 : 0)) {
        return false;
    }
    const std::uint32_t id = v2 ? at(7) + 256 * at(8) + 65536 * at(9) : at(5);
    const MessageInfo* const info = find_message(id);
    if (info == nullptr || (v2 ? length > info->max_length : length != info->min_length)) {
        return false;
    }
    const unsigned crc = reference_crc(s.subspan(p + 1, header + length - 1), info->crc_extra);
    place = {p, header + length + 2 + (is_signed ? 13 : 0), is_signed};
    return at(header + length) == crc % 256 && at(header + length + 1) == crc / 256;
}

/// Left to right: a frame is taken whole, anything else moves on by one byte.
std::vector<Place> reference_scan(std::span<const std::byte> stream)
{
    std::vector<Place> places;
    std::size_t p = 0;
    while (p < stream.size()) {
        Place place{};
        if (frame_at(stream, p, place)) {
            places.push_back(place);
            p += place.size;
        } else {
            ++p;
        }
    }
    return places;
}

std::vector<Bytes> sample_frames(Random& random)
{
    std::vector<Bytes> frames;
    for_each_message([&]<class M>() {
        const Header header{static_cast<std::uint8_t>(random.below(256)), static_cast<std::uint8_t>(random.below(256)),
                            static_cast<std::uint8_t>(random.below(256))};
        M message = random_message<M>(random);
        if (random.below(3) == 0) {  // a short one
            Bytes payload = payload_of(message);
            std::fill(payload.begin() + static_cast<std::ptrdiff_t>(random.below(payload.size())), payload.end(),
                      std::byte{0});
            message = from_payload<M>(payload);
        }
        frames.push_back(random.below(4) == 0 && M::kInfo.id < 256 ? legacy_frame_of(message, header)
                                                                   : frame_of(message, header));
    });
    return frames;
}

Bytes noise(Random& random)
{
    Bytes bytes = random_bytes(random, random.below(40));
    constexpr std::array<unsigned, 8> kLikely{0xFD, 0xFE, 0xFD, 0x00, 0x01, 0x09, 0xFF, 0x4C};
    for (std::byte& b : bytes) {
        if (random.below(2) == 0) {
            b = static_cast<std::byte>(kLikely[random.below(kLikely.size())]);
        }
    }
    return bytes;
}

/// False header of a message that is known and long: the parser must wait for all that it claims.
Bytes false_header(Random& random)
{
    const std::vector<std::string_view> headers{"fdff000001010100006e",
                                                "fda700000001c44a0100",
                                                "fde70000000101"
                                                "4b0100",
                                                "fd090000000101000000",
                                                "fe0900010100",
                                                "fe1c00010120",
                                                "fd0102fe",
                                                "fdff01"};
    return from_hex(headers[random.below(headers.size())]);
}

void damage(Random& random, Bytes& frame)
{
    switch (random.below(6)) {
    case 0: frame[random.below(frame.size())] ^= static_cast<std::byte>(1U << random.below(8)); break;
    case 1: frame.resize(random.below(frame.size())); break;
    case 2: frame.erase(frame.begin() + static_cast<std::ptrdiff_t>(random.below(frame.size()))); break;
    case 3:
        frame.insert(frame.begin() + static_cast<std::ptrdiff_t>(random.below(frame.size())), std::byte{0xFD});
        break;
    case 4: frame[1] = static_cast<std::byte>(random.below(256)); break;
    default:
        frame[std::min<std::size_t>(frame.size() - 1, 7)] = std::byte{3};  // no such message
        break;
    }
}

Bytes random_stream(Random& random, const std::vector<Bytes>& frames)
{
    Bytes stream;
    const std::size_t parts = 5 + random.below(40);
    for (std::size_t i = 0; i < parts; ++i) {
        Bytes part = frames[random.below(frames.size())];
        switch (random.below(6)) {
        case 0: part = noise(random); break;
        case 1: part = false_header(random); break;
        case 2: damage(random, part); break;
        default: break;
        }
        stream.insert(stream.end(), part.begin(), part.end());
    }
    return stream;
}

TEST(MavlinkParserLaw, FindsExactlyWhatABruteForceSearchFinds)
{
    for (std::uint64_t round = 0; round < 3000; ++round) {
        const std::uint64_t seed = parser_seed() + round;
        Random random(seed);
        const std::vector<Bytes> frames = sample_frames(random);
        const Bytes stream = random_stream(random, frames);
        const std::vector<Place> expected = reference_scan(stream);

        Parser parser;
        const std::vector<Received> found = parse(parser, stream, 1 + random.below(600), true);
        std::vector<Bytes> unsigned_ones;
        std::size_t frame_bytes = 0;
        for (const Place& place : expected) {
            frame_bytes += place.size;
            if (!place.is_signed) {
                const auto begin = stream.begin() + static_cast<std::ptrdiff_t>(place.position);
                unsigned_ones.emplace_back(begin, begin + static_cast<std::ptrdiff_t>(place.size));
            }
        }
        ASSERT_EQ(found.size(), unsigned_ones.size()) << "JINK_SEED=" << seed;
        for (std::size_t i = 0; i < found.size(); ++i) {
            const std::size_t header = found[i].version == 1 ? kHeaderV1 : kHeaderV2;
            const Bytes payload(unsigned_ones[i].begin() + static_cast<std::ptrdiff_t>(header),
                                unsigned_ones[i].end() - 2);
            ASSERT_EQ(found[i].length, payload.size()) << "JINK_SEED=" << seed;
            ASSERT_TRUE(std::equal(payload.begin(), payload.end(), found[i].payload.begin())) << "JINK_SEED=" << seed;
        }
        // every byte is accounted for
        ASSERT_EQ(parser.diagnostics().noise_bytes + frame_bytes, stream.size()) << "JINK_SEED=" << seed;
        ASSERT_EQ(parser.diagnostics().accepted, found.size());
        ASSERT_EQ(parser.pending(), 0U);
    }
}

TEST(MavlinkParserLaw, NoGoodFrameIsLostUnlessAnAcceptedOneOverlapsIt)
{
    std::size_t overlapped = 0;
    for (std::uint64_t round = 0; round < 500; ++round) {
        const std::uint64_t seed = parser_seed() + 7'000'000 + round;
        Random random(seed);
        const Bytes stream = random_stream(random, sample_frames(random));
        const std::vector<Place> accepted = reference_scan(stream);
        for (std::size_t p = 0; p < stream.size(); ++p) {
            Place place{};
            if (!frame_at(stream, p, place) || std::find(accepted.begin(), accepted.end(), place) != accepted.end()) {
                continue;
            }
            const bool overlaps = std::any_of(accepted.begin(), accepted.end(), [&place](const Place& a) {
                return a.position < place.position + place.size && place.position < a.position + a.size;
            });
            ASSERT_TRUE(overlaps) << "frame at " << p << " lost, JINK_SEED=" << seed;
            ++overlapped;
        }
    }
    RecordProperty("overlapped", std::to_string(overlapped));
}

TEST(MavlinkParserLaw, ChunksDoNotMatter)
{
    for (std::uint64_t round = 0; round < 100; ++round) {
        const std::uint64_t seed = parser_seed() + 8'000'000 + round;
        Random random(seed);
        const Bytes stream = random_stream(random, sample_frames(random));
        Parser whole;
        const std::size_t n = parse(whole, stream).size();
        for (const std::size_t chunk : {1U, 2U, 7U, 64U, 279U, 280U, 281U, 559U, 560U, 561U}) {
            Parser parser;
            ASSERT_EQ(parse(parser, stream, chunk).size(), n) << "chunk " << chunk << " JINK_SEED=" << seed;
            ASSERT_EQ(parser.diagnostics().noise_bytes, whole.diagnostics().noise_bytes);
            ASSERT_EQ(parser.diagnostics().checksum_bytes, whole.diagnostics().checksum_bytes);
            ASSERT_LT(parser.pending(), kMaxFrame);
        }
    }
}

/// Checksum bytes per input byte.
double work_of(const Bytes& stream)
{
    Parser parser;
    parse(parser, stream, 1U << 20U, true);
    return static_cast<double>(parser.diagnostics().checksum_bytes) / static_cast<double>(stream.size());
}

Bytes repeated(std::string_view hex, std::size_t size)
{
    const Bytes pattern = from_hex(hex);
    Bytes stream(size);
    for (std::size_t i = 0; i < size; ++i) {
        stream[i] = pattern[i % pattern.size()];
    }
    return stream;
}

TEST(MavlinkParserLaw, WorkPerByteStaysBelowTheStatedBound)
{
    constexpr std::size_t kSize = 20'000;
    double worst = 0.0;
    const auto measure = [&worst](const Bytes& stream) {
        const double work = work_of(stream);
        worst = std::max(worst, work);
        ASSERT_LE(work, static_cast<double>(kMaxFrame - 1));
    };
    // headers as tight as they can overlap, each claiming as much as a frame can: FILE_TRANSFER_PROTOCOL, 255 bytes
    measure(repeated("fdff000000016e0000", kSize));
    measure(repeated("fdff00000001016e0000", kSize));
    measure(repeated("fdff00fdff00fdff6e0000", kSize));
    measure(repeated("fefefefe", kSize));
    measure(repeated("fdfd", kSize));
    // hill climbing over short patterns
    for (std::uint64_t start = 0; start < 40; ++start) {
        Random random(parser_seed() + start);
        constexpr std::array<unsigned, 10> kLikely{0xFD, 0xFE, 0x00, 0x00, 0x01, 0x6E, 0xFF, 0xFB, 0x16, 0x09};
        Bytes best(3 + random.below(12));
        double best_work = 0.0;
        for (int step = 0; step < 150; ++step) {
            Bytes next = best;
            for (std::size_t k = 0; k <= random.below(3); ++k) {
                next[random.below(next.size())] = static_cast<std::byte>(kLikely[random.below(kLikely.size())]);
            }
            const double work = work_of(repeated(to_hex(next), 3000));
            if (work >= best_work) {
                best_work = work;
                best = next;
            }
        }
        measure(repeated(to_hex(best), kSize));
    }
    std::printf("worst work found: %.1f checksum bytes per input byte, bound %zu\n", worst, kMaxFrame - 1);
}

TEST(MavlinkParserLaw, OneCallIsBoundedToo)
{
    // all that can be pending is rejected by one last byte
    for (const std::string_view pattern : {"fdff00000001016e0000", "fdff000000016e0000"}) {
        Parser parser;
        std::uint32_t before = 0;
        for (const std::byte b : repeated(pattern, 5000)) {
            std::span<const std::byte> one(&b, 1);
            while (parser.next(one)) {
            }
            const std::uint32_t after = parser.diagnostics().checksum_bytes;
            ASSERT_LE(after - before, kMaxFrame * kMaxFrame / 2);
            before = after;
        }
    }
}

}  // namespace
}  // namespace jink::link::mavlink
