// SPDX-License-Identifier: BSD-3-Clause
// Calls in parallel: each index once, whatever the number of threads, and an exception ends the rest.
#include "toolchain/sim/parallel.hpp"

#include <algorithm>
#include <atomic>
#include <latch>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

namespace jink::sim {
namespace {

TEST(InParallel, EachIndexIsCalledOnceWithAnyNumberOfThreads)
{
    for (const unsigned threads : {0U, 1U, 2U, 7U, 64U}) {
        for (const std::size_t count :
             {std::size_t{0}, std::size_t{1}, std::size_t{2}, std::size_t{63}, std::size_t{1000}}) {
            std::vector<std::atomic<unsigned>> calls(count);
            in_parallel(count, threads, [&](std::size_t i) { ++calls.at(i); });
            EXPECT_TRUE(std::all_of(calls.begin(), calls.end(), [](const auto& n) { return n == 1U; }))
                << count << " calls, " << threads << " threads";
        }
    }
}

/// Both calls wait for each other: one thread alone would wait for ever.
TEST(InParallel, TwoCallsRunAtOnce)
{
    std::latch both(2);
    in_parallel(2, 2, [&](std::size_t) { both.arrive_and_wait(); });
    EXPECT_TRUE(both.try_wait());
}

TEST(InParallel, OneThreadKeepsTheOrder)
{
    std::vector<std::size_t> order;
    in_parallel(100, 1, [&](std::size_t i) { order.push_back(i); });
    EXPECT_EQ(order.size(), 100U);
    EXPECT_TRUE(std::is_sorted(order.begin(), order.end()));
}

TEST(InParallel, NoCallBeginsAfterAFailure)
{
    std::vector<std::size_t> called;
    try {
        in_parallel(100, 1, [&](std::size_t i) {
            called.push_back(i);
            if (i == 5) {
                throw std::runtime_error("fifth");
            }
        });
        ADD_FAILURE() << "nothing was thrown";
    } catch (const std::runtime_error& e) {
        EXPECT_EQ(e.what(), std::string("fifth"));
    }
    EXPECT_EQ(called, (std::vector<std::size_t>{0, 1, 2, 3, 4, 5}));
}

/// A call that fails while the other is under way: both end before the exception arrives.
TEST(InParallel, CallsUnderWayEndBeforeTheExceptionArrives)
{
    std::latch begun(2);
    std::atomic<bool> failed{false};
    std::atomic<bool> ended{false};
    EXPECT_THROW(in_parallel(2, 2,
                             [&](std::size_t i) {
                                 begun.arrive_and_wait();
                                 if (i == 0) {
                                     failed = true;
                                     throw std::logic_error("first");
                                 }
                                 while (!failed) {
                                     std::this_thread::yield();
                                 }
                                 ended = true;
                             }),
                 std::logic_error);
    EXPECT_TRUE(ended);
}

/// All calls fail at once: one exception arrives, and it is one of theirs.
TEST(InParallel, OneOfManyExceptionsArrives)
{
    constexpr std::size_t kCalls = 8;
    std::latch begun(kCalls);
    try {
        in_parallel(kCalls, kCalls, [&](std::size_t i) {
            begun.arrive_and_wait();
            throw i;
        });
        ADD_FAILURE() << "nothing was thrown";
    } catch (const std::size_t i) {
        EXPECT_LT(i, kCalls);
    }
}

}  // namespace
}  // namespace jink::sim
