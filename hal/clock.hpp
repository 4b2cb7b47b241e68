// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

namespace jink::hal {

/// Monotonic time. Everything above the ports is given its time from one of these and asks nothing else.
class Clock {
public:
    /// Microseconds since an arbitrary start; never runs backwards. O(1).
    [[nodiscard]] virtual std::int64_t now_us() noexcept = 0;

protected:
    ~Clock() = default;
};

}  // namespace jink::hal
