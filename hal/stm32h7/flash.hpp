// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <concepts>

#include "hal/stm32/flash_controller.hpp"

namespace jink::hal::stm32h7 {

/// Memory whose reads may fail with a bus fault that is reported instead of taken. The writes reach the memory in their
/// order, and in the order with those to the controller.
template <class T>
concept FaultTolerantMemory = requires(T& block, std::uint32_t offset, std::uint32_t value)
{
    {
        block.read(offset)
        } -> std::same_as<std::optional<std::uint32_t>>;
    block.write(offset, value);
};

/// Bank 2 (ST RM0433, 4.9; ST's stm32h743xx.h).
struct FlashLayout {
    static constexpr std::uint32_t kKey = 0x104;
    static constexpr std::uint32_t kControl = 0x10C;
    static constexpr std::uint32_t kStatus = 0x110;
    static constexpr std::uint32_t kClear = 0x114;  // by ones
    /// Write protection, sequence, strobe, inconsistency, operation, read protection, secure area.
    static constexpr std::uint32_t kErrors =
        1U << 17U | 1U << 18U | 1U << 19U | 1U << 21U | 1U << 22U | 1U << 23U | 1U << 24U;
    static constexpr std::uint32_t kDoubleError = 1U << 26U;                            // of the code: not corrected
    static constexpr std::uint32_t kOtherFlags = 1U << 16U | 1U << 25U | kDoubleError;  // end of operation, corrected
    static constexpr std::uint32_t kBusy = 7U;  // busy, write buffer not empty, operations waiting
    static constexpr std::uint32_t kLock = 1U << 0U;
};

/// Two neighbouring sectors of 128 KiB in bank 2 of the STM32H743's flash of 2 MiB (ST RM0433, 4.3 and 4.9), programmed
/// by flash words of 256 bits. Each has a code of 10 bits that corrects one wrong bit and detects two. A flash word
/// that was cut within its program reads with a bus fault, if the code detects it: read() reports it.
///
/// The program runs from bank 1: neither the processor nor interrupts stop during an operation, but program() and
/// erase() wait for its end: 100 us for a flash word (200 us at most), 1 s for a sector (2 s at most; ST DS12110,
/// tables 43 and 140: 64 bits at once, which needs a supply of 1.8 V). With its banks swapped (an option), the chip has
/// other sectors at these addresses: they are read, and neither programmed nor erased.
///
/// @tparam Memory   the sectors' memory, not cached, as ordered as devices
/// @tparam Erasing  called with true before a sector is erased and with false afterwards: watchdogs must allow for
///                  the time between
template <RegisterBlock Registers, FaultTolerantMemory Memory, class Erasing>
class Flash final : public FlashRegion {
public:
    static constexpr std::uint32_t kSectorBytes = 128U * 1024U;
    static constexpr std::uint32_t kUnitBytes = 32;
    /// Polls; a poll takes 10 cycles of 400 MHz or more (the bus has half of the processor's clock), so 2.5 s or more.
    static constexpr std::uint32_t kErasePatience = 100'000'000;

    /// @param registers  the controller's
    /// @param memory     the flash itself, from the first of the two sectors on
    /// @param first      number of that sector in bank 2, 0..6
    Flash(Registers registers, Memory memory, std::uint32_t first, Erasing erasing,
          std::uint32_t erase_patience = kErasePatience) noexcept
        : controller_(registers), memory_(memory), erasing_(erasing), first_(first), erase_patience_(erase_patience)
    {
    }

    [[nodiscard]] std::uint32_t sector_bytes() const noexcept override { return kSectorBytes; }
    [[nodiscard]] std::uint32_t unit_bytes() const noexcept override { return kUnitBytes; }

    [[nodiscard]] std::optional<std::uint32_t> read(std::uint32_t sector, std::uint32_t offset) noexcept override
    {
        if (controller_.is_broken()) {
            return std::nullopt;  // a read of a busy bank would wait for ever
        }
        Registers& registers = controller_.registers();
        registers.write(FlashLayout::kClear, FlashLayout::kDoubleError);
        const std::optional<std::uint32_t> word = memory_.read(sector * kSectorBytes + offset);
        if ((registers.read(FlashLayout::kStatus) & FlashLayout::kDoubleError) == 0) {
            return word;
        }
        registers.write(FlashLayout::kClear, FlashLayout::kDoubleError);
        return std::nullopt;
    }

    [[nodiscard]] bool program(std::uint32_t sector, std::uint32_t offset,
                               std::span<const std::uint32_t> unit) noexcept override
    {
        // A flash word that is not erased would get a wrong code.
        if (unit.size() != kUnitWords || offset % kUnitBytes != 0 || !reads_as(sector, offset, kErased) ||
            is_swapped() || !controller_.unlock()) {
            return false;
        }
        controller_.control(kDoubleWords | kProgram);
        for (std::uint32_t i = 0; i < kUnitWords; ++i) {
            memory_.write(sector * kSectorBytes + offset + 4U * i, unit[i]);  // the last one starts the program
        }
        return controller_.finish(kProgramPatience) && reads_as(sector, offset, unit);
    }

    [[nodiscard]] bool erase(std::uint32_t sector) noexcept override
    {
        if (is_swapped() || !controller_.unlock()) {
            return false;
        }
        const std::uint32_t which = kDoubleWords | kSectorErase | (first_ + sector) << kSectorNumber;
        erasing_(true);
        controller_.control(which);
        controller_.control(which | kStart);
        const bool done = controller_.finish(erase_patience_);
        erasing_(false);
        return done;
    }

private:
    static constexpr std::uint32_t kOptions = 0x18;  // FLASH_OPTCR
    static constexpr std::uint32_t kSwapBank = 1U << 31U;
    static constexpr std::uint32_t kProgram = 1U << 1U;  // of the control register
    static constexpr std::uint32_t kSectorErase = 1U << 2U;
    static constexpr std::uint32_t kDoubleWords = 3U << 4U;
    static constexpr std::uint32_t kStart = 1U << 7U;
    static constexpr std::uint32_t kSectorNumber = 8;

    static constexpr std::uint32_t kUnitWords = kUnitBytes / 4U;
    static constexpr std::array<std::uint32_t, kUnitWords> kErased{0xFFFFFFFF, 0xFFFFFFFF, 0xFFFFFFFF, 0xFFFFFFFF,
                                                                   0xFFFFFFFF, 0xFFFFFFFF, 0xFFFFFFFF, 0xFFFFFFFF};
    static constexpr std::uint32_t kProgramPatience = 20'000;

    [[nodiscard]] bool is_swapped() noexcept { return (controller_.registers().read(kOptions) & kSwapBank) != 0; }

    [[nodiscard]] bool reads_as(std::uint32_t sector, std::uint32_t offset,
                                std::span<const std::uint32_t> unit) noexcept
    {
        for (std::uint32_t i = 0; i < kUnitWords; ++i) {
            if (read(sector, offset + 4U * i) != unit[i]) {
                return false;
            }
        }
        return true;
    }

    stm32::FlashController<FlashLayout, Registers> controller_;
    Memory memory_;
    Erasing erasing_;
    std::uint32_t first_;
    std::uint32_t erase_patience_;
};

}  // namespace jink::hal::stm32h7
