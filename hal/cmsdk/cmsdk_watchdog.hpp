// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "hal/register_block.hpp"
#include "hal/watchdog.hpp"

namespace jink::hal {

/// The CMSDK APB watchdog (ARM DDI 0479): `timeout` ticks after the last feed it raises its interrupt (the NMI on MPS2
/// boards), and after as many ticks again it resets.
template <RegisterBlock Registers>
class CmsdkWatchdog final : public Watchdog {
public:
    explicit CmsdkWatchdog(Registers registers) noexcept : registers_(registers) {}

    /// Arms the watchdog. @param timeout  ticks of the peripheral clock, > 0
    void start(std::uint32_t timeout) noexcept
    {
        registers_.write(kLockRegister, kUnlock);
        registers_.write(kLoad, timeout);
        registers_.write(kControl, kInterruptAndReset);
        registers_.write(kLockRegister, kLock);
    }

    void feed() noexcept override
    {
        registers_.write(kLockRegister, kUnlock);
        registers_.write(kClear, 1);  // restarts the count from `timeout`
        registers_.write(kLockRegister, kLock);
    }

private:
    static constexpr std::uint32_t kLoad = 0x000;
    static constexpr std::uint32_t kControl = 0x008;
    static constexpr std::uint32_t kClear = 0x00C;
    static constexpr std::uint32_t kLockRegister = 0xC00;
    static constexpr std::uint32_t kUnlock = 0x1ACCE551;
    static constexpr std::uint32_t kLock = 0;
    static constexpr std::uint32_t kInterruptAndReset = 3;

    Registers registers_;
};

}  // namespace jink::hal
