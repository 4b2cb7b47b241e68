// SPDX-License-Identifier: BSD-3-Clause
#include "hal/ring.hpp"

#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "core/base/random.hpp"

namespace jink::hal {
namespace {

TEST(Ring, HoldsItsCapacityAndNotOneMore)
{
    ByteRing<8> ring;
    for (int i = 0; i < 8; ++i) {
        EXPECT_TRUE(ring.push(static_cast<std::byte>(i)));
    }
    EXPECT_FALSE(ring.push(std::byte{9}));
    EXPECT_EQ(ring.size(), 8U);
    std::byte byte{};
    for (int i = 0; i < 8; ++i) {
        ASSERT_TRUE(ring.pop(byte));
        EXPECT_EQ(byte, static_cast<std::byte>(i));
    }
    EXPECT_FALSE(ring.pop(byte));
}

TEST(Ring, IsAQueueWhateverThePiecesAre)
{
    ByteRing<16> ring;
    Random random(7);
    std::vector<std::byte> in;
    std::vector<std::byte> out;
    unsigned next = 0;
    for (int round = 0; round < 20000; ++round) {
        std::array<std::byte, 24> piece{};
        const std::size_t size = random.below(piece.size() + 1);
        for (std::size_t i = 0; i < size; ++i) {
            piece[i] = static_cast<std::byte>(next + i);
        }
        const std::size_t room = ring.capacity() - ring.size();
        const std::size_t taken = ring.push(std::span<const std::byte>(piece.data(), size));
        ASSERT_EQ(taken, std::min(room, size));
        in.insert(in.end(), piece.begin(), piece.begin() + static_cast<std::ptrdiff_t>(taken));
        next += static_cast<unsigned>(taken);
        const std::size_t wanted = random.below(piece.size() + 1);
        const std::size_t got = ring.pop(std::span<std::byte>(piece.data(), wanted));
        out.insert(out.end(), piece.begin(), piece.begin() + static_cast<std::ptrdiff_t>(got));
    }
    ASSERT_LE(out.size(), in.size());
    EXPECT_TRUE(std::equal(out.begin(), out.end(), in.begin()));
    EXPECT_EQ(in.size() - out.size(), ring.size());
}

TEST(Ring, LosesNothingBetweenTwoThreads)
{
    constexpr unsigned kBytes = 200'000;
    ByteRing<64> ring;
    std::thread writer([&] {
        for (unsigned i = 0; i < kBytes;) {
            i += ring.push(static_cast<std::byte>(i * 7U)) ? 1U : 0U;
        }
    });
    unsigned wrong = 0;
    std::byte byte{};
    for (unsigned i = 0; i < kBytes;) {
        if (ring.pop(byte)) {
            wrong += byte != static_cast<std::byte>(i * 7U) ? 1U : 0U;
            ++i;
        }
    }
    writer.join();
    EXPECT_EQ(wrong, 0U);
}

}  // namespace
}  // namespace jink::hal
