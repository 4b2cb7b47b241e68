// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <compare>
#include <cstdint>

namespace jink {

/// Duration [s].
using Seconds = float;

/// Instant on the co-processor's own monotonic clock, in microseconds since an arbitrary start.
/// 64 bits: does not wrap within the life of the hardware.
struct TimePoint {
    std::int64_t us = 0;
    friend constexpr auto operator<=>(const TimePoint&, const TimePoint&) noexcept = default;
};

/// later - earlier [s]; negative when `later` is the earlier instant. Exact to 1 us up to 16 s, to 1e-7 relative
/// beyond.
[[nodiscard]] constexpr Seconds operator-(TimePoint later, TimePoint earlier) noexcept
{
    return static_cast<Seconds>(later.us - earlier.us) * 1e-6F;
}

/// `t` moved by `d` seconds, rounded towards zero to whole microseconds; |d| < 9e12 s.
[[nodiscard]] constexpr TimePoint operator+(TimePoint t, Seconds d) noexcept
{
    return {t.us + static_cast<std::int64_t>(static_cast<double>(d) * 1e6)};
}
[[nodiscard]] constexpr TimePoint operator-(TimePoint t, Seconds d) noexcept { return t + (-d); }

}  // namespace jink
