// SPDX-License-Identifier: BSD-3-Clause
// The flash in memory that replaces a chip's on hosts.
#include "tests/memory_flash.hpp"

#include <gtest/gtest.h>

namespace jink::hal {
namespace {

constexpr std::uint32_t kErasedWord = 0xFFFFFFFF;

TEST(MemoryFlash, TakesBitsFromOneToZeroAndErasesSectorsAsAWhole)
{
    MemoryFlash<64> flash;
    EXPECT_TRUE(flash.program(0, 60, 0xF0F0F0F0));
    EXPECT_FALSE(flash.program(0, 60, 0xFF00FF00));
    EXPECT_EQ(flash.read(0, 60), 0xF000F000U);
    EXPECT_TRUE(flash.program(1, 0, 7));
    EXPECT_TRUE(flash.erase(0));
    EXPECT_EQ(flash.read(0, 60), kErasedWord);
    EXPECT_EQ(flash.read(1, 0), 7U);
    EXPECT_EQ(flash.steps(), 3U + 16U);
    EXPECT_EQ(flash.erases(), 1U);
}

TEST(MemoryFlash, ACutLeavesPartOfAStepAndNothingOfLaterOnes)
{
    MemoryFlash<16> flash;
    flash.cut_at(1, 0x0000FFFF);
    EXPECT_TRUE(flash.program(0, 0, 0));
    EXPECT_FALSE(flash.program(0, 4, 0));
    EXPECT_TRUE(flash.is_cut());
    EXPECT_FALSE(flash.program(0, 8, 0));
    EXPECT_FALSE(flash.erase(0));
    EXPECT_EQ(flash.read(0, 4), 0xFFFF0000U);
    EXPECT_EQ(flash.read(0, 8), kErasedWord);
    flash.restore();
    EXPECT_TRUE(flash.program(0, 8, 1));
    flash.cut_at(2, 1);
    EXPECT_FALSE(flash.erase(0));
    flash.restore();
    EXPECT_EQ(flash.read(0, 0), kErasedWord);
    EXPECT_EQ(flash.read(0, 4), kErasedWord);
    EXPECT_EQ(flash.read(0, 8), 1U) << "bit 0 was set already";
    EXPECT_EQ(flash.read(0, 12), kErasedWord);
}

TEST(MemoryFlash, AUnitWithACodeIsProgrammedOnceAfterAnErase)
{
    MemoryFlash<64, 32> flash;
    const std::array<std::uint32_t, 8> unit{1, 2, 3, 4, 5, 6, 7, 8};
    EXPECT_TRUE(flash.program(0, 32, unit));
    EXPECT_EQ(flash.read(0, 36), 2U);
    EXPECT_FALSE(flash.program(0, 32, unit)) << "the same again leaves a wrong code too";
    EXPECT_EQ(flash.read(0, 36), std::nullopt);
    EXPECT_EQ(flash.read(0, 28), kErasedWord) << "of another unit";
    EXPECT_TRUE(flash.erase(0));
    EXPECT_EQ(flash.read(0, 36), kErasedWord);
    EXPECT_TRUE(flash.program(0, 32, unit));
    EXPECT_EQ(flash.steps(), 5U);
}

TEST(MemoryFlash, ACutWithinAUnitWithACodeMakesItUnreadableUnlessNothingOrAllHasChanged)
{
    const std::array<std::uint32_t, 8> unit{};
    for (const std::uint32_t mask : {0U, 1U, 0x0FF0U, ~0U}) {
        MemoryFlash<64, 32> flash;
        flash.cut_at(0, mask);
        EXPECT_FALSE(flash.program(1, 0, unit));
        flash.restore();
        EXPECT_EQ(flash.read(1, 0), mask == 0     ? std::optional(kErasedWord)
                                    : mask == ~0U ? std::optional(0U)
                                                  : std::nullopt);
    }
    MemoryFlash<64, 32, WrongCode::as_it_looks> missed;
    missed.cut_at(0, 1);
    EXPECT_FALSE(missed.program(1, 0, unit));
    EXPECT_EQ(missed.read(1, 0), kErasedWord - 1U);
}

}  // namespace
}  // namespace jink::hal
