// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "hal/clock.hpp"
#include "hal/cortex_m/startup.hpp"

namespace jink::hal::cortex_m {

/// Calls `step(now_us)` every `period_us` for ever, asleep in between; a periodic interrupt must wake it
/// (start_systick). A late step is not made up for: the next is due a period after its beginning.
template <class ClockType, class Step>
[[noreturn]] void run_every(std::int64_t period_us, ClockType& clock, Step step) noexcept
{
    std::int64_t next = clock.now_us();
    for (;;) {
        const std::int64_t now = clock.now_us();
        if (now < next) {
            wait_for_interrupt();
            continue;
        }
        step(now);
        next = next + period_us < now ? now : next + period_us;
    }
}

}  // namespace jink::hal::cortex_m
