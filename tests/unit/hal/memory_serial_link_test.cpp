// SPDX-License-Identifier: BSD-3-Clause
#include "hal/memory/memory_serial_link.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <deque>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "hal/memory/manual_clock.hpp"

namespace jink::hal {
namespace {

constexpr std::uint32_t kMillion = 1'000'000;

std::vector<std::byte> random_bytes(std::size_t size, std::mt19937& random)
{
    std::vector<std::byte> bytes(size);
    std::generate(bytes.begin(), bytes.end(), [&] { return static_cast<std::byte>(random() & 0xFFU); });
    return bytes;
}

/// 0, 1, 2, ... so that the order of arrival is visible.
std::vector<std::byte> counting_bytes(std::size_t size)
{
    std::vector<std::byte> bytes(size);
    for (std::size_t i = 0; i < size; ++i) {
        bytes[i] = static_cast<std::byte>(i);
    }
    return bytes;
}

std::vector<std::byte> read_all(SerialPort& port)
{
    std::vector<std::byte> got(2 * kMemoryLineCapacity);
    got.resize(port.read(got));
    return got;
}

void expect_sum(const LineCounters& c)
{
    EXPECT_EQ(c.taken, c.delivered + c.lost + c.overrun + c.discarded + c.queued);
}

TEST(MemorySerialLink, StartsOpenAndEmpty)
{
    ManualClock clock;
    MemorySerialLink link(clock, 1);
    for (MemorySerialLink::Port* port : {&link.a(), &link.b()}) {
        std::array<std::byte, 3> bytes{};
        EXPECT_EQ(port->health().state, PortState::open);
        EXPECT_EQ(port->read(bytes), 0U);
        EXPECT_EQ(port->read({}), 0U);
        EXPECT_EQ(port->write({}), 0U);
        EXPECT_EQ(port->health().bytes_in, 0U);
    }
}

// Law: without faults each end reads exactly what the other wrote, in order, for any division into pieces, and never
// more than the capacity is in transit. The oracle is a queue.
TEST(MemorySerialLink, IsAQueueInEachDirection)
{
    for (std::uint32_t seed = 1; seed <= 50; ++seed) {
        SCOPED_TRACE("seed " + std::to_string(seed));
        std::mt19937 random(seed);
        ManualClock clock;
        MemorySerialLink link(clock, seed);
        LineFaults small;
        small.capacity = random() % 300;
        link.a_to_b().set_faults(small);
        link.b_to_a().set_faults(small);
        std::deque<std::byte> a_to_b;
        std::deque<std::byte> b_to_a;
        for (int step = 0; step < 400; ++step) {
            const bool from_a = (random() & 1U) != 0;
            auto& queue = from_a ? a_to_b : b_to_a;
            SerialPort& writer = from_a ? link.a() : link.b();
            SerialPort& reader = from_a ? link.b() : link.a();
            const auto bytes = random_bytes(random() % 200, random);
            const std::size_t taken = writer.write(bytes);
            ASSERT_EQ(taken, std::min(bytes.size(), small.capacity - queue.size()));
            queue.insert(queue.end(), bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(taken));
            std::vector<std::byte> got(random() % 200);
            const std::size_t count = reader.read(got);
            ASSERT_EQ(count, std::min(got.size(), queue.size()));
            for (std::size_t i = 0; i < count; ++i) {
                ASSERT_EQ(got[i], queue.front());
                queue.pop_front();
            }
        }
        EXPECT_EQ(link.a().health().bytes_out, link.b().health().bytes_in + a_to_b.size());
        EXPECT_EQ(link.b().health().bytes_out, link.a().health().bytes_in + b_to_a.size());
    }
}

TEST(MemorySerialLink, TakesItsCapacityAndRefusesTheRest)
{
    ManualClock clock;
    MemorySerialLink link(clock, 1);
    const auto bytes = counting_bytes(kMemoryLineCapacity + 10);
    EXPECT_EQ(link.a().write(bytes), kMemoryLineCapacity);
    EXPECT_EQ(link.a().health().bytes_refused, 10U);
    EXPECT_EQ(link.a().write(bytes), 0U);
    EXPECT_EQ(link.b().health().overruns, 0U);
    EXPECT_EQ(read_all(link.b()), counting_bytes(kMemoryLineCapacity));
}

TEST(MemorySerialLink, WithoutBackPressureOverrunsAreLostAndCounted)
{
    ManualClock clock;
    MemorySerialLink link(clock, 1);
    LineFaults bare_uart;
    bare_uart.capacity = 16;
    bare_uart.back_pressure = false;
    link.a_to_b().set_faults(bare_uart);
    EXPECT_EQ(link.a().write(counting_bytes(40)), 40U);
    EXPECT_EQ(link.a().health().bytes_refused, 0U);
    EXPECT_EQ(link.b().health().overruns, 24U);
    EXPECT_EQ(link.a().health().overruns, 0U);
    EXPECT_EQ(read_all(link.b()), counting_bytes(16));
    expect_sum(link.a_to_b().counters());
}

TEST(MemorySerialLink, LosesBytesAtTheRateAskedAndKeepsTheOrderOfTheRest)
{
    ManualClock clock;
    MemorySerialLink link(clock, 99);
    LineFaults faults;
    faults.loss_per_million = 100'000;
    link.a_to_b().set_faults(faults);
    std::size_t arrived = 0;
    for (int round = 0; round < 1000; ++round) {
        ASSERT_EQ(link.a().write(counting_bytes(100)), 100U);
        const auto got = read_all(link.b());
        EXPECT_TRUE(std::is_sorted(got.begin(), got.end(), std::less_equal<>()));
        arrived += got.size();
    }
    const LineCounters counters = link.a_to_b().counters();
    EXPECT_EQ(counters.lost, 100'000 - arrived);
    // Binomial: mean 10000, standard deviation 95; six of them.
    EXPECT_NEAR(static_cast<double>(counters.lost), 10'000.0, 570.0);
    expect_sum(counters);
}

TEST(MemorySerialLink, CorruptsOneBitOfEachByteHit)
{
    ManualClock clock;
    MemorySerialLink link(clock, 5);
    LineFaults faults;
    faults.corruption_per_million = 50'000;
    link.a_to_b().set_faults(faults);
    std::array<int, 8> hits_of_bit{};
    std::uint64_t corrupted = 0;
    std::mt19937 random(5);
    for (int round = 0; round < 1000; ++round) {
        const auto bytes = random_bytes(100, random);
        ASSERT_EQ(link.a().write(bytes), bytes.size());
        const auto got = read_all(link.b());
        ASSERT_EQ(got.size(), bytes.size());
        for (std::size_t i = 0; i < got.size(); ++i) {
            const auto flipped = std::to_integer<unsigned>(got[i] ^ bytes[i]);
            ASSERT_LE(std::popcount(flipped), 1);
            if (flipped != 0) {
                ++corrupted;
                ++hits_of_bit[static_cast<std::size_t>(std::countr_zero(flipped))];
            }
        }
    }
    EXPECT_EQ(link.a_to_b().counters().corrupted, corrupted);
    // Binomial: mean 5000, standard deviation 69; each bit mean 625, standard deviation 25; six of them.
    EXPECT_NEAR(static_cast<double>(corrupted), 5'000.0, 414.0);
    for (const int hits : hits_of_bit) {
        EXPECT_NEAR(hits, 625, 150);
    }
    expect_sum(link.a_to_b().counters());
}

TEST(MemorySerialLink, CertainLossAndCertainCorruption)
{
    ManualClock clock;
    MemorySerialLink link(clock, 6);
    LineFaults faults;
    faults.loss_per_million = kMillion;
    link.a_to_b().set_faults(faults);
    const std::array<std::byte, 50> zeros{};
    EXPECT_EQ(link.a().write(zeros), 50U);
    EXPECT_TRUE(read_all(link.b()).empty());
    EXPECT_EQ(link.a_to_b().counters().lost, 50U);

    faults = {};
    faults.corruption_per_million = kMillion;
    link.a_to_b().set_faults(faults);
    EXPECT_EQ(link.a().write(zeros), 50U);
    const auto got = read_all(link.b());
    EXPECT_EQ(got.size(), 50U);
    for (const std::byte byte : got) {
        EXPECT_EQ(std::popcount(std::to_integer<unsigned>(byte)), 1);
    }
    EXPECT_EQ(link.a_to_b().counters().corrupted, 50U);
}

TEST(MemorySerialLink, BytesAppearAfterTheLatencyAndNotBefore)
{
    ManualClock clock(1'000'000);
    MemorySerialLink link(clock, 7);
    LineFaults faults;
    faults.latency_us = 2'500;
    link.a_to_b().set_faults(faults);
    const std::vector<std::byte> first{std::byte{1}, std::byte{2}, std::byte{3}};
    const std::vector<std::byte> second{std::byte{4}, std::byte{5}};
    ASSERT_EQ(link.a().write(first), 3U);
    clock.advance(1'000);
    ASSERT_EQ(link.a().write(second), 2U);
    clock.advance(1'499);
    EXPECT_TRUE(read_all(link.b()).empty());
    clock.advance(1);
    EXPECT_EQ(read_all(link.b()), first);
    clock.advance(999);
    EXPECT_TRUE(read_all(link.b()).empty());
    clock.advance(1);
    EXPECT_EQ(read_all(link.b()), second);
}

TEST(MemorySerialLink, AShorterLatencyDoesNotLetBytesOvertake)
{
    ManualClock clock;
    MemorySerialLink link(clock, 7);
    LineFaults slow;
    slow.latency_us = 100;
    link.a_to_b().set_faults(slow);
    ASSERT_EQ(link.a().write(std::array{std::byte{1}}), 1U);
    link.a_to_b().set_faults({});
    ASSERT_EQ(link.a().write(std::array{std::byte{2}}), 1U);
    EXPECT_TRUE(read_all(link.b()).empty());
    clock.advance(100);
    EXPECT_EQ(read_all(link.b()), (std::vector{std::byte{1}, std::byte{2}}));
}

TEST(MemorySerialLink, AStallHoldsBytesBackInOneDirection)
{
    ManualClock clock;
    MemorySerialLink link(clock, 8);
    ASSERT_TRUE(link.a_to_b().try_add_stall({100, 200}));
    ASSERT_TRUE(link.a_to_b().try_add_stall({300, 400}));
    const std::array byte{std::byte{9}};
    clock.advance(99);
    ASSERT_EQ(link.a().write(byte), 1U);
    EXPECT_EQ(read_all(link.b()).size(), 1U);
    clock.advance(1);
    ASSERT_EQ(link.a().write(byte), 1U);
    ASSERT_EQ(link.b().write(byte), 1U);
    EXPECT_TRUE(read_all(link.b()).empty());
    EXPECT_EQ(read_all(link.a()).size(), 1U);
    clock.advance(99);
    EXPECT_TRUE(read_all(link.b()).empty());
    clock.advance(1);
    EXPECT_EQ(read_all(link.b()).size(), 1U);
    clock.advance(150);
    ASSERT_EQ(link.a().write(byte), 1U);
    EXPECT_TRUE(read_all(link.b()).empty());
    clock.advance(50);
    EXPECT_EQ(read_all(link.b()).size(), 1U);
}

TEST(MemorySerialLink, RefusesMoreStallsThanItHolds)
{
    ManualClock clock;
    MemorySerialLink link(clock, 8);
    for (std::size_t i = 0; i < kMaxStalls; ++i) {
        EXPECT_TRUE(link.a_to_b().try_add_stall({0, 1}));
    }
    EXPECT_FALSE(link.a_to_b().try_add_stall({0, 1}));
}

TEST(MemorySerialLink, ADisconnectLosesWhatIsUnderWayOnBothEnds)
{
    ManualClock clock;
    MemorySerialLink link(clock, 9);
    const std::array<std::byte, 10> bytes{};
    ASSERT_EQ(link.a().write(bytes), 10U);
    ASSERT_EQ(link.b().write(bytes), 10U);
    link.disconnect();
    link.disconnect();
    EXPECT_EQ(link.a().health().state, PortState::lost);
    EXPECT_EQ(link.b().health().state, PortState::lost);
    EXPECT_TRUE(read_all(link.a()).empty());
    EXPECT_EQ(link.a().write(bytes), 0U);
    EXPECT_EQ(link.a().health().bytes_refused, 10U);
    EXPECT_EQ(link.b().health().bytes_refused, 0U);
    link.reconnect();
    link.reconnect();
    EXPECT_EQ(link.b().health().state, PortState::open);
    EXPECT_EQ(link.b().health().disconnects, 1U);
    EXPECT_EQ(link.b().health().reconnects, 1U);
    EXPECT_TRUE(read_all(link.b()).empty());
    EXPECT_EQ(link.a_to_b().counters().discarded, 10U);
    ASSERT_EQ(link.a().write(bytes), 10U);
    EXPECT_EQ(read_all(link.b()).size(), 10U);
    expect_sum(link.a_to_b().counters());
    expect_sum(link.b_to_a().counters());
}

/// Random faults, cuts, reads and writes; returns the received bytes.
std::vector<std::byte> run_with_all_faults(std::uint32_t seed)
{
    std::mt19937 random(seed);
    ManualClock clock;
    MemorySerialLink link(clock, seed);
    std::vector<std::byte> received;
    std::uint64_t offered = 0;
    EXPECT_TRUE(link.a_to_b().try_add_stall({50'000, 90'000}));
    for (int step = 0; step < 500; ++step) {
        if (step % 50 == 0) {
            LineFaults faults;
            faults.loss_per_million = static_cast<std::uint32_t>(random() % 200'000);
            faults.corruption_per_million = static_cast<std::uint32_t>(random() % 200'000);
            faults.latency_us = static_cast<std::int64_t>(random() % 5'000);
            faults.capacity = random() % (kMemoryLineCapacity + 1);
            faults.back_pressure = (random() & 1U) != 0;
            link.a_to_b().set_faults(faults);
        }
        if (random() % 40 == 0) {
            link.disconnect();
        } else if (random() % 4 == 0) {
            link.reconnect();
        }
        const auto bytes = random_bytes(random() % 300, random);
        offered += bytes.size();
        (void)link.a().write(bytes);
        std::vector<std::byte> got(random() % 300);
        got.resize(link.b().read(got));
        received.insert(received.end(), got.begin(), got.end());
        clock.advance(static_cast<std::int64_t>(random() % 500));
        expect_sum(link.a_to_b().counters());
    }
    const PortHealth a = link.a().health();
    const PortHealth b = link.b().health();
    EXPECT_EQ(a.bytes_out + a.bytes_refused, offered);
    EXPECT_EQ(a.bytes_out, link.a_to_b().counters().taken);
    EXPECT_EQ(b.bytes_in, received.size());
    EXPECT_EQ(b.overruns, link.a_to_b().counters().overrun);
    return received;
}

// Law: every accepted byte is accounted for in all cases, and the same seed gives the same bytes.
TEST(MemorySerialLink, AccountsForEveryByteUnderAllFaultsAtOnce)
{
    for (std::uint32_t seed = 1; seed <= 50; ++seed) {
        SCOPED_TRACE("seed " + std::to_string(seed));
        const auto first = run_with_all_faults(seed);
        EXPECT_GT(first.size(), 1'000U);
        EXPECT_EQ(first, run_with_all_faults(seed));
    }
}

TEST(MemorySerialLink, DirectionsAndSeedsHaveTheirOwnLuck)
{
    ManualClock clock;
    MemorySerialLink one(clock, 1);
    MemorySerialLink two(clock, 2);
    LineFaults faults;
    faults.loss_per_million = 500'000;
    for (MemoryLine* line : {&one.a_to_b(), &one.b_to_a(), &two.a_to_b()}) {
        line->set_faults(faults);
    }
    const auto bytes = counting_bytes(200);
    ASSERT_EQ(one.a().write(bytes), bytes.size());
    ASSERT_EQ(one.b().write(bytes), bytes.size());
    ASSERT_EQ(two.a().write(bytes), bytes.size());
    const auto first = read_all(one.b());
    EXPECT_NE(first, read_all(one.a()));
    EXPECT_NE(first, read_all(two.b()));
}

}  // namespace
}  // namespace jink::hal
