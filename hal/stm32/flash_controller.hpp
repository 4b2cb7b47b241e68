// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "hal/flash_region.hpp"
#include "hal/register_block.hpp"

namespace jink::hal::stm32 {

/// Keys, lock and waiting of an STM32's flash controller, or of one of its banks.
///
/// The controller is locked except during an operation. A controller that does not read as locked beforehand is absent
/// or faulty, and is not used. A controller that stays busy or locked is never accessed again, because the chip would
/// stop, or fault.
///
/// @tparam Layout  offsets and bits: hal/stm32f4/flash.hpp, hal/stm32h7/flash.hpp
template <class Layout, RegisterBlock Registers>
class FlashController {
public:
    explicit FlashController(Registers registers) noexcept : registers_(registers) {}

    [[nodiscard]] Registers& registers() noexcept { return registers_; }

    /// Prepares an operation, with the errors of earlier ones cleared. False: there must be none. O(1).
    [[nodiscard]] bool unlock() noexcept
    {
        constexpr std::uint32_t kKey1 = 0x45670123;
        constexpr std::uint32_t kKey2 = 0xCDEF89AB;
        if (broken_ || (registers_.read(Layout::kControl) & Layout::kLock) == 0 ||
            (registers_.read(Layout::kStatus) & Layout::kBusy) != 0) {
            return false;
        }
        registers_.write(Layout::kKey, kKey1);
        registers_.write(Layout::kKey, kKey2);
        broken_ = (registers_.read(Layout::kControl) & Layout::kLock) != 0;  // repeating the keys is a bus fault
        if (broken_) {
            return false;
        }
        registers_.write(Layout::kClear, Layout::kErrors | Layout::kOtherFlags);  // also a debugger's
        return true;
    }

    /// Begins what `bits` of the control register say. The read waits until the register has them.
    void control(std::uint32_t bits) noexcept
    {
        registers_.write(Layout::kControl, bits);
        static_cast<void>(registers_.read(Layout::kControl));
    }

    /// Waits for the end, at most `patience` polls, and locks. False: an error, or a time-out.
    [[nodiscard]] bool finish(std::uint32_t patience) noexcept
    {
        std::uint32_t status = registers_.read(Layout::kStatus);
        for (std::uint32_t i = 0; i < patience && (status & Layout::kBusy) != 0; ++i) {
            status = registers_.read(Layout::kStatus);
        }
        broken_ = (status & Layout::kBusy) != 0;
        if (broken_) {
            return false;  // a write to the control register would stop the bus
        }
        registers_.write(Layout::kControl, Layout::kLock);
        return (status & Layout::kErrors) == 0;
    }

    /// Ended by a time-out or by refused keys.
    [[nodiscard]] bool is_broken() const noexcept { return broken_; }

private:
    Registers registers_;
    bool broken_ = false;
};

}  // namespace jink::hal::stm32
