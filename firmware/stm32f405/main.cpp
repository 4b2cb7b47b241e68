// SPDX-License-Identifier: BSD-3-Clause
// jink on an STM32F405 (Cortex-M4F, a flight controller's chip): MAVLink on USART1, PA9 and PA10; a DroneCAN bus of 1
// Mbit/s on CAN1, PB8 and PB9. Of the pins possible for CAN1, the smallest package has these and those of USB.
#include <new>

#include "firmware/app/can_bus.hpp"
#include "firmware/stm32/run_board.hpp"
#include "hal/cortex_m/memory_protection.hpp"
#include "hal/cortex_m/vector_table.hpp"
#include "hal/stm32/pin_pair.hpp"
#include "hal/stm32f4/bxcan.hpp"
#include "hal/stm32f4/clock_tree.hpp"
#include "hal/stm32f4/flash.hpp"
#include "hal/stm32f4/reset_flags.hpp"
#include "hal/stm32f4/usart.hpp"

namespace {

using namespace jink;
using hal::cortex_m::MappedRegisters;

// Addresses, interrupts: ST RM0090, 2.3 and 12.2.
constexpr std::uintptr_t kRcc = 0x40023800;
constexpr std::uintptr_t kFlash = 0x40023C00;
constexpr std::uintptr_t kGpioA = 0x40020000;
constexpr std::uintptr_t kGpioB = 0x40020400;
constexpr std::uintptr_t kCan1 = 0x40006400;
constexpr std::uintptr_t kStore = 0x080C0000;  // sectors 10 and 11 of the flash (3.3): stm32f405.ld leaves them out
constexpr std::uint32_t kStoreSector = 10;
constexpr std::uintptr_t kStackBottom = 0x20000000;  // stm32f405.ld
constexpr std::uintptr_t kUniqueId = 0x1FFF7A10;     // 96 bits (39.1)
static_assert(!hal::cortex_m::is_guarded(kStackBottom, kUniqueId) &&
              !hal::cortex_m::is_guarded(kStackBottom, kUniqueId + 11));
constexpr unsigned kCan1TransmitInterrupt = 19;
constexpr unsigned kCan1ReceiveInterrupt = 20;
constexpr unsigned kCan1StatusInterrupt = 22;
constexpr std::uint32_t kAhb1Enable = 0x30;
constexpr std::uint32_t kApb1Enable = 0x40;
constexpr std::uint32_t kApb2Enable = 0x44;

constexpr std::uint32_t kCanBitRate = 1'000'000;

using Can = hal::stm32f4::BxCan<MappedRegisters, hal::cortex_m::Pend>;

/// Core-coupled memory: no bus master but the processor reaches it, and CAN needs none. Start-up does not clear it, and
/// it is unused before start_bus().
alignas(Can) __attribute__((section(".ccm"))) std::byte can_memory[sizeof(Can)];
alignas(app::CanBus) __attribute__((section(".ccm"))) std::byte bus_memory[sizeof(app::CanBus)];
Can* can = nullptr;  ///< nullptr: no CAN

/// Likewise; at the start of the core-coupled memory. An emulator has none, and as much behind the RAM.
__attribute__((section(".plan"))) firmware::ApartMemory apart_memory_of_chip;
__attribute__((section(".plan_emulated"))) firmware::ApartMemory apart_memory_emulated;

/// PB8 and PB9; without a transceiver PB8 reads as recessive.
constexpr hal::stm32::PinPair kCanPins{kAhb1Enable, 1U << 1U, kApb1Enable, 1U << 25U, 8, 9, 8};
/// PA9 and PA10; an open line at PA10 reads as idle.
constexpr hal::stm32::PinPair kUsartPins{kAhb1Enable, 1U << 0U, kApb2Enable, 1U << 4U, 9, 7, 10};

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

}  // namespace

// A reset does not clear it. Its content is used before clear() only after a reset without warning.
__attribute__((section(".noinit"))) hal::LastWords last_words;

