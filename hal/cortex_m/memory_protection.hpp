// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "hal/register_block.hpp"

// The memory protection unit (ARMv7-M Architecture Reference Manual, B3.5). Callers wait with a barrier before they
// rely on a change.

namespace jink::hal::cortex_m {

/// Base of the System blocks below.
inline constexpr std::uintptr_t kSystemControl = 0xE000E000;

/// What may be done in a region. No region is executable.
enum class Access : std::uint8_t {
    none,  ///< each access faults; fault handlers have access
    /// Read and written in the program's order, nothing cached, nothing read ahead.
    strongly_ordered,
};

struct ProtectedRegion {
    std::uint32_t number;     ///< 0 .. 7 at least; where two overlap, the higher one counts
    std::uint32_t base;       ///< a multiple of the size
    std::uint32_t log2_size;  ///< of the size [bytes]: 5 .. 32
    Access access;
    std::uint8_t left_out = 0;  ///< bit i: eighth i of the region is left out; from 256 bytes on
};

/// Sets a region and turns the unit on, with the default memory map elsewhere. False, with nothing changed, if the
/// processor has no such region. O(1).
template <RegisterBlock System>
bool protect(System system, const ProtectedRegion& region) noexcept
{
    constexpr std::uint32_t kType = 0xD90;
    constexpr std::uint32_t kControl = 0xD94;
    constexpr std::uint32_t kNumber = 0xD98;
    constexpr std::uint32_t kBase = 0xD9C;
    constexpr std::uint32_t kSize = 0xDA0;
    constexpr std::uint32_t kNotExecutable = 1U << 28U;
    constexpr std::uint32_t kReadWrite = 3U << 24U;
    constexpr std::uint32_t kOn = 1;
    constexpr std::uint32_t kOnWithDefaults = 5;
    if (region.number >= (system.read(kType) >> 8U & 0xFFU)) {
        return false;
    }
    const std::uint32_t access = region.access == Access::none ? 0U : kReadWrite;
    system.write(kNumber, region.number);
    system.write(kBase, region.base);
    system.write(kSize, kNotExecutable | access | static_cast<std::uint32_t>(region.left_out) << 8U |
                            (region.log2_size - 1U) << 1U | kOn);
    system.write(kControl, kOnWithDefaults);
    return true;
}

/// Size of the region below the stack that guard_stack() protects: above the size of any stack here, so that no
/// overflow reaches beyond it. No larger: what chips keep of themselves lies near, as the STM32F405's unique id.
inline constexpr std::uint32_t kStackGuardLog2 = 15;

/// Whether an address lies in what guard_stack() protects.
[[nodiscard]] constexpr bool is_guarded(std::uintptr_t stack_bottom, std::uintptr_t address) noexcept
{
    return address < stack_bottom && stack_bottom - address <= (std::uintptr_t{1} << kStackGuardLog2);
}

/// Denies access to the memory below a stack, which might take an overflow without a fault. False if the stack does not
/// begin on a multiple of the region's size, or there is no such region. Start-up gives region 0 to the program's
/// stack.
template <RegisterBlock System>
bool guard_stack(System system, std::uintptr_t stack_bottom, std::uint32_t region = 0) noexcept
{
    constexpr std::uintptr_t kBytes = std::uintptr_t{1} << kStackGuardLog2;
    return stack_bottom >= kBytes && stack_bottom % kBytes == 0 &&
           protect(system, {region, static_cast<std::uint32_t>(stack_bottom - kBytes), kStackGuardLog2, Access::none});
}

}  // namespace jink::hal::cortex_m
