// SPDX-License-Identifier: BSD-3-Clause
// jink on the MPS2 board with the AN500 image: Cortex-M7, 25 MHz, MAVLink on UART0.
#include <array>

#include "firmware/app/coprocessor.hpp"
#include "firmware/link/mavlink/endpoint.hpp"
#include "hal/cmsdk/cmsdk_uart.hpp"
#include "hal/cmsdk/cmsdk_watchdog.hpp"
#include "hal/cortex_m/cortex_m.hpp"
#include "hal/cortex_m/startup.hpp"
#include "hal/counter_clock.hpp"

namespace {

using namespace jink;
using hal::cortex_m::Handler;
using hal::cortex_m::MappedRegisters;

// Addresses, interrupts: ARM application note AN500 (and AN385, whose memory map it keeps).
constexpr std::uint32_t kClockHz = 25'000'000;
constexpr std::uintptr_t kTimer = 0x40000000;
constexpr std::uintptr_t kUart = 0x40004000;
constexpr std::uintptr_t kWatchdog = 0x40008000;
constexpr unsigned kUartReceive = 0;
constexpr unsigned kUartTransmit = 1;
constexpr unsigned kUartOverrun = 12;

constexpr std::uint32_t kBaud = 921600;
constexpr std::int64_t kTickMicroseconds = 20'000;
/// A step that is this late has failed.
constexpr std::uint32_t kWatchdogTicks = kClockHz / 4;

using Uart = hal::CmsdkUart<MappedRegisters, hal::cortex_m::Pend>;

Uart& uart() noexcept
{
    static Uart port(MappedRegisters{kUart}, hal::cortex_m::Pend(kUartTransmit));
    return port;
}

void start_timer() noexcept
{
    constexpr std::uint32_t kOn = 1;
    hal::cortex_m::at(kTimer + 8U) = 0xFFFFFFFF;  // reload
    hal::cortex_m::at(kTimer + 4U) = 0xFFFFFFFF;  // value
    hal::cortex_m::at(kTimer) = kOn;
}

}  // namespace

extern "C" {
void jink_uart_receive() { uart().on_receive(); }
void jink_uart_transmit() { uart().on_transmit(); }
void jink_uart_overrun() { uart().on_overrun(); }
}

namespace {

constexpr std::size_t kInterrupts = 32;

struct VectorTable {
    std::uint32_t* stack;
    std::array<Handler, 15 + kInterrupts> handlers;
};

/// Whatever nobody expects is a fault.
constexpr VectorTable make_vectors() noexcept
{
    constexpr std::size_t kReset = 0;
    constexpr std::size_t kSystick = 14;
    constexpr std::size_t kFirstInterrupt = 15;
    VectorTable table{&hal::cortex_m::_stack_top, {}};
    table.handlers.fill(&hal::cortex_m::jink_fault_handler);
    table.handlers[kReset] = &hal::cortex_m::jink_reset_handler;
    table.handlers[kSystick] = &hal::cortex_m::jink_systick_handler;
    table.handlers[kFirstInterrupt + kUartReceive] = &jink_uart_receive;
    table.handlers[kFirstInterrupt + kUartTransmit] = &jink_uart_transmit;
    table.handlers[kFirstInterrupt + kUartOverrun] = &jink_uart_overrun;
    return table;
}

__attribute__((section(".vectors"), used)) constinit const VectorTable vectors = make_vectors();

link::mavlink::Endpoint& endpoint() noexcept
{
    static link::mavlink::Endpoint link;
    return link;
}

}  // namespace

extern "C" void hal::cortex_m::jink_on_fault(const FaultRecord& /*record*/) {}

extern "C" void hal::cortex_m::jink_main()
{
    start_timer();
    static hal::CounterClock clock(hal::cortex_m::at(kTimer + 4U), hal::CounterClock::Direction::down, kClockHz);
    static hal::CmsdkWatchdog watchdog{MappedRegisters(kWatchdog)};
    static app::Coprocessor coprocessor(endpoint(), uart(), watchdog, app::Parameters());

    static_cast<void>(uart().start(kClockHz, kBaud));
    for (const unsigned irq : {kUartReceive, kUartTransmit, kUartOverrun}) {
        hal::cortex_m::enable_interrupt(irq);
    }
    hal::cortex_m::start_systick(kClockHz / 1000U);
    watchdog.start(kWatchdogTicks);

    std::int64_t next = clock.now_us();
    for (;;) {
        const std::int64_t now = clock.now_us();
        if (now < next) {
            hal::cortex_m::wait_for_interrupt();
            continue;
        }
        static_cast<void>(coprocessor.step({now}));
        next = next + kTickMicroseconds < now ? now : next + kTickMicroseconds;
    }
}
