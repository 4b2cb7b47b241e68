// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "hal/cortex_m/startup.hpp"
#include "hal/watchdog.hpp"

namespace jink::hal::cortex_m {

/// SysTick ticks until a step counts as stuck; 0: not monitored. The handler below counts them down.
extern "C" volatile std::uint32_t jink_guard_left;
/// SysTick's handler for a board whose watchdog resets without warning. When the ticks are used up it continues as
/// jink_fault_handler, with the stuck program in the fault record (exception 15).
extern "C" void jink_guard_handler();

/// A watchdog with a second one in front that acts earlier and sends last words. An interrupt handler that hangs stops
/// the one in front too; the watchdog behind covers that case.
template <class Inner>
class GuardedWatchdog final : public Watchdog {
public:
    /// @param ticks  of SysTick between two feeds, > 0; must be shorter than `inner`'s time-out
    GuardedWatchdog(Inner& inner, std::uint32_t ticks) noexcept : inner_(inner), ticks_(ticks) {}

    void feed() noexcept override
    {
        inner_.feed();
        jink_guard_left = ticks_;
    }
    /// Stops monitoring until the next feed; the watchdog behind continues.
    void pause() noexcept { jink_guard_left = 0; }

private:
    Inner& inner_;
    std::uint32_t ticks_;
};

}  // namespace jink::hal::cortex_m
