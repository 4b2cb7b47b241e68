// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include "toolchain/sim/board_line.hpp"

namespace jink::sim {
namespace {

constexpr Micros kMs = 1000;

TEST(BoardClock, GoesByTheWallUntilItIsReported)
{
    BoardClock clock;
    EXPECT_EQ(clock.due(0, 100.0), 0);
    EXPECT_NEAR(static_cast<double>(clock.due(0, 103.5)), 3.5e6, 1.0);
    EXPECT_TRUE(clock.is_free());
}

TEST(BoardClock, WaitsForABoardThatIsHeldUp)
{
    BoardClock clock;
    EXPECT_EQ(clock.due(0, 10.0), 0);
    clock.tell(7'000 * kMs, 500 * kMs, 10.5);  // the board's 7 s are the plant's 0.5 s from now on
    EXPECT_FALSE(clock.is_free());
    EXPECT_EQ(clock.due(500 * kMs, 10.5), 500 * kMs);
    EXPECT_EQ(clock.due(500 * kMs, 10.51), 510 * kMs);
    EXPECT_EQ(clock.due(510 * kMs, 10.6), 520 * kMs);
    EXPECT_EQ(clock.due(520 * kMs, 12.4), 520 * kMs);  // 1.9 s of the wall, a step of the board
    clock.tell(7'020 * kMs, 520 * kMs, 12.4);
    EXPECT_EQ(clock.due(520 * kMs, 12.4), 520 * kMs);
    EXPECT_EQ(clock.times_deaf(), 0U);
}

TEST(BoardClock, ShowsAClockThatJumps)
{
    BoardClock clock;
    clock.tell(1'000 * kMs, 1'000 * kMs, 1.0);
    clock.tell(1'300 * kMs, 1'020 * kMs, 1.3);
    EXPECT_EQ(clock.due(1'020 * kMs, 1.3), 1'300 * kMs);
}

TEST(BoardClock, IsNotHeldUpByADeadBoardAndCountsIt)
{
    BoardClock clock;
    clock.tell(1'000 * kMs, 1'000 * kMs, 1.0);
    EXPECT_EQ(clock.due(1'020 * kMs, 2.99), 1'020 * kMs);
    EXPECT_EQ(clock.due(1'020 * kMs, 3.01), 1'020 * kMs);
    EXPECT_TRUE(clock.is_free());
    EXPECT_EQ(clock.times_deaf(), 1U);
    EXPECT_NEAR(static_cast<double>(clock.due(1'020 * kMs, 4.01)), 2'020e3, 2.0);
    clock.tell(1'100 * kMs, 2'020 * kMs, 4.01);  // alive after all
    EXPECT_EQ(clock.due(2'020 * kMs, 4.01), 2'020 * kMs);
    EXPECT_EQ(clock.times_deaf(), 1U);
}

TEST(BoardClock, LetGoItWaitsForANewLife)
{
    BoardClock clock;
    clock.tell(5'000 * kMs, 1'000 * kMs, 1.0);
    clock.let_go(1'000 * kMs, 1.0);
    clock.tell(5'020 * kMs, 1'010 * kMs, 1.01);  // was in transit
    EXPECT_TRUE(clock.is_free());
    clock.tell(300 * kMs, 1'400 * kMs, 1.4);
    EXPECT_FALSE(clock.is_free());
    EXPECT_EQ(clock.due(1'400 * kMs, 1.4), 1'400 * kMs);
}

TEST(BoardClock, ANewLifeMayBeOlderThanTheLastOneWas)
{
    BoardClock clock;
    clock.tell(200 * kMs, 1'000 * kMs, 1.0);
    clock.let_go(1'000 * kMs, 1.0);
    clock.tell(220 * kMs, 1'500 * kMs, 1.5);  // could be either
    EXPECT_TRUE(clock.is_free());
    clock.tell(900 * kMs, 2'100 * kMs, 2.1);
    EXPECT_FALSE(clock.is_free());
    EXPECT_EQ(clock.due(2'100 * kMs, 2.1), 2'100 * kMs);
}

}  // namespace
}  // namespace jink::sim
