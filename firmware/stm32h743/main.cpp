// SPDX-License-Identifier: BSD-3-Clause
// jink on an STM32H743ZI (Cortex-M7), wired as a Nucleo-H743ZI2: MAVLink on USART3, PD8 and PD9, which the board's
// debugger carries to USB; its 8 MHz come from the debugger (ST UM2407). No CAN: there is no driver for FDCAN. No
// emulator has this chip (docs/guides/porting.md).
#include "firmware/stm32/run_board.hpp"
#include "hal/cortex_m/caches.hpp"
#include "hal/cortex_m/memory_protection.hpp"
#include "hal/cortex_m/tolerant_memory.hpp"
#include "hal/cortex_m/vector_table.hpp"
#include "hal/stm32/pin_pair.hpp"
#include "hal/stm32h7/axi_sram.hpp"
#include "hal/stm32h7/clock_tree.hpp"
#include "hal/stm32h7/flash.hpp"
#include "hal/stm32h7/reset_flags.hpp"
#include "hal/stm32h7/usart.hpp"

namespace {

using namespace jink;
using hal::cortex_m::MappedRegisters;

// Addresses, interrupts: ST RM0433, table 8 and 19.1.2; ST's stm32h743xx.h.
constexpr std::uintptr_t kRcc = 0x58024400;
constexpr std::uintptr_t kPower = 0x58024800;
constexpr std::uintptr_t kFlash = 0x52002000;
constexpr std::uintptr_t kGpioD = 0x58020C00;
constexpr std::uintptr_t kDebug = 0x5C001000;
constexpr std::uintptr_t kMatrix = 0x51000000;  // of the AXI buses
constexpr std::uint32_t kCode = 0x08000000;     // the vectors: stm32h743.ld
constexpr std::uint32_t kStoreSector = 6;       // of bank 2, and 7: stm32h743.ld leaves all of bank 2 out
constexpr std::uint32_t kStore = 0x081C0000;
constexpr std::uint32_t kStoreLog2 = 18;       // both sectors
constexpr std::uintptr_t kPlans = 0x24000000;  // the AXI SRAM: stm32h743.ld
constexpr std::uint32_t kAhb4Enable = 0xE0;
constexpr std::uint32_t kApb1LowEnable = 0xE8;

/// Of the debugger; a board with a crystal says so here.
constexpr hal::stm32h7::ExternalClock kExternalClock = hal::stm32h7::ExternalClock::fed;
/// PD8 and PD9; an open line at PD9 reads as idle.
constexpr hal::stm32::PinPair kUsartPins{kAhb4Enable, 1U << 3U, kApb1LowEnable, 1U << 18U, 8, 7, 9};

/// At the start of the AXI SRAM. Start-up does not clear it.
__attribute__((section(".plan"))) firmware::ApartMemory apart_memory_of_chip;

/// Protection and caches. Data and stack lie in the DTCM, which no cache covers; code, tables and plans are cached.
/// There is no other bus master (no DMA), so nothing has to be kept coherent, except for the two sectors of flash that
/// are programmed: these are strongly ordered, so that each read is one of the flash.
void start_memory() noexcept
{
    using namespace hal::cortex_m;
    constexpr std::uintptr_t kVectors = 0xE000ED08;  // VTOR
    const MappedRegisters system{kSystemControl};
    at(kVectors) = kCode;  // also where the chip was started by its own loader
    hal::stm32h7::settle_axi_sram(MappedRegisters{kDebug}, MappedRegisters{kMatrix});
    // 0x60000000 to 0x9FFFFFFF, external memories: nothing is there, and a Cortex-M7 may read normal memory ahead of
    // time.
    static_cast<void>(protect(system, {1, 0, 32, Access::none, 0xE7}));
    static_cast<void>(protect(system, {2, kStore, kStoreLog2, Access::strongly_ordered}));
    static_cast<void>(guard_stack(system, kPlans, 3));
    barrier();
    start_caches(system, [] { barrier(); });
}

}  // namespace

// A reset does not clear it. Its content is used before clear() only after a reset without warning. In the DTCM: what
// is written there is not in a cache when a reset comes, and whole words are complete (RM0433, 2.4).
__attribute__((section(".noinit"))) hal::LastWords last_words;

