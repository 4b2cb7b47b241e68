// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>

// Access to the processor's own registers for all Cortex-M images (ARMv7-M Architecture Reference Manual, B3).

namespace jink::hal::cortex_m {

using Register = volatile std::uint32_t;

[[nodiscard]] inline Register& at(std::uintptr_t address) noexcept
{
    return *reinterpret_cast<Register*>(address);  // NOLINT(performance-no-int-to-ptr): that is where it is
}

inline constexpr std::uintptr_t kNvicEnable = 0xE000E100;   ///< ISER0
inline constexpr std::uintptr_t kNvicPending = 0xE000E200;  ///< ISPR0

/// Waits for all accesses, and has the processor fetch its instructions anew.
inline void barrier() noexcept { __asm volatile("dsb\nisb" ::: "memory"); }

/// Enables interrupt `irq` (0..239).
inline void enable_interrupt(unsigned irq) noexcept { at(kNvicEnable + 4U * (irq / 32U)) = 1U << (irq % 32U); }

/// Raises an interrupt in software, so that a driver's handler does all work on the driver's registers.
class Pend {
public:
    explicit constexpr Pend(unsigned irq) noexcept : irq_(irq) {}
    void operator()() const noexcept { at(kNvicPending + 4U * (irq_ / 32U)) = 1U << (irq_ % 32U); }

private:
    unsigned irq_;
};

/// The registers of one peripheral.
class MappedRegisters {
public:
    explicit constexpr MappedRegisters(std::uintptr_t base) noexcept : base_(base) {}
    [[nodiscard]] std::uint32_t read(std::uint32_t offset) const noexcept { return at(base_ + offset); }
    void write(std::uint32_t offset, std::uint32_t value) const noexcept { at(base_ + offset) = value; }

private:
    std::uintptr_t base_;
};

}  // namespace jink::hal::cortex_m
