// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <map>
#include <vector>

#include <gtest/gtest.h>

#include "hal/stm32f4/flash.hpp"
#include "hal/stm32h7/flash.hpp"

// Models of the flash controllers of the STM32F4 (ST RM0090, 3.5 to 3.9) and of bank 2 of the STM32H743 (ST RM0433, 4.3
// and 4.9), written from the manuals.

namespace jink::hal {

inline constexpr std::uint32_t kModelSector = 128U * 1024U;
inline constexpr std::uint32_t kBlank = 0xFFFFFFFF;

/// What both have: two sectors, keys, a lock, operations that take time, and what can go wrong with them.
struct FlashModel {
    FlashModel(std::uint32_t lock_bit, std::uint32_t busy_bits, std::uint32_t first_sector)
        : lock(lock_bit), busy(busy_bits), first(first_sector), control(lock_bit)
    {
    }

    const std::uint32_t lock, busy, first;
    std::uint32_t status = 0, control;
    std::vector<std::uint32_t> words = std::vector<std::uint32_t>(2 * kModelSector / 4, kBlank);
    std::vector<bool> erasing;  ///< announcements of the driver
    int keys = 0;
    int writes = 0;       ///< to the controller, without those that clear flags
    int word_writes = 0;  ///< to the flash
    int busy_looks = 3;   ///< that an operation takes
    int busy_left = 0;
    bool stays_busy = false;
    bool refuses_keys = false;  ///< locked until the next reset, as after a wrong sequence
    bool is_protected = false;  ///< write protection of both sectors
    bool absent = false;        ///< an emulator's: reads as zero, takes anything
    bool bus_stalled = false;   ///< accessed while busy
    bool faulted = false;       ///< a key too many: a bus fault

    [[nodiscard]] bool is_locked() const { return (control & lock) != 0; }
    [[nodiscard]] bool is_busy() const { return (status & busy) != 0; }
    /// A read of the status.
    std::uint32_t poll()
    {
        if (!stays_busy && busy_left > 0 && --busy_left == 0) {
            status &= ~busy;
        }
        return status;
    }
    void begin(std::uint32_t bit)
    {
        status |= bit;
        busy_left = busy_looks;
    }
    void write_key(std::uint32_t value)
    {
        constexpr std::uint32_t kKeys[] = {0x45670123, 0xCDEF89AB};
        faulted = faulted || keys < 0 || !is_locked();
        if (keys < 0 || value != kKeys[keys]) {
            keys = -1;  // until the next reset
            return;
        }
        if (++keys == 2) {
            control &= refuses_keys ? control : ~lock;
            keys = refuses_keys ? -1 : 0;
        }
    }
    /// Whether it starts an erase.
    [[nodiscard]] bool takes_control(std::uint32_t value, std::uint32_t start)
    {
        bus_stalled = bus_stalled || is_busy();
        if (is_locked()) {
            return false;
        }
        control = value & ~start;
        return (value & start) != 0;
    }
    void erase_words(std::uint32_t sector)
    {
        for (std::uint32_t i = 0; i < kModelSector / 4; ++i) {
            words[(sector - first) * kModelSector / 4 + i] = kBlank;
        }
    }
};

/// Controller of the STM32F4, sectors 10 and 11, and a data cache that nothing but its reset keeps true.
struct ControllerModel : FlashModel {
    ControllerModel() : FlashModel(1U << 31U, 1U << 16U, 10) {}

    std::uint32_t access = 0x705;
    std::map<std::uint32_t, std::uint32_t> cache;

