// SPDX-License-Identifier: BSD-3-Clause
// Parameters in flash whose units become unreadable, and where a record and a unit end.
#include "tests/unit/app/param_flash_bench.hpp"

namespace jink::app {
namespace {

constexpr std::uint32_t kMagic = 0x014B4E8A;
using CodedFlash = FlashKind<32>::Of<kSmall>;

template <class Kind>
class ParamFlashUnits : public testing::Test {
};
TYPED_TEST_SUITE(ParamFlashUnits, FlashKinds);

/// A record whose checksum is an erased word: its last value is the state of the checksum before it.
std::vector<std::uint32_t> record_with_erased_checksum()
{
    std::vector<std::pair<std::string, float>> entries{{"TRK_AGE", 9.0F}};
    while (entries.size() < 9) {  // 49 words: three blocks of 64 bytes, and the checksum
        entries.emplace_back("UNKNOWN_" + std::to_string(entries.size()), 0.0F);
    }
    std::vector<std::uint32_t> words = record_of(1, entries);
    std::uint32_t state = 0xFFFFFFFF;
    for (std::size_t i = 0; i + 2 < words.size(); ++i) {
        for (int bit = 0; bit < 32; ++bit) {
            const std::uint32_t differs = (state ^ (words[i] >> bit)) & 1U;
            state = (state >> 1U) ^ (differs != 0 ? 0xEDB88320U : 0U);
        }
    }
    entries.back().second = std::bit_cast<float>(state);
    return record_of(1, entries);
}

TYPED_TEST(ParamFlashUnits, AChecksumThatLooksErasedIsNotWrittenOver)
{
    const std::vector<std::uint32_t> record = record_with_erased_checksum();
    ASSERT_EQ(record.size(), 49U);
    ASSERT_EQ(record.back(), 0xFFFFFFFFU);
    for (std::uint64_t step = 0; step < TypeParam::units(9); ++step) {
        typename TypeParam::template Of<kSmall> flash;
        put(flash, 0, 0, record);
        ASSERT_EQ(restarted(flash), own_with(Param::track_age, 9.0F));
        flash.cut_at(step, 0x00FF00FF);
        ASSERT_FALSE(saved(flash, own_with(Param::track_age, 10.0F)));
        flash.restore();
        ASSERT_EQ(restarted(flash), own_with(Param::track_age, 9.0F)) << step;
    }
    typename TypeParam::template Of<kSmall> flash;
    put(flash, 0, 0, record);
    ASSERT_TRUE(saved(flash, own_with(Param::track_age, 10.0F)));
    EXPECT_EQ(flash.read(0, 192), 0xFFFFFFFFU);
    EXPECT_EQ(flash.read(0, 256), kMagic);
    EXPECT_EQ(restarted(flash), own_with(Param::track_age, 10.0F));
}

TYPED_TEST(ParamFlashUnits, WhatIsBehindARecordInItsLastUnitStaysErased)
{
    typename TypeParam::template Of<kSmall> flash;
    ASSERT_TRUE(saved(flash, own_with(Param::track_age, 9.0F)));
    for (std::uint32_t offset = 36; offset < 64; offset += 4) {
        EXPECT_EQ(flash.read(0, offset), 0xFFFFFFFFU) << offset;
    }
    EXPECT_EQ(flash.steps(), TypeParam::units(9));
}

TEST(ParamFlashUnreadable, AnyUnitOfTheNewestRecordLeavesTheRecordBefore)
{
    for (std::uint32_t unit = 0; unit < 2; ++unit) {
        CodedFlash flash;
        ASSERT_TRUE(saved(flash, own_with(Param::track_age, 8.0F)));
        ASSERT_TRUE(saved(flash, own_with(Param::track_age, 9.0F)));
        flash.make_unreadable(0, 64 + 32 * unit);
        ParamLoad load;
        ASSERT_EQ(restarted(flash, &load), own_with(Param::track_age, 8.0F)) << unit;
        EXPECT_FALSE(load.damaged) << "a record is whole";
        ASSERT_TRUE(saved(flash, own_with(Param::track_age, 10.0F)));
        EXPECT_EQ(flash.read(0, 128), kMagic) << "behind the unreadable unit";
        ASSERT_EQ(restarted(flash), own_with(Param::track_age, 10.0F)) << unit;
    }
}

TEST(ParamFlashUnreadable, TheHeadOfTheOnlyRecordIsDamage)
{
    CodedFlash flash;
    ASSERT_TRUE(saved(flash, own_with(Param::track_age, 8.0F)));
    flash.make_unreadable(0, 0);
    ParamLoad load;
    EXPECT_EQ(restarted(flash, &load), own());
    EXPECT_TRUE(load.damaged);
    EXPECT_EQ(load.taken, 0U);
}

TEST(ParamFlashUnreadable, AWholeSectorLeavesTheOtherAndIsErasedWhenItIsNeeded)
{
    CodedFlash flash;
    for (int i = 1; i <= 8; ++i) {  // the first sector is full
        ASSERT_TRUE(saved(flash, own_with(Param::track_age, static_cast<float>(i))));
    }
    for (std::uint32_t offset = 0; offset < kSmall; offset += 32) {
        flash.make_unreadable(1, offset);
    }
    EXPECT_EQ(restarted(flash), own_with(Param::track_age, 8.0F));
    ASSERT_TRUE(saved(flash, own_with(Param::track_age, 9.0F)));
    EXPECT_EQ(flash.erases(), 1U);
    EXPECT_EQ(restarted(flash), own_with(Param::track_age, 9.0F));
}

TEST(ParamFlashUnreadable, BothSectorsAreDamageAndOneIsErased)
{
    CodedFlash flash;
    for (std::uint32_t offset = 0; offset < kSmall; offset += 32) {
        flash.make_unreadable(0, offset);
        flash.make_unreadable(1, offset);
    }
    ParamLoad load;
    EXPECT_EQ(restarted(flash, &load), own());
    EXPECT_TRUE(load.damaged);
    ASSERT_TRUE(saved(flash, own_with(Param::track_age, 9.0F)));
    EXPECT_EQ(restarted(flash, &load), own_with(Param::track_age, 9.0F));
    EXPECT_FALSE(load.damaged);
}

TEST(ParamFlashUnreadable, AUnitThatOnlyLooksErasedFailsOnceAndIsPassed)
{
    // A program that was cut before any bit of the values changed, but bits of the code did: the next one leaves a
    // wrong code.
    CodedFlash flash;
    ASSERT_TRUE(saved(flash, own_with(Param::track_age, 8.0F)));
    ParamFlash store(flash);
    ParamValues values = own();
    static_cast<void>(store.load(values));
    flash.make_unreadable(0, 96);  // after load() has read it
    EXPECT_FALSE(store.save(own(), own_with(Param::track_age, 9.0F)));
    EXPECT_EQ(restarted(flash), own_with(Param::track_age, 8.0F));
    EXPECT_TRUE(store.save(own(), own_with(Param::track_age, 9.0F)));
    EXPECT_EQ(flash.read(0, 128), kMagic);
    EXPECT_EQ(restarted(flash), own_with(Param::track_age, 9.0F));
}

}  // namespace
}  // namespace jink::app
