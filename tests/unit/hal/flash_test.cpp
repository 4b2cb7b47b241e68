// SPDX-License-Identifier: BSD-3-Clause
// The flash driver of the STM32F4 against a model of the controller, written from the manual (ST RM0090, 3.5 to 3.9).
#include "hal/stm32f4/flash.hpp"

#include <map>
#include <vector>

#include <gtest/gtest.h>

#include "core/base/random.hpp"

namespace jink::hal {
namespace {

constexpr std::uint32_t kSector = 128U * 1024U;
constexpr std::uint32_t kErased = 0xFFFFFFFF;
constexpr std::uint32_t kFirst = 10;

/// Controller, sectors 10 and 11, and a data cache that nothing but its reset keeps true.
struct ControllerModel {
    std::uint32_t access = 0x705, status = 0, control = 1U << 31U;
    std::vector<std::uint32_t> words = std::vector<std::uint32_t>(2 * kSector / 4, kErased);
    std::map<std::uint32_t, std::uint32_t> cache;
    std::vector<bool> erasing;  ///< announcements of the driver
    int keys = 0;
    int writes = 0;       ///< to the controller
    int word_writes = 0;  ///< to the flash
    int busy_looks = 3;   ///< that an operation takes
    int busy_left = 0;
    bool stays_busy = false;
    bool refuses_keys = false;  ///< locked until the next reset, as after a wrong sequence
    bool is_protected = false;  ///< write protection of both sectors
    bool absent = false;        ///< an emulator's: reads as zero, takes anything
    bool bus_stalled = false;   ///< accessed while busy
    bool faulted = false;       ///< bus fault

    std::uint32_t read(std::uint32_t offset)
    {
        if (absent) {
            return 0;
        }
        switch (offset) {
        case 0x00: return access;
        case 0x0C:
            if (!stays_busy && busy_left > 0 && --busy_left == 0) {
                status &= ~(1U << 16U);
            }
            return status;
        case 0x10: return control;
        default: ADD_FAILURE() << "not read: " << offset; return 0;
        }
    }
    void write(std::uint32_t offset, std::uint32_t value)
    {
        ++writes;
        if (absent) {
            return;
        }
        switch (offset) {
        case 0x00: write_access(value); break;
        case 0x04: write_key(value); break;
        case 0x0C: status &= ~(value & 0xF3U); break;
        case 0x10: write_control(value); break;
        default: ADD_FAILURE() << "not written: " << offset;
        }
    }
    void write_access(std::uint32_t value)
    {
        if ((value & 1U << 12U) != 0) {
            EXPECT_EQ(access & 1U << 10U, 0U) << "reset only while off";
            cache.clear();
        }
        access = value;
    }
    void write_key(std::uint32_t value)
    {
        constexpr std::uint32_t kKeys[] = {0x45670123, 0xCDEF89AB};
        faulted = faulted || keys < 0 || (control & 1U << 31U) == 0;
        if (keys < 0 || value != kKeys[keys]) {
            keys = -1;  // until the next reset
            return;
        }
        if (++keys == 2) {
            control &= refuses_keys ? control : ~(1U << 31U);
            keys = refuses_keys ? -1 : 0;
        }
    }
    void write_control(std::uint32_t value)
    {
        bus_stalled = bus_stalled || (status & 1U << 16U) != 0;
        if ((control & 1U << 31U) != 0) {
            return;
        }
        control = value & ~(1U << 16U);
        if ((value & 1U << 16U) == 0) {
            return;
        }
        const std::uint32_t sector = value >> 3U & 0xFU;
        EXPECT_EQ(value & 0x7U, 2U) << "a sector, not all of the chip";
        ASSERT_TRUE(sector == kFirst || sector == kFirst + 1) << "the program lies there";
        if (is_protected) {
            status |= 1U << 4U;
            return;
        }
        begin();
        for (std::uint32_t i = 0; i < kSector / 4; ++i) {
            words[(sector - kFirst) * kSector / 4 + i] = kErased;
        }
    }
    void begin()
    {
        status |= 1U << 16U;
        busy_left = busy_looks;
    }
    std::uint32_t read_word(std::uint32_t offset)
    {
        bus_stalled = bus_stalled || (status & 1U << 16U) != 0;
        if ((access & 1U << 10U) == 0) {
            return words[offset / 4];
        }
        return cache.emplace(offset, words[offset / 4]).first->second;
    }
    void write_word(std::uint32_t offset, std::uint32_t value)
    {
        ++word_writes;
        if ((control & 1U << 31U) != 0 || (control & 1U) == 0) {
            status |= 1U << 7U;
        } else if ((control >> 8U & 3U) != 2U) {
            status |= 1U << 6U;
        } else if (is_protected) {
            status |= 1U << 4U;
        } else {
            begin();
            words[offset / 4] &= value;
        }
    }
};

struct ByController {
    ControllerModel* m;
    [[nodiscard]] std::uint32_t read(std::uint32_t offset) const { return m->read(offset); }
    void write(std::uint32_t offset, std::uint32_t value) const { m->write(offset, value); }
};
struct ByWord {
    ControllerModel* m;
    [[nodiscard]] std::uint32_t read(std::uint32_t offset) const { return m->read_word(offset); }
    void write(std::uint32_t offset, std::uint32_t value) const { m->write_word(offset, value); }
};
struct Announced {
    ControllerModel* m;
    void operator()(bool erasing) const { m->erasing.push_back(erasing); }
};

bool program(FlashRegion& flash, std::uint32_t sector, std::uint32_t offset, std::uint32_t word)
{
    return flash.program(sector, offset, {&word, 1});
}

class FlashDriver : public testing::Test {
protected:
    ControllerModel model;
    stm32f4::Flash<ByController, ByWord, Announced> flash{ByController{&model}, ByWord{&model}, kFirst,
                                                          Announced{&model}, 1000};