namespace {

/// The board of firmware/stm32/run_board.hpp.
struct Board {
    using Usart = hal::stm32h7::Usart<MappedRegisters, hal::cortex_m::Pend>;
    static constexpr std::uintptr_t kUsart = 0x40004800;  // USART3
    static constexpr unsigned kUsartInterrupt = 39;
    static constexpr std::uintptr_t kWatchdog = 0x58004800;  // IWDG1
    static constexpr std::uintptr_t kTimer = 0x40000000;     // TIM2
    /// Without its external clock the processor runs at the same clock (clock_tree.hpp).
    static constexpr std::uint32_t kClock = 400'000'000;
    static constexpr std::string_view kNoBus{};

    static Usart& usart() noexcept
    {
        static Usart port(MappedRegisters{kUsart}, hal::cortex_m::Pend(kUsartInterrupt));
        return port;
    }
    static hal::LastWords& last_words() noexcept { return ::last_words; }
    static hal::stm32::ResetCause take_reset_cause() noexcept
    {
        return hal::stm32::take_reset_cause(MappedRegisters{kRcc}, hal::stm32h7::kResetFlags);
    }
    static hal::stm32::Clocks start() noexcept
    {
        const MappedRegisters rcc{kRcc};
        start_memory();
        const hal::stm32::Clocks clocks =
            hal::stm32h7::start_clocks(rcc, MappedRegisters{kPower}, MappedRegisters{kFlash}, kExternalClock);
        hal::stm32::start_pins(rcc, MappedRegisters{kGpioD}, kUsartPins);
        hal::stm32::enable_clock(rcc, kApb1LowEnable, 1U << 0U);  // TIM2
        return clocks;
    }
    static std::uint32_t usart_clock(const hal::stm32::Clocks& clocks) noexcept { return clocks.apb1; }
    static hal::FlashRegion& flash(firmware::stm32::ErasePatience patience) noexcept
    {
        static hal::stm32h7::Flash region(MappedRegisters{kFlash}, hal::cortex_m::TolerantMemory{kStore}, kStoreSector,
                                          patience);
        return region;
    }
    static firmware::ApartMemory& apart_memory(const hal::stm32::Clocks& /*clocks*/) noexcept
    {
        return apart_memory_of_chip;
    }
    static link::SensorBus* start_bus(const hal::stm32::Clocks& /*clocks*/) noexcept { return nullptr; }
    static void listen_to_bus() noexcept {}
    static void service_bus() noexcept {}
};

}  // namespace

extern "C" void jink_usart3() { Board::usart().on_interrupt(); }

/// Where the chip starts. After power-on nothing may be written to any RAM, so not to the stack either, before the
/// supply is chosen and its voltage is there (Run* mode: ST RM0433, 6.6.1, and ST's stm32h7xx_hal_pwr_ex.c). The wait
/// is bounded: start_clocks() does the same again, and tells what is missing.
extern "C" __attribute__((naked)) void jink_supply_handler()
{
    __asm volatile("ldr r0, =0x58024800\n"     // PWR
                   "ldr r1, [r0, #0x0C]\n"     // CR3
                   "bic r1, r1, #7\n"          // the fields of clock_tree.hpp
                   "orr r1, r1, #2\n"          // the linear regulator
                   "str r1, [r0, #0x0C]\n"     // counts once after power-on
                   "ldr r2, =400000\n"         // polls
                   "1: ldr r1, [r0, #0x04]\n"  // CSR1
                   "tst r1, #0x2000\n"         // the voltage is there
                   "bne 2f\n"
                   "subs r2, #1\n"
                   "bne 1b\n"
                   "2: b jink_reset_handler\n");
}

namespace {

__attribute__((section(".vectors"), used)) constinit const auto vectors = hal::cortex_m::make_vectors<150>(
    {{Board::kUsartInterrupt, &jink_usart3}}, &hal::cortex_m::jink_guard_handler, &jink_supply_handler);

}  // namespace

extern "C" void hal::cortex_m::jink_on_fault(const FaultRecord& /*record*/) { firmware::stm32::say_words<Board>(); }

extern "C" void hal::cortex_m::jink_main() { firmware::stm32::run_board<Board>(); }
