// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "hal/watchdog.hpp"

namespace jink::hal {

/// Watchdog that counts its feeds and never acts.
class CountingWatchdog final : public Watchdog {
public:
    void feed() noexcept override { ++feeds_; }
    [[nodiscard]] std::uint64_t feeds() const noexcept { return feeds_; }

private:
    std::uint64_t feeds_ = 0;
};

}  // namespace jink::hal
