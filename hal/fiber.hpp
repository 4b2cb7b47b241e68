// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <span>

namespace jink::hal {

/// A flow of control with a stack of its own, in the same thread: it runs when it is resumed, until it pauses or ends.
/// For x86-64, AArch64 and ARM (A32, Thumb-2), with or without floating-point registers. Interrupts that use the
/// interrupted stack need space on it too.
class Fiber {
public:
    using Run = void (*)(void* argument) noexcept;

    /// `stack` outlives this, 512 bytes at least; painted, so that `deepest` can tell how much of it was used.
    explicit Fiber(std::span<std::byte> stack) noexcept;
    Fiber(const Fiber&) = delete;
    Fiber& operator=(const Fiber&) = delete;

    /// From the next `resume` on `run(argument)` runs. What ran before and has not ended is dropped where it paused: no
    /// destructor of its objects is called. Not from within the fiber; neither are resume and drop.
    void begin(Run run, void* argument) noexcept;
    /// Runs until `pause` or the end; nothing where nothing has begun.
    void resume() noexcept;
    /// Back to `resume`; returns in the next `resume`. From within the fiber alone.
    void pause() noexcept;
    void drop() noexcept { run_ = nullptr; }
    /// Whether something has begun and not ended.
    [[nodiscard]] bool runs() const noexcept { return run_ != nullptr; }
    /// Bytes of the stack that were in use at once, at most, since construction. O(stack).
    [[nodiscard]] std::size_t deepest() const noexcept;

private:
    static void main(Fiber* fiber) noexcept;
    friend void enter_fiber(Fiber* fiber) noexcept;

    std::span<std::byte> stack_;
    Run run_ = nullptr;
    void* argument_ = nullptr;
    void* own_ = nullptr;       ///< stack pointer of the fiber while it is paused
    void* caller_ = nullptr;    ///< and of whoever resumed it
    void* fake_own_ = nullptr;  ///< AddressSanitizer's; unused without
    void* fake_caller_ = nullptr;
    const void* caller_bottom_ = nullptr;
    std::size_t caller_size_ = 0;
};

}  // namespace jink::hal
