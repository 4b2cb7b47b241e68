// SPDX-License-Identifier: BSD-3-Clause
// jink on an STM32F405 (Cortex-M4F, a flight controller's chip): MAVLink on USART1, PA9 and PA10; a DroneCAN bus of 1
// Mbit/s on CAN1, PB8 and PB9. Of the pins possible for CAN1, the smallest package has these and those of USB.
#include <new>

#include "firmware/app/can_bus.hpp"
#include "firmware/app/param_keeper.hpp"
#include "firmware/app/work_rate.hpp"
#include "firmware/cortex_m/flight.hpp"
#include "firmware/link/mavlink/endpoint.hpp"
#include "hal/cortex_m/cortex_m.hpp"
#include "hal/cortex_m/startup.hpp"
#include "hal/cortex_m/step_guard.hpp"
#include "hal/cortex_m/vector_table.hpp"
#include "hal/counter_clock.hpp"
#include "hal/last_words.hpp"
#include "hal/stm32f4/bxcan.hpp"
#include "hal/stm32f4/clock_tree.hpp"
#include "hal/stm32f4/flash.hpp"
#include "hal/stm32f4/independent_watchdog.hpp"
#include "hal/stm32f4/reset_cause.hpp"
#include "hal/stm32f4/usart.hpp"

namespace {

using namespace jink;
using hal::cortex_m::MappedRegisters;

// Addresses, interrupts: ST RM0090, 2.3 and 12.2.
constexpr std::uintptr_t kRcc = 0x40023800;
constexpr std::uintptr_t kFlash = 0x40023C00;
constexpr std::uintptr_t kGpioA = 0x40020000;
constexpr std::uintptr_t kUsart1 = 0x40011000;
constexpr std::uintptr_t kWatchdog = 0x40003000;
constexpr std::uintptr_t kTimer2 = 0x40000000;
constexpr std::uintptr_t kGpioB = 0x40020400;
constexpr std::uintptr_t kCan1 = 0x40006400;
constexpr std::uintptr_t kStore = 0x080C0000;  // sectors 10 and 11 of the flash (3.3): stm32f405.ld leaves them out
constexpr std::uint32_t kStoreSector = 10;
constexpr std::uintptr_t kUniqueId = 0x1FFF7A10;  // 96 bits (39.1)
constexpr unsigned kCan1TransmitInterrupt = 19;
constexpr unsigned kCan1ReceiveInterrupt = 20;
constexpr unsigned kCan1StatusInterrupt = 22;
constexpr unsigned kUsart1Interrupt = 37;

constexpr std::uint32_t kBaud = 921600;
/// Work of a step. Without its crystal the processor runs at the same clock (clock_tree.hpp).
constexpr app::WorkRate kRate(168'000'000);
static_assert(kRate.has_time_for(kRate.work()) && avoid::is_valid(kRate.work()));
constexpr std::uint32_t kCanBitRate = 1'000'000;
/// A step that is this late has failed.
constexpr std::uint32_t kWatchdogMilliseconds = 250;
/// A step that is this late is stopped with last words, before the watchdog at its fastest (0.68 of the above) resets
/// without them. Ticks of SysTick.
constexpr std::uint32_t kGuardMilliseconds = 150;
/// While a sector is erased, 2 s at most, the program stops: the watchdog at its fastest then acts after 2.8 s.
constexpr std::uint32_t kEraseMilliseconds = 4095;

using Usart = hal::stm32f4::Usart<MappedRegisters, hal::cortex_m::Pend>;

Usart& usart() noexcept
{
    static Usart port(MappedRegisters{kUsart1}, hal::cortex_m::Pend(kUsart1Interrupt));
    return port;
}

using ChipWatchdog = hal::stm32f4::IndependentWatchdog<MappedRegisters>;

/// Extends both watchdogs during a sector's erase, which only a running program begins.
struct Patience {
    ChipWatchdog* watchdog;
    hal::cortex_m::GuardedWatchdog<ChipWatchdog>* guarded;