    std::uint32_t read(std::uint32_t offset)
    {
        switch (offset) {
        case 0x00: return absent ? 0 : access;
        case 0x0C: return absent ? 0 : poll();
        case 0x10: return absent ? 0 : control;
        default: ADD_FAILURE() << "not read: " << offset; return 0;
        }
    }
    void write(std::uint32_t offset, std::uint32_t value)
    {
        writes += offset == 0x0C ? 0 : 1;
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
    void write_control(std::uint32_t value)
    {
        if (!takes_control(value, 1U << 16U)) {
            return;
        }
        const std::uint32_t sector = value >> 3U & 0xFU;
        EXPECT_EQ(value & 0x7U, 2U) << "a sector, not all of the chip";
        ASSERT_TRUE(sector == first || sector == first + 1) << "the program lies there";
        if (is_protected) {
            status |= 1U << 4U;
            return;
        }
        begin(busy);
        erase_words(sector);
    }
    std::uint32_t read_word(std::uint32_t offset)
    {
        bus_stalled = bus_stalled || is_busy();
        if ((access & 1U << 10U) == 0) {
            return words[offset / 4];
        }
        return cache.emplace(offset, words[offset / 4]).first->second;
    }
    void write_word(std::uint32_t offset, std::uint32_t value)
    {
        ++word_writes;
        if (is_locked() || (control & 1U) == 0) {
            status |= 1U << 7U;
        } else if ((control >> 8U & 3U) != 2U) {
            status |= 1U << 6U;
        } else if (is_protected) {
            status |= 1U << 4U;
        } else {
            begin(busy);
            words[offset / 4] &= value;
        }
    }
};

/// Controller of bank 2 of the STM32H743, its sectors 6 and 7, and their code.
struct BankModel : FlashModel {
    BankModel() : FlashModel(1U << 0U, 7U, 6) { control |= 3U << 4U; }

    static constexpr std::uint32_t kDoubleError = 1U << 26U;

    std::uint32_t options = 0;
    std::vector<bool> wrong_code = std::vector<bool>(2 * kModelSector / 32, false);
    std::array<std::uint32_t, 8> buffer{};
    std::uint32_t buffered = 0;    ///< words
    std::uint32_t buffer_for = 0;  ///< flash word
    bool tears = false;            ///< programs leave a wrong code
    bool faults_bus = true;        ///< a wrong code is a bus fault too

    std::uint32_t read(std::uint32_t offset)
    {
        switch (offset) {
        case 0x018: return absent ? 0 : options;
        case 0x10C: return absent ? 0 : control;
        case 0x110: return absent ? 0 : poll();
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
    void write_control(std::uint32_t value)
    {
        if (!takes_control(value, 1U << 7U)) {
            return;
        }
        EXPECT_EQ(value & 0xEU, 4U) << "a sector, not the bank, and no program";
        EXPECT_EQ(value >> 4U & 3U, 3U) << "64 bits at once";
        const std::uint32_t sector = value >> 8U & 7U;
        ASSERT_TRUE(sector == first || sector == first + 1) << "not ours";
        if (is_protected) {
            status |= 1U << 17U;
            return;
        }
        begin(4U);
        erase_words(sector);
        for (std::uint32_t i = 0; i < kModelSector / 32; ++i) {
            wrong_code[(sector - first) * kModelSector / 32 + i] = false;
        }
    }
    std::optional<std::uint32_t> read_word(std::uint32_t offset)
    {
        bus_stalled = bus_stalled || is_busy();
        if (!wrong_code[offset / 32]) {
            return words[offset / 4];
        }
        status |= kDoubleError;
        return faults_bus ? std::nullopt : std::optional(words[offset / 4]);
    }
    void write_word(std::uint32_t offset, std::uint32_t value)
    {
        ++word_writes;
        if (is_locked() || (control & 2U) == 0) {
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
        begin(4U);
    }
};

template <class Model>
struct ByController {
    Model* m;
    [[nodiscard]] std::uint32_t read(std::uint32_t offset) const { return m->read(offset); }
    void write(std::uint32_t offset, std::uint32_t value) const { m->write(offset, value); }
};
/// The flash itself; `error` is what each write sets in the status besides.
template <class Model>
struct BySectors {
    Model* m;
    std::uint32_t error = 0;

    [[nodiscard]] auto read(std::uint32_t offset) const { return m->read_word(offset); }
    void write(std::uint32_t offset, std::uint32_t value) const
    {
        m->write_word(offset, value);
        m->status |= error;
    }
};
template <class Model>
struct Announced {
    Model* m;
    void operator()(bool erasing) const { m->erasing.push_back(erasing); }
};

/// A chip's model and driver.
struct FlashOfF4 {
    using Model = ControllerModel;
    using Driver = stm32f4::Flash<ByController<Model>, BySectors<Model>, Announced<Model>>;
};
struct FlashOfH7 {
    using Model = BankModel;
    using Driver = stm32h7::Flash<ByController<Model>, BySectors<Model>, Announced<Model>>;
};

template <class Chip>
[[nodiscard]] typename Chip::Driver flash_driver(typename Chip::Model& model, std::uint32_t error = 0)
{
    using Model = typename Chip::Model;
    return {ByController<Model>{&model}, BySectors<Model>{&model, error}, model.first, Announced<Model>{&model}, 1000};
}

}  // namespace jink::hal
