// SPDX-License-Identifier: BSD-3-Clause
#include "hal/fiber.hpp"

#include <array>
#include <cmath>
#include <cstdint>
#include <memory>
#include <vector>

#include <gtest/gtest.h>

namespace jink::hal {
namespace {

using Stack = std::array<std::byte, 64 * 1024>;

struct Notes {
    Fiber* fiber = nullptr;
    std::vector<int> written;
    double sum = 0.0;
};

void count(void* argument) noexcept
{
    Notes& notes = *static_cast<Notes*>(argument);
    for (int i = 0; i < 3; ++i) {
        notes.written.push_back(i);
        notes.fiber->pause();
    }
    notes.written.push_back(3);
}

TEST(Fiber, RunsFromPauseToPauseToItsEnd)
{
    const auto stack = std::make_unique<Stack>();
    Fiber fiber(*stack);
    Notes notes{&fiber, {}};
    EXPECT_FALSE(fiber.runs());
    fiber.resume();
    fiber.begin(&count, &notes);
    EXPECT_TRUE(fiber.runs());
    EXPECT_TRUE(notes.written.empty()) << "begun, not resumed";
    for (int i = 0; i < 4; ++i) {
        EXPECT_TRUE(fiber.runs());
        fiber.resume();
        EXPECT_EQ(notes.written.size(), static_cast<std::size_t>(i) + 1);
    }
    EXPECT_FALSE(fiber.runs());
    fiber.resume();
    EXPECT_EQ(notes.written, (std::vector{0, 1, 2, 3}));
}

TEST(Fiber, BeginsAnewAfterItsEndAndInPlaceOfWhatIsDropped)
{
    const auto stack = std::make_unique<Stack>();
    Fiber fiber(*stack);
    Notes notes{&fiber, {}};
    for (int i = 0; i < 100; ++i) {
        notes.written.clear();
        fiber.begin(&count, &notes);
        for (int k = 0; k < i % 5; ++k) {
            fiber.resume();
        }
        EXPECT_EQ(notes.written.size(), static_cast<std::size_t>(i % 5));
        if (i % 3 == 0) {
            fiber.drop();
            EXPECT_FALSE(fiber.runs());
            fiber.resume();
            EXPECT_EQ(notes.written.size(), static_cast<std::size_t>(i % 5)) << "what is dropped does not go on";
        }
    }
}

/// Sums by recursion, pausing at every level: registers and frames have to survive.
double harmonic(Notes& notes, int n) noexcept
{
    const double share = 1.0 / n;
    notes.fiber->pause();
    const double rest = n > 1 ? harmonic(notes, n - 1) : 0.0;
    notes.fiber->pause();
    return share + rest;
}

void sum_up(void* argument) noexcept
{
    Notes& notes = *static_cast<Notes*>(argument);
    notes.sum = harmonic(notes, 100);
}

TEST(Fiber, KeepsFramesAndNumbersOfBothFlows)
{
    const auto stack = std::make_unique<Stack>();
    Fiber fiber(*stack);
    Notes notes{&fiber, {}};
    fiber.begin(&sum_up, &notes);
    double mine = 0.0;
    int turns = 0;
    std::array<double, 12> many{};
    while (fiber.runs()) {
        for (std::size_t i = 0; i < many.size(); ++i) {
            many[i] = mine + static_cast<double>(i) * 0.1;
        }
        fiber.resume();
        ++turns;
        for (std::size_t i = 0; i < many.size(); ++i) {
            ASSERT_EQ(many[i], mine + static_cast<double>(i) * 0.1) << turns;
        }
        mine += std::sqrt(static_cast<double>(turns));
    }
    EXPECT_EQ(turns, 201);
    double expected = 0.0;
    for (int n = 1; n <= 100; ++n) {
        expected = 1.0 / n + expected;
    }
    EXPECT_EQ(notes.sum, expected);
    EXPECT_GT(fiber.deepest(), 1000U);
    EXPECT_LT(fiber.deepest(), stack->size() / 2);
}

struct Two {
    Fiber* inner;
    Fiber* outer;
    Notes* notes;
};

void resume_inner(void* argument) noexcept
{
    const Two& two = *static_cast<Two*>(argument);
    while (two.inner->runs()) {
        two.inner->resume();
        two.outer->pause();
    }
}

TEST(Fiber, MayResumeAnother)
{
    const auto stacks = std::make_unique<std::array<Stack, 2>>();
    Fiber inner((*stacks)[0]);
    Fiber outer((*stacks)[1]);
    Notes notes{&inner, {}};
    Two two{&inner, &outer, &notes};
    inner.begin(&count, &notes);
    outer.begin(&resume_inner, &two);
    int turns = 0;
    while (outer.runs()) {
        outer.resume();
        ++turns;
    }
    EXPECT_EQ(turns, 5);
    EXPECT_EQ(notes.written, (std::vector{0, 1, 2, 3}));
}

/// A stack of any size and place is used from its top, and of it no more than there is.
TEST(Fiber, StackOfAnyAlignment)
{
    const auto stack = std::make_unique<Stack>();
    for (std::size_t offset = 0; offset < 16; ++offset) {
        Fiber fiber(std::span<std::byte>(*stack).subspan(offset, 32 * 1024 - 2 * offset));
        Notes notes{&fiber, {}};
        fiber.begin(&sum_up, &notes);
        while (fiber.runs()) {
            fiber.resume();
        }
        EXPECT_NEAR(notes.sum, 5.187377517639621, 1e-12) << offset;
        EXPECT_LE(fiber.deepest(), 32 * 1024 - 2 * offset);
    }
}

}  // namespace
}  // namespace jink::hal
