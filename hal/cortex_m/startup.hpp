// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

// Start-up from reset to jink_main(), and the record kept when the processor faults. Memory comes from the image's
// linker script: _stack_bottom, _stack_top, _data_load, _data_start, _data_end, _bss_start, _bss_end,
// _init_array_start, _init_array_end.

namespace jink::hal::cortex_m {

using Handler = void (*)();

/// State of the processor when it faulted, kept across the reset that follows.
struct FaultRecord {
    std::uint32_t magic;
    std::uint32_t exception;  ///< number: 2 NMI (watchdog), 3 hard fault, 15 SysTick (step_guard); kSilentReset
    std::uint32_t pc;
    std::uint32_t lr;
    std::uint32_t cause;    ///< CFSR
    std::uint32_t address;  ///< BFAR or MMFAR, whichever is valid by the cause; else 0
    std::uint32_t count;    ///< faults since power-on
    std::uint32_t streak;   ///< of them since forgive_faults()
    std::uint32_t check;    ///< sum of the above, so that random RAM content at power-on does not count as a record
};

/// FaultRecord::exception of a reset without a fault: no further information.
inline constexpr std::uint32_t kSilentReset = 0x200;

/// Reads the record of the fault that led to this start; false after power-on. Marks it as read; the counts stay.
[[nodiscard]] bool take_fault_record(FaultRecord& out) noexcept;
/// Records a watchdog's reset; false if a fault has recorded it before.
[[nodiscard]] bool note_silent_reset() noexcept;
/// Ends the streak of faults: this start has proved itself.
void forgive_faults() noexcept;
/// Resets the counts: no fault since power-on.
void forget_faults() noexcept;

/// From here on, until the next start, a fault calls jink_on_fault: the data it needs are ready.
void let_faults_speak() noexcept;

/// A stack beside the program's, aligned to a word: what is kept of a fault on it has its program counter too.
void note_second_stack(std::span<std::byte> stack) noexcept;

/// Most bytes of stack used so far, by the pattern that start-up wrote to it. O(stack).
[[nodiscard]] std::size_t stack_used() noexcept;

/// Sleeps until an interrupt comes.
void wait_for_interrupt() noexcept;
/// Restarts the processor.
[[noreturn]] void reset() noexcept;

/// Starts SysTick's interrupt every `ticks` (1..2^24) of the processor clock, to wake up by.
void start_systick(std::uint32_t ticks) noexcept;

/// Called by the fault handler once its record is kept, with interrupts off, on an empty stack, if let_faults_speak()
/// was called since the start; the image sends its last words there. The reset follows. A fault within it, or before
/// let_faults_speak(), leads to the reset at once.
extern "C" void jink_on_fault(const FaultRecord& record);

/// The image's program; it does not return. Not called main(), which C++ reserves.
extern "C" void jink_main();

extern "C" [[noreturn]] void jink_reset_handler();
extern "C" void jink_fault_handler();
extern "C" void jink_systick_handler();
extern "C" std::uint32_t _stack_top;

}  // namespace jink::hal::cortex_m
