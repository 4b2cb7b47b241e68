// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cassert>
#include <cstdint>

#include "hal/clock.hpp"

namespace jink::hal {

/// Clock that only advance() moves: its owner controls the time.
class ManualClock final : public Clock {
public:
    explicit ManualClock(std::int64_t start_us = 0) noexcept : now_us_(start_us) {}

    [[nodiscard]] std::int64_t now_us() noexcept override { return now_us_; }

    /// @param step_us  [us], >= 0: time never runs backwards
    void advance(std::int64_t step_us) noexcept
    {
        assert(step_us >= 0);
        now_us_ += step_us;
    }

private:
    std::int64_t now_us_;
};

}  // namespace jink::hal
