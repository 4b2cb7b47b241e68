// SPDX-License-Identifier: BSD-3-Clause
// What is the STM32H743's own in its flash driver, its code first of all; the rest is in flash_test.cpp.
#include "tests/unit/hal/flash_models.hpp"

namespace jink::hal {
namespace {

class FlashDriverH7 : public testing::Test {
protected:
    BankModel model;
    FlashOfH7::Driver flash = flash_driver<FlashOfH7>(model);
    std::array<std::uint32_t, 8> unit{1, 2, 3, 4, 5, 6, 7, 8};

    void TearDown() override { EXPECT_FALSE(model.bus_stalled) << "touched while busy"; }
};

TEST_F(FlashDriverH7, AWrongCodeIsUnreadableAsABusFaultOrAsAFlagAndDoesNotOutlastItsUnit)
{
    for (const bool faults_bus : {true, false}) {
        model.faults_bus = faults_bus;
        ASSERT_TRUE(flash.erase(0));
        ASSERT_TRUE(flash.program(0, 0, unit));
        model.wrong_code[1] = true;
        for (std::uint32_t offset = 32; offset < 64; offset += 4) {
            EXPECT_EQ(flash.read(0, offset), std::nullopt);
            EXPECT_EQ(model.status & BankModel::kDoubleError, 0U) << "cleared";
            EXPECT_EQ(flash.read(0, 0), 1U);
            EXPECT_EQ(flash.read(0, 64), kBlank);
        }
    }
    model.status |= BankModel::kDoubleError;  // a debugger's read
    EXPECT_EQ(flash.read(0, 0), 1U);
}

TEST_F(FlashDriverH7, ATornProgramIsAFailureAndTheSectorCanBeErased)
{
    model.tears = true;
    EXPECT_FALSE(flash.program(0, 0, unit));
    EXPECT_EQ(flash.read(0, 0), std::nullopt);
    EXPECT_TRUE(model.is_locked());
    model.tears = false;
    EXPECT_TRUE(flash.erase(0));
    EXPECT_TRUE(flash.program(0, 0, unit));
}

TEST_F(FlashDriverH7, AUnitThatIsNotErasedIsRefusedAndStaysReadable)
{
    EXPECT_EQ(flash.unit_bytes(), 32U);
    ASSERT_TRUE(flash.program(0, 0, unit));
    const int writes = model.word_writes;
    EXPECT_FALSE(flash.program(0, 0, unit));
    EXPECT_FALSE(flash.program(0, 0, std::array<std::uint32_t, 8>{}));
    EXPECT_EQ(model.word_writes, writes);
    EXPECT_EQ(flash.read(0, 28), 8U);
}

TEST_F(FlashDriverH7, UnitsBeginAtMultiplesOfTheirSize)
{
    for (std::uint32_t offset = 4; offset < 32; offset += 4) {
        EXPECT_FALSE(flash.program(0, offset, unit));
    }
    EXPECT_EQ(model.word_writes, 0);
}

TEST_F(FlashDriverH7, FlagsOfEachKindThatADebuggerLeftAreClearedFirst)
{
    std::uint32_t at = 0;
    for (const unsigned bit : {16U, 17U, 18U, 19U, 21U, 22U, 23U, 24U, 25U, 26U}) {
        model.status |= 1U << bit;
        EXPECT_TRUE(flash.program(0, at += 32, unit)) << bit;
    }
}

TEST_F(FlashDriverH7, AnErrorOfEachKindIsAFailureAndACorrectedBitIsNone)
{
    std::uint32_t at = 0;
    for (const unsigned bit : {17U, 18U, 19U, 21U, 22U, 23U, 24U, 25U}) {
        auto erring = flash_driver<FlashOfH7>(model, 1U << bit);
        EXPECT_EQ(erring.program(1, at += 32, unit), bit == 25) << bit;
    }
}

TEST_F(FlashDriverH7, SwappedBanksAreReadAndNotChanged)
{
    model.options = 1U << 31U;
    EXPECT_EQ(flash.read(0, 0), kBlank);
    EXPECT_FALSE(flash.program(0, 0, unit));
    EXPECT_FALSE(flash.erase(0));
    EXPECT_EQ(model.writes, 0);
    EXPECT_EQ(model.word_writes, 0);
    EXPECT_TRUE(model.erasing.empty());
}

}  // namespace
}  // namespace jink::hal
