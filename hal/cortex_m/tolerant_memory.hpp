// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include "hal/cortex_m/cortex_m.hpp"

namespace jink::hal::cortex_m {

/// Memory whose reads may fail: a bus fault of a read is reported instead of taken, as by a wrong code of flash
/// (ARMv7-M Architecture Reference Manual, B1.5.14 and B3.2.8). For the main program. Interrupts wait for the time of a
/// read.
///
/// The memory must be strongly ordered (memory_protection.hpp): nothing may be read ahead of time. O(1).
class TolerantMemory {
public:
    explicit constexpr TolerantMemory(std::uintptr_t base) noexcept : base_(base) {}

    [[nodiscard]] std::optional<std::uint32_t> read(std::uint32_t offset) const noexcept
    {
        constexpr std::uintptr_t kConfiguration = 0xE000ED14;  // CCR
        constexpr std::uint32_t kIgnoreBusFaults = 1U << 8U;   // at the priority of a fault, which FAULTMASK gives
        constexpr std::uintptr_t kFaultCause = 0xE000ED28;     // CFSR
        constexpr std::uint32_t kBusFaults = 0xFF00;           // cleared by ones
        __asm volatile("cpsid f" ::: "memory");
        at(kConfiguration) = at(kConfiguration) | kIgnoreBusFaults;
        barrier();
        const std::uint32_t word = at(base_ + offset);
        barrier();
        const bool failed = (at(kFaultCause) & kBusFaults) != 0;
        at(kFaultCause) = kBusFaults;
        at(kConfiguration) = at(kConfiguration) & ~kIgnoreBusFaults;
        barrier();
        __asm volatile("cpsie f" ::: "memory");
        return failed ? std::nullopt : std::optional(word);
    }

    /// After all accesses before it, and before those after it.
    void write(std::uint32_t offset, std::uint32_t value) const noexcept
    {
        barrier();
        at(base_ + offset) = value;
        barrier();
    }

private:
    std::uintptr_t base_;
};

}  // namespace jink::hal::cortex_m
