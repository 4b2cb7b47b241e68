// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <initializer_list>

#include "hal/cortex_m/startup.hpp"

namespace jink::hal::cortex_m {

/// The vectors of a processor with this many interrupts (ARMv7-M, B1.5.3). An image keeps one table in the section
/// `.vectors`.
template <std::size_t Interrupts>
struct VectorTable {
    static constexpr std::size_t kReset = 0;
    static constexpr std::size_t kSystick = 14;
    static constexpr std::size_t kFirstInterrupt = 15;

    std::uint32_t* stack;
    std::array<Handler, kFirstInterrupt + Interrupts> handlers;
};

struct InterruptVector {
    unsigned irq;
    Handler handler;
};

/// Reset, SysTick, and the listed interrupts. All others are faults, the NMI too. A `reset` of the chip's own ends with
/// jink_reset_handler.
template <std::size_t Interrupts>
[[nodiscard]] consteval VectorTable<Interrupts> make_vectors(std::initializer_list<InterruptVector> interrupts,
                                                             Handler systick = &jink_systick_handler,
                                                             Handler reset = &jink_reset_handler) noexcept
{
    using Table = VectorTable<Interrupts>;
    Table table{&_stack_top, {}};
    table.handlers.fill(&jink_fault_handler);
    table.handlers[Table::kReset] = reset;
    table.handlers[Table::kSystick] = systick;
    for (const InterruptVector& vector : interrupts) {
        table.handlers[Table::kFirstInterrupt + vector.irq] = vector.handler;
    }
    return table;
}

}  // namespace jink::hal::cortex_m
