// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "hal/clock.hpp"
#include "hal/watchdog.hpp"

namespace jink::hal {

/// Watchdog that only reports: for boards without one, for tests, and beside a real one to see how close it came.
///
/// Armed by the first feed, so that a slow start is not taken for a hang. Between two feeds at most `timeout_us` may
/// pass; a longer gap counts as one miss, whether or not anybody asked during it.
class SoftwareWatchdog final : public Watchdog {
public:
    /// @param clock       outlives this watchdog
    /// @param timeout_us  longest permitted gap between feeds [us], > 0
    SoftwareWatchdog(Clock& clock, std::int64_t timeout_us) noexcept : clock_(clock), timeout_us_(timeout_us) {}

    void feed() noexcept override
    {
        const std::int64_t now = clock_.now_us();
        if (feeds_ > 0) {
            const std::int64_t gap = now - last_us_;
            longest_gap_us_ = gap > longest_gap_us_ ? gap : longest_gap_us_;
            misses_ += gap > timeout_us_ ? 1U : 0U;
        }
        last_us_ = now;
        ++feeds_;
    }

    /// True while the present gap is too long: it should have been fed by now.
    [[nodiscard]] bool starving() noexcept { return feeds_ > 0 && clock_.now_us() - last_us_ > timeout_us_; }

    [[nodiscard]] std::uint64_t feeds() const noexcept { return feeds_; }
    /// Gaps that were too long and have ended; the present one is told by `starving()`.
    [[nodiscard]] std::uint64_t misses() const noexcept { return misses_; }
    /// Longest gap between two feeds [us].
    [[nodiscard]] std::int64_t longest_gap_us() const noexcept { return longest_gap_us_; }

private:
    Clock& clock_;
    std::int64_t timeout_us_;
    std::int64_t last_us_ = 0;
    std::int64_t longest_gap_us_ = 0;
    std::uint64_t feeds_ = 0;
    std::uint64_t misses_ = 0;
};

}  // namespace jink::hal
