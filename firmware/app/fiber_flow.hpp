// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <span>

#include "core/base/flow.hpp"
#include "hal/fiber.hpp"

namespace jink::app {

/// A fiber as the core knows it.
class FiberFlow final : public Flow {
public:
    /// As hal::Fiber.
    explicit FiberFlow(std::span<std::byte> stack) noexcept : fiber_(stack) {}

    void begin(Run run, void* argument) noexcept override { fiber_.begin(run, argument); }
    void resume() noexcept override { fiber_.resume(); }
    void pause() noexcept override { fiber_.pause(); }
    void drop() noexcept override { fiber_.drop(); }
    [[nodiscard]] bool runs() const noexcept override { return fiber_.runs(); }
    [[nodiscard]] const hal::Fiber& fiber() const noexcept { return fiber_; }

private:
    hal::Fiber fiber_;
};

}  // namespace jink::app
