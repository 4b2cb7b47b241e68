// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace jink::hal {

/// Acts when it is not fed in time: resets the board, restarts the process, or raises an alarm.
class Watchdog {
public:
    /// Reports that one step was healthy from end to end. Never blocks; after a failed feed the watchdog acts. O(1).
    virtual void feed() noexcept = 0;

protected:
    ~Watchdog() = default;
};

}  // namespace jink::hal