    void operator()(bool erasing) const noexcept
    {
        watchdog->start(erasing ? kEraseMilliseconds : kWatchdogMilliseconds);
        erasing ? guarded->pause() : guarded->feed();
    }
};

using Can = hal::stm32f4::BxCan<MappedRegisters, hal::cortex_m::Pend>;

/// Core-coupled memory: no bus master but the processor reaches it, and CAN needs none. Start-up does not clear it, and
/// it is unused before start_can().
alignas(Can) __attribute__((section(".ccm"))) std::byte can_memory[sizeof(Can)];
alignas(app::CanBus) __attribute__((section(".ccm"))) std::byte bus_memory[sizeof(app::CanBus)];
Can* can = nullptr;  ///< nullptr: no CAN

/// Likewise; at the start of the core-coupled memory. An emulator has none, and as much behind the RAM.
__attribute__((section(".plan"))) firmware::ApartMemory apart_memory;
__attribute__((section(".plan_emulated"))) firmware::ApartMemory apart_memory_emulated;

/// Two neighbouring pins for a peripheral.
struct PinPair {
    std::uintptr_t gpio;
    std::uint32_t gpio_on;        ///< in AHB1ENR
    std::uint32_t enable;         ///< offset of the peripheral's clock register in RCC
    std::uint32_t peripheral_on;  ///< in that register
    std::uint32_t first;          ///< the lower pin, 8 .. 14; the other is the next
    std::uint32_t alternate;      ///< function of both
    std::uint32_t pulled_up;      ///< the pin with a pull-up, high while it is not driven
};

/// Connects the pins to the peripheral, and starts the clocks of both.
void start_pins(const PinPair& pins) noexcept
{
    const MappedRegisters rcc{kRcc};
    const MappedRegisters gpio{pins.gpio};
    constexpr std::uint32_t kAhb1Enable = 0x30;
    constexpr std::uint32_t kMode = 0x00;
    constexpr std::uint32_t kPull = 0x0C;
    constexpr std::uint32_t kAlternateHigh = 0x24;
    const std::uint32_t at = 2U * pins.first;                   // two bits a pin
    const std::uint32_t at_alternate = 4U * (pins.first - 8U);  // four bits a pin, from pin 8
    const std::uint32_t functions = (pins.alternate * 0x11U) << at_alternate;
    rcc.write(kAhb1Enable, rcc.read(kAhb1Enable) | pins.gpio_on);
    rcc.write(pins.enable, rcc.read(pins.enable) | pins.peripheral_on);
    gpio.write(kAlternateHigh, (gpio.read(kAlternateHigh) & ~(0xFFU << at_alternate)) | functions);
    gpio.write(kPull, (gpio.read(kPull) & ~(0xFU << at)) | 1U << (2U * pins.pulled_up));
    gpio.write(kMode, (gpio.read(kMode) & ~(0xFU << at)) | 0xAU << at);
}

/// PB8 and PB9; without a transceiver PB8 reads as recessive.
constexpr PinPair kCanPins{kGpioB, 1U << 1U, 0x40, 1U << 25U, 8, 9, 8};
/// PA9 and PA10; an open line at PA10 reads as idle.
constexpr PinPair kUsartPins{kGpioA, 1U << 0U, 0x44, 1U << 4U, 9, 7, 10};

/// The chip's own unique id, and a node id from the bus's allocator.
link::dronecan::NodeOptions node_options() noexcept
{
    constexpr std::size_t kBytes = 12;
    link::dronecan::NodeOptions options;
    const MappedRegisters unique{kUniqueId};
    std::uint64_t seed = 0;
    for (std::uint32_t word = 0; word < kBytes / 4; ++word) {
        const std::uint32_t bits = unique.read(4 * word);
        seed = (seed ^ bits) * 0x9E3779B97F4A7C15ULL;
        for (std::uint32_t i = 0; i < 4; ++i) {
            options.unique_id[4 * word + i] = static_cast<std::uint8_t>(bits >> (8U * i));
        }
    }
    options.seed = seed;
    options.name = "org.jink.stm32f405";
    return options;
}

/// A controller that takes part in a bus, or nullptr. The internal oscillator is off by up to 1 %, and CAN at 1 Mbit/s
/// tolerates a third of that: without the crystal the controller would only disturb the bus.
app::CanBus* start_can(const hal::stm32f4::Clocks& clocks) noexcept
{
    if (clocks.source != hal::stm32f4::ClockSource::crystal) {
        return nullptr;
    }
    start_pins(kCanPins);
    can = new (can_memory) Can(MappedRegisters{kCan1}, hal::cortex_m::Pend(kCan1TransmitInterrupt));
    if (!can->start(clocks.apb1, kCanBitRate)) {
        can = nullptr;
        return nullptr;
    }
    return new (bus_memory) app::CanBus(*can, node_options());
}

/// TIM2 counts microseconds in 32 bits. SysTick would not do: it loses a tick if its interrupt is delayed for a
/// millisecond.
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
    timer.write(kEvent, 1);  // loads the prescaler
    timer.write(kControl, 1);
}

}  // namespace

extern "C" void jink_usart1() { usart().on_interrupt(); }
// Enabled once `can` exists.
extern "C" void jink_can1_transmit() { can->on_transmit(); }
extern "C" void jink_can1_receive() { can->on_receive(); }
extern "C" void jink_can1_status() { can->on_status(); }

