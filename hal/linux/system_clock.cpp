// SPDX-License-Identifier: BSD-3-Clause
#include "hal/linux/system_clock.hpp"

#include <ctime>

namespace jink::hal {

std::int64_t SystemClock::now_us() noexcept
{
    timespec now{};
    // Always succeeds: the clock id is valid on every Linux and the pointer is ours.
    (void)::clock_gettime(CLOCK_MONOTONIC, &now);
    return static_cast<std::int64_t>(now.tv_sec) * 1'000'000 + static_cast<std::int64_t>(now.tv_nsec) / 1'000;
}

}  // namespace jink::hal
