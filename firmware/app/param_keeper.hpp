// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "firmware/app/coprocessor.hpp"
#include "firmware/app/param_flash.hpp"

namespace jink::app {

/// Keeps what is set over a link in flash, in the next tick in which the vehicle is disarmed: a write takes up to 31 ms
/// and an erase 2 s, during which nothing is received, planned or sent. Until then a change waits, and a restart loses
/// it.
///
/// A failure is reported to the pilot once and tried again every 10 s.
class ParamKeeper {
public:
    static constexpr Seconds kRetry = 10.0F;

    /// @param flash  outlives this
    explicit ParamKeeper(ParamFlash& flash) noexcept : flash_(flash) {}

    /// Brings what is stored into force. Once, before the first step. Damaged records and values that are refused are
    /// reported to the pilot, the others count.
    void start(Coprocessor& coprocessor) noexcept;

    /// Between steps.
    void work(Coprocessor& coprocessor, TimePoint now) noexcept;

private:
    ParamFlash& flash_;
    std::uint32_t kept_ = 0;  ///< Parameters::generation() in flash
    bool failed_ = false;
    TimePoint retry_;
};

}  // namespace jink::app