    void TearDown() override
    {
        EXPECT_FALSE(model.bus_stalled) << "touched while busy";
        EXPECT_FALSE(model.faulted) << "a key too many";
        EXPECT_EQ(model.access, 0x705U) << "caches as they were";
    }
    [[nodiscard]] bool is_locked() const { return (model.control & 1U << 31U) != 0; }
};

TEST_F(FlashDriver, WordsAreProgrammedWhereTheyBelongAndTheControllerIsLockedAgain)
{
    Random random(5);
    std::map<std::uint32_t, std::uint32_t> written;
    for (int i = 0; i < 300; ++i) {
        const auto sector = static_cast<std::uint32_t>(random.below(2));
        const auto offset = static_cast<std::uint32_t>(4 * random.below(kSector / 4));
        const auto word = static_cast<std::uint32_t>(random.next());
        if (!written.emplace(sector * kSector + offset, word).second) {
            continue;
        }
        EXPECT_EQ(flash.read(sector, offset), kErased);
        EXPECT_TRUE(program(flash, sector, offset, word));
        EXPECT_EQ(flash.read(sector, offset), word) << "not what the cache held";
        EXPECT_TRUE(is_locked());
    }
    for (std::uint32_t i = 0; i < model.words.size(); ++i) {
        const auto at = written.find(4 * i);
        ASSERT_EQ(model.words[i], at == written.end() ? kErased : at->second) << i;
    }
    EXPECT_TRUE(model.erasing.empty());
}

TEST_F(FlashDriver, TheSectorThatIsNamedIsErasedAndNoOther)
{
    for (const std::uint32_t sector : {0U, 1U, 0U}) {
        ASSERT_TRUE(program(flash, 0, 8, 1));
        ASSERT_TRUE(program(flash, 1, kSector - 4, 2));
        EXPECT_TRUE(flash.erase(sector));
        EXPECT_TRUE(is_locked());
        EXPECT_EQ(flash.read(0, 8), sector == 0 ? kErased : 1U) << "not what the cache held";
        EXPECT_EQ(flash.read(1, kSector - 4), sector == 1 ? kErased : 2U);
        ASSERT_TRUE(flash.erase(1 - sector));
    }
    EXPECT_EQ(model.erasing.size(), 12U);
}

TEST_F(FlashDriver, WhoWatchesIsAskedForPatienceAroundAnEraseAlsoWhereItFails)
{
    EXPECT_TRUE(flash.erase(1));
    EXPECT_EQ(model.erasing, (std::vector<bool>{true, false}));
    model.is_protected = true;
    EXPECT_FALSE(flash.erase(1));
    EXPECT_EQ(model.erasing, (std::vector<bool>{true, false, true, false}));
}

TEST_F(FlashDriver, AUnitIsOneWord)
{
    EXPECT_EQ(flash.unit_bytes(), 4U);
    const std::uint32_t two[2] = {1, 2};
    EXPECT_FALSE(flash.program(0, 0, two));
    EXPECT_EQ(model.word_writes, 0);
}

TEST_F(FlashDriver, AWordThatNeedsASetBitIsAFailure)
{
    ASSERT_TRUE(program(flash, 0, 0, 0x0F));
    EXPECT_FALSE(program(flash, 0, 0, 0xF0));
    EXPECT_EQ(flash.read(0, 0), 0U);
}

TEST_F(FlashDriver, WriteProtectionIsAFailureAndTheNextOperationStartsWithoutItsError)
{
    model.is_protected = true;
    EXPECT_FALSE(program(flash, 0, 0, 1));
    EXPECT_FALSE(flash.erase(0));
    EXPECT_TRUE(is_locked());
    model.is_protected = false;
    EXPECT_TRUE(program(flash, 0, 0, 1));
    EXPECT_TRUE(flash.erase(0));
}

TEST_F(FlashDriver, ErrorsThatADebuggerLeftAreClearedFirst)
{
    for (const unsigned bit : {1U, 4U, 5U, 6U, 7U}) {
        model.status |= 1U << bit;
        EXPECT_TRUE(program(flash, 0, 4 * bit, 1)) << bit;
    }
}

TEST_F(FlashDriver, AnErrorOfEachKindIsAFailure)
{
    for (const unsigned bit : {1U, 4U, 5U, 6U, 7U}) {
        struct Erring {
            ControllerModel* m;
            std::uint32_t error;
            [[nodiscard]] std::uint32_t read(std::uint32_t offset) const { return m->read_word(offset); }
            void write(std::uint32_t offset, std::uint32_t value) const
            {
                m->write_word(offset, value);
                m->status |= error;
            }
        };
        stm32f4::Flash<ByController, Erring, Announced> erring{ByController{&model}, Erring{&model, 1U << bit}, kFirst,
                                                               Announced{&model}, 1000};
        EXPECT_FALSE(program(erring, 1, 4 * bit, 1)) << bit;
    }
}

TEST_F(FlashDriver, AnEmulatorWithoutAControllerIsLeftAlone)
{
    model.absent = true;
    EXPECT_FALSE(program(flash, 0, 0, 1));
    EXPECT_FALSE(flash.erase(0));
    EXPECT_EQ(model.writes, 0);
    EXPECT_EQ(model.word_writes, 0);
    EXPECT_TRUE(model.erasing.empty());
}

TEST_F(FlashDriver, KeysThatAreRefusedAreNotTriedAgain)
{
    model.refuses_keys = true;
    EXPECT_FALSE(program(flash, 0, 0, 1));
    EXPECT_FALSE(program(flash, 0, 0, 1));
    EXPECT_FALSE(flash.erase(0));
    EXPECT_EQ(model.word_writes, 0);
    EXPECT_TRUE(model.erasing.empty());
}

TEST_F(FlashDriver, AControllerThatStaysBusyEndsTheWaitAndIsNotTouchedAgain)
{
    for (const bool erases : {false, true}) {
        ControllerModel stuck;
        stm32f4::Flash<ByController, ByWord, Announced> driver{ByController{&stuck}, ByWord{&stuck}, kFirst,
                                                               Announced{&stuck}, 1000};
        stuck.stays_busy = true;
        EXPECT_FALSE(erases ? driver.erase(0) : program(driver, 0, 0, 1));
        const int writes = stuck.writes;
        EXPECT_FALSE(driver.erase(0));
        EXPECT_FALSE(program(driver, 0, 0, 1));
        EXPECT_EQ(driver.read(0, 0), std::nullopt);
        EXPECT_EQ(stuck.writes, writes);
        EXPECT_FALSE(stuck.bus_stalled);
        EXPECT_EQ(stuck.erasing.size(), erases ? 2U : 0U);
    }
}

TEST_F(FlashDriver, ABusyControllerIsNotInterrupted)
{
    model.begin();
    model.stays_busy = true;
    EXPECT_FALSE(program(flash, 0, 0, 1));
    EXPECT_EQ(model.writes, 0);
    model.stays_busy = false;
    model.busy_left = 1;
    EXPECT_TRUE(program(flash, 0, 0, 1)) << "and is used once it is free";
}

}  // namespace
}  // namespace jink::hal
