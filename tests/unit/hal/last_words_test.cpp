// SPDX-License-Identifier: BSD-3-Clause
#include "hal/last_words.hpp"

#include <algorithm>
#include <cstring>
#include <vector>

#include <gtest/gtest.h>

#include "core/base/random.hpp"

namespace jink::hal {
namespace {

using Bytes = std::vector<std::byte>;

Bytes bytes_of(const char* text)
{
    Bytes bytes(std::strlen(text));
    std::memcpy(bytes.data(), text, bytes.size());
    return bytes;
}
void put(LastWords& words, const Bytes& bytes)
{
    std::copy(bytes.begin(), bytes.end(), words.draft().begin());
    words.publish(bytes.size());
}
Bytes valid(const LastWords& words)
{
    const auto v = words.valid();
    return {v.begin(), v.end()};
}

TEST(LastWords, NothingIsValidBeforeAnythingWasPublished)
{
    LastWords words;
    std::memset(static_cast<void*>(&words), 0xA5, sizeof words);  // memory contents at power-on
    EXPECT_TRUE(words.valid().empty());
    words.clear();
    EXPECT_TRUE(words.valid().empty());
}

TEST(LastWords, TheNewestCountAndAHalfWrittenDraftDoesNot)
{
    LastWords words;
    words.clear();
    for (int i = 0; i < 5; ++i) {
        put(words, bytes_of(i % 2 == 0 ? "even" : "odd words"));
        EXPECT_EQ(valid(words), bytes_of(i % 2 == 0 ? "even" : "odd words"));
        const Bytes half = bytes_of("half");
        std::copy(half.begin(), half.end(), words.draft().begin());
        EXPECT_EQ(valid(words), bytes_of(i % 2 == 0 ? "even" : "odd words"));
    }
    words.publish(LastWords::kMax + 1);  // invalid size: the older words stay
    EXPECT_EQ(valid(words), bytes_of("even"));
}

TEST(LastWords, NoChangeOfAByteGoesUnnoticed)
{
    Random random(5);
    for (std::size_t size : {std::size_t{1}, std::size_t{63}, LastWords::kMax}) {
        LastWords words;
        words.clear();
        Bytes said(size);
        for (std::byte& b : said) {
            b = static_cast<std::byte>(random.below(256));
        }
        put(words, said);
        ASSERT_EQ(valid(words), said);
        // Every byte of the object that the words depend on: after a flip the result is the words or nothing.
        auto* raw = reinterpret_cast<unsigned char*>(&words);
        unsigned refused = 0;
        for (std::size_t i = 0; i < sizeof words; ++i) {
            for (unsigned char flip : {1, 0x80, 0xFF}) {
                raw[i] = static_cast<unsigned char>(raw[i] ^ flip);
                const Bytes now = valid(words);
                EXPECT_TRUE(now.empty() || now == said) << "byte " << i;
                refused += now.empty() ? 1U : 0U;
                raw[i] = static_cast<unsigned char>(raw[i] ^ flip);
            }
        }
        EXPECT_GE(refused, 3 * (size + 8));  // bytes, size, check sum
        EXPECT_EQ(valid(words), said);
    }
}

/// A UART that takes a byte at every other poll, and stops for good after `room` bytes.
struct Line {
    Bytes* sent;
    std::size_t room = 1U << 20U;
    unsigned looks = 0;
    [[nodiscard]] std::uint32_t read(std::uint32_t) { return ++looks % 2 == 0 && sent->size() < room ? 1U : 0U; }
    void write(std::uint32_t, std::uint32_t value) { sent->push_back(static_cast<std::byte>(value)); }
};
struct LineUart {
    static constexpr std::size_t kHardwareBytes = 2;
    static bool has_room(Line& line) { return line.read(0) != 0; }
    static void put(Line& line, std::byte byte) { line.write(0, std::to_integer<std::uint32_t>(byte)); }
};

TEST(SayLastWords, WhatWaitsGoesFirstThenZerosThenTheWords)
{
    ByteRing<64> ring;
    const Bytes waiting = bytes_of("rest of a frame");
    ASSERT_EQ(ring.push(std::span<const std::byte>(waiting)), waiting.size());
    Bytes sent;
    const Bytes words = bytes_of("last words");
    EXPECT_TRUE(say_last_words<LineUart>(Line{&sent}, ring, words, 30, 10));
    Bytes expected = waiting;
    expected.resize(expected.size() + 30);
    expected.insert(expected.end(), words.begin(), words.end());
    expected.resize(expected.size() + 4);
    EXPECT_EQ(sent, expected);
    EXPECT_EQ(ring.size(), 0U);
}

TEST(SayLastWords, ALineThatTakesNothingEndsItWherever)
{
    const Bytes words = bytes_of("last words");
    for (std::size_t room = 0; room < 45; ++room) {
        ByteRing<64> ring;
        ASSERT_TRUE(ring.push(std::byte{7}));
        Bytes sent;
        EXPECT_FALSE(say_last_words<LineUart>(Line{&sent, room}, ring, words, 30, 10));
        EXPECT_EQ(sent.size(), room);
    }
}

TEST(SayLastWords, ARingWhoseIndicesCannotBeRightIsPassedOver)
{
    ByteRing<64> ring;
    auto* raw = reinterpret_cast<unsigned char*>(&ring);
    const std::uint32_t wild = 0x80000000;
    std::memcpy(raw, &wild, sizeof wild);
    ASSERT_GT(ring.size(), 64U);
    Bytes sent;
    const Bytes words = bytes_of("x");
    EXPECT_TRUE(say_last_words<LineUart>(Line{&sent}, ring, words, 2, 10));
    EXPECT_EQ(sent.size(), 2U + 1U + 4U);
}

}  // namespace
}  // namespace jink::hal
