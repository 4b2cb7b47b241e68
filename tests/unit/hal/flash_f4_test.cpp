// SPDX-License-Identifier: BSD-3-Clause
// What is the STM32F4's own in its flash driver; the rest is in flash_test.cpp.
#include "tests/unit/hal/flash_models.hpp"

namespace jink::hal {
namespace {

/// Bits of the status that are errors.
constexpr unsigned kErrorsOfF4[] = {1, 4, 5, 6, 7};

class FlashDriverF4 : public testing::Test {
protected:
    ControllerModel model;
    FlashOfF4::Driver flash = flash_driver<FlashOfF4>(model);

    void TearDown() override
    {
        EXPECT_FALSE(model.bus_stalled) << "touched while busy";
        EXPECT_EQ(model.access, 0x705U) << "caches as they were";
    }
    bool program_word(std::uint32_t sector, std::uint32_t offset, std::uint32_t word)
    {
        return flash.program(sector, offset, {&word, 1});
    }
};

TEST_F(FlashDriverF4, AWordThatNeedsASetBitIsAFailure)
{
    EXPECT_EQ(flash.unit_bytes(), 4U);
    ASSERT_TRUE(program_word(0, 0, 0x0F));
    EXPECT_FALSE(program_word(0, 0, 0xF0));
    EXPECT_EQ(flash.read(0, 0), 0U);
}

TEST_F(FlashDriverF4, ErrorsThatADebuggerLeftAreClearedFirst)
{
    for (const unsigned bit : kErrorsOfF4) {
        model.status |= 1U << bit;
        EXPECT_TRUE(program_word(0, 4 * bit, 1)) << bit;
    }
}

TEST_F(FlashDriverF4, AnErrorOfEachKindIsAFailure)
{
    for (const unsigned bit : kErrorsOfF4) {
        auto erring = flash_driver<FlashOfF4>(model, 1U << bit);
        const std::uint32_t word = 1;
        EXPECT_FALSE(erring.program(1, 4 * bit, {&word, 1})) << bit;
    }
}

TEST_F(FlashDriverF4, CachesAreAsTheyWereAfterEachOperation)
{
    EXPECT_TRUE(program_word(0, 0, 1));
    EXPECT_EQ(model.access, 0x705U);
    EXPECT_TRUE(flash.erase(0));
    EXPECT_EQ(model.access, 0x705U);
    model.is_protected = true;
    EXPECT_FALSE(program_word(0, 0, 1));
}

TEST_F(FlashDriverF4, ABusyControllerIsNotInterrupted)
{
    model.begin(model.busy);
    model.stays_busy = true;
    EXPECT_FALSE(program_word(0, 0, 1));
    EXPECT_EQ(model.writes, 0);
    model.stays_busy = false;
    model.busy_left = 1;
    EXPECT_TRUE(program_word(0, 0, 1)) << "and is used once it is free";
}

}  // namespace
}  // namespace jink::hal
