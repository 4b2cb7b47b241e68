// SPDX-License-Identifier: BSD-3-Clause
// jink on the MPS2 board with the AN500 image: Cortex-M7, 25 MHz, MAVLink on UART0.
#include <new>

#include "firmware/app/built_map.hpp"
#include "firmware/app/work_rate.hpp"
#include "firmware/cortex_m/flight.hpp"
#include "firmware/link/mavlink/endpoint.hpp"
#include "hal/cmsdk/cmsdk_uart.hpp"
#include "hal/cmsdk/cmsdk_watchdog.hpp"
#include "hal/cortex_m/cortex_m.hpp"
#include "hal/cortex_m/startup.hpp"
#include "hal/cortex_m/vector_table.hpp"
#include "hal/counter_clock.hpp"
#include "hal/last_words.hpp"

namespace {

using namespace jink;
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
/// Work of a step. The emulated board's clock says nothing; this image stands for a Cortex-M7 from 216 MHz on.
constexpr app::WorkRate kRate(216'000'000);
constexpr avoid::WorkPerUpdate kWork = app::work_of_image(kRate);
static_assert(kRate.has_time_for(kWork) && avoid::is_valid(kWork));
/// A step that is this late has failed.
constexpr std::uint32_t kWatchdogTicks = kClockHz / 4;

using Uart = hal::CmsdkUart<MappedRegisters, hal::cortex_m::Pend>;

Uart& uart() noexcept
{
    static Uart port(MappedRegisters{kUart}, hal::cortex_m::Pend(kUartTransmit));
    return port;
}

__attribute__((section(".plan"))) firmware::ApartMemory apart;

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

__attribute__((section(".vectors"), used)) constinit const auto vectors = hal::cortex_m::make_vectors<32>(
    {{kUartReceive, &jink_uart_receive}, {kUartTransmit, &jink_uart_transmit}, {kUartOverrun, &jink_uart_overrun}});

link::mavlink::Endpoint& endpoint() noexcept
{
    static link::mavlink::Endpoint link;
    return link;
}

}  // namespace

// A reset does not clear it. Its content is not used before clear().
__attribute__((section(".noinit"))) hal::LastWords last_words;

extern "C" void hal::cortex_m::jink_on_fault(const FaultRecord& /*record*/)
{
    static_cast<void>(say_last_words<Uart>(MappedRegisters{kUart}, uart().to_send(), last_words.valid(),
                                           link::mavlink::kMaxFrame, firmware::kPatience));
}

extern "C" void hal::cortex_m::jink_main()
{
    start_timer();
    static hal::CounterClock clock(hal::cortex_m::at(kTimer + 4U), hal::CounterClock::Direction::down, kClockHz);
    static hal::CmsdkWatchdog watchdog{MappedRegisters(kWatchdog)};
    static app::Coprocessor coprocessor(endpoint(), uart(), watchdog, app::Parameters());

    static_cast<void>(uart().start(kClockHz, kBaud));
    last_words.clear();
    coprocessor.keep_last_words(last_words);
    coprocessor.stream(*new (apart.log) flightlog::LogStream(kBaud));
    hal::cortex_m::let_faults_speak();
    for (const unsigned irq : {kUartReceive, kUartTransmit, kUartOverrun}) {
        hal::cortex_m::enable_interrupt(irq);
    }
    hal::cortex_m::start_systick(kClockHz / 1000U);
    app::PlanMemory& plans = *new (apart.plans) app::PlanMemory;
    hal::cortex_m::note_second_stack(plans.stack);
    static_cast<void>(coprocessor.plan_in_slices(plans.plan, kWork));  // valid, as asserted above
    firmware::settle_reach_sets(coprocessor);
    firmware::settle_map(coprocessor);
    const bool passive = firmware::settle_faults(coprocessor, clock);
    watchdog.start(kWatchdogTicks);
    firmware::fly(coprocessor, clock, kClockHz, passive, [] {});
}
