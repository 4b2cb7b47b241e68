// SPDX-License-Identifier: BSD-3-Clause
// Parameters in flash: cuts at every word, damage, records of other versions.
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "firmware/app/param_flash.hpp"
#include "tests/memory_flash.hpp"

namespace jink::app {
namespace {

constexpr std::uint32_t kSmall = 512;
using SmallFlash = hal::MemoryFlash<kSmall>;
using RoomyFlash = hal::MemoryFlash<4096>;

ParamValues own() { return Parameters().values(); }

ParamValues own_with(Param p, float value)
{
    ParamValues values = own();
    values[static_cast<std::size_t>(p)] = value;
    return values;
}

/// The parameters after a restart.
ParamValues restarted(hal::FlashRegion& flash, ParamLoad* load = nullptr)
{
    ParamFlash store(flash);
    ParamValues values = own();
    const ParamLoad found = store.load(values);
    if (load != nullptr) {
        *load = found;
    }
    return values;
}

bool saved(hal::FlashRegion& flash, const ParamValues& values)
{
    ParamFlash store(flash);
    ParamValues before = own();
    static_cast<void>(store.load(before));
    return store.save(own(), values);
}

/// A record, made by hand from the header's text: another checksum's code than that of the store.
std::vector<std::uint32_t> record_of(std::uint32_t sequence, const std::vector<std::pair<std::string, float>>& entries)
{
    std::vector<std::uint32_t> words{0x014B4E8A, sequence, static_cast<std::uint32_t>(entries.size())};
    for (const auto& [name, value] : entries) {
        std::string padded = name;
        padded.resize(16, '\0');
        for (std::size_t i = 0; i < 16; i += 4) {
            std::uint32_t word = 0;
            std::memcpy(&word, padded.data() + i, 4);
            words.push_back(word);
        }
        words.push_back(std::bit_cast<std::uint32_t>(value));
    }
    std::uint32_t crc = 0xFFFFFFFF;
    for (const std::uint32_t word : words) {
        for (int bit = 0; bit < 32; ++bit) {
            const std::uint32_t differs = (crc ^ (word >> bit)) & 1U;
            crc = (crc >> 1U) ^ (differs != 0 ? 0xEDB88320U : 0U);
        }
    }
    words.push_back(~crc);
    return words;
}

void put(hal::FlashRegion& flash, std::uint32_t sector, std::uint32_t offset, const std::vector<std::uint32_t>& words)
{
    for (std::size_t i = 0; i < words.size(); ++i) {
        ASSERT_TRUE(flash.program(sector, offset + static_cast<std::uint32_t>(4 * i), words[i]));
    }
}

TEST(ParamFlash, ErasedFlashHoldsNothing)
{
    SmallFlash flash;
    ParamLoad load;
    EXPECT_EQ(restarted(flash, &load), own());
    EXPECT_EQ(load.taken, 0U);
    EXPECT_FALSE(load.damaged);
    EXPECT_EQ(flash.steps(), 0U) << "nothing is written by looking";
}

TEST(ParamFlash, AllParametersComeBackBitForBit)
{
    RoomyFlash flash;
    ParamValues values = own();
    for (std::size_t i = 0; i < kParamCount; ++i) {
        values[i] = std::nextafter(values[i], 1e9F);
    }
    ASSERT_TRUE(saved(flash, values));
    ParamLoad load;
    EXPECT_EQ(restarted(flash, &load), values);
    EXPECT_EQ(load.taken, kParamCount);
    EXPECT_EQ(flash.steps(), 3U + 5U * kParamCount + 1U);
    ASSERT_TRUE(saved(flash, own())) << "and back";
    EXPECT_EQ(restarted(flash), own());
}

TEST(ParamFlash, TheRecordIsTheDocumentedOne)
{
    RoomyFlash flash;
    ASSERT_TRUE(saved(flash, own_with(Param::track_age, 7.3F)));
    const auto expected = record_of(1, {{"TRK_AGE", 7.3F}});
    for (std::size_t i = 0; i < expected.size(); ++i) {
        EXPECT_EQ(flash.read(0, static_cast<std::uint32_t>(4 * i)), expected[i]) << i;
    }
    ASSERT_TRUE(saved(flash, own_with(Param::sigma_compared, 4.0F)));
    EXPECT_EQ(flash.read(0, 64), expected[0]);
    EXPECT_EQ(flash.read(0, 68), 2U);
    put(flash, 0, 128, record_of(3, {{"JNK_MODE", 1.0F}, {"TRK_AGE", 9.5F}}));
    ParamValues both = own_with(Param::track_age, 9.5F);
    both[0] = 1.0F;
    EXPECT_EQ(restarted(flash), both);
}

TEST(ParamFlash, NamesThatThereAreNoMoreAreCountedAndTheOthersTaken)
{
    RoomyFlash flash;
    put(flash, 1, 0, record_of(7, {{"OLD_NAME", 1.0F}, {"TRK_AGE", 9.0F}, {"A_NAME_OF_16_CHR", 2.0F}}));
    ParamLoad load;
    EXPECT_EQ(restarted(flash, &load), own_with(Param::track_age, 9.0F));
    EXPECT_EQ(load.taken, 3U);
    EXPECT_EQ(load.unknown, 2U);
    ASSERT_TRUE(saved(flash, own_with(Param::track_age, 8.0F)));
    EXPECT_EQ(flash.read(1, 128 + 4), 8U) << "behind it, in its sector";
}

TEST(ParamFlash, TheSameValuesAreNotWrittenAgain)
{
    SmallFlash flash;
    ASSERT_TRUE(saved(flash, own_with(Param::track_age, 9.0F)));
    const std::uint64_t steps = flash.steps();
    EXPECT_TRUE(saved(flash, own_with(Param::track_age, 9.0F)));
    EXPECT_EQ(flash.steps(), steps);
    EXPECT_TRUE(saved(flash, own_with(Param::track_age, 9.5F)));
    EXPECT_GT(flash.steps(), steps);
}

TEST(ParamFlash, ACutAtAnyWordLeavesTheValuesBeforeOrAfterTheChange)
{
    // Nineteen changes: three sectors are filled, so the second and the third by an erase. Of the word that is cut no
    // bit, all bits or every other bit has changed.
    constexpr int kChanges = 19;
    const auto values_of = [](int change) {
        return change == 0 ? own() : own_with(Param::track_age, 1.0F + 0.1F * static_cast<float>(change));
    };
    SmallFlash uncut;
    for (int i = 1; i <= kChanges; ++i) {
        ASSERT_TRUE(saved(uncut, values_of(i)));
    }
    ASSERT_EQ(uncut.erases(), 2U);
    int before = 0;
    int after = 0;
    for (std::uint64_t step = 0; step < uncut.steps(); ++step) {
        for (const std::uint32_t mask : {0U, 0x55555555U, ~0U}) {
            SmallFlash flash;
            flash.cut_at(step, mask);
            int change = 1;
            for (; saved(flash, values_of(change)); ++change) {
                ASSERT_LT(change, kChanges);
            }
            flash.restore();
            const ParamValues left = restarted(flash);
            ASSERT_TRUE(left == values_of(change - 1) || left == values_of(change)) << "step " << step;
            ++(left == values_of(change) ? after : before);
            for (; change <= kChanges; ++change) {
                ASSERT_TRUE(saved(flash, values_of(change))) << "step " << step << " change " << change;
                ASSERT_EQ(restarted(flash), values_of(change)) << "step " << step << " change " << change;
            }
        }
    }
    EXPECT_GT(before, 1000);
    EXPECT_EQ(after, kChanges) << "the last word of each, whole";
}

TEST(ParamFlash, ACutWithinARecordOfAllParametersLeavesNoMixture)
{
    ParamValues first = own();
    ParamValues second = own();
    for (std::size_t i = 0; i < kParamCount; ++i) {
        first[i] = std::nextafter(first[i], 1e9F);
        second[i] = std::nextafter(second[i], -1e9F);
    }
    for (std::uint64_t step = 0; step < 3U + 5U * kParamCount + 1U; ++step) {
        for (const std::uint32_t mask : {0U, 0x0F0F0F0FU}) {
            RoomyFlash flash;
            ASSERT_TRUE(saved(flash, first));
            flash.cut_at(step, mask);
            ASSERT_FALSE(saved(flash, second));
            flash.restore();
            ASSERT_EQ(restarted(flash), first) << step;
        }
    }
}

TEST(ParamFlash, OneFlippedBitAnywhereInTheNewestRecordLeavesTheOneBefore)
{
    for (std::uint32_t bit = 0; bit < 32U * 9U; ++bit) {
        SmallFlash flash;
        ASSERT_TRUE(saved(flash, own_with(Param::track_age, 8.0F)));
        ASSERT_TRUE(saved(flash, own_with(Param::track_age, 9.0F)));
        flash.flip(0, 64 + bit / 32U * 4U, 1U << bit % 32U);
        ASSERT_EQ(restarted(flash), own_with(Param::track_age, 8.0F)) << bit;
        ASSERT_TRUE(saved(flash, own_with(Param::track_age, 10.0F)));
        ASSERT_EQ(restarted(flash), own_with(Param::track_age, 10.0F)) << bit;
    }
}

TEST(ParamFlash, ASectorThatIsDamagedAsAWholeLeavesTheOther)
{
    SmallFlash flash;
    for (int i = 1; i <= 10; ++i) {  // eight in the first sector
        ASSERT_TRUE(saved(flash, own_with(Param::track_age, static_cast<float>(i))));
    }
    for (std::uint32_t offset = 0; offset < kSmall; offset += 4) {
        flash.flip(1, offset, 0x00010000);
    }
    EXPECT_EQ(restarted(flash), own_with(Param::track_age, 8.0F));
    ASSERT_TRUE(saved(flash, own_with(Param::track_age, 11.0F))) << "by an erase of the damaged one";
    EXPECT_EQ(restarted(flash), own_with(Param::track_age, 11.0F));
    EXPECT_EQ(flash.erases(), 2U);
}

TEST(ParamFlash, RecordsOfWhichNoneIsWholeAreDamage)
{
    SmallFlash flash;
    ASSERT_TRUE(saved(flash, own_with(Param::track_age, 8.0F)));
    flash.flip(0, 8, 0x80000000);  // a number of values beyond the sector
    ParamLoad load;
    EXPECT_EQ(restarted(flash, &load), own());
    EXPECT_TRUE(load.damaged);
    EXPECT_EQ(load.taken, 0U);
    ASSERT_TRUE(saved(flash, own_with(Param::track_age, 9.0F)));
    EXPECT_EQ(restarted(flash, &load), own_with(Param::track_age, 9.0F));
    EXPECT_FALSE(load.damaged);
}

TEST(ParamFlash, WhatAnotherProgramLeftInBothSectorsIsErasedAndNoDamage)
{
    SmallFlash flash;
    for (std::uint32_t offset = 0; offset < kSmall; offset += 4) {
        flash.flip(0, offset, ~0U);
        flash.flip(1, offset, offset * 2654435761U);
    }
    ParamLoad load;
    EXPECT_EQ(restarted(flash, &load), own());
    EXPECT_FALSE(load.damaged);
    ASSERT_TRUE(saved(flash, own_with(Param::track_age, 9.0F)));
    EXPECT_EQ(restarted(flash), own_with(Param::track_age, 9.0F));
    EXPECT_EQ(flash.erases(), 1U);
}

/// Flash with configurable faults.
class FailingFlash final : public hal::FlashRegion {
public:
    std::uint32_t sector_bytes() const noexcept override { return kSmall; }
    std::uint32_t read(std::uint32_t sector, std::uint32_t offset) const noexcept override
    {
        return inner.read(sector, offset);
    }
    bool program(std::uint32_t sector, std::uint32_t offset, std::uint32_t word) noexcept override
    {
        const bool done = programs && inner.program(sector, offset, lies || drops ? word & 0xFFFF0000U : word);
        return drops || (done && !lies);
    }
    bool erase(std::uint32_t sector) noexcept override { return erases && (leaves || inner.erase(sector)); }

