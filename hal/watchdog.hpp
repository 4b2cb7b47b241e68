// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace jink::hal {

/// Something that acts when it is not fed in time: resets the board, restarts the process, raises an alarm.
class Watchdog {
public:
    /// Says that one step was healthy from end to end. Never blocks; a failed feed shows by the watchdog acting. O(1).
    virtual void feed() noexcept = 0;

protected:
    ~Watchdog() = default;
};

}  // namespace jink::hal
