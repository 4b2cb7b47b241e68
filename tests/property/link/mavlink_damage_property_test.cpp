// SPDX-License-Identifier: BSD-3-Clause
// Damage to frames of every message: single bits, bursts, cuts, and the other bad frames of
// docs/guides/mavlink_frames.md by name.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <gtest/gtest.h>
#include <string>

#include "firmware/link/mavlink/checksum.hpp"
#include "tests/unit/link/mavlink_tools.hpp"

namespace jink::link::mavlink {
namespace {

using namespace test;

std::uint64_t base_seed()
{
    const char* const given = std::getenv("JINK_SEED");
    return given != nullptr ? std::strtoull(given, nullptr, 0) : 20260202;
}

struct Sample {
    MessageInfo info;
    Bytes frame;
};

std::vector<Sample> samples(std::uint64_t seed, bool legacy)
{
    Random random(seed);
    std::vector<Sample> all;
    for_each_message([&]<class M>() {
        M message = random_message<M>(random);
        if (!legacy) {
            all.push_back({M::kInfo, frame_of(message)});
        } else if (M::kInfo.id < 256) {
            all.push_back({M::kInfo, legacy_frame_of(message)});
        }
    });
    return all;
}

Bytes good_frame()
{
    Heartbeat m;
    m.custom_mode = 0xA5;
    return frame_of(m, {42, 42, 42});
}

bool is_good_frame(const Received& r)
{
    return r.message_id == 0 && r.header.system_id == 42 && r.payload[0] == std::byte{0xA5};
}

/// Frames other than the good one that follows the damaged bytes; fails when the good one is not found.
std::size_t strangers(const Bytes& damaged, LongerPayload longer = LongerPayload::reject)
{
    Parser parser(nullptr, longer);
    Bytes stream = damaged;
    const Bytes good = good_frame();
    stream.insert(stream.end(), good.begin(), good.end());
    const std::vector<Received> found = parse(parser, stream, 1U << 20U, true);
    EXPECT_TRUE(!found.empty() && is_good_frame(found.back())) << "good frame lost behind " << to_hex(damaged);
    return found.empty() ? 0 : found.size() - 1;
}

/// Frames found in `damaged`; bytes claimed by a raised length are filled with zeros.
std::size_t frames_in(const Bytes& damaged)
{
    Parser parser;
    const std::size_t found = parse(parser, damaged).size();
    return found + parse(parser, Bytes(kMaxFrame, std::byte{0})).size();
}

constexpr std::size_t kLengthByte = 1;

TEST(MavlinkDamage, NoSingleFlippedBitIsAccepted)
{
    std::size_t flips = 0;
    for (const bool legacy : {false, true}) {
        for (std::uint64_t variant = 0; variant < 8; ++variant) {
            for (const Sample& sample : samples(base_seed() + variant, legacy)) {
                for (std::size_t bit = 0; bit < 8 * sample.frame.size(); ++bit) {
                    Bytes damaged = sample.frame;
                    damaged[bit / 8] ^= static_cast<std::byte>(1U << (bit % 8));
                    if (bit / 8 == kLengthByte) {  // moves the checksum: see the next test
                        continue;
                    }
                    ASSERT_EQ(frames_in(damaged), 0U)
                        << "message " << sample.info.id << " bit " << bit << " variant " << variant;
                    ++flips;
                }
            }
        }
    }
    std::printf("single flipped bits: %zu tried, 0 accepted\n", flips);
}

// A changed length makes the parser read the checksum at another place, from arbitrary bytes: a 16-bit checksum then
// accepts one in 2^16. The test allows four times that for chance.
TEST(MavlinkDamage, FlippedLengthsAreAcceptedNoMoreOftenThanTheChecksumAllows)
{
    std::size_t tries = 0;
    std::size_t accepted = 0;
    for (std::uint64_t variant = 0; variant < 500; ++variant) {
        for (const Sample& sample : samples(base_seed() + 1000 + variant, false)) {
            for (std::size_t bit = 0; bit < 8; ++bit) {
                Bytes damaged = sample.frame;
                damaged[kLengthByte] ^= static_cast<std::byte>(1U << bit);
                accepted += frames_in(damaged);
                ++tries;
            }
        }
    }
    std::printf("flipped length bits: %zu tried, %zu accepted\n", tries, accepted);
    EXPECT_LE(accepted, tries >> 14U);
}

TEST(MavlinkDamage, BurstsAreAcceptedNoMoreOftenThanTheChecksumAllows)
{
    constexpr std::size_t kTries = 4'000'000;
    const std::vector<Sample> all = samples(base_seed(), false);
    Random random(base_seed() + 99);
    std::size_t accepted = 0;
    std::size_t accepted_short = 0;
    Parser parser;
    for (std::size_t i = 0; i < kTries; ++i) {
        const Sample& sample = all[random.below(all.size())];
        Bytes damaged = sample.frame;
        // a burst of 2 to 30 bits behind the header: its first and last bit flipped, those between at random
        const std::size_t end_of_frame = 8 * damaged.size();
        const std::size_t length = 2 + random.below(std::min<std::size_t>(29, end_of_frame - 8 * kHeaderV2 - 1));
        const std::size_t begin = 8 * kHeaderV2 + random.below(end_of_frame - 8 * kHeaderV2 - length + 1);
        for (std::size_t k = 0; k < length; ++k) {
            if (k == 0 || k == length - 1 || random.below(2) == 0) {
                damaged[(begin + k) / 8] ^= static_cast<std::byte>(1U << ((begin + k) % 8));
            }
        }
        std::span<const std::byte> input = damaged;
        std::size_t found = 0;
        while (parser.next(input)) {
            ++found;
        }
        while (parser.flush()) {
            ++found;
        }
        accepted += found;
        // CRC_EXTRA is between payload and checksum, so a burst across both is longer than its bits on the wire
        const std::size_t checksum = end_of_frame - 16;
        const bool on_one_side = begin + length <= checksum || begin >= checksum;
        accepted_short += on_one_side && length <= 16 ? found : 0;
    }
    std::printf("bursts of 2 to 30 bits: %zu tried, %zu accepted\n", kTries, accepted);
    EXPECT_LE(accepted, kTries >> 16U);
    EXPECT_EQ(accepted_short, 0U) << "a 16-bit CRC catches every burst up to 16 bits";
}

/// Whether the good frame by chance completes the cut frame, checksum included: undetectable, one in 65 536.
bool is_made_whole(const Bytes& cut, const MessageInfo& info, std::size_t header)
{
    Bytes stream = cut;
    const Bytes good = good_frame();
    stream.insert(stream.end(), good.begin(), good.end());
    if (cut.size() <= kLengthByte) {
        return false;
    }
    const std::size_t length = header + std::to_integer<std::size_t>(cut[kLengthByte]);
    if (length + 2 > stream.size()) {
        return false;
    }
    Checksum checksum;
    checksum.add({stream.data() + 1, length - 1});
    checksum.add(static_cast<std::byte>(info.crc_extra));
    return checksum.value() ==
           std::to_integer<unsigned>(stream[length]) + 256U * std::to_integer<unsigned>(stream[length + 1]);
}

TEST(MavlinkDamage, CutAtEveryByte)
{
    int made_whole = 0;
    for (const bool legacy : {false, true}) {
        for (const Sample& sample : samples(base_seed(), legacy)) {
            for (std::size_t n = 0; n < sample.frame.size(); ++n) {
                const Bytes cut(sample.frame.begin(), sample.frame.begin() + static_cast<std::ptrdiff_t>(n));
                if (is_made_whole(cut, sample.info, legacy ? 6 : 10)) {
                    ++made_whole;
                    continue;
                }
                ASSERT_EQ(strangers(cut), 0U) << sample.info.id << " cut at " << n;
            }
        }
    }
    EXPECT_LE(made_whole, 4);
}

TEST(MavlinkDamage, WrongStartByte)
{
    for (const Sample& sample : samples(base_seed(), false)) {
        for (unsigned start = 0; start < 256; ++start) {
            Bytes damaged = sample.frame;
            damaged[0] = static_cast<std::byte>(start);
            ASSERT_EQ(strangers(damaged), start == 0xFD ? 1U : 0U) << sample.info.id;
        }
    }
}

/// A frame of `info` with `length` bytes of payload and a right checksum.
Bytes frame_of_length(const MessageInfo& info, std::size_t length, unsigned version, std::byte fill = std::byte{0x11})
{
    RawFrame raw;
    raw.version = version;
    raw.id = info.id;
    raw.crc_extra = info.crc_extra;
    raw.payload = Bytes(length, fill);
    return raw.bytes();
}

TEST(MavlinkDamage, EveryLength)
{
    for (const Sample& sample : samples(base_seed(), false)) {
        for (std::size_t length = 0; length <= 255; ++length) {
            const bool fits = length <= sample.info.max_length;
            ASSERT_EQ(strangers(frame_of_length(sample.info, length, 2)), fits ? 1U : 0U)
                << sample.info.id << " " << length;
            ASSERT_EQ(strangers(frame_of_length(sample.info, length, 2), LongerPayload::accept), 1U);
            if (sample.info.id < 256) {
                const bool exact = length == sample.info.min_length;
                ASSERT_EQ(strangers(frame_of_length(sample.info, length, 1)), exact ? 1U : 0U) << sample.info.id;
            }
        }
    }
}

TEST(MavlinkDamage, LegacyFrameOfAnIdThatOnlyTheNewVersionHas)
{
    // v1 has one byte for the id: the received frame is that of another message, and its checksum fails
    for (const Sample& sample : samples(base_seed(), false)) {
        if (sample.info.id > 255) {
            ASSERT_EQ(strangers(frame_of_length(sample.info, sample.info.min_length, 1)), 0U) << sample.info.id;
        }
    }
}

TEST(MavlinkDamage, UnknownIdAndUnknownFlags)
{
    for (const Sample& sample : samples(base_seed(), false)) {
        MessageInfo unknown = sample.info;
        for (const std::uint32_t id : {3U, 13'000U, 0xFFFFFFU}) {
            unknown.id = id;
            ASSERT_EQ(strangers(frame_of_length(unknown, sample.info.max_length, 2)), 0U);
        }
        for (unsigned flags = 2; flags < 256; flags += 1) {
            RawFrame raw;
            raw.incompatible = static_cast<std::uint8_t>(flags);
            raw.id = sample.info.id;
            raw.crc_extra = sample.info.crc_extra;
            raw.payload = Bytes(sample.info.max_length, std::byte{1});
            ASSERT_EQ(strangers(raw.bytes()), 0U) << sample.info.id << " flags " << flags;
        }
    }
}

TEST(MavlinkDamage, EveryOtherCrcExtra)
{
    for (const Sample& sample : samples(base_seed(), false)) {
        for (unsigned extra = 0; extra < 256; ++extra) {
            MessageInfo other = sample.info;
            other.crc_extra = static_cast<std::uint8_t>(extra);
            ASSERT_EQ(strangers(frame_of_length(other, other.max_length, 2)), extra == sample.info.crc_extra ? 1U : 0U)
                << sample.info.id << " extra " << extra;
        }
    }
}

TEST(MavlinkDamage, GluedAndRepeatedFrames)
{
    for (const Sample& sample : samples(base_seed(), false)) {
        Bytes twice = sample.frame;
        twice.insert(twice.end(), sample.frame.begin(), sample.frame.end());
        ASSERT_EQ(strangers(twice), 2U) << sample.info.id;
    }
}

TEST(MavlinkDamage, SignedFramesWithoutAKey)
{
    Random random(base_seed());
    Signing signing({}, 0, 0);
    for_each_message([&]<class M>() {
        Bytes frame(kMaxFrame);
        frame.resize(encode_signed(random_message<M>(random), {1, 1, 0}, signing, frame));
        ASSERT_EQ(strangers(frame), 1U) << M::kInfo.id << ": whole, and nothing of its signature as a frame";
    });
}

TEST(MavlinkDamage, RandomMessagesComeBackAsTheyWere)
{
    for (std::uint64_t round = 0; round < 300; ++round) {
        const std::uint64_t seed = base_seed() + 5000 + round;
        Random random(seed);
        for_each_message([&]<class M>() {
            const M message = random_message<M>(random);
            const Bytes frame = frame_of(message);
            Parser parser;
            const auto frames = parse(parser, frame, 1 + random.below(50));
            ASSERT_EQ(frames.size(), 1U) << "JINK_SEED=" << seed;
            M decoded;
            ASSERT_TRUE(decode(frames[0].frame(), decoded));
            ASSERT_EQ(payload_of(decoded), payload_of(message)) << M::kInfo.id << " JINK_SEED=" << seed;
        });
    }
}

}  // namespace
}  // namespace jink::link::mavlink
