// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <span>

#include "core/base/flow.hpp"

namespace jink::hal {

/// A flow with a stack of its own, in the same thread. For x86-64, AArch64 and ARM (A32, Thumb-2), with or without
/// floating-point registers. Interrupts that use the interrupted stack need space on both.
class Fiber final : public Flow {
public:
    /// `stack` outlives this, kLeastStack bytes at least; painted, so that `deepest` can tell how much of it was used.
    explicit Fiber(std::span<std::byte> stack) noexcept;
    Fiber(const Fiber&) = delete;
    Fiber& operator=(const Fiber&) = delete;

    void begin(Run run, void* argument) noexcept override;
    void resume() noexcept override;
    void pause() noexcept override;
    void drop() noexcept override { run_ = nullptr; }
    [[nodiscard]] bool runs() const noexcept override { return run_ != nullptr; }
    /// Bytes of the stack that were in use at once, at most, since construction. O(stack).
    [[nodiscard]] std::size_t deepest() const noexcept;

    static constexpr std::size_t kLeastStack = 512;

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