namespace {

__attribute__((section(".vectors"), used)) constinit const auto vectors =
    hal::cortex_m::make_vectors<82>({{kUsart1Interrupt, &jink_usart1},
                                     {kCan1TransmitInterrupt, &jink_can1_transmit},
                                     {kCan1ReceiveInterrupt, &jink_can1_receive},
                                     {kCan1StatusInterrupt, &jink_can1_status}},
                                    &hal::cortex_m::jink_guard_handler);

}  // namespace

// A reset does not clear it. Its content is used before clear() only after a reset without warning.
__attribute__((section(".noinit"))) hal::LastWords last_words;

namespace {

void say_words() noexcept
{
    static_cast<void>(say_last_words<Usart>(MappedRegisters{kUsart1}, usart().to_send(), last_words.valid(),
                                            link::mavlink::kMaxFrame, firmware::kPatience));
}

/// The watchdog gave no time for last words: they are sent now, as prepared in the last step.
void settle_reset(hal::stm32f4::ResetCause cause) noexcept
{
    using hal::stm32f4::ResetCause;
    if (cause == ResetCause::power || cause == ResetCause::pin) {
        hal::cortex_m::forget_faults();
    } else if (cause == ResetCause::independent_watchdog && hal::cortex_m::note_silent_reset()) {
        say_words();
    }
    last_words.clear();
}

}  // namespace

extern "C" void hal::cortex_m::jink_on_fault(const FaultRecord& /*record*/) { say_words(); }

extern "C" void hal::cortex_m::jink_main()
{
    const hal::stm32f4::ResetCause cause = hal::stm32f4::take_reset_cause(MappedRegisters{kRcc});
    const hal::stm32f4::Clocks clocks = hal::stm32f4::start_clocks(MappedRegisters{kRcc}, MappedRegisters{kFlash});
    start_pins(kUsartPins);
    start_timer(clocks);
    hal::cortex_m::start_systick(clocks.processor / 1000U);  // to wake up by
    constexpr std::uintptr_t kCount = 0x24;
    static hal::CounterClock clock(hal::cortex_m::at(kTimer2 + kCount), hal::CounterClock::Direction::up, 1'000'000);
    static link::mavlink::Endpoint endpoint;
    static ChipWatchdog watchdog{MappedRegisters{kWatchdog}};
    static hal::cortex_m::GuardedWatchdog guarded(watchdog, kGuardMilliseconds);
    app::CanBus* const bus = start_can(clocks);
    static app::Coprocessor coprocessor(endpoint, usart(), guarded, app::Parameters(), bus);
    static hal::stm32f4::Flash flash(MappedRegisters{kFlash}, MappedRegisters{kStore}, kStoreSector,
                                     Patience{&watchdog, &guarded});
    static app::ParamFlash stored(flash);
    static app::ParamKeeper keeper(stored);

    static_cast<void>(usart().start(clocks.apb2, kBaud));
    settle_reset(cause);
    firmware::ApartMemory& apart =
        clocks.source == hal::stm32f4::ClockSource::emulator ? apart_memory_emulated : apart_memory;
    coprocessor.keep_last_words(last_words);
    coprocessor.stream(*new (apart.log) flightlog::LogStream(kBaud));
    hal::cortex_m::let_faults_speak();
    hal::cortex_m::enable_interrupt(kUsart1Interrupt);
    if (bus != nullptr) {
        for (const unsigned irq : {kCan1TransmitInterrupt, kCan1ReceiveInterrupt, kCan1StatusInterrupt}) {
            hal::cortex_m::enable_interrupt(irq);
        }
    }
    keeper.start(coprocessor);
    app::PlanMemory& plans = *new (apart.plans) app::PlanMemory;
    hal::cortex_m::note_second_stack(plans.stack);
    static_cast<void>(coprocessor.plan_in_slices(plans.plan, kRate.work()));  // valid, as asserted above
    firmware::settle_reach_sets(coprocessor);
    firmware::settle_map(coprocessor);
    const bool passive = firmware::settle_faults(coprocessor, clock);
    if (bus == nullptr) {
        app::Text text;
        text << "jink: no CAN bus, going on without";
        static_cast<void>(coprocessor.tell_when_heard(link::Severity::notice, text));
    }
    watchdog.start(kWatchdogMilliseconds);
    guarded.feed();
    firmware::fly(coprocessor, clock, passive, [] {
        if (can != nullptr) {
            can->service();
        }
        keeper.work(coprocessor, {clock.now_us()});
    });
}
