// SPDX-License-Identifier: BSD-3-Clause
#include "core/orca/command_ring.hpp"

#include <limits>

#include <gtest/gtest.h>

namespace jink::orca {
namespace {

Vec3 along(float speed) { return {speed, 0.0F, 0.0F}; }

TEST(CommandRing, KeepsTheOrderOfTimes)
{
    CommandRing ring;
    EXPECT_TRUE(ring.empty());
    for (int i = 0; i < 5; ++i) {
        ASSERT_EQ(ring.add(TimePoint{25'000 * i}, along(static_cast<float>(i))), RingStatus::ok);
    }
    ASSERT_EQ(ring.size(), 5U);
    for (std::size_t i = 0; i < 5; ++i) {
        EXPECT_EQ(ring[i].velocity.x(), static_cast<float>(i));
    }
    EXPECT_EQ(ring.newest().issued.us, 100'000);
}

/// Section 18: 64 commands; the oldest is overwritten.
TEST(CommandRing, TheSixtyFifthCommandOverwritesTheFirst)
{
    CommandRing ring;
    for (int i = 0; i < static_cast<int>(kMaxCommands) + 3; ++i) {
        ASSERT_EQ(ring.add(TimePoint{i}, along(static_cast<float>(i))), RingStatus::ok);
    }
    ASSERT_EQ(ring.size(), kMaxCommands);
    for (std::size_t i = 0; i < kMaxCommands; ++i) {
        EXPECT_EQ(ring[i].issued.us, static_cast<std::int64_t>(i) + 3);
        EXPECT_EQ(ring[i].velocity.x(), static_cast<float>(i) + 3.0F);
    }
}

TEST(CommandRing, RefusesWhatIsNoCommand)
{
    CommandRing ring;
    ASSERT_EQ(ring.add(TimePoint{100}, along(1.0F)), RingStatus::ok);
    EXPECT_EQ(ring.add(TimePoint{100}, along(2.0F)), RingStatus::not_later);
    EXPECT_EQ(ring.add(TimePoint{99}, along(2.0F)), RingStatus::not_later);
    EXPECT_EQ(ring.add(TimePoint{200}, along(std::numeric_limits<float>::quiet_NaN())), RingStatus::not_finite);
    EXPECT_EQ(ring.add(TimePoint{200}, along(std::numeric_limits<float>::infinity())), RingStatus::not_finite);
    EXPECT_EQ(ring.size(), 1U);
    EXPECT_EQ(ring.newest().velocity.x(), 1.0F);
}

TEST(CommandRing, ClearedItTakesAnyTime)
{
    CommandRing ring;
    ASSERT_EQ(ring.add(TimePoint{100}, along(1.0F)), RingStatus::ok);
    ring.clear();
    EXPECT_TRUE(ring.empty());
    EXPECT_EQ(ring.add(TimePoint{50}, along(2.0F)), RingStatus::ok);
    EXPECT_EQ(ring.newest().issued.us, 50);
}

}  // namespace
}  // namespace jink::orca
