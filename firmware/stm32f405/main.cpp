// SPDX-License-Identifier: BSD-3-Clause
// jink on an STM32F405 (Cortex-M4F, a flight controller's chip): MAVLink on USART1, PA9 and PA10.
#include <array>

#include "firmware/app/coprocessor.hpp"
#include "firmware/link/mavlink/endpoint.hpp"
#include "hal/cortex_m/cortex_m.hpp"
#include "hal/cortex_m/startup.hpp"
#include "hal/counter_clock.hpp"
#include "hal/stm32f4/clock_tree.hpp"
#include "hal/stm32f4/independent_watchdog.hpp"
#include "hal/stm32f4/usart.hpp"

namespace {

using namespace jink;
using hal::cortex_m::Handler;
using hal::cortex_m::MappedRegisters;

// Addresses, interrupts: ST RM0090, 2.3 and 12.2.
constexpr std::uintptr_t kRcc = 0x40023800;
constexpr std::uintptr_t kFlash = 0x40023C00;
constexpr std::uintptr_t kGpioA = 0x40020000;
constexpr std::uintptr_t kUsart1 = 0x40011000;
constexpr std::uintptr_t kWatchdog = 0x40003000;
constexpr std::uintptr_t kTimer2 = 0x40000000;
constexpr unsigned kUsart1Interrupt = 37;

constexpr std::uint32_t kBaud = 921600;
constexpr std::int64_t kTickMicroseconds = 20'000;
/// A step that is this late has failed.
constexpr std::uint32_t kWatchdogMilliseconds = 250;

using Usart = hal::stm32f4::Usart<MappedRegisters, hal::cortex_m::Pend>;

Usart& usart() noexcept
{
    static Usart port(MappedRegisters{kUsart1}, hal::cortex_m::Pend(kUsart1Interrupt));
    return port;
}

/// TIM2 counts microseconds, all 32 bits of them. Not SysTick: whose interrupt is held off for a millisecond loses one.
void start_timer(const hal::stm32f4::Clocks& clocks) noexcept
{
    constexpr std::uint32_t kApb1Enable = 0x40;
    constexpr std::uint32_t kTimer2On = 1U << 0U;
    constexpr std::uint32_t kControl = 0x00;
    constexpr std::uint32_t kEvent = 0x14;
    constexpr std::uint32_t kPrescaler = 0x28;
    constexpr std::uint32_t kReload = 0x2C;
    const MappedRegisters rcc{kRcc};
    const MappedRegisters timer{kTimer2};
    rcc.write(kApb1Enable, rcc.read(kApb1Enable) | kTimer2On);
    timer.write(kPrescaler, clocks.timer / 1'000'000U - 1U);
    timer.write(kReload, 0xFFFFFFFF);
    timer.write(kEvent, 1);  // takes the prescaler over
    timer.write(kControl, 1);
}

/// PA9 and PA10 to USART1, and the clocks of both.
void start_pins() noexcept
{
    const MappedRegisters rcc{kRcc};
    const MappedRegisters gpio{kGpioA};
    constexpr std::uint32_t kAhb1Enable = 0x30;
    constexpr std::uint32_t kApb2Enable = 0x44;
    constexpr std::uint32_t kGpioAOn = 1U << 0U;
    constexpr std::uint32_t kUsart1On = 1U << 4U;
    constexpr std::uint32_t kMode = 0x00;
    constexpr std::uint32_t kPull = 0x0C;
    constexpr std::uint32_t kAlternateHigh = 0x24;
    rcc.write(kAhb1Enable, rcc.read(kAhb1Enable) | kGpioAOn);
    rcc.write(kApb2Enable, rcc.read(kApb2Enable) | kUsart1On);
    gpio.write(kAlternateHigh, (gpio.read(kAlternateHigh) & ~0xFF0U) | 0x770U);
    gpio.write(kPull, (gpio.read(kPull) & ~(0xFU << 18U)) | 1U << 20U);  // an open line reads as idle
    gpio.write(kMode, (gpio.read(kMode) & ~(0xFU << 18U)) | 0xAU << 18U);
}

}  // namespace

extern "C" void jink_usart1() { usart().on_interrupt(); }

namespace {

constexpr std::size_t kInterrupts = 82;

struct VectorTable {
    std::uint32_t* stack;
    std::array<Handler, 15 + kInterrupts> handlers;
};

/// Whatever nobody expects is a fault.
constexpr VectorTable make_vectors() noexcept
{
    constexpr std::size_t kReset = 0;
    constexpr std::size_t kSystickException = 14;
    constexpr std::size_t kFirstInterrupt = 15;
    VectorTable table{&hal::cortex_m::_stack_top, {}};
    table.handlers.fill(&hal::cortex_m::jink_fault_handler);
    table.handlers[kReset] = &hal::cortex_m::jink_reset_handler;
    table.handlers[kSystickException] = &hal::cortex_m::jink_systick_handler;
    table.handlers[kFirstInterrupt + kUsart1Interrupt] = &jink_usart1;
    return table;
}

__attribute__((section(".vectors"), used)) constinit const VectorTable vectors = make_vectors();

}  // namespace

extern "C" void hal::cortex_m::jink_on_fault(const FaultRecord& /*record*/) {}

extern "C" void hal::cortex_m::jink_main()
{
    const hal::stm32f4::Clocks clocks = hal::stm32f4::start_clocks(MappedRegisters{kRcc}, MappedRegisters{kFlash});
    start_pins();
    start_timer(clocks);
    hal::cortex_m::start_systick(clocks.processor / 1000U);  // to wake up by
    constexpr std::uintptr_t kCount = 0x24;
    static hal::CounterClock clock(hal::cortex_m::at(kTimer2 + kCount), hal::CounterClock::Direction::up, 1'000'000);
    static link::mavlink::Endpoint endpoint;
    static hal::stm32f4::IndependentWatchdog watchdog{MappedRegisters{kWatchdog}};
    static app::Coprocessor coprocessor(endpoint, usart(), watchdog, app::Parameters());

    static_cast<void>(usart().start(clocks.apb2, kBaud));
    hal::cortex_m::enable_interrupt(kUsart1Interrupt);
    watchdog.start(kWatchdogMilliseconds);

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