    SmallFlash inner;
    bool programs = true, erases = true;
    bool lies = false;    ///< other words than those asked for
    bool drops = false;   ///< the same, and reports success
    bool leaves = false;  ///< reports erased, and is not
};

TEST(ParamFlash, AFailureIsCountedAndKeepsWhatIsThere)
{
    FailingFlash flash;
    ParamFlash store(flash);
    ParamValues values = own();
    static_cast<void>(store.load(values));
    for (int i = 1; i <= 8; ++i) {
        ASSERT_TRUE(store.save(own(), own_with(Param::track_age, static_cast<float>(i))));
    }
    const auto expect_failure = [&](const char* what) {
        const std::uint32_t failures = store.diagnostics().failures;
        EXPECT_FALSE(store.save(own(), own_with(Param::track_age, 20.0F))) << what;
        EXPECT_EQ(store.diagnostics().failures, failures + 1) << what;
        EXPECT_EQ(restarted(flash), own_with(Param::track_age, 8.0F)) << what;
    };
    flash.erases = false;
    expect_failure("the sector is full and the other cannot be erased");
    flash.erases = true;
    flash.leaves = true;
    flash.inner.flip(1, 64, 1);
    expect_failure("the other says that it is erased");
    flash.leaves = false;
    flash.programs = false;
    expect_failure("nothing can be programmed");
    flash.programs = true;
    flash.lies = true;
    for (int i = 0; i < 20; ++i) {  // beyond the end of the other sector
        expect_failure("other words");
    }
    flash.lies = false;
    flash.drops = true;
    expect_failure("other words, said to be right");
    flash.drops = false;
    EXPECT_TRUE(store.save(own(), own_with(Param::track_age, 20.0F)));
    EXPECT_EQ(restarted(flash), own_with(Param::track_age, 20.0F));
    EXPECT_EQ(store.diagnostics().writes, 9U);
}

TEST(ParamFlash, ARecordThatFitsNoSectorIsRefusedWithoutAnErase)
{
    SmallFlash flash;
    ParamValues values = own();
    for (std::size_t i = 0; i < kParamCount; ++i) {
        values[i] = std::nextafter(values[i], 1e9F);
    }
    ASSERT_TRUE(saved(flash, own_with(Param::track_age, 8.0F)));
    EXPECT_FALSE(saved(flash, values));
    EXPECT_EQ(flash.erases(), 0U);
    EXPECT_EQ(restarted(flash), own_with(Param::track_age, 8.0F));
}

TEST(ParamFlash, ARecordThatFillsASectorToItsEndFits)
{
    hal::MemoryFlash<256> flash;  // twelve values: 64 words
    for (const float offset : {1.0F, 2.0F, 3.0F}) {
        ParamValues values = own();
        for (std::size_t i = 0; i < 12; ++i) {
            values[i] += offset;
        }
        ASSERT_TRUE(saved(flash, values));
        EXPECT_EQ(restarted(flash), values);
    }
    EXPECT_EQ(flash.erases(), 2U);
}

TEST(ParamFlash, NothingIsJudgedByTheStore)
{
    RoomyFlash flash;
    const float nan = std::numeric_limits<float>::quiet_NaN();
    put(flash, 0, 0, record_of(1, {{"TRK_AGE", nan}, {"TRK_RADIUS", -1e30F}}));
    const ParamValues values = restarted(flash);
    EXPECT_TRUE(std::isnan(values[static_cast<std::size_t>(Param::track_age)]));
    Parameters parameters;
    EXPECT_EQ(parameters.set_each(values), 2U);
    EXPECT_EQ(parameters.values(), own()) << "but by the parameters";
}

}  // namespace
}  // namespace jink::app
