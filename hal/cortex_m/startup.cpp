// SPDX-License-Identifier: BSD-3-Clause
#include "hal/cortex_m/startup.hpp"

#include "hal/cortex_m/cortex_m.hpp"

extern "C" {
// NOLINTBEGIN(bugprone-reserved-identifier): the linker script's names
extern std::uint32_t _stack_bottom;
extern const std::uint32_t _data_load;
extern std::uint32_t _data_start;
extern std::uint32_t _data_end;
extern std::uint32_t _bss_start;
extern std::uint32_t _bss_end;
extern jink::hal::cortex_m::Handler _init_array_start;
extern jink::hal::cortex_m::Handler _init_array_end;
// NOLINTEND(bugprone-reserved-identifier)
void jink_main();
}

namespace jink::hal::cortex_m {
namespace {

constexpr std::uintptr_t kSystickControl = 0xE000E010;
constexpr std::uintptr_t kSystickReload = 0xE000E014;
constexpr std::uintptr_t kSystickValue = 0xE000E018;
constexpr std::uintptr_t kResetControl = 0xE000ED0C;  // AIRCR
constexpr std::uintptr_t kFaultCause = 0xE000ED28;    // CFSR
constexpr std::uintptr_t kMemoryAddress = 0xE000ED34;
constexpr std::uintptr_t kBusAddress = 0xE000ED38;
constexpr std::uintptr_t kCoprocessors = 0xE000ED88;  // CPACR

constexpr std::uint32_t kPaint = 0xC5C5C5C5;
constexpr std::uint32_t kMagic = 0x4A494E4B;

__attribute__((section(".noinit"))) FaultRecord kept;

std::uint32_t sum_of(const FaultRecord& r) noexcept
{
    return r.magic + r.exception + r.pc + r.lr + r.cause + r.address + r.count;
}

bool holds_record() noexcept { return kept.magic == kMagic && kept.check == sum_of(kept); }

}  // namespace

bool take_fault_record(FaultRecord& out) noexcept
{
    if (!holds_record() || kept.exception == 0) {
        return false;
    }
    out = kept;
    kept.exception = 0;  // the count stays
    kept.check = sum_of(kept);
    return true;
}

std::size_t stack_size() noexcept
{
    return static_cast<std::size_t>(&_stack_top - &_stack_bottom) * sizeof(std::uint32_t);
}

std::size_t stack_used() noexcept
{
    const std::uint32_t* word = &_stack_bottom;
    while (word < &_stack_top && *word == kPaint) {
        ++word;
    }
    return static_cast<std::size_t>(&_stack_top - word) * sizeof(std::uint32_t);
}

void wait_for_interrupt() noexcept { __asm volatile("wfi" ::: "memory"); }

void reset() noexcept
{
    constexpr std::uint32_t kKeyAndRequest = 0x05FA0004;
    __asm volatile("dsb" ::: "memory");
    at(kResetControl) = kKeyAndRequest;
    for (;;) {
    }
}

void start_systick(std::uint32_t ticks) noexcept
{
    constexpr std::uint32_t kProcessorClockInterruptOn = 7;
    at(kSystickReload) = ticks - 1;
    at(kSystickValue) = 0;
    at(kSystickControl) = kProcessorClockInterruptOn;
}

extern "C" void jink_systick_handler() {}

/// The frame that the processor pushed: r0-r3, r12, lr, pc, xpsr.
extern "C" [[noreturn]] void jink_note_fault(const std::uint32_t* frame)
{
    constexpr std::uint32_t kMemoryValid = 1U << 7U;
    constexpr std::uint32_t kBusValid = 1U << 15U;
    std::uint32_t exception = 0;
    __asm volatile("mrs %0, ipsr" : "=r"(exception));
    const bool in_stack = frame >= &_stack_bottom && frame + 8 <= &_stack_top;  // not where the stack itself overflowed
    const std::uint32_t count = holds_record() ? kept.count : 0;
    const std::uint32_t cause = at(kFaultCause);
    kept = {};
    kept.magic = kMagic;
    kept.exception = exception & 0x1FFU;
    kept.pc = in_stack ? frame[6] : 0;
    kept.lr = in_stack ? frame[5] : 0;
    kept.cause = cause;
    kept.address = (cause & kBusValid) != 0 ? at(kBusAddress) : (cause & kMemoryValid) != 0 ? at(kMemoryAddress) : 0;
    kept.count = count + 1;
    kept.check = sum_of(kept);
    jink_on_fault(kept);
    reset();
}

/// On a stack of its own start: what faulted may have been the stack.
extern "C" __attribute__((naked)) void jink_fault_handler()
{
    __asm volatile("mrs r0, msp\n"
                   "ldr r1, =_stack_top\n"
                   "mov sp, r1\n"
                   "b jink_note_fault\n");
}

extern "C" void jink_reset_handler()
{
    constexpr std::uint32_t kFpuOn = 0xFU << 20U;
    at(kCoprocessors) = at(kCoprocessors) | kFpuOn;
    __asm volatile("dsb\nisb" ::: "memory");

    const std::uint32_t* from = &_data_load;
    for (std::uint32_t* to = &_data_start; to < &_data_end; ++to, ++from) {
        *to = *from;
    }
    for (std::uint32_t* word = &_bss_start; word < &_bss_end; ++word) {
        *word = 0;
    }
    std::uint32_t* here = nullptr;
    __asm volatile("mov %0, sp" : "=r"(here));
    for (volatile std::uint32_t* word = &_stack_bottom; word < here; ++word) {
        *word = kPaint;
    }
    for (Handler* constructor = &_init_array_start; constructor < &_init_array_end; ++constructor) {
        (*constructor)();
    }
    jink_main();
    reset();
}

}  // namespace jink::hal::cortex_m
