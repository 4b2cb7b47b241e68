// SPDX-License-Identifier: BSD-3-Clause
#include "hal/fiber.hpp"

#include <algorithm>
#include <cstdint>
#include <cstring>

#if defined(__SANITIZE_ADDRESS__)
#define JINK_FIBER_ASAN 1
#elif defined(__has_feature)
#if __has_feature(address_sanitizer)
#define JINK_FIBER_ASAN 1
#endif
#endif

#if defined(JINK_FIBER_ASAN)
// Of AddressSanitizer's interface (sanitizer/common_interface_defs.h).
extern "C" {
void __sanitizer_start_switch_fiber(void** fake, const void* bottom, std::size_t size);
void __sanitizer_finish_switch_fiber(void* fake, const void** bottom, std::size_t* size);
void __asan_unpoison_memory_region(const volatile void* begin, std::size_t size);
}
#endif

// jink_switch_stack(save, load): saves the registers that a callee has to keep on the stack, the stack pointer in
// *save, and returns on the stack that was left at `load`. jink_fiber_start: where a new fiber begins, with the fiber
// in the first of these registers.
#if defined(__x86_64__)
asm(R"(
    .text
    .globl jink_switch_stack
    .type jink_switch_stack, @function
jink_switch_stack:
    pushq %rbp
    pushq %rbx
    pushq %r12
    pushq %r13
    pushq %r14
    pushq %r15
    subq $8, %rsp
    stmxcsr (%rsp)
    fnstcw 4(%rsp)
    movq %rsp, (%rdi)
    movq %rsi, %rsp
    ldmxcsr (%rsp)
    fldcw 4(%rsp)
    addq $8, %rsp
    popq %r15
    popq %r14
    popq %r13
    popq %r12
    popq %rbx
    popq %rbp
    ret
    .size jink_switch_stack, .-jink_switch_stack
    .globl jink_fiber_start
    .type jink_fiber_start, @function
jink_fiber_start:
    movq %rbx, %rdi
    call jink_fiber_main
    ud2
    .size jink_fiber_start, .-jink_fiber_start
)");
#elif defined(__aarch64__)
asm(R"(
    .text
    .globl jink_switch_stack
    .type jink_switch_stack, %function
jink_switch_stack:
    sub sp, sp, #160
    stp x19, x20, [sp, #0]
    stp x21, x22, [sp, #16]
    stp x23, x24, [sp, #32]
    stp x25, x26, [sp, #48]
    stp x27, x28, [sp, #64]
    stp x29, x30, [sp, #80]
    stp d8, d9, [sp, #96]
    stp d10, d11, [sp, #112]
    stp d12, d13, [sp, #128]
    stp d14, d15, [sp, #144]
    mov x9, sp
    str x9, [x0]
    mov sp, x1
    ldp x19, x20, [sp, #0]
    ldp x21, x22, [sp, #16]
    ldp x23, x24, [sp, #32]
    ldp x25, x26, [sp, #48]
    ldp x27, x28, [sp, #64]
    ldp x29, x30, [sp, #80]
    ldp d8, d9, [sp, #96]
    ldp d10, d11, [sp, #112]
    ldp d12, d13, [sp, #128]
    ldp d14, d15, [sp, #144]
    add sp, sp, #160
    ret
    .size jink_switch_stack, .-jink_switch_stack
    .globl jink_fiber_start
    .type jink_fiber_start, %function
jink_fiber_start:
    mov x0, x19
    bl jink_fiber_main
    brk #0
    .size jink_fiber_start, .-jink_fiber_start
)");
#elif defined(__arm__)
#if defined(__ARM_FP)
#define JINK_SAVE_FLOATS "    vpush {d8-d15}\n"
#define JINK_LOAD_FLOATS "    vpop {d8-d15}\n"
#else
#define JINK_SAVE_FLOATS ""
#define JINK_LOAD_FLOATS ""
#endif
#if defined(__thumb__)
#define JINK_STATE "    .thumb\n    .thumb_func\n"
#else
#define JINK_STATE "    .arm\n"
#endif
asm("    .syntax unified\n    .text\n    .align 2\n    .globl jink_switch_stack\n" JINK_STATE
    "    .type jink_switch_stack, %function\n"
    "jink_switch_stack:\n"
    "    push {r3-r11, lr}\n" JINK_SAVE_FLOATS "    mov r2, sp\n"
    "    str r2, [r0]\n"
    "    mov sp, r1\n" JINK_LOAD_FLOATS "    pop {r3-r11, pc}\n"
    "    .size jink_switch_stack, .-jink_switch_stack\n"
    "    .align 2\n    .globl jink_fiber_start\n" JINK_STATE "    .type jink_fiber_start, %function\n"
    "jink_fiber_start:\n"
    "    mov r0, r4\n"
    "    bl jink_fiber_main\n"
    "    udf #0\n"
    "    .size jink_fiber_start, .-jink_fiber_start\n");
#else
#error "no stack switch for this processor"
#endif

extern "C" {
void jink_switch_stack(void** save, void* load) noexcept;
void jink_fiber_start() noexcept;
void jink_fiber_main(jink::hal::Fiber* fiber) noexcept;
}

namespace jink::hal {
namespace {

constexpr std::byte kPaint{0xA5};

#if defined(JINK_FIBER_ASAN)
void leave(void** fake, const void* bottom, std::size_t size) noexcept
{
    __sanitizer_start_switch_fiber(fake, bottom, size);
}
void arrive(void* fake, const void** bottom, std::size_t* size) noexcept
{
    __sanitizer_finish_switch_fiber(fake, bottom, size);
}
/// Frames that were dropped have left their marks.
void forget_marks(std::span<std::byte> stack) noexcept { __asan_unpoison_memory_region(stack.data(), stack.size()); }
#else
void forget_marks(std::span<std::byte>) noexcept {}
void leave(void**, const void*, std::size_t) noexcept {}
void arrive(void*, const void**, std::size_t*) noexcept {}
#endif

/// The frame that jink_switch_stack loads first: registers from the lowest address up, as words.
#if defined(__x86_64__)
constexpr std::size_t kWords = 8;  // floating-point control, r15, r14, r13, r12, rbx, rbp, return address
constexpr std::size_t kFiberAt = 5;
constexpr std::size_t kReturnAt = 7;
#elif defined(__aarch64__)
constexpr std::size_t kWords = 20;
constexpr std::size_t kFiberAt = 0;
constexpr std::size_t kReturnAt = 11;
#elif defined(__ARM_FP)
constexpr std::size_t kWords = 26;  // d8 to d15, r3 to r11, return address
constexpr std::size_t kFiberAt = 17;
constexpr std::size_t kReturnAt = 25;
#else
constexpr std::size_t kWords = 10;
constexpr std::size_t kFiberAt = 1;
constexpr std::size_t kReturnAt = 9;
#endif

}  // namespace

Fiber::Fiber(std::span<std::byte> stack) noexcept : stack_(stack)
{
    forget_marks(stack_);
    std::fill(stack_.begin(), stack_.end(), kPaint);
}

void Fiber::begin(Run run, void* argument) noexcept
{
    run_ = run;
    argument_ = argument;
    forget_marks(stack_);
    constexpr std::uintptr_t kAligned = 16;
    const auto top = reinterpret_cast<std::uintptr_t>(stack_.data() + stack_.size()) / kAligned * kAligned;
    auto* const frame = reinterpret_cast<std::uintptr_t*>(top) - kWords;
    std::fill_n(frame, kWords, std::uintptr_t{0});
#if defined(__x86_64__)
    constexpr std::uintptr_t kControl = 0x037F'0000'1F80;  // as the ABI has it at the start of a program
    frame[0] = kControl;
#endif
    frame[kFiberAt] = reinterpret_cast<std::uintptr_t>(this);
    frame[kReturnAt] = reinterpret_cast<std::uintptr_t>(&jink_fiber_start);
    own_ = frame;
    fake_own_ = nullptr;
}

void Fiber::resume() noexcept
{
    if (run_ == nullptr) {
        return;
    }
    leave(&fake_caller_, stack_.data(), stack_.size());
    jink_switch_stack(&caller_, own_);
    arrive(fake_caller_, nullptr, nullptr);
}

void Fiber::pause() noexcept
{
    leave(&fake_own_, caller_bottom_, caller_size_);
    jink_switch_stack(&own_, caller_);
    arrive(fake_own_, &caller_bottom_, &caller_size_);
}

void Fiber::main(Fiber* fiber) noexcept
{
    arrive(nullptr, &fiber->caller_bottom_, &fiber->caller_size_);
    fiber->run_(fiber->argument_);
    fiber->run_ = nullptr;
    leave(nullptr, fiber->caller_bottom_, fiber->caller_size_);
    void* unused = nullptr;
    jink_switch_stack(&unused, fiber->caller_);
}

void enter_fiber(Fiber* fiber) noexcept { Fiber::main(fiber); }

std::size_t Fiber::deepest() const noexcept
{
    const auto untouched =
        std::find_if(stack_.begin(), stack_.end(), [](std::byte byte) { return byte != kPaint; }) - stack_.begin();
    return stack_.size() - static_cast<std::size_t>(untouched);
}

}  // namespace jink::hal

void jink_fiber_main(jink::hal::Fiber* fiber) noexcept { jink::hal::enter_fiber(fiber); }
