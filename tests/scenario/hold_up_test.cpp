// SPDX-License-Identifier: BSD-3-Clause
#include "toolchain/sim/hold_up.hpp"

#include <chrono>
#include <thread>
#include <utility>

#include <gtest/gtest.h>
#include <sched.h>

namespace jink::sim {
namespace {

constexpr pid_t kMain = 7;
constexpr pid_t kProcessor = 8;

HoldUp::Sample sample(double wall, Child::Thread main, Child::Thread processor, double stolen = 0.0)
{
    return {wall, stolen, {{kMain, main}, {kProcessor, processor}}};
}

TEST(HoldUp, IsTheLongestWaitOfAnyThread)
{
    HoldUp hold_up;
    EXPECT_EQ(hold_up.look(sample(1.00, {5.0, 3.0, false}, {9.0, 4.0, true})), 0.0);
    EXPECT_EQ(hold_up.look(sample(1.02, {5.0, 3.0, false}, {9.01, 4.0, true})), 0.0);
    EXPECT_NEAR(hold_up.look(sample(1.04, {5.0, 3.004, true}, {9.02, 4.007, true})), 0.007, 1e-9);
    EXPECT_NEAR(hold_up.look(sample(1.06, {5.01, 3.024, true}, {9.03, 4.007, true})), 0.020, 1e-9);
    EXPECT_EQ(hold_up.look(sample(1.08, {5.02, 3.024, true}, {9.03, 4.007, false})), 0.0);
    EXPECT_NEAR(hold_up.longest(), 0.020, 1e-9);
}

TEST(HoldUp, CountsAWaitThatStillGoesOn)
{
    HoldUp hold_up;
    constexpr Child::Thread kAsleep{1.0, 0.0, false};
    static_cast<void>(hold_up.look(sample(1.00, kAsleep, {1.0, 0.0, false})));
    EXPECT_EQ(hold_up.look(sample(1.02, kAsleep, {1.0, 0.0, true})), 0.0);  // perhaps just before its turn
    EXPECT_NEAR(hold_up.look(sample(1.04, kAsleep, {1.0, 0.0, true})), 0.02, 1e-9);
    EXPECT_NEAR(hold_up.look(sample(1.06, kAsleep, {1.0, 0.0, true})), 0.04, 1e-9);
    EXPECT_NEAR(hold_up.look(sample(1.08, kAsleep, {1.01, 0.07, true})), 0.07, 1e-9);
    EXPECT_EQ(hold_up.look(sample(1.10, kAsleep, {1.02, 0.07, true})), 0.0);
}

TEST(HoldUp, IsTimeGivenToOtherMachinesAndTimeWithoutALook)
{
    HoldUp hold_up;
    constexpr Child::Thread kAsleep{1.0, 0.0, false};
    static_cast<void>(hold_up.look(sample(1.00, kAsleep, kAsleep, 50.0)));
    EXPECT_EQ(hold_up.look(sample(1.03, kAsleep, kAsleep, 50.0)), 0.0);
    EXPECT_NEAR(hold_up.look(sample(1.05, kAsleep, kAsleep, 50.3)), 0.3, 1e-9);
    EXPECT_NEAR(hold_up.look(sample(1.45, kAsleep, kAsleep, 50.3)), 0.4, 1e-9);
}

TEST(HoldUp, KnowsNothingOfAThreadThatIsNew)
{
    HoldUp hold_up;
    static_cast<void>(hold_up.look({1.0, 0.0, {{kMain, {1.0, 0.0, false}}}}));
    EXPECT_EQ(hold_up.look(sample(1.02, {1.0, 0.0, false}, {3.0, 2.0, true})), 0.0);
}

TEST(HoldUp, WhatFailsIsRunAgainOnlyWhereTheMachineStoodStill)
{
    const auto attempts = [](double held_up_s, int fails) {
        int runs = 0;
        const int failures = run_unheld([&](int attempt, double& held_up) {
            EXPECT_EQ(attempt, ++runs);
            held_up = held_up_s;
            return attempt <= fails ? 2 : 0;
        });
        return std::pair(runs, failures);
    };
    EXPECT_EQ(attempts(0.05, 9), std::pair(1, 2));
    EXPECT_EQ(attempts(0.2, 9), std::pair(4, 2));
    EXPECT_EQ(attempts(0.2, 3), std::pair(4, 0));
    EXPECT_EQ(attempts(0.2, 1), std::pair(2, 0));
    EXPECT_EQ(attempts(0.2, 0), std::pair(1, 0));
}

void pause() { std::this_thread::sleep_for(std::chrono::milliseconds(20)); }

double wall() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

TEST(HoldUp, AProgramThatSleepsWaitsForNoProcessor)
{
    const Child child({"sleep", "60"}, "/dev/null");
    for (int i = 0; i < 10; ++i) {
        pause();
        const Child::Threads threads = child.threads();
        ASSERT_EQ(threads.size(), 1U);
        EXPECT_FALSE(i > 5 && threads.begin()->second.ready);
    }
}

/// A busy program does not count as delayed by the host: its processor time increases.
TEST(HoldUp, AProgramThatNeverEndsItsLoopIsNotExcused)
{
    const Child child({"sh", "-c", "while :; do :; done"}, "/dev/null");
    const auto ran = [&] { return child.threads().begin()->second.ran; };
    const double before = ran();
    bool runs = false;
    for (int i = 0; i < 500 && !runs; ++i) {  // its turn comes at some time
        pause();
        runs = ran() > before;
    }
    EXPECT_TRUE(runs);
    EXPECT_TRUE(child.threads().begin()->second.ready);
}

/// Two programs and one processor: each waits while the other one runs.
TEST(HoldUp, AProgramThatSharesItsProcessorIsHeldUp)
{
    cpu_set_t before;
    ASSERT_EQ(::sched_getaffinity(0, sizeof before, &before), 0);
    cpu_set_t one;
    CPU_ZERO(&one);
    for (std::size_t i = 0; i < CPU_SETSIZE && CPU_COUNT(&one) == 0; ++i) {
        if (CPU_ISSET(i, &before)) {
            CPU_SET(i, &one);
        }
    }
    ASSERT_EQ(::sched_setaffinity(0, sizeof one, &one), 0);  // theirs, too
    const Child first({"sh", "-c", "while :; do :; done"}, "/dev/null");
    const Child second({"sh", "-c", "while :; do :; done"}, "/dev/null");
    ASSERT_EQ(::sched_setaffinity(0, sizeof before, &before), 0);
    HoldUp hold_up;
    for (int i = 0; i < 500 && hold_up.longest() <= 0.001; ++i) {
        pause();
        HoldUp::Sample now = HoldUp::sample(first, wall());
        now.wall = 0.02 * i;  // neither this test's own waiting nor stolen time is meant
        now.stolen = 0.0;
        static_cast<void>(hold_up.look(now));
    }
    EXPECT_GT(hold_up.longest(), 0.001);
}

}  // namespace
}  // namespace jink::sim
