// SPDX-License-Identifier: BSD-3-Clause
// The flash driver of the STM32H743 against a model of bank 2's controller and of its code, written from the manual (ST
// RM0433, 4.3 and 4.9).
#include "hal/stm32h7/flash.hpp"

#include <array>
#include <map>
#include <vector>

#include <gtest/gtest.h>

#include "core/base/random.hpp"

namespace jink::hal {
namespace {

constexpr std::uint32_t kBankSector = 128U * 1024U;
constexpr std::uint32_t kBlank = 0xFFFFFFFF;
constexpr std::uint32_t kFirstOfBank = 6;
constexpr std::uint32_t kDoubleError = 1U << 26U;
using FlashWord = std::array<std::uint32_t, 8>;

/// Controller of bank 2, and its sectors 6 and 7.
struct BankModel {
    std::uint32_t status = 0, control = 0x31, options = 0;
    std::vector<std::uint32_t> words = std::vector<std::uint32_t>(2 * kBankSector / 4, kBlank);
    std::vector<bool> wrong_code = std::vector<bool>(2 * kBankSector / 32, false);
    FlashWord buffer{};
    std::uint32_t buffered = 0;    ///< words
    std::uint32_t buffer_for = 0;  ///< flash word
    std::vector<bool> erasing;     ///< announcements of the driver
    int keys = 0;
    int writes = 0;       ///< to the controller, without those that clear flags
    int word_writes = 0;  ///< to the flash
    int busy_looks = 3;   ///< that an operation takes
    int busy_left = 0;
    bool stays_busy = false;
    bool refuses_keys = false;  ///< locked until the next reset, as after a wrong sequence
    bool is_protected = false;  ///< write protection of both sectors
    bool tears = false;         ///< programs leave a wrong code
    bool faults_bus = true;     ///< a wrong code is a bus fault too
    bool absent = false;        ///< reads as zero, takes anything
    bool touched_busy = false;  ///< the flash or its control while busy
    bool faulted = false;       ///< a key too many

    std::uint32_t read(std::uint32_t offset)
    {
        if (absent) {
            return 0;
        }
        switch (offset) {
        case 0x018: return options;
        case 0x10C: return control;
        case 0x110:
            if (!stays_busy && busy_left > 0 && --busy_left == 0) {
                status &= ~7U;
                status |= 1U << 16U;
            }
            return status;
        default: ADD_FAILURE() << "not read: " << offset; return 0;
        }
    }
    void write(std::uint32_t offset, std::uint32_t value)
    {
        writes += offset == 0x114 ? 0 : 1;
        if (absent) {
            return;
        }
        switch (offset) {
        case 0x104: write_key(value); break;
        case 0x10C: write_control(value); break;
        case 0x114: status &= ~(value & 0x0FEF0000U); break;
        default: ADD_FAILURE() << "not written: " << offset;
        }
    }
    void write_key(std::uint32_t value)
    {
        constexpr std::uint32_t kKeys[] = {0x45670123, 0xCDEF89AB};
        faulted = faulted || keys < 0 || (control & 1U) == 0;
        if (keys < 0 || value != kKeys[keys]) {
            keys = -1;  // until the next reset
            return;
        }
        if (++keys == 2) {
            control &= refuses_keys ? control : ~1U;
            keys = refuses_keys ? -1 : 0;
        }
    }
    void write_control(std::uint32_t value)
    {
        touched_busy = touched_busy || (status & 7U) != 0;
        if ((control & 1U) != 0) {
            return;
        }
        control = value & ~(1U << 7U);
        if ((value & 1U << 7U) == 0) {
            return;
        }
        EXPECT_EQ(value & 0xEU, 4U) << "a sector, not the bank, and no program";
        EXPECT_EQ(value >> 4U & 3U, 3U) << "64 bits at once";
        const std::uint32_t sector = value >> 8U & 7U;
        ASSERT_TRUE(sector == kFirstOfBank || sector == kFirstOfBank + 1) << "not ours";
        if (is_protected) {
            status |= 1U << 17U;
            return;
        }
        begin();
        for (std::uint32_t i = 0; i < kBankSector / 4; ++i) {
            words[(sector - kFirstOfBank) * kBankSector / 4 + i] = kBlank;
            wrong_code[((sector - kFirstOfBank) * kBankSector + 4 * i) / 32] = false;
        }
    }
    void begin()
    {
        status |= 4U;
        busy_left = busy_looks;
    }
    std::optional<std::uint32_t> read_word(std::uint32_t offset)
    {
        touched_busy = touched_busy || (status & 7U) != 0;
        if (!wrong_code[offset / 32]) {
            return words[offset / 4];
        }
        status |= kDoubleError;
        return faults_bus ? std::nullopt : std::optional(words[offset / 4]);
    }
    void write_word(std::uint32_t offset, std::uint32_t value)
    {
        ++word_writes;
        if ((control & 1U) != 0 || (control & 2U) == 0) {
            status |= 1U << 18U;  // sequence
            return;
        }
        if (is_protected) {
            status |= 1U << 17U;
            return;
        }
        if (buffered > 0 && buffer_for != offset / 32) {
            status |= 1U << 21U;  // inconsistency
            return;
        }
        EXPECT_EQ(offset % 32 / 4, buffered) << "in their order";
        buffer_for = offset / 32;
        buffer[buffered++] = value;
        status |= 2U;
        if (buffered < 8) {
            return;
        }
        status &= ~2U;
        for (std::uint32_t i = 0; i < 8; ++i) {
            std::uint32_t& cell = words[buffer_for * 8 + i];
            wrong_code[buffer_for] = wrong_code[buffer_for] || cell != kBlank || tears;
            cell &= buffer[i];
        }
        buffered = 0;
        begin();
    }
};

struct ByBank {
    BankModel* m;
    [[nodiscard]] std::uint32_t read(std::uint32_t offset) const { return m->read(offset); }
    void write(std::uint32_t offset, std::uint32_t value) const { m->write(offset, value); }
};
struct ByFlashWord {
    BankModel* m;
    [[nodiscard]] std::optional<std::uint32_t> read(std::uint32_t offset) const { return m->read_word(offset); }
    void write(std::uint32_t offset, std::uint32_t value) const { m->write_word(offset, value); }
};
struct AnnouncedErase {
    BankModel* m;
    void operator()(bool erasing) const { m->erasing.push_back(erasing); }
};
using BankFlash = stm32h7::Flash<ByBank, ByFlashWord, AnnouncedErase>;

FlashWord random_unit(Random& random)
{
    FlashWord unit{};
    for (std::uint32_t& word : unit) {
        word = static_cast<std::uint32_t>(random.next());
    }
    return unit;
}

class FlashDriverH7 : public testing::Test {
protected:
    BankModel model;
    BankFlash flash{ByBank{&model}, ByFlashWord{&model}, kFirstOfBank, AnnouncedErase{&model}, 1000};
    FlashWord unit{1, 2, 3, 4, 5, 6, 7, 8};