namespace {

/// The board of firmware/stm32/run_board.hpp.
struct Board {
    using Usart = hal::stm32f4::Usart<MappedRegisters, hal::cortex_m::Pend>;
    static constexpr std::uintptr_t kUsart = 0x40011000;  // USART1
    static constexpr unsigned kUsartInterrupt = 37;
    static constexpr std::uintptr_t kWatchdog = 0x40003000;
    static constexpr std::uintptr_t kTimer = 0x40000000;  // TIM2
    /// Without its crystal the processor runs at the same clock (clock_tree.hpp).
    static constexpr std::uint32_t kClock = 168'000'000;
    static constexpr std::string_view kNoBus = "jink: no CAN bus, going on without";

    static Usart& usart() noexcept
    {
        static Usart port(MappedRegisters{kUsart}, hal::cortex_m::Pend(kUsartInterrupt));
        return port;
    }
    static hal::LastWords& last_words() noexcept { return ::last_words; }
    static hal::stm32::ResetCause take_reset_cause() noexcept
    {
        return hal::stm32::take_reset_cause(MappedRegisters{kRcc}, hal::stm32f4::kResetFlags);
    }
    static hal::stm32::Clocks start() noexcept
    {
        const MappedRegisters rcc{kRcc};
        const hal::stm32::Clocks clocks = hal::stm32f4::start_clocks(rcc, MappedRegisters{kFlash});
        hal::stm32::start_pins(rcc, MappedRegisters{kGpioA}, kUsartPins);
        hal::stm32::enable_clock(rcc, kApb1Enable, 1U << 0U);  // TIM2
        return clocks;
    }
    static std::uint32_t usart_clock(const hal::stm32::Clocks& clocks) noexcept { return clocks.apb2; }
    static hal::FlashRegion& flash(firmware::stm32::ErasePatience patience) noexcept
    {
        static hal::stm32f4::Flash region(MappedRegisters{kFlash}, MappedRegisters{kStore}, kStoreSector, patience);
        return region;
    }
    static firmware::ApartMemory& apart_memory(const hal::stm32::Clocks& clocks) noexcept
    {
        const bool emulated = clocks.source == hal::stm32::ClockSource::emulator;
        return emulated ? apart_memory_emulated : apart_memory_of_chip;
    }
    /// A controller that takes part in a bus, or nullptr. The internal oscillator is off by up to 1 %, and CAN at 1
    /// Mbit/s tolerates a third of that: without the crystal the controller would only disturb the bus.
    static link::SensorBus* start_bus(const hal::stm32::Clocks& clocks) noexcept
    {
        if (clocks.source != hal::stm32::ClockSource::crystal) {
            return nullptr;
        }
        hal::stm32::start_pins(MappedRegisters{kRcc}, MappedRegisters{kGpioB}, kCanPins);
        can = new (can_memory) Can(MappedRegisters{kCan1}, hal::cortex_m::Pend(kCan1TransmitInterrupt));
        if (!can->start(clocks.apb1, kCanBitRate)) {
            can = nullptr;
            return nullptr;
        }
        return new (bus_memory) app::CanBus(*can, node_options());
    }
    static void listen_to_bus() noexcept
    {
        for (const unsigned irq : {kCan1TransmitInterrupt, kCan1ReceiveInterrupt, kCan1StatusInterrupt}) {
            hal::cortex_m::enable_interrupt(irq);
        }
    }
    static void service_bus() noexcept
    {
        if (can != nullptr) {
            can->service();
        }
    }
};

}  // namespace

extern "C" void jink_usart1() { Board::usart().on_interrupt(); }
// Enabled once `can` exists.
extern "C" void jink_can1_transmit() { can->on_transmit(); }
extern "C" void jink_can1_receive() { can->on_receive(); }
extern "C" void jink_can1_status() { can->on_status(); }

namespace {

__attribute__((section(".vectors"), used)) constinit const auto vectors =
    hal::cortex_m::make_vectors<82>({{Board::kUsartInterrupt, &jink_usart1},
                                     {kCan1TransmitInterrupt, &jink_can1_transmit},
                                     {kCan1ReceiveInterrupt, &jink_can1_receive},
                                     {kCan1StatusInterrupt, &jink_can1_status}},
                                    &hal::cortex_m::jink_guard_handler);

}  // namespace

extern "C" void hal::cortex_m::jink_on_fault(const FaultRecord& /*record*/) { firmware::stm32::say_words<Board>(); }

extern "C" void hal::cortex_m::jink_main() { firmware::stm32::run_board<Board>(); }
