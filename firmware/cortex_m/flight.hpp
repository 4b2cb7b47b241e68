// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "firmware/app/coprocessor.hpp"
#include "firmware/app/plan_memory.hpp"
#include "firmware/flight_log/log_stream.hpp"
#include "hal/cortex_m/cortex_m.hpp"
#include "hal/cortex_m/cycle_counter.hpp"
#include "hal/cortex_m/periodic.hpp"
#include "hal/cortex_m/startup.hpp"

// Common part of the flight images of all boards: the step every 20 ms, and the reports of earlier faults at a start.

namespace jink::firmware {

inline constexpr std::int64_t kTickMicroseconds = 20'000;
/// After so many faults, each within kProvenMicroseconds of its start, the next start stays passive until power-on: a
/// co-processor that repeatedly takes over and drops the controls is worse than none.
inline constexpr std::uint32_t kFaultsInARow = 3;
inline constexpr std::int64_t kProvenMicroseconds = 60'000'000;
/// A passive start waits this long before its first step, so that even faults in each step do not flood the line.
inline constexpr std::int64_t kPassiveWait = 1'000'000;

/// Polls of a UART per byte of the last words: above 0.5 ms on every board, 40 bytes' time at 921600 baud.
inline constexpr std::uint32_t kPatience = 20'000;

/// Memory apart from the rest, which start-up does not clear: plans, whose stack lies at its start, and the flight log.
struct ApartMemory {
    alignas(app::PlanMemory) std::byte plans[sizeof(app::PlanMemory)];
    alignas(flightlog::LogStream) std::byte log[sizeof(flightlog::LogStream)];
};

/// Report of a fault, in two lines of a STATUSTEXT.
struct FaultStory {
    app::Text what;
    app::Text where;
};
[[nodiscard]] FaultStory tell_story(const hal::cortex_m::FaultRecord& record) noexcept;

/// Checks the reach sets against their checksums; damaged ones are left out, and the autopilot gets a message. Reads
/// all tables bit by bit: 11 million instructions on a Cortex-M7 for 256 KiB, so call it before the watchdog is
/// started.
void settle_reach_sets(app::Coprocessor& coprocessor) noexcept;

/// Takes the map that the image is built with, if any (built_map.hpp). With a damaged one the image stays passive, and
/// the autopilot gets a report: without its map nothing would be in the way. Reads all of its tables bit by bit, so
/// before the watchdog is started.
void settle_map(app::Coprocessor& coprocessor) noexcept;

/// Reads the record of the fault before this start and has it reported: each of the first kFaultsInARow, then those
/// whose count is a power of two. True where this start is to be passive; then it returns after kPassiveWait only. For
/// the time before the watchdog is started.
[[nodiscard]] bool settle_faults(app::Coprocessor& coprocessor, hal::Clock& clock) noexcept;

/// Steps for ever, and counts the cycles of each step; `before_step` services the ports once per tick.
/// @param processor_clock  [Hz], at least 1 MHz
template <class Clock, class BeforeStep>
[[noreturn]] void fly(app::Coprocessor& coprocessor, Clock& clock, std::uint32_t processor_clock, bool passive,
                      BeforeStep before_step) noexcept
{
    const std::int64_t start = clock.now_us();
    const hal::cortex_m::CycleCounter counter(hal::cortex_m::MappedRegisters(0xE0000000));
    hal::cortex_m::run_every(kTickMicroseconds, clock, [&, proven = passive](std::int64_t now) mutable {
        before_step();
        const std::uint32_t began = counter.cycles();
        static_cast<void>(coprocessor.step({now}));
        if (counter.is_there()) {
            coprocessor.note_cycles(counter.cycles() - began, processor_clock / 1'000'000);
        }
        if (!proven && now - start >= kProvenMicroseconds) {
            proven = true;
            hal::cortex_m::forgive_faults();
        }
    });
}

}  // namespace jink::firmware