    void TearDown() override
    {
        EXPECT_FALSE(model.touched_busy);
        EXPECT_FALSE(model.faulted) << "a key too many";
    }
    [[nodiscard]] bool is_locked() const { return (model.control & 1U) != 0; }
};

TEST_F(FlashDriverH7, UnitsAreProgrammedWhereTheyBelongAndTheControllerIsLockedAgain)
{
    EXPECT_EQ(flash.unit_bytes(), 32U);
    EXPECT_EQ(flash.sector_bytes(), kBankSector);
    Random random(5);
    std::map<std::uint32_t, FlashWord> written;
    for (int i = 0; i < 300; ++i) {
        const auto sector = static_cast<std::uint32_t>(random.below(2));
        const auto offset = static_cast<std::uint32_t>(32 * random.below(kBankSector / 32));
        const FlashWord words = random_unit(random);
        if (!written.emplace((sector * kBankSector + offset) / 32, words).second) {
            continue;
        }
        EXPECT_EQ(flash.read(sector, offset), kBlank);
        EXPECT_TRUE(flash.program(sector, offset, words));
        for (std::uint32_t k = 0; k < 8; ++k) {
            EXPECT_EQ(flash.read(sector, offset + 4 * k), words[k]);
        }
        EXPECT_TRUE(is_locked());
    }
    for (std::uint32_t i = 0; i < model.words.size(); ++i) {
        const auto at = written.find(i / 8);
        ASSERT_EQ(model.words[i], at == written.end() ? kBlank : at->second[i % 8]) << i;
    }
    EXPECT_TRUE(model.erasing.empty());
}

TEST_F(FlashDriverH7, TheSectorThatIsNamedIsErasedAndNoOther)
{
    for (const std::uint32_t sector : {0U, 1U, 0U}) {
        ASSERT_TRUE(flash.program(0, 64, unit));
        ASSERT_TRUE(flash.program(1, kBankSector - 32, unit));
        EXPECT_TRUE(flash.erase(sector));
        EXPECT_TRUE(is_locked());
        EXPECT_EQ(flash.read(0, 64), sector == 0 ? kBlank : 1U);
        EXPECT_EQ(flash.read(1, kBankSector - 4), sector == 1 ? kBlank : 8U);
        ASSERT_TRUE(flash.erase(1 - sector));
    }
    EXPECT_EQ(model.erasing.size(), 12U);
}

TEST_F(FlashDriverH7, AWrongCodeIsUnreadableAsABusFaultOrAsAFlagAndDoesNotOutlastItsUnit)
{
    for (const bool faults_bus : {true, false}) {
        model.faults_bus = faults_bus;
        ASSERT_TRUE(flash.erase(0));
        ASSERT_TRUE(flash.program(0, 0, unit));
        model.wrong_code[1] = true;
        for (std::uint32_t offset = 32; offset < 64; offset += 4) {
            EXPECT_EQ(flash.read(0, offset), std::nullopt);
            EXPECT_EQ(model.status & kDoubleError, 0U) << "cleared";
            EXPECT_EQ(flash.read(0, 0), 1U);
            EXPECT_EQ(flash.read(0, 64), kBlank);
        }
    }
    model.status |= kDoubleError;  // a debugger's read
    EXPECT_EQ(flash.read(0, 0), 1U);
}

TEST_F(FlashDriverH7, ATornProgramIsAFailureAndTheSectorCanBeErased)
{
    model.tears = true;
    EXPECT_FALSE(flash.program(0, 0, unit));
    EXPECT_EQ(flash.read(0, 0), std::nullopt);
    EXPECT_TRUE(is_locked());
    model.tears = false;
    EXPECT_TRUE(flash.erase(0));
    EXPECT_TRUE(flash.program(0, 0, unit));
}

TEST_F(FlashDriverH7, AUnitThatIsNotErasedIsRefusedAndStaysReadable)
{
    ASSERT_TRUE(flash.program(0, 0, unit));
    const int writes = model.word_writes;
    EXPECT_FALSE(flash.program(0, 0, unit));
    EXPECT_FALSE(flash.program(0, 0, FlashWord{}));
    EXPECT_EQ(model.word_writes, writes);
    EXPECT_EQ(flash.read(0, 28), 8U);
}

TEST_F(FlashDriverH7, OnlyWholeUnitsAreProgrammed)
{
    for (const std::size_t words : {std::size_t{0}, std::size_t{1}, std::size_t{7}}) {
        EXPECT_FALSE(flash.program(0, 0, std::span(unit).first(words)));
    }
    for (std::uint32_t offset = 4; offset < 32; offset += 4) {
        EXPECT_FALSE(flash.program(0, offset, unit));
    }
    EXPECT_EQ(model.writes, 0);
    EXPECT_EQ(model.word_writes, 0);
}

TEST_F(FlashDriverH7, WhoWatchesIsAskedForPatienceAroundAnEraseAlsoWhereItFails)
{
    EXPECT_TRUE(flash.erase(1));
    EXPECT_EQ(model.erasing, (std::vector<bool>{true, false}));
    model.is_protected = true;
    EXPECT_FALSE(flash.erase(1));
    EXPECT_EQ(model.erasing, (std::vector<bool>{true, false, true, false}));
}

TEST_F(FlashDriverH7, WriteProtectionIsAFailureAndTheNextOperationStartsWithoutItsError)
{
    model.is_protected = true;
    EXPECT_FALSE(flash.program(0, 0, unit));
    EXPECT_FALSE(flash.erase(0));
    EXPECT_TRUE(is_locked());
    model.is_protected = false;
    EXPECT_TRUE(flash.program(0, 0, unit));
    EXPECT_TRUE(flash.erase(0));
}

TEST_F(FlashDriverH7, ErrorsOfEachKindThatADebuggerLeftAreClearedFirst)
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
        struct Erring {
            BankModel* m;
            std::uint32_t error;
            [[nodiscard]] std::optional<std::uint32_t> read(std::uint32_t offset) const { return m->read_word(offset); }
            void write(std::uint32_t offset, std::uint32_t value) const
            {
                m->write_word(offset, value);
                m->status |= error;
            }
        };
        stm32h7::Flash<ByBank, Erring, AnnouncedErase> erring{ByBank{&model}, Erring{&model, 1U << bit}, kFirstOfBank,
                                                              AnnouncedErase{&model}, 1000};
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

TEST_F(FlashDriverH7, AControllerThatIsAbsentOrUnlockedIsLeftAlone)
{
    model.absent = true;
    EXPECT_FALSE(flash.program(0, 0, unit));
    EXPECT_FALSE(flash.erase(0));
    model.absent = false;
    model.control = 0;
    EXPECT_FALSE(flash.program(0, 0, unit));
    EXPECT_FALSE(flash.erase(0));
    EXPECT_EQ(model.writes, 0);
    EXPECT_EQ(model.word_writes, 0);
    EXPECT_TRUE(model.erasing.empty());
}

TEST_F(FlashDriverH7, KeysThatAreRefusedAreNotTriedAgain)
{
    model.refuses_keys = true;
    EXPECT_FALSE(flash.program(0, 0, unit));
    EXPECT_FALSE(flash.program(0, 0, unit));
    EXPECT_FALSE(flash.erase(0));
    EXPECT_EQ(model.word_writes, 0);
    EXPECT_TRUE(model.erasing.empty());
}

TEST_F(FlashDriverH7, AControllerThatStaysBusyEndsTheWaitAndIsNotChangedAgain)
{
    for (const bool erases : {false, true}) {
        BankModel stuck;
        BankFlash driver{ByBank{&stuck}, ByFlashWord{&stuck}, kFirstOfBank, AnnouncedErase{&stuck}, 1000};
        stuck.stays_busy = true;
        EXPECT_FALSE(erases ? driver.erase(0) : driver.program(0, 0, unit));
        const int writes = stuck.writes;
        EXPECT_FALSE(driver.erase(0));
        EXPECT_FALSE(driver.program(1, 0, unit));
        EXPECT_EQ(driver.read(0, 0), std::nullopt);
        EXPECT_EQ(stuck.writes, writes);
        EXPECT_FALSE(stuck.touched_busy);
        EXPECT_EQ(stuck.erasing.size(), erases ? 2U : 0U);
    }
}

}  // namespace
}  // namespace jink::hal
