// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "core/avoid/settings.hpp"
#include "firmware/app/autopilot_control.hpp"

namespace jink::app {

/// From a processor's clock to the work units of a step: the one place where they are derived. toolchain/report/timing
/// prints what follows for each board, and fails where what it counts is more than what is assumed here.
///
/// instructions = clock * tick / cycles per instruction (kCyclesPerInstructionBy10 / 10). A step has kSharePercent of
/// them: kUncounted for what no unit counts, and kInstructionsPerUnit for each unit. Its mandatory part has
/// kMandatoryPercent at most.
class WorkRate {
public:
    /// Assumed, on average, with caches cold and flash that waits: no board has been timed.
    static constexpr std::uint64_t kCyclesPerInstructionBy10 = 15;
    static constexpr std::uint64_t kSharePercent = 80;  ///< the rest: interrupts, and what the assumption misses
    static constexpr std::uint64_t kMandatoryPercent = 50;
    static constexpr std::uint64_t kInstructionsPerUnit = 170;  ///< at most (WorkBudget)
    /// Link, tables, the flight of the tick: twice the most found without a log (docs/guides/board_log.md).
    static constexpr std::uint64_t kUncounted = 130'000;

    /// `clock` [Hz].
    explicit constexpr WorkRate(std::uint32_t clock) noexcept
        : instructions_(clock / 1000U * 10U * kTickMilliseconds / kCyclesPerInstructionBy10)
    {
    }

    [[nodiscard]] static constexpr WorkRate of_megahertz(unsigned clock) noexcept
    {
        return WorkRate(clock * 1'000'000U);
    }
    /// Below this clock [MHz] the least slice does not fit, with the default capacities.
    static constexpr unsigned kMinMegahertz = 125;
    static constexpr unsigned kMaxMegahertz = 4000;  ///< what 32 bits hold [Hz]

    /// Instructions that fit into a tick.
    [[nodiscard]] constexpr std::uint64_t instructions() const noexcept { return instructions_; }
    [[nodiscard]] constexpr avoid::WorkPerUpdate work() const noexcept
    {
        const std::uint32_t all = units(kSharePercent);
        return {all, all - units(kMandatoryPercent)};
    }
    /// Most instructions of a step that spends all of `work`.
    [[nodiscard]] static constexpr std::uint64_t most(const avoid::WorkPerUpdate& work) noexcept
    {
        return work.all * kInstructionsPerUnit + kUncounted;
    }
    /// Whether a step, and its mandatory part alone, keep within their shares of the tick.
    [[nodiscard]] constexpr bool has_time_for(const avoid::WorkPerUpdate& work) const noexcept
    {
        const avoid::WorkPerUpdate mandatory{work.all - work.slice, 0};
        return most(work) <= instructions_ * kSharePercent / 100 &&
               most(mandatory) <= instructions_ * kMandatoryPercent / 100;
    }

private:
    static constexpr std::uint64_t kTickMilliseconds =
        static_cast<std::uint64_t>(AutopilotControl::kTick * 1000.0F + 0.5F);

    [[nodiscard]] constexpr std::uint32_t units(std::uint64_t percent) const noexcept
    {
        const std::uint64_t share = instructions_ * percent / 100;
        return share > kUncounted ? static_cast<std::uint32_t>((share - kUncounted) / kInstructionsPerUnit) : 0;
    }

    std::uint64_t instructions_;
};

/// What is done where nothing else is said is for processors from this clock on [Hz], unless capacities are so large
/// that the least slice is more than the usual one.
inline constexpr std::uint32_t kMinClockOfDefault = 1'000'000'000;
static_assert(avoid::WorkPerUpdate::kMinSlice > avoid::WorkPerUpdate::kUsualSlice ||
              WorkRate(kMinClockOfDefault).has_time_for(avoid::WorkPerUpdate{}));

}  // namespace jink::app
