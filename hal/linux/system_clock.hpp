// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "hal/clock.hpp"

namespace jink::hal {

/// CLOCK_MONOTONIC: cannot be set, slewed by NTP by at most 500 ppm, stops while the machine sleeps.
class SystemClock final : public Clock {
public:
    [[nodiscard]] std::int64_t now_us() noexcept override;
};

}  // namespace jink::hal
