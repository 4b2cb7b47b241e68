// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "hal/register_block.hpp"

namespace jink::hal::cortex_m {

/// The processor's counter of clock cycles (ARMv7-M Architecture Reference Manual, C1.6.5 and C1.8). All calls O(1).
template <RegisterBlock System>
class CycleCounter {
public:
    /// Starts it. `system` is the block at 0xE0000000. Processors may lack the counter, and qemu does: is_there().
    explicit CycleCounter(System system) noexcept : system_(system)
    {
        system_.write(kDebugControl, system_.read(kDebugControl) | kTraceOn);
        system_.write(kLock, kKey);  // a Cortex-M7 locks the counter's registers, others ignore this
        system_.write(kControl, system_.read(kControl) | kCounts);
        const std::uint32_t control = system_.read(kControl);
        is_there_ = (control & kCounts) != 0 && (control & kNone) == 0;
    }

    [[nodiscard]] bool is_there() const noexcept { return is_there_; }
    /// Wraps after 2^32 cycles: 19 s at 216 MHz.
    [[nodiscard]] std::uint32_t cycles() const noexcept { return system_.read(kCycles); }

private:
    static constexpr std::uint32_t kControl = 0x1000;  // DWT_CTRL
    static constexpr std::uint32_t kCycles = 0x1004;   // DWT_CYCCNT
    static constexpr std::uint32_t kLock = 0x1FB0;     // DWT_LAR
    static constexpr std::uint32_t kKey = 0xC5ACCE55;
    static constexpr std::uint32_t kDebugControl = 0xEDFC;  // DEMCR
    static constexpr std::uint32_t kTraceOn = 1U << 24U;    // TRCENA
    static constexpr std::uint32_t kCounts = 1U << 0U;      // CYCCNTENA
    static constexpr std::uint32_t kNone = 1U << 25U;       // NOCYCCNT

    System system_;
    bool is_there_ = false;
};

}  // namespace jink::hal::cortex_m
