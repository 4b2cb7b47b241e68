// SPDX-License-Identifier: BSD-3-Clause
// The co-processor on a custom board: a port, a clock, a watchdog, and one call per tick. The board is the MPS2 with
// the AN500 image, because qemu supports it.
#include "firmware/app/coprocessor.hpp"
#include "firmware/link/mavlink/endpoint.hpp"
#include "hal/cmsdk/cmsdk_uart.hpp"
#include "hal/cmsdk/cmsdk_watchdog.hpp"
#include "hal/cortex_m/cortex_m.hpp"
#include "hal/cortex_m/startup.hpp"
#include "hal/cortex_m/vector_table.hpp"
#include "hal/counter_clock.hpp"

namespace {

using namespace jink;
using hal::cortex_m::MappedRegisters;
using Uart = hal::CmsdkUart<MappedRegisters, hal::cortex_m::Pend>;

constexpr std::uint32_t kClockHz = 25'000'000;
constexpr std::uintptr_t kTimer = 0x40000000;
constexpr std::uintptr_t kUart = 0x40004000;
constexpr std::uintptr_t kWatchdog = 0x40008000;
constexpr unsigned kReceive = 0;
constexpr unsigned kTransmit = 1;
constexpr unsigned kOverrun = 12;

Uart& uart() noexcept
{
    static Uart port(MappedRegisters{kUart}, hal::cortex_m::Pend(kTransmit));
    return port;
}

}  // namespace

extern "C" {
void on_receive() { uart().on_receive(); }
void on_transmit() { uart().on_transmit(); }
void on_overrun() { uart().on_overrun(); }
}

__attribute__((section(".vectors"), used)) constinit const auto vectors =
    hal::cortex_m::make_vectors<32>({{kReceive, &on_receive}, {kTransmit, &on_transmit}, {kOverrun, &on_overrun}});

extern "C" void hal::cortex_m::jink_on_fault(const FaultRecord& /*record*/) {}

extern "C" void hal::cortex_m::jink_main()
{
    hal::cortex_m::at(kTimer + 8U) = 0xFFFFFFFF;
    hal::cortex_m::at(kTimer + 4U) = 0xFFFFFFFF;
    hal::cortex_m::at(kTimer) = 1;
    static hal::CounterClock clock(hal::cortex_m::at(kTimer + 4U), hal::CounterClock::Direction::down, kClockHz);
    static hal::CmsdkWatchdog watchdog{MappedRegisters(kWatchdog)};
    static link::mavlink::Endpoint link;
    static app::Coprocessor coprocessor(link, uart(), watchdog, app::Parameters());
    static_cast<void>(uart().start(kClockHz, 921600));
    for (const unsigned irq : {kReceive, kTransmit, kOverrun}) {
        hal::cortex_m::enable_interrupt(irq);
    }
    watchdog.start(kClockHz / 4);
    TimePoint next{clock.now_us()};
    for (;;) {
        const TimePoint now{clock.now_us()};
        if (now >= next) {
            static_cast<void>(coprocessor.step(now));
            next = next + app::Coprocessor::kTick;
        }
    }
}
