// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <new>

#include "firmware/app/built_map.hpp"
#include "firmware/app/param_keeper.hpp"
#include "firmware/app/work_rate.hpp"
#include "firmware/cortex_m/flight.hpp"
#include "firmware/link/mavlink/endpoint.hpp"
#include "hal/cortex_m/step_guard.hpp"
#include "hal/counter_clock.hpp"
#include "hal/last_words.hpp"
#include "hal/stm32/clocks.hpp"
#include "hal/stm32/independent_watchdog.hpp"
#include "hal/stm32/microsecond_timer.hpp"
#include "hal/stm32/reset_cause.hpp"

// Common part of the flight images of all STM32: the order of their start, their watchdogs, their last words. An image
// gives a Board:
//
//   Usart                     the driver's type; static Usart& usart(): the port of MAVLink
//   kUsart, kUsartInterrupt   base of its registers, and its interrupt
//   kWatchdog, kTimer         bases of the independent watchdog and of a timer of 32 bits
//   kClock                    the processor's at full speed [Hz]
//   take_reset_cause()        the cause of the last reset
//   start()                   clocks, pins, and the timer's clock; returns the hal::stm32::Clocks
//   usart_clock(clocks)       of the USART [Hz]
//   flash(patience)           hal::FlashRegion& of the parameters; patience is an ErasePatience
//   apart_memory(clocks)      ApartMemory&, at the start of a memory
//   last_words()              hal::LastWords& that a reset does not clear
//   start_bus(clocks)         link::SensorBus* or nullptr; its text without one: kNoBus, empty for none
//   listen_to_bus()           enables the interrupts of the bus
//   service_bus()             between steps

namespace jink::firmware::stm32 {

using hal::cortex_m::MappedRegisters;
using ChipWatchdog = hal::stm32::IndependentWatchdog<MappedRegisters>;
using Guarded = hal::cortex_m::GuardedWatchdog<ChipWatchdog>;

inline constexpr std::uint32_t kBaud = 921600;
/// A step that is this late has failed.
inline constexpr std::uint32_t kWatchdogMilliseconds = 250;
/// A step that is this late is stopped with last words, before the watchdog at its fastest (0.68 of the above) resets
/// without them. Ticks of SysTick.
inline constexpr std::uint32_t kGuardMilliseconds = 150;
/// While a sector is erased, 2 s at most, no step begins: the watchdog at its fastest then acts after 2.8 s.
inline constexpr std::uint32_t kEraseMilliseconds = 4095;

/// Extends both watchdogs during a sector's erase, which only a running program begins.
struct ErasePatience {
    ChipWatchdog* watchdog;
    Guarded* guarded;

    void operator()(bool erasing) const noexcept
    {
        watchdog->start(erasing ? kEraseMilliseconds : kWatchdogMilliseconds);
        erasing ? guarded->pause() : guarded->feed();
    }
};

/// Sends what is in Board::last_words(), as a fault handler can.
template <class Board>
void say_words() noexcept
{
    static_cast<void>(hal::say_last_words<typename Board::Usart>(MappedRegisters{Board::kUsart},
                                                                 Board::usart().to_send(), Board::last_words().valid(),
                                                                 link::mavlink::kMaxFrame, kPatience));
}

/// The watchdog gave no time for last words: they are sent now, as prepared in the last step.
template <class Board>
void settle_reset(hal::stm32::ResetCause cause) noexcept
{
    using hal::stm32::ResetCause;
    if (cause == ResetCause::power || cause == ResetCause::pin) {
        hal::cortex_m::forget_faults();
    } else if (cause == ResetCause::independent_watchdog && hal::cortex_m::note_silent_reset()) {
        say_words<Board>();
    }
    Board::last_words().clear();
}

/// What a start has to report besides faults.
template <class Board>
void report_start(app::Coprocessor& coprocessor, const hal::stm32::Clocks& clocks, bool has_bus) noexcept
{
    if (clocks.processor < Board::kClock) {
        app::Text text;
        text << "jink: clock too slow, passive";
        static_cast<void>(coprocessor.tell_when_heard(link::Severity::critical, text));
        coprocessor.stay_passive();
    }
    if (!has_bus && !Board::kNoBus.empty()) {
        app::Text text;
        text << Board::kNoBus;
        static_cast<void>(coprocessor.tell_when_heard(link::Severity::notice, text));
    }
}

/// The image's program.
template <class Board>
[[noreturn]] void run_board() noexcept
{
    constexpr app::WorkRate kRate(Board::kClock);
    constexpr avoid::WorkPerUpdate kWork = app::work_of_image(kRate);
    static_assert(kRate.has_time_for(kWork) && avoid::is_valid(kWork));
    const hal::stm32::ResetCause cause = Board::take_reset_cause();
    const hal::stm32::Clocks clocks = Board::start();
    hal::stm32::start_microseconds(MappedRegisters{Board::kTimer}, clocks.timer);
    hal::cortex_m::start_systick(clocks.processor / 1000U);  // to wake up by
    static hal::CounterClock clock(hal::cortex_m::at(Board::kTimer + hal::stm32::kTimerCount),
                                   hal::CounterClock::Direction::up, 1'000'000);
    static link::mavlink::Endpoint endpoint;
    static ChipWatchdog watchdog{MappedRegisters{Board::kWatchdog}};
    static Guarded guarded(watchdog, kGuardMilliseconds);
    link::SensorBus* const bus = Board::start_bus(clocks);
    static app::Coprocessor coprocessor(endpoint, Board::usart(), guarded, app::Parameters(), bus);
    static app::ParamFlash stored(Board::flash(ErasePatience{&watchdog, &guarded}));
    static app::ParamKeeper keeper(stored);

    static_cast<void>(Board::usart().start(Board::usart_clock(clocks), kBaud));
    settle_reset<Board>(cause);
    ApartMemory& apart = Board::apart_memory(clocks);
    coprocessor.keep_last_words(Board::last_words());
    coprocessor.stream(*new (apart.log) flightlog::LogStream(kBaud));
    hal::cortex_m::let_faults_speak();
    hal::cortex_m::enable_interrupt(Board::kUsartInterrupt);
    if (bus != nullptr) {
        Board::listen_to_bus();
    }
    keeper.start(coprocessor);
    app::PlanMemory& plans = *new (apart.plans) app::PlanMemory;
    hal::cortex_m::note_second_stack(plans.stack);
    static_cast<void>(coprocessor.plan_in_slices(plans.plan, kWork));  // valid, as asserted above
    settle_reach_sets(coprocessor);
    settle_map(coprocessor);
    const bool passive = settle_faults(coprocessor, clock);
    report_start<Board>(coprocessor, clocks, bus != nullptr);
    watchdog.start(kWatchdogMilliseconds);
    guarded.feed();
    fly(coprocessor, clock, clocks.processor, passive, [] {
        Board::service_bus();
        keeper.work(coprocessor, {clock.now_us()});
    });
}

}  // namespace jink::firmware::stm32
