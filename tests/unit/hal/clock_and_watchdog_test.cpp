// SPDX-License-Identifier: BSD-3-Clause
#include <ctime>

#include <gtest/gtest.h>

#include "hal/linux/system_clock.hpp"
#include "hal/memory/counting_watchdog.hpp"
#include "hal/memory/manual_clock.hpp"

namespace jink::hal {
namespace {

TEST(CountingWatchdog, CountsFeeds)
{
    CountingWatchdog watchdog;
    EXPECT_EQ(watchdog.feeds(), 0U);
    Watchdog& as_port = watchdog;
    as_port.feed();
    as_port.feed();
    EXPECT_EQ(watchdog.feeds(), 2U);
}

TEST(SystemClock, NeverRunsBackwardsAndAgreesWithTheKernel)
{
    SystemClock clock;
    std::int64_t last = clock.now_us();
    for (int i = 0; i < 100'000; ++i) {
        const std::int64_t now = clock.now_us();
        ASSERT_GE(now, last);
        last = now;
    }
    timespec before{};
    timespec after{};
    ::clock_gettime(CLOCK_MONOTONIC, &before);
    const std::int64_t now = clock.now_us();
    ::clock_gettime(CLOCK_MONOTONIC, &after);
    EXPECT_GE(now, before.tv_sec * 1'000'000 + before.tv_nsec / 1'000);
    EXPECT_LE(now, after.tv_sec * 1'000'000 + after.tv_nsec / 1'000);
}

TEST(ManualClock, MovesOnlyWhenReported)
{
    ManualClock clock(-7);
    EXPECT_EQ(clock.now_us(), -7);
    EXPECT_EQ(clock.now_us(), -7);
    clock.advance(10);
    clock.advance(0);
    EXPECT_EQ(clock.now_us(), 3);
}

}  // namespace
}  // namespace jink::hal
