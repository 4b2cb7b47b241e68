// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

namespace jink::hal {

/// Monotonic time. All code above the ports gets its time from a Clock and uses no other source of time.
class Clock {
public:
    /// Microseconds since an arbitrary start; never runs backwards. O(1).
    [[nodiscard]] virtual std::int64_t now_us() noexcept = 0;

protected:
    ~Clock() = default;
};

}  // namespace jink::hal
