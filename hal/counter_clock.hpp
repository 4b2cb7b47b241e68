// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "hal/clock.hpp"

namespace jink::hal {

/// Clock on a free-running 32-bit hardware counter.
///
/// now_us() must be called at least once per turn of the counter (172 s at 25 MHz): each call adds the ticks since the
/// previous call, without rounding. Not for interrupt handlers.
class CounterClock final : public Clock {
public:
    enum class Direction : std::uint8_t { up, down };

    /// @param counter   outlives this; counts through all 32 bits and wraps
    /// @param ticks_hz  its rate, a whole number of ticks per microsecond or microseconds per tick: no rounding
    CounterClock(const volatile std::uint32_t& counter, Direction direction, std::uint32_t ticks_hz) noexcept
        : counter_(counter), direction_(direction), ticks_per_us_(ticks_hz >= kMega ? ticks_hz / kMega : 1U),
          us_per_tick_(ticks_hz >= kMega ? 1U : kMega / ticks_hz), last_(counter)
    {
    }

    [[nodiscard]] std::int64_t now_us() noexcept override
    {
        const std::uint32_t value = counter_;
        const std::uint32_t passed = direction_ == Direction::up ? value - last_ : last_ - value;
        last_ = value;
        ticks_ += passed;
        return static_cast<std::int64_t>(ticks_ / ticks_per_us_ * us_per_tick_);
    }

    /// Ticks since the start, as of the last now_us().
    [[nodiscard]] std::uint64_t ticks() const noexcept { return ticks_; }

private:
    static constexpr std::uint32_t kMega = 1'000'000;

    const volatile std::uint32_t& counter_;
    Direction direction_;
    std::uint32_t ticks_per_us_;
    std::uint32_t us_per_tick_;
    std::uint32_t last_;
    std::uint64_t ticks_ = 0;
};

}  // namespace jink::hal
