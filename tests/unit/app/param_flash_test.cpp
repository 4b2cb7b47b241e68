// SPDX-License-Identifier: BSD-3-Clause
// Parameters in flash of every kind: cuts at every unit, damage, records of other versions.
#include <cmath>
#include <limits>

#include "tests/unit/app/param_flash_bench.hpp"

namespace jink::app {
namespace {

template <class Kind>
class ParamFlashStore : public testing::Test {
};
TYPED_TEST_SUITE(ParamFlashStore, FlashKinds);

TYPED_TEST(ParamFlashStore, ErasedFlashHoldsNothing)
{
    typename TypeParam::template Of<kSmall> flash;
    ParamLoad load;
    EXPECT_EQ(restarted(flash, &load), own());
    EXPECT_EQ(load.taken, 0U);
    EXPECT_FALSE(load.damaged);
    EXPECT_EQ(flash.steps(), 0U) << "nothing is written by looking";
}

TYPED_TEST(ParamFlashStore, AllParametersComeBackBitForBit)
{
    typename TypeParam::template Of<4096> flash;
    ParamValues values = own();
    for (std::size_t i = 0; i < kParamCount; ++i) {
        values[i] = std::nextafter(values[i], 1e9F);
    }
    ASSERT_TRUE(saved(flash, values));
    ParamLoad load;
    EXPECT_EQ(restarted(flash, &load), values);
    EXPECT_EQ(load.taken, kParamCount);
    EXPECT_EQ(flash.steps(), TypeParam::units(3U + 5U * kParamCount + 1U));
    ASSERT_TRUE(saved(flash, own())) << "and back";
    EXPECT_EQ(restarted(flash), own());
}

TYPED_TEST(ParamFlashStore, TheRecordIsTheDocumentedOne)
{
    typename TypeParam::template Of<4096> flash;
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

TYPED_TEST(ParamFlashStore, NamesThatThereAreNoMoreAreCountedAndTheOthersTaken)
{
    typename TypeParam::template Of<4096> flash;
    put(flash, 1, 0, record_of(7, {{"OLD_NAME", 1.0F}, {"TRK_AGE", 9.0F}, {"A_NAME_OF_16_CHR", 2.0F}}));
    ParamLoad load;
    EXPECT_EQ(restarted(flash, &load), own_with(Param::track_age, 9.0F));
    EXPECT_EQ(load.taken, 3U);
    EXPECT_EQ(load.unknown, 2U);
    ASSERT_TRUE(saved(flash, own_with(Param::track_age, 8.0F)));
    EXPECT_EQ(flash.read(1, 128 + 4), 8U) << "behind it, in its sector";
}

TYPED_TEST(ParamFlashStore, TheSameValuesAreNotWrittenAgain)
{
    typename TypeParam::template Of<kSmall> flash;
    ASSERT_TRUE(saved(flash, own_with(Param::track_age, 9.0F)));
    const std::uint64_t steps = flash.steps();
    EXPECT_TRUE(saved(flash, own_with(Param::track_age, 9.0F)));
    EXPECT_EQ(flash.steps(), steps);
    EXPECT_TRUE(saved(flash, own_with(Param::track_age, 9.5F)));
    EXPECT_GT(flash.steps(), steps);
}

TYPED_TEST(ParamFlashStore, ACutAtAnyUnitLeavesTheValuesBeforeOrAfterTheChange)
{
    // Nineteen changes: three sectors are filled, so the second and the third by an erase. Of the unit that is cut no
    // bit, all bits or every other bit has changed.
    constexpr int kChanges = 19;
    const auto values_of = [](int change) {
        return change == 0 ? own() : own_with(Param::track_age, 1.0F + 0.1F * static_cast<float>(change));
    };
    typename TypeParam::template Of<kSmall> uncut;
    for (int i = 1; i <= kChanges; ++i) {
        ASSERT_TRUE(saved(uncut, values_of(i)));
    }
    ASSERT_EQ(uncut.erases(), 2U);
    std::uint64_t before = 0;
    std::uint64_t after = 0;
    for (std::uint64_t step = 0; step < uncut.steps(); ++step) {
        for (const std::uint32_t mask : {0U, 0x55555555U, ~0U}) {
            typename TypeParam::template Of<kSmall> flash;
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
    EXPECT_GT(before, 2 * uncut.steps());
    EXPECT_EQ(after, kChanges) << "the last unit of each, whole";
}

TYPED_TEST(ParamFlashStore, ACutWithinARecordOfAllParametersLeavesNoMixture)
{
    ParamValues first = own();
    ParamValues second = own();
    for (std::size_t i = 0; i < kParamCount; ++i) {
        first[i] = std::nextafter(first[i], 1e9F);
        second[i] = std::nextafter(second[i], -1e9F);
    }
    for (std::uint64_t step = 0; step < TypeParam::units(3U + 5U * kParamCount + 1U); ++step) {
        for (const std::uint32_t mask : {0U, 0x0F0F0F0FU}) {
            typename TypeParam::template Of<4096> flash;
            ASSERT_TRUE(saved(flash, first));
            flash.cut_at(step, mask);
            ASSERT_FALSE(saved(flash, second));
            flash.restore();
            ASSERT_EQ(restarted(flash), first) << step;
        }
    }
}

TYPED_TEST(ParamFlashStore, OneFlippedBitAnywhereInTheNewestRecordLeavesTheOneBefore)
{
    for (std::uint32_t bit = 0; bit < 32U * 9U; ++bit) {
        typename TypeParam::template Of<kSmall> flash;
        ASSERT_TRUE(saved(flash, own_with(Param::track_age, 8.0F)));
        ASSERT_TRUE(saved(flash, own_with(Param::track_age, 9.0F)));
        flash.flip(0, 64 + bit / 32U * 4U, 1U << bit % 32U);
        ASSERT_EQ(restarted(flash), own_with(Param::track_age, 8.0F)) << bit;
        ASSERT_TRUE(saved(flash, own_with(Param::track_age, 10.0F)));
        ASSERT_EQ(restarted(flash), own_with(Param::track_age, 10.0F)) << bit;
    }
}

TYPED_TEST(ParamFlashStore, ASectorThatIsDamagedAsAWholeLeavesTheOther)
{
    typename TypeParam::template Of<kSmall> flash;
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

TYPED_TEST(ParamFlashStore, RecordsOfWhichNoneIsWholeAreDamage)
{
    typename TypeParam::template Of<kSmall> flash;
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

TYPED_TEST(ParamFlashStore, WhatAnotherProgramLeftInBothSectorsIsErasedAndNoDamage)
{
    typename TypeParam::template Of<kSmall> flash;
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
template <class Inner>
class FailingFlash final : public hal::FlashRegion {
public:
    std::uint32_t sector_bytes() const noexcept override { return kSmall; }
    std::uint32_t unit_bytes() const noexcept override { return inner.unit_bytes(); }
    std::optional<std::uint32_t> read(std::uint32_t sector, std::uint32_t offset) noexcept override
    {
        return inner.read(sector, offset);
    }
    bool program(std::uint32_t sector, std::uint32_t offset, std::span<const std::uint32_t> unit) noexcept override
    {
        std::vector<std::uint32_t> words(unit.begin(), unit.end());
        for (std::uint32_t& word : words) {
            word &= lies || drops ? 0xFFFF0000U : ~0U;
        }
        const bool done = programs && inner.program(sector, offset, words);
        return drops || (done && !lies);
    }
    bool erase(std::uint32_t sector) noexcept override { return erases && (leaves || inner.erase(sector)); }

    Inner inner;
    bool programs = true, erases = true;
    bool lies = false;    ///< other words than those asked for
    bool drops = false;   ///< the same, and reports success
    bool leaves = false;  ///< reports erased, and is not
};

TYPED_TEST(ParamFlashStore, AFailureIsCountedAndKeepsWhatIsThere)
{
    FailingFlash<typename TypeParam::template Of<kSmall>> flash;
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

TYPED_TEST(ParamFlashStore, ARecordThatFitsNoSectorIsRefusedWithoutAnErase)
{
    typename TypeParam::template Of<kSmall> flash;
    ParamValues values = own();
    for (std::size_t i = 0; i < kParamCount; ++i) {
        values[i] = std::nextafter(values[i], 1e9F);
    }
    ASSERT_TRUE(saved(flash, own_with(Param::track_age, 8.0F)));
    EXPECT_FALSE(saved(flash, values));
    EXPECT_EQ(flash.erases(), 0U);
    EXPECT_EQ(restarted(flash), own_with(Param::track_age, 8.0F));
}

TYPED_TEST(ParamFlashStore, ARecordThatFillsASectorToItsEndFits)
{
    typename TypeParam::template Of<256> flash;  // twelve values: 64 words
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

TYPED_TEST(ParamFlashStore, NothingIsJudgedByTheStore)
{
    typename TypeParam::template Of<4096> flash;
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
