// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "hal/cortex_m/startup.hpp"
#include "hal/watchdog.hpp"

namespace jink::hal::cortex_m {

/// SysTick's ticks until a step counts as stuck; 0: not watched. The handler of step_guard counts them down.
extern "C" volatile std::uint32_t jink_guard_left;
/// SysTick's handler for a board whose watchdog resets without warning: when the ticks are used up it goes on as
/// jink_fault_handler, with the program that is stuck in the fault record (exception 15).
extern "C" void jink_guard_handler();

/// A watchdog, and in front of it one that acts earlier and leaves last words. An interrupt handler that hangs stops
/// this one too; the watchdog behind it is for that.
template <class Inner>
class GuardedWatchdog final : public Watchdog {
public:
    /// @param ticks  of SysTick between two feeds, > 0; with them less time than `inner` has
    GuardedWatchdog(Inner& inner, std::uint32_t ticks) noexcept : inner_(inner), ticks_(ticks) {}

    void feed() noexcept override
    {
        inner_.feed();
        jink_guard_left = ticks_;
    }
    /// Not watched until the next feed; the watchdog behind goes on.
    void pause() noexcept { jink_guard_left = 0; }

private:
    Inner& inner_;
    std::uint32_t ticks_;
};

}  // namespace jink::hal::cortex_m
