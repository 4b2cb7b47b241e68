// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "hal/stm32/flash_controller.hpp"

namespace jink::hal::stm32f4 {

/// ST RM0090, 3.9.
struct FlashLayout {
    static constexpr std::uint32_t kKey = 0x04;
    static constexpr std::uint32_t kStatus = 0x0C;
    static constexpr std::uint32_t kClear = kStatus;  // by ones
    static constexpr std::uint32_t kControl = 0x10;
    /// Operation, write protection, alignment, parallelism, sequence.
    static constexpr std::uint32_t kErrors = 1U << 1U | 1U << 4U | 1U << 5U | 1U << 6U | 1U << 7U;
    static constexpr std::uint32_t kOtherFlags = 1U << 0U;  // end of operation
    static constexpr std::uint32_t kBusy = 1U << 16U;
    static constexpr std::uint32_t kLock = 1U << 31U;
};

/// Two neighbouring sectors of 128 KiB of the STM32F405's flash (ST RM0090, 3.5 to 3.9), programmed by 32-bit words:
/// the supply must be 2.7 V or more.
///
/// During an operation the processor stops at its next fetch from flash, and interrupts wait: 16 us for a word (100 us
/// at most), 1 s for a sector (2 s at most; ST DS8626, flash memory characteristics).
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
        : controller_(registers), memory_(memory), erasing_(erasing), first_(first), erase_patience_(erase_patience)
    {
    }

    [[nodiscard]] std::uint32_t sector_bytes() const noexcept override { return kSectorBytes; }
    [[nodiscard]] std::uint32_t unit_bytes() const noexcept override { return 4; }

    [[nodiscard]] std::optional<std::uint32_t> read(std::uint32_t sector, std::uint32_t offset) noexcept override
    {
        if (controller_.is_broken()) {
            return std::nullopt;  // a read of a busy flash would stop the bus
        }
        return memory_.read(sector * kSectorBytes + offset);
    }

    [[nodiscard]] bool program(std::uint32_t sector, std::uint32_t offset,
                               std::span<const std::uint32_t> unit) noexcept override
    {
        if (unit.size() != 1 || !controller_.unlock()) {
            return false;
        }
        controller_.control(kWords | kProgram);
        memory_.write(sector * kSectorBytes + offset, unit[0]);
        return finish(kProgramPatience) && read(sector, offset) == unit[0];
    }

    [[nodiscard]] bool erase(std::uint32_t sector) noexcept override
    {
        if (!controller_.unlock()) {
            return false;
        }
        const std::uint32_t which = kWords | kSectorErase | (first_ + sector) << kSectorNumber;
        erasing_(true);
        controller_.control(which);
        controller_.registers().write(FlashLayout::kControl, which | kStart);
        const bool done = finish(erase_patience_);
        erasing_(false);
        return done;
    }

private:
    static constexpr std::uint32_t kAccess = 0x00;  // FLASH_ACR
    static constexpr std::uint32_t kDataCache = 1U << 10U;
    static constexpr std::uint32_t kDataCacheReset = 1U << 12U;
    static constexpr std::uint32_t kProgram = 1U << 0U;  // of the control register
    static constexpr std::uint32_t kSectorErase = 1U << 1U;
    static constexpr std::uint32_t kSectorNumber = 3;
    static constexpr std::uint32_t kWords = 2U << 8U;
    static constexpr std::uint32_t kStart = 1U << 16U;

    static constexpr std::uint32_t kProgramPatience = 10'000;

    [[nodiscard]] bool finish(std::uint32_t patience) noexcept
    {
        const bool good = controller_.finish(patience);
        if (!controller_.is_broken()) {
            forget_cached_data();
        }
        return good;
    }

    /// The cache may hold older data than the programmed or erased flash. It can be reset only while off. No code lies
    /// in the two sectors: cached instructions stay valid.
    void forget_cached_data() noexcept
    {
        Registers& registers = controller_.registers();
        const std::uint32_t access = registers.read(kAccess);
        const std::uint32_t off = access & ~kDataCache;
        registers.write(kAccess, off);
        registers.write(kAccess, off | kDataCacheReset);
        registers.write(kAccess, off);
        registers.write(kAccess, access);
    }

    stm32::FlashController<FlashLayout, Registers> controller_;
    Memory memory_;
    Erasing erasing_;
    std::uint32_t first_;
    std::uint32_t erase_patience_;
};

}  // namespace jink::hal::stm32f4
