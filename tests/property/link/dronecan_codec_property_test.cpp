// SPDX-License-Identifier: BSD-3-Clause
// Laws of the bit codec over random values; float16 against an oracle in double precision, every pattern.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "tests/unit/link/dronecan_tools.hpp"

namespace jink::link::dronecan {
namespace {

using namespace test;

/// Value of a half by its definition.
double half_value(unsigned pattern)
{
    const double sign = (pattern & 0x8000U) != 0 ? -1.0 : 1.0;
    const int exponent = static_cast<int>(pattern >> 10U & 31U);
    const double fraction = static_cast<double>(pattern & 0x3FFU);
    if (exponent == 31) {
        return fraction != 0.0 ? std::nan("") : sign * HUGE_VAL;
    }
    return exponent == 0 ? sign * std::ldexp(fraction, -24) : sign * std::ldexp(1024.0 + fraction, exponent - 25);
}

/// Nearest half by bisection over the positive patterns, which are in order; ties to the even pattern.
unsigned nearest_half(double value)
{
    const unsigned sign = std::signbit(value) ? 0x8000U : 0U;
    const double magnitude = std::abs(value);
    unsigned low = 0;
    unsigned high = 0x7C00;  // infinity, whose place is that of 65536
    const auto place = [](unsigned pattern) { return pattern == 0x7C00 ? 65536.0 : half_value(pattern); };
    if (magnitude >= 65536.0) {
        return sign | high;
    }
    while (high - low > 1) {
        const unsigned middle = (low + high) / 2;
        (place(middle) <= magnitude ? low : high) = middle;
    }
    const double below = magnitude - place(low);
    const double above = place(high) - magnitude;
    const bool up = above < below || (above == below && (low & 1U) != 0);
    return sign | (up ? high : low);
}

TEST(DronecanFloat16, EveryPatternReadsAsItsDefinitionAndWritesBack)
{
    for (unsigned pattern = 0; pattern < 65536; ++pattern) {
        const float read = from_float16(static_cast<std::uint16_t>(pattern));
        const double expected = half_value(pattern);
        if (std::isnan(expected)) {
            ASSERT_TRUE(std::isnan(read)) << pattern;
            ASSERT_EQ(to_float16(read), pattern | 0x200U) << pattern;  // quieted, as IEEE 754 has it
            continue;
        }
        ASSERT_EQ(static_cast<double>(read), expected) << pattern;
        ASSERT_EQ(std::signbit(read), std::signbit(expected)) << pattern;
        ASSERT_EQ(to_float16(read), pattern) << pattern;
    }
}

TEST(DronecanFloat16, BetweenAllNeighboursTheMiddleGoesToTheEvenOneAndTheRestToTheNearest)
{
    for (unsigned pattern = 0; pattern < 0x7C00; ++pattern) {
        const double next = pattern + 1 == 0x7C00 ? 65536.0 : half_value(pattern + 1);
        const auto middle = static_cast<float>((half_value(pattern) + next) / 2.0);  // exact: 12 bits
        const float around[] = {std::nextafter(middle, 0.0F), middle, std::nextafter(middle, HUGE_VALF)};
        for (const float value : around) {
            ASSERT_EQ(to_float16(value), nearest_half(static_cast<double>(value))) << value;
            ASSERT_EQ(to_float16(-value), nearest_half(static_cast<double>(-value))) << value;
        }
    }
}

TEST(DronecanFloat16, RandomFloatsGoToTheNearestHalf)
{
    const std::uint64_t seed = base_seed();
    Random random(seed);
    for (int i = 0; i < 1'000'000; ++i) {
        const auto value = std::bit_cast<float>(static_cast<std::uint32_t>(random.next()));
        if (std::isnan(value)) {
            ASSERT_TRUE(std::isnan(from_float16(to_float16(value)))) << "JINK_SEED=" << seed;
        } else {
            ASSERT_EQ(to_float16(value), nearest_half(static_cast<double>(value))) << value << " JINK_SEED=" << seed;
        }
    }
}

/// The order of bits written down as text, one character a bit.
std::string reference_bits(std::uint64_t value, unsigned bits)
{
    std::string out;
    for (unsigned done = 0; done < bits; done += 8) {
        const unsigned n = std::min(8U, bits - done);
        for (unsigned b = n; b-- > 0;) {
            out += (value >> (done + b) & 1U) != 0 ? '1' : '0';
        }
    }
    return out;
}

TEST(DronecanBits, AnySequenceOfWidthsReadsAsWrittenAndLiesAsTheReferenceSays)
{
    const std::uint64_t seed = base_seed();
    Random random(seed);
    for (int round = 0; round < 100'000; ++round) {
        std::vector<std::pair<std::uint64_t, unsigned>> values;
        Bytes bytes(64);
        BitWriter writer(bytes);
        std::string expected;
        for (std::uint64_t n = random.below(12) + 1; n > 0; --n) {
            const unsigned bits = static_cast<unsigned>(random.below(64)) + 1;
            const std::uint64_t value = random.next() >> (64 - bits);
            if (!writer.put(value, bits)) {
                ASSERT_GT(expected.size() + bits, 512U) << "JINK_SEED=" << seed;
                continue;
            }
            values.emplace_back(value, bits);
            expected += reference_bits(value, bits);
        }
        ASSERT_LE(expected.size(), 512U);
        ASSERT_EQ(writer.bytes(), (expected.size() + 7) / 8);
        expected.resize(512, '0');
        for (std::size_t i = 0; i < 512; ++i) {
            const bool set = (std::to_integer<unsigned>(bytes[i / 8]) >> (7 - i % 8) & 1U) != 0;
            ASSERT_EQ(set, expected[i] == '1') << "bit " << i << " JINK_SEED=" << seed;
        }
        BitReader reader(bytes);
        for (const auto& [value, bits] : values) {
            std::uint64_t read = 0;
            ASSERT_TRUE(reader.get(read, bits));
            ASSERT_EQ(read, value) << bits << " bits, JINK_SEED=" << seed;
        }
    }
}

TEST(DronecanCodec, WhatIsWrittenReadsAsItWasAndFitsItsType)
{
    const std::uint64_t seed = base_seed();
    Random random(seed);
    for_each_type([&]<class M>() {
        for (int i = 0; i < 5000; ++i) {
            const M message = random_message<M>(random);
            Bytes bytes(M::kType.max_length);
            std::size_t size = 0;
            ASSERT_EQ(encode(message, bytes, size), CodecStatus::ok) << M::kType.id << " JINK_SEED=" << seed;
            bytes.resize(size);
            M read;
            ASSERT_EQ(decode(bytes, read), CodecStatus::ok) << M::kType.id << " JINK_SEED=" << seed;
            // A signalling NaN is quieted where it is written as a half: compared where it was read.
            Bytes again(M::kType.max_length);
            std::size_t size_again = 0;
            ASSERT_EQ(encode(read, again, size_again), CodecStatus::ok);
            again.resize(size_again);
            M third;
            ASSERT_EQ(decode(again, third), CodecStatus::ok);
            ASSERT_EQ(print(third), print(read)) << M::kType.id << " JINK_SEED=" << seed;
            ASSERT_EQ(size, size_again);
        }
    });
}

TEST(DronecanCodec, EveryCutPayloadIsRefusedOrReadsWithinBounds)
{
    const std::uint64_t seed = base_seed();
    Random random(seed);
    for_each_type([&]<class M>() {
        for (int i = 0; i < 200; ++i) {
            const Bytes bytes = payload_of(random_message<M>(random));
            for (std::size_t n = 0; n <= bytes.size(); ++n) {
                M read;
                // A tail array ends where the transfer ends: a shorter one may be whole. Anything must come to an end.
                const CodecStatus status = decode(std::span(bytes).first(n), read);
                ASSERT_TRUE(n < bytes.size() || status == CodecStatus::ok) << M::kType.id << " JINK_SEED=" << seed;
                if (status == CodecStatus::ok) {
                    ASSERT_EQ(payload_of(read).size(), n) << M::kType.id << " JINK_SEED=" << seed;
                }
            }
        }
    });
}

TEST(DronecanCodec, RandomBytesAreRefusedOrReadWithinBounds)
{
    const std::uint64_t seed = base_seed();
    Random random(seed);
    for_each_type([&]<class M>() {
        for (int i = 0; i < 20'000; ++i) {
            Bytes bytes(random.below(M::kType.max_length + 3U));
            for (std::byte& byte : bytes) {
                byte = static_cast<std::byte>(random.next());
            }
            M read;
            if (decode(bytes, read) == CodecStatus::ok && M::kType.id != Fix2::kType.id) {
                ASSERT_EQ(payload_of(read).size(), bytes.size()) << M::kType.id << " JINK_SEED=" << seed;
            }
        }
    });
}

}  // namespace
}  // namespace jink::link::dronecan
