// SPDX-License-Identifier: BSD-3-Clause
// What the flash drivers of all chips keep, against models of their controllers.
#include <map>
#include <vector>

#include "core/base/random.hpp"
#include "tests/unit/hal/flash_models.hpp"

namespace jink::hal {
namespace {

template <class Chip>
class FlashDriver : public testing::Test {
protected:
    typename Chip::Model model;
    typename Chip::Driver flash = flash_driver<Chip>(model);

    void TearDown() override
    {
        EXPECT_FALSE(model.bus_stalled) << "touched while busy";
        EXPECT_FALSE(model.faulted) << "a key too many";
    }
    /// A unit of words that count up.
    [[nodiscard]] std::vector<std::uint32_t> unit(std::uint32_t from = 1)
    {
        std::vector<std::uint32_t> words(flash.unit_bytes() / 4);
        for (std::uint32_t& word : words) {
            word = from++;
        }
        return words;
    }
    [[nodiscard]] std::uint32_t last_unit() { return kModelSector - flash.unit_bytes(); }
};
using FlashChips = testing::Types<FlashOfF4, FlashOfH7>;
TYPED_TEST_SUITE(FlashDriver, FlashChips);

TYPED_TEST(FlashDriver, UnitsAreProgrammedWhereTheyBelongAndTheControllerIsLockedAgain)
{
    EXPECT_EQ(this->flash.sector_bytes(), kModelSector);
    const std::uint32_t bytes = this->flash.unit_bytes();
    Random random(5);
    std::map<std::uint32_t, std::uint32_t> written;
    for (int i = 0; i < 300; ++i) {
        const auto sector = static_cast<std::uint32_t>(random.below(2));
        const auto offset = static_cast<std::uint32_t>(bytes * random.below(kModelSector / bytes));
        const auto words = this->unit(static_cast<std::uint32_t>(random.below(1U << 31U)));
        if (written.contains((sector * kModelSector + offset) / 4)) {
            continue;
        }
        EXPECT_EQ(this->flash.read(sector, offset), kBlank);
        EXPECT_TRUE(this->flash.program(sector, offset, words));
        for (std::uint32_t k = 0; k < words.size(); ++k) {
            written[(sector * kModelSector + offset) / 4 + k] = words[k];
            EXPECT_EQ(this->flash.read(sector, offset + 4 * k), words[k]) << "not what a cache held";
        }
        EXPECT_TRUE(this->model.is_locked());
    }
    for (std::uint32_t i = 0; i < this->model.words.size(); ++i) {
        const auto at = written.find(i);
        ASSERT_EQ(this->model.words[i], at == written.end() ? kBlank : at->second) << i;
    }
    EXPECT_TRUE(this->model.erasing.empty());
}

TYPED_TEST(FlashDriver, OnlyWholeUnitsAreProgrammed)
{
    std::vector<std::uint32_t> words = this->unit();
    words.push_back(9);
    EXPECT_FALSE(this->flash.program(0, 0, words));
    words.resize(words.size() - 2);
    EXPECT_FALSE(this->flash.program(0, 0, words));
    EXPECT_FALSE(this->flash.program(0, 0, {}));
    EXPECT_EQ(this->model.writes, 0);
    EXPECT_EQ(this->model.word_writes, 0);
}

TYPED_TEST(FlashDriver, TheSectorThatIsNamedIsErasedAndNoOther)
{
    for (const std::uint32_t sector : {0U, 1U, 0U}) {
        ASSERT_TRUE(this->flash.program(0, 64, this->unit()));
        ASSERT_TRUE(this->flash.program(1, this->last_unit(), this->unit(7)));
        EXPECT_TRUE(this->flash.erase(sector));
        EXPECT_TRUE(this->model.is_locked());
        EXPECT_EQ(this->flash.read(0, 64), sector == 0 ? kBlank : 1U) << "not what a cache held";
        EXPECT_EQ(this->flash.read(1, this->last_unit()), sector == 1 ? kBlank : 7U);
        ASSERT_TRUE(this->flash.erase(1 - sector));
    }
    EXPECT_EQ(this->model.erasing.size(), 12U);
}

TYPED_TEST(FlashDriver, WhoWatchesIsAskedForPatienceAroundAnEraseAlsoWhereItFails)
{
    EXPECT_TRUE(this->flash.erase(1));
    EXPECT_EQ(this->model.erasing, (std::vector<bool>{true, false}));
    this->model.is_protected = true;
    EXPECT_FALSE(this->flash.erase(1));
    EXPECT_EQ(this->model.erasing, (std::vector<bool>{true, false, true, false}));
}

TYPED_TEST(FlashDriver, WriteProtectionIsAFailureAndTheNextOperationStartsWithoutItsError)
{
    this->model.is_protected = true;
    EXPECT_FALSE(this->flash.program(0, 0, this->unit()));
    EXPECT_FALSE(this->flash.erase(0));
    EXPECT_TRUE(this->model.is_locked());
    this->model.is_protected = false;
    EXPECT_TRUE(this->flash.program(0, 0, this->unit()));
    EXPECT_TRUE(this->flash.erase(0));
}

TYPED_TEST(FlashDriver, AControllerThatIsAbsentOrUnlockedIsLeftAlone)
{
    this->model.absent = true;
    EXPECT_FALSE(this->flash.program(0, 0, this->unit()));
    EXPECT_FALSE(this->flash.erase(0));
    this->model.absent = false;
    this->model.control &= ~this->model.lock;
    EXPECT_FALSE(this->flash.program(0, 0, this->unit()));
    EXPECT_FALSE(this->flash.erase(0));
    EXPECT_EQ(this->model.writes, 0);
    EXPECT_EQ(this->model.word_writes, 0);
    EXPECT_TRUE(this->model.erasing.empty());
}

TYPED_TEST(FlashDriver, KeysThatAreRefusedAreNotTriedAgain)
{
    this->model.refuses_keys = true;
    EXPECT_FALSE(this->flash.program(0, 0, this->unit()));
    EXPECT_FALSE(this->flash.program(0, 0, this->unit()));
    EXPECT_FALSE(this->flash.erase(0));
    EXPECT_EQ(this->model.word_writes, 0);
    EXPECT_TRUE(this->model.erasing.empty());
}

TYPED_TEST(FlashDriver, AControllerThatStaysBusyEndsTheWaitAndIsNotTouchedAgain)
{
    for (const bool erases : {false, true}) {
        typename TypeParam::Model stuck;
        auto driver = flash_driver<TypeParam>(stuck);
        stuck.stays_busy = true;
        EXPECT_FALSE(erases ? driver.erase(0) : driver.program(0, 0, this->unit()));
        const int writes = stuck.writes;
        EXPECT_FALSE(driver.erase(0));
        EXPECT_FALSE(driver.program(1, 0, this->unit()));
        EXPECT_EQ(driver.read(0, 0), std::nullopt);
        EXPECT_EQ(stuck.writes, writes);
        EXPECT_FALSE(stuck.bus_stalled);
        EXPECT_EQ(stuck.erasing.size(), erases ? 2U : 0U);
    }
}

}  // namespace
}  // namespace jink::hal
