// SPDX-License-Identifier: BSD-3-Clause
// Signing keys that come over the link must not get into a log, however their frames are split, cut or overlapped.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <random>

#include "firmware/linux/flight_log/key_eraser.hpp"
#include "tests/flight_log/setup_signing.hpp"

namespace {

using namespace jink;
using namespace jink::test;
using namespace jink::flightlog;

/// What an eraser leaves of a stream that comes in reads of these sizes, which are repeated.
std::vector<std::byte> left_by_eraser(std::span<const std::byte> stream, const std::vector<std::size_t>& sizes)
{
    KeyEraser eraser;
    std::vector<std::byte> kept;
    for (std::size_t at = 0, i = 0; at < stream.size(); ++i) {
        const std::size_t n = std::min(sizes[i % sizes.size()], stream.size() - at);
        std::vector<std::byte> piece(stream.begin() + static_cast<std::ptrdiff_t>(at),
                                     stream.begin() + static_cast<std::ptrdiff_t>(at + n));
        const std::vector<std::byte> before = piece;
        EXPECT_TRUE(eraser.erase(piece) || piece == before) << "a change that is not reported";
        kept.insert(kept.end(), piece.begin(), piece.end());
        at += n;
    }
    return kept;
}

/// The same of the whole stream: each header in it overwrites what it announces (payload and checksum).
std::vector<std::byte> left_at_once(std::span<const std::byte> stream)
{
    constexpr std::size_t kHeader = 10;
    std::vector<std::byte> kept(stream.begin(), stream.end());
    for (std::size_t i = 0; i + kHeader <= stream.size(); ++i) {
        const auto byte = [&](std::size_t k) { return static_cast<unsigned>(stream[i + k]); };
        const unsigned id = byte(7) | byte(8) << 8U | byte(9) << 16U;
        if (byte(0) == 0xFD && byte(1) > 10 && byte(2) <= 1 && id == 256) {
            for (std::size_t k = i + kHeader; k < std::min(i + kHeader + byte(1) + 2, stream.size()); ++k) {
                kept[k] = std::byte{0};
            }
        }
    }
    return kept;
}

/// A frame that lost its end is followed by a whole one, which the receiver takes.
TEST(KeyEraser, ErasesAKeyAfterAFrameThatWasCut)
{
    const std::vector<std::byte> frame = setup_signing_frame();
    for (std::size_t cut = 1; cut < frame.size(); ++cut) {
        std::vector<std::byte> stream(frame.begin(), frame.begin() + static_cast<std::ptrdiff_t>(cut));
        stream.insert(stream.end(), frame.begin(), frame.end());
        for (const std::size_t size : {std::size_t{1}, std::size_t{7}, std::size_t{30}, std::size_t{200}}) {
            ASSERT_LE(longest_part(left_by_eraser(stream, {size}), secret()), 1U)
                << "cut after " << cut << " bytes, in reads of " << size;
        }
    }
}

/// Streams full of headers and of parts of headers, in reads of any sizes. JINK_LOG_SEED: the first seed.
TEST(KeyEraser, ReadsOfAnySizesLeaveWhatTheWholeStreamLeaves)
{
    const char* const given = std::getenv("JINK_LOG_SEED");
    const std::uint64_t first = given != nullptr ? std::strtoull(given, nullptr, 0) : 1;
    const std::vector<std::byte> frame = setup_signing_frame();
    std::size_t changed = 0;
    for (std::uint64_t seed = first; seed < first + 4'000; ++seed) {
        std::mt19937_64 random(seed);
        std::vector<std::byte> stream;
        while (stream.size() < 150) {
            constexpr std::array<unsigned, 8> kTempting{0xFD, 0xFD, 0, 0, 1, 42, 43, 2};
            switch (random() % 3) {
            case 0: stream.push_back(static_cast<std::byte>(kTempting[random() % kTempting.size()])); break;
            case 1: stream.push_back(static_cast<std::byte>(random())); break;
            default:
                stream.insert(stream.end(), frame.begin(), frame.begin() + static_cast<std::ptrdiff_t>(random() % 14));
            }
        }
        std::vector<std::size_t> sizes(1 + random() % 6);
        std::generate(sizes.begin(), sizes.end(), [&] { return 1 + random() % (random() % 2 == 0 ? 12U : 80U); });
        const std::vector<std::byte> expected = left_at_once(stream);
        ASSERT_EQ(left_by_eraser(stream, sizes), expected) << "JINK_LOG_SEED=" << seed;
        changed += expected != stream ? 1U : 0U;
    }
    EXPECT_GT(changed, 2'000U);
}

TEST(KeyEraser, ErasesAKeyHoweverItsFrameIsSplit)
{
    const std::vector<std::byte> frame = setup_signing_frame();
    const auto key = secret();
    for (std::size_t before = 0; before < 20; ++before) {
        std::vector<std::byte> stream(before, std::byte{0x11});
        stream.insert(stream.end(), frame.begin(), frame.end());
        stream.insert(stream.end(), 30, std::byte{0x22});
        for (std::size_t first = 1; first < stream.size(); ++first) {
            for (const std::size_t step : {std::size_t{1}, std::size_t{5}, std::size_t{9}, std::size_t{200}}) {
                KeyEraser eraser;
                std::vector<std::byte> kept;
                bool erased = false;
                for (std::size_t at = 0; at < stream.size();) {
                    const std::size_t n = std::min(at == 0 ? first : step, stream.size() - at);
                    std::vector<std::byte> piece(stream.begin() + static_cast<std::ptrdiff_t>(at),
                                                 stream.begin() + static_cast<std::ptrdiff_t>(at + n));
                    erased = eraser.erase(piece) || erased;
                    kept.insert(kept.end(), piece.begin(), piece.end());
                    at += n;
                }
                ASSERT_TRUE(erased);
                ASSERT_LE(longest_part(kept, key), 1U) << before << " " << first << " " << step;
                ASSERT_TRUE(std::equal(stream.begin(), stream.begin() + static_cast<std::ptrdiff_t>(before + 10),
                                       kept.begin()));
                ASSERT_TRUE(std::equal(stream.end() - 30, stream.end(), kept.end() - 30)) << "what follows stays";
            }
        }
    }
}

/// The receiver takes payloads that are longer than those of this revision, and the key in them.
TEST(KeyEraser, ErasesAKeyInALongerPayload)
{
    constexpr std::ptrdiff_t kBehind = 70;
    for (const std::size_t payload : {42U, 43U, 50U, 255U}) {
        std::vector<std::byte> stream = setup_signing_frame(payload);
        stream.insert(stream.end(), kBehind, std::byte{0x22});
        ASSERT_EQ(longest_part(stream, secret()), secret().size());
        for (const std::size_t size : {1U, 7U, 30U, 500U}) {
            const std::vector<std::byte> kept = left_by_eraser(stream, {size});
            EXPECT_LE(longest_part(kept, secret()), 1U) << payload << " bytes in reads of " << size;
            EXPECT_TRUE(std::equal(stream.end() - kBehind, stream.end(), kept.end() - kBehind)) << payload;
        }
        for (std::ptrdiff_t missing = 1; missing < 52; ++missing) {
            KeyEraser eraser;
            eraser.forget();
            std::vector<std::byte> rest(stream.begin() + missing, stream.end());
            static_cast<void>(eraser.erase(rest));
            EXPECT_LE(longest_part(rest, secret()), 1U) << payload << " without the first " << missing;
        }
    }
}

TEST(KeyEraser, LeavesOtherFramesAlone)
{
    std::mt19937_64 random(5);
    KeyEraser eraser;
    for (int i = 0; i < 2'000; ++i) {
        std::vector<std::byte> bytes(random() % 500);
        std::generate(bytes.begin(), bytes.end(), [&] { return static_cast<std::byte>(random()); });
        const std::vector<std::byte> before = bytes;
        ASSERT_FALSE(eraser.erase(bytes));
        ASSERT_EQ(bytes, before);
    }
}

/// The header, or a part of it, is missing: what can follow it is overwritten, and no more than kUnknown bytes.
/// The 254th frame of an autopilot whose ids are 1: its number begins what would be a SETUP_SIGNING of one byte.
TEST(KeyEraser, LeavesAHeaderThatAnnouncesNoKeyAlone)
{
    constexpr std::array<unsigned, 16> kMissionCurrent{0xFD, 4, 0, 0, 0xFD, 1, 1, 42, 0, 0, 1, 0, 1, 0, 0x12, 0x34};
    std::vector<std::byte> stream;
    for (const unsigned byte : kMissionCurrent) {
        stream.push_back(static_cast<std::byte>(byte));
    }
    for (const std::size_t size : {std::size_t{1}, std::size_t{5}, std::size_t{16}}) {
        EXPECT_EQ(left_by_eraser(stream, {size}), stream) << size;
    }
}

TEST(KeyEraser, OverwritesWhatMayFollowMissingBytes)
{
    const std::vector<std::byte> frame = setup_signing_frame();
    for (std::size_t missing = 1; missing <= frame.size(); ++missing) {
        for (const std::size_t size : {std::size_t{1}, std::size_t{7}, std::size_t{30}, std::size_t{300}}) {
            KeyEraser eraser;
            std::vector<std::byte> before(frame.begin(), frame.begin() + static_cast<std::ptrdiff_t>(missing - 1));
            static_cast<void>(eraser.erase(before));
            eraser.forget();
            std::vector<std::byte> stream(frame.begin() + static_cast<std::ptrdiff_t>(missing), frame.end());
            stream.insert(stream.end(), frame.begin(), frame.end());  // the next one is found by its header
            stream.insert(stream.end(), 150, std::byte{0x22});
            std::vector<std::byte> kept;
            for (std::size_t at = 0; at < stream.size(); at += size) {
                const std::size_t n = std::min(size, stream.size() - at);
                std::vector<std::byte> piece(stream.begin() + static_cast<std::ptrdiff_t>(at),
                                             stream.begin() + static_cast<std::ptrdiff_t>(at + n));
                static_cast<void>(eraser.erase(piece));
                kept.insert(kept.end(), piece.begin(), piece.end());
            }
            ASSERT_LE(longest_part(kept, secret()), 1U) << missing << " " << size;
            ASSERT_GE(std::count(kept.begin(), kept.end(), std::byte{0x22}), 150 - std::ptrdiff_t{KeyEraser::kUnknown});
        }
    }
}

}  // namespace
