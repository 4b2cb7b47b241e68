// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <atomic>
#include <cstdint>

#include "hal/clock.hpp"
#include "hal/register_block.hpp"

namespace jink::hal::cortex_m {

/// Clock on SysTick: its interrupt counts milliseconds, its counter what has passed of the present one. Interrupts must
/// not be held off for a millisecond.
template <RegisterBlock Registers>
class SystickClock final : public Clock {
public:
    explicit SystickClock(Registers registers) noexcept : registers_(registers) {}

    /// @param clock_hz  of the processor: a whole number of MHz, 1..16777
    void start(std::uint32_t clock_hz) noexcept
    {
        ticks_per_us_ = clock_hz / 1'000'000U;
        registers_.write(kReload, ticks_per_us_ * 1000U - 1U);
        registers_.write(kValue, 0);
        registers_.write(kControl, kProcessorClockInterruptOn);
    }

    /// From SysTick's handler. O(1).
    void on_interrupt() noexcept
    {
        milliseconds_.store(milliseconds_.load(std::memory_order_relaxed) + 1U, std::memory_order_relaxed);
    }

    /// Not for handlers of SysTick's priority or above.
    [[nodiscard]] std::int64_t now_us() noexcept override
    {
        std::uint32_t before = 0;
        std::uint32_t left = 0;
        do {  // again where the millisecond ended in between; at most twice, the two reads take far less than one
            before = milliseconds_.load(std::memory_order_relaxed);
            left = registers_.read(kValue);
        } while (milliseconds_.load(std::memory_order_relaxed) != before);
        turns_ += before < last_ ? 1U : 0U;  // 49.7 days
        last_ = before;
        const std::uint32_t passed = (ticks_per_us_ * 1000U - 1U - left) / ticks_per_us_;
        const std::int64_t now = ((static_cast<std::int64_t>(turns_) << 32U) + before) * 1000 + passed;
        // The counter may have started anew with its interrupt still under way.
        latest_us_ = now > latest_us_ ? now : latest_us_;
        return latest_us_;
    }

private:
    static constexpr std::uint32_t kControl = 0x0;
    static constexpr std::uint32_t kReload = 0x4;
    static constexpr std::uint32_t kValue = 0x8;
    static constexpr std::uint32_t kProcessorClockInterruptOn = 7;

    Registers registers_;
    std::uint32_t ticks_per_us_ = 1;
    std::atomic<std::uint32_t> milliseconds_{0};
    std::uint32_t last_ = 0;
    std::uint32_t turns_ = 0;
    std::int64_t latest_us_ = 0;
};

}  // namespace jink::hal::cortex_m
