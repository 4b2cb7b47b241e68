// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/app/work_rate.hpp"

#include <gtest/gtest.h>

namespace jink::app {
namespace {

/// In double precision, by what WorkRate says of itself.
double share(unsigned megahertz, double percent) { return megahertz * 1e6 * 0.02 / 1.5 * percent / 100.0; }

TEST(WorkRates, FillTheirSharesOfTheTickAndNoMore)
{
    for (unsigned clock = 150; clock <= 4000; ++clock) {
        const WorkRate rate = WorkRate::of_megahertz(clock);
        const avoid::WorkPerUpdate work = rate.work();
        ASSERT_TRUE(avoid::is_valid(work)) << clock;
        ASSERT_TRUE(rate.has_time_for(work)) << clock;
        ASSERT_LE(work.all * 170.0 + 130'000.0, share(clock, 80.0)) << clock;
        ASSERT_LE((work.all - work.slice) * 170.0 + 130'000.0, share(clock, 50.0)) << clock;
        ASSERT_GT((work.all + 2) * 170.0 + 130'000.0, share(clock, 80.0)) << clock;
        ASSERT_FALSE(rate.has_time_for({work.all + 2, work.slice})) << clock;
        ASSERT_FALSE(rate.has_time_for({work.all, work.slice - 2})) << clock << ", the mandatory part";
    }
}

TEST(WorkRates, OfTheBoards)
{
    EXPECT_EQ(WorkRate(168'000'000).work(), (avoid::WorkPerUpdate{9776, 3953}));
    EXPECT_EQ(WorkRate(216'000'000).work(), (avoid::WorkPerUpdate{12788, 5083}));
    EXPECT_TRUE(WorkRate(480'000'000).has_time_for(WorkRate(216'000'000).work()));
    EXPECT_FALSE(WorkRate(168'000'000).has_time_for(WorkRate(216'000'000).work()));
    EXPECT_EQ(WorkRate::most({9776, 3953}), 1'791'920U) << "of 2 240 000 in a tick";
}

TEST(WorkRates, TooSlowAClockLeavesNothing)
{
    EXPECT_EQ(WorkRate(1'000'000).work(), (avoid::WorkPerUpdate{0, 0}));
    EXPECT_FALSE(avoid::is_valid(WorkRate(1'000'000).work()));
}

}  // namespace
}  // namespace jink::app
