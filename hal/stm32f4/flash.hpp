// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "hal/flash_region.hpp"
#include "hal/register_block.hpp"

namespace jink::hal::stm32f4 {

/// Two neighbouring sectors of 128 KiB of the STM32F405's flash (ST RM0090, 3.5 to 3.9), programmed by 32-bit words:
/// the supply must be 2.7 V or more.
///
/// During an operation the processor stops at its next fetch from flash, and interrupts wait: 16 us for a word (100 us
/// at most), 1 s for a sector (2 s at most; ST DS8626, flash memory characteristics). The controller is locked except
/// during an operation. A controller that does not read as locked beforehand is absent or faulty, and is not used. A
/// controller that stays busy or locked is never accessed again, because the chip would stop, or fault.
///
/// @tparam Erasing  called with true before a sector is erased and with false afterwards: watchdogs must allow for
///                  the time between
template <RegisterBlock Registers, RegisterBlock Memory, class Erasing>
class Flash final : public FlashRegion {
public:
    static constexpr std::uint32_t kSectorBytes = 128U * 1024U;
    /// Polls; a poll takes 6 cycles of 168 MHz or more, so 3.5 s or more.
    static constexpr std::uint32_t kErasePatience = 100'000'000;

    /// @param registers  the controller's
    /// @param memory     the flash itself, from the first of the two sectors on
    /// @param first      number of that sector, 5..10
    Flash(Registers registers, Memory memory, std::uint32_t first, Erasing erasing,
          std::uint32_t erase_patience = kErasePatience) noexcept
        : registers_(registers), memory_(memory), erasing_(erasing), first_(first), erase_patience_(erase_patience)
    {
    }

    [[nodiscard]] std::uint32_t sector_bytes() const noexcept override { return kSectorBytes; }

    [[nodiscard]] std::uint32_t read(std::uint32_t sector, std::uint32_t offset) const noexcept override
    {
        return memory_.read(sector * kSectorBytes + offset);
    }

    [[nodiscard]] bool program(std::uint32_t sector, std::uint32_t offset, std::uint32_t word) noexcept override
    {
        if (!unlock()) {
            return false;
        }
        registers_.write(kControl, kWords | kProgram);
        memory_.write(sector * kSectorBytes + offset, word);
        return finish(kProgramPatience) && read(sector, offset) == word;
    }

    [[nodiscard]] bool erase(std::uint32_t sector) noexcept override
    {
        if (!unlock()) {
            return false;
        }
        const std::uint32_t which = kWords | kSectorErase | (first_ + sector) << kSectorNumber;
        erasing_(true);
        registers_.write(kControl, which);
        registers_.write(kControl, which | kStart);
        const bool done = finish(erase_patience_);
        erasing_(false);
        return done;
    }

private:
    static constexpr std::uint32_t kAccess = 0x00;  // FLASH_ACR
    static constexpr std::uint32_t kKey = 0x04;
    static constexpr std::uint32_t kStatus = 0x0C;
    static constexpr std::uint32_t kControl = 0x10;

    static constexpr std::uint32_t kDataCache = 1U << 10U;  // of kAccess
    static constexpr std::uint32_t kDataCacheReset = 1U << 12U;
    static constexpr std::uint32_t kKey1 = 0x45670123;
    static constexpr std::uint32_t kKey2 = 0xCDEF89AB;
    static constexpr std::uint32_t kEnd = 1U << 0U;  // of kStatus
    /// Operation, write protection, alignment, parallelism, sequence.
    static constexpr std::uint32_t kErrors = 1U << 1U | 1U << 4U | 1U << 5U | 1U << 6U | 1U << 7U;
    static constexpr std::uint32_t kBusy = 1U << 16U;
    static constexpr std::uint32_t kProgram = 1U << 0U;  // of kControl
    static constexpr std::uint32_t kSectorErase = 1U << 1U;
    static constexpr std::uint32_t kSectorNumber = 3;
    static constexpr std::uint32_t kWords = 2U << 8U;
    static constexpr std::uint32_t kStart = 1U << 16U;
    static constexpr std::uint32_t kLock = 1U << 31U;

    static constexpr std::uint32_t kProgramPatience = 10'000;

    [[nodiscard]] bool unlock() noexcept
    {
        if (broken_ || (registers_.read(kControl) & kLock) == 0 || (registers_.read(kStatus) & kBusy) != 0) {
            return false;
        }
        registers_.write(kKey, kKey1);
        registers_.write(kKey, kKey2);
        broken_ = (registers_.read(kControl) & kLock) != 0;  // repeating the keys is a bus fault
        if (broken_) {
            return false;
        }
        registers_.write(kStatus, kErrors | kEnd);  // of an earlier operation, or a debugger's
        return true;
    }

    /// Waits for the end, and locks. False: an error, or a time-out.
    [[nodiscard]] bool finish(std::uint32_t patience) noexcept
    {
        std::uint32_t status = registers_.read(kStatus);
        for (std::uint32_t i = 0; i < patience && (status & kBusy) != 0; ++i) {
            status = registers_.read(kStatus);
        }
        broken_ = (status & kBusy) != 0;
        if (broken_) {
            return false;  // a write to the control register would stop the bus
        }
        registers_.write(kControl, kLock);
        forget_cached_data();
        return (status & kErrors) == 0;
    }

    /// The cache may hold older data than the programmed or erased flash. It can be reset only while off. No code lies
    /// in the two sectors: cached instructions stay valid.
    void forget_cached_data() noexcept
    {
        const std::uint32_t access = registers_.read(kAccess);
        const std::uint32_t off = access & ~kDataCache;
        registers_.write(kAccess, off);
        registers_.write(kAccess, off | kDataCacheReset);
        registers_.write(kAccess, off);
        registers_.write(kAccess, access);
    }

    Registers registers_;
    Memory memory_;
    Erasing erasing_;
    std::uint32_t first_;
    std::uint32_t erase_patience_;
    bool broken_ = false;
};

}  // namespace jink::hal::stm32f4
