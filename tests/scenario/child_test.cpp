// SPDX-License-Identifier: BSD-3-Clause
#include "toolchain/sim/child.hpp"

#include <chrono>
#include <thread>

#include <gtest/gtest.h>

namespace jink::sim {
namespace {

void pause() { std::this_thread::sleep_for(std::chrono::milliseconds(200)); }

TEST(Child, ThatSleepsWaitsForNoProcessor)
{
    const Child child({"sleep", "60"}, "/dev/null");
    pause();
    const Child::Processor before = child.look({});
    pause();
    const Child::Processor after = child.look(before);
    EXPECT_FALSE(after.waiting);
    EXPECT_EQ(after.ran, before.ran);
}

/// A program that is busy with itself is not taken for one that the machine starves: its time runs.
TEST(Child, ThatNeverEndsItsLoopIsNotExcused)
{
    const Child child({"sh", "-c", "while :; do :; done"}, "/dev/null");
    Child::Processor before = child.look({});
    bool ran = false;
    for (int i = 0; i < 50 && !ran; ++i) {  // its turn comes at some time
        pause();
        const Child::Processor after = child.look(before);
        EXPECT_EQ(after.waiting, after.ran == before.ran);
        ran = after.ran > before.ran;
        before = after;
    }
    EXPECT_TRUE(ran);
}

}  // namespace
}  // namespace jink::sim
