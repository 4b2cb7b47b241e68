// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstring>

#include "hal/can_port.hpp"
#include "hal/register_block.hpp"
#include "hal/ring.hpp"

namespace jink::hal::stm32f4 {

/// CAN controller of the STM32F4 (bxCAN; ST RM0090, 32) behind the CAN port: classic frames, fed by interrupts.
///
/// Received frames come through FIFO 0, three deep. Its handler must run within the time of three frames (201 us at 1
/// Mbit/s, shortest frames), or the newest frame is lost and counted; a frame that finds the ring full is lost and
/// counted too. Frames are sent in the order of send(), as multi-frame transfers require (TXFP). The controller leaves
/// bus off by itself after 128 occurrences of eleven recessive bits (ABOM).
///
/// Memory: 32 frames in and 16 out, 16 bytes each: 0.9 KiB.
template <RegisterBlock Registers, InterruptWake Wake>
class BxCan final : public CanPort {
public:
    static constexpr std::size_t kReceiveFrames = 32;
    static constexpr std::size_t kTransmitFrames = 16;

    /// @param wake_transmit  raises the transmit interrupt
    BxCan(Registers registers, Wake wake_transmit) noexcept : registers_(registers), wake_transmit_(wake_transmit) {}

    /// Sets the bit rate and joins the bus, with all frames accepted. False, with the port left closed, if the clock
    /// does not give the rate exactly in 14 time quanta (sampled at 12, 86 %), or if the controller does not enter or
    /// leave its initialisation in time.
    [[nodiscard]] bool start(std::uint32_t peripheral_clock_hz, std::uint32_t bit_rate) noexcept
    {
        const std::uint32_t quantum_rate = bit_rate * kQuanta;
        if (bit_rate == 0 || bit_rate > 1'000'000U || peripheral_clock_hz % quantum_rate != 0) {
            return false;
        }
        const std::uint32_t prescaler = peripheral_clock_hz / quantum_rate;
        if (prescaler == 0 || prescaler > kLargestPrescaler) {
            return false;
        }
        registers_.write(kMaster, kInitialise);  // and leaves sleep mode after the reset
        if (!becomes(kMasterStatus, kInitialising | kSleeping, kInitialising)) {
            return false;
        }
        registers_.write(kMaster, kInitialise | kAutomaticBusOff | kInOrder);
        registers_.write(kBitTiming, (prescaler - 1U) | (kSegment1 - 1U) << 16U | (kSegment2 - 1U) << 20U);
        let_all_through();
        registers_.write(kInterrupts, kInterruptsOn);
        registers_.write(kMaster, kAutomaticBusOff | kInOrder);
        if (!becomes(kMasterStatus, kInitialising, 0)) {
            return false;  // the bus is stuck dominant: the controller waits for eleven consecutive recessive bits
        }
        look_.store(static_cast<std::uint32_t>(CanState::active), std::memory_order_relaxed);
        return true;
    }

    [[nodiscard]] bool receive(CanFrame& frame) noexcept override
    {
        Compact item;
        if (!received_.pop(item)) {
            return false;
        }
        frame = {};
        frame.extended = item.extended;
        frame.remote = item.remote;
        frame.id = item.id;
        frame.length = item.length;
        std::memcpy(frame.data.data(), item.data, item.length);
        ++health_.frames_in;
        return true;
    }

    [[nodiscard]] bool send(const CanFrame& frame) noexcept override
    {
        if (!is_valid(frame) || frame.fd) {
            ++health_.frames_bad;
            return false;
        }
        const CanState now = state();
        Compact item{frame.id, {}, frame.length, frame.extended, frame.remote};
        if (!frame.remote) {
            std::memcpy(item.data, frame.data.data(), frame.length);
        }
        if (now == CanState::closed || now == CanState::bus_off || !to_send_.push(item)) {
            ++health_.frames_refused;
            return false;
        }
        ++health_.frames_out;
        wake_transmit_();
        return true;
    }

    [[nodiscard]] CanHealth health() const noexcept override
    {
        CanHealth health = health_;
        health.state = state();
        health.overruns = overruns_.load(std::memory_order_relaxed);
        health.bus_errors = bus_errors_.load(std::memory_order_relaxed);
        health.bus_offs = bus_offs_.load(std::memory_order_relaxed);
        health.restarts = restarts_.load(std::memory_order_relaxed) + restarts_seen_;
        return health;
    }

    /// Called by FIFO 0's interrupt. O(frames received), 3 and those that arrive meanwhile; kReceiveFrames at most.
    void on_receive() noexcept
    {
        for (std::size_t i = 0; i < kReceiveFrames; ++i) {
            const std::uint32_t status = registers_.read(kFifo0);
            if ((status & kFifoOverrun) != 0) {
                count(overruns_);
                registers_.write(kFifo0, kFifoOverrun);
            }
            if ((status & kFifoPending) == 0) {
                return;
            }
            if (!received_.push(take_frame())) {
                count(overruns_);
            }
            registers_.write(kFifo0, kFifoRelease);
        }
    }

    /// Called by the transmit mailboxes' interrupt. O(mailboxes).
    void on_transmit() noexcept
    {
        registers_.write(kTransmitStatus, kRequestsCompleted);
        Compact item;
        for (std::uint32_t box = 0; box < kMailboxes; ++box) {
            if ((registers_.read(kTransmitStatus) & (kMailboxEmpty << box)) != 0 && to_send_.pop(item)) {
                put_frame(kMailbox + box * kMailboxSize, item);
            }
        }
    }

    /// Called by the status change interrupt: errors, bus off. O(1).
    void on_status() noexcept
    {
        const std::uint32_t errors = registers_.read(kErrors);
        const std::uint32_t last = errors & kLastError;
        if (last != 0 && last != kErrorSetBySoftware) {
            count(bus_errors_);
            registers_.write(kErrors, kErrorSetBySoftware);
        }
        const CanState before = state();
        const CanState now = (errors & kBusOff) != 0         ? CanState::bus_off
                             : (errors & kErrorPassive) != 0 ? CanState::error_passive
                                                             : CanState::active;
        if (now == CanState::bus_off && before != CanState::bus_off) {
            count(bus_offs_);
        }
        if (now != CanState::bus_off && before == CanState::bus_off) {
            count(restarts_);
        }
        look_.store((look_.load(std::memory_order_relaxed) & ~kStateBits) + kStateBits + 1U +
                        static_cast<std::uint32_t>(now),
                    std::memory_order_relaxed);
        registers_.write(kMasterStatus, kErrorInterrupt);
    }

    /// Polls for state changes that raise no interrupt: the returns from bus off and from error passive. Call once per
    /// tick. O(1).
    ///
    /// The status interrupt may come between the poll and its conclusion. In that case the interrupt's state is kept: a
    /// controller that has just left the bus is never reported as active.
    void service() noexcept
    {
        std::uint32_t look = look_.load(std::memory_order_relaxed);
        const CanState before = state_of(look);
        const std::uint32_t errors = registers_.read(kErrors);
        const bool back = before == CanState::bus_off && (errors & kBusOff) == 0;
        const bool better = before == CanState::error_passive && (errors & (kBusOff | kErrorPassive)) == 0;
        const std::uint32_t active = (look & ~kStateBits) | static_cast<std::uint32_t>(CanState::active);
        if ((!back && !better) || !look_.compare_exchange_strong(look, active, std::memory_order_relaxed)) {
            return;  // no change, or the interrupt has set a newer state
        }
        if (back) {
            restarts_seen_ += 1U;
        }
    }

private:
    struct Compact {
        std::uint32_t id = 0;
        std::uint8_t data[8] = {};
        std::uint8_t length = 0;
        bool extended = false;
        bool remote = false;
    };

    static constexpr std::uint32_t kMaster = 0x000;  // MCR
    static constexpr std::uint32_t kMasterStatus = 0x004;
    static constexpr std::uint32_t kTransmitStatus = 0x008;
    static constexpr std::uint32_t kFifo0 = 0x00C;
    static constexpr std::uint32_t kInterrupts = 0x014;
    static constexpr std::uint32_t kErrors = 0x018;
    static constexpr std::uint32_t kBitTiming = 0x01C;
    static constexpr std::uint32_t kMailbox = 0x180;
    static constexpr std::uint32_t kMailboxSize = 0x10;
    static constexpr std::uint32_t kFifo0Frame = 0x1B0;
    static constexpr std::uint32_t kFilterMaster = 0x200;
    static constexpr std::uint32_t kFilterMode = 0x204;
    static constexpr std::uint32_t kFilterScale = 0x20C;
    static constexpr std::uint32_t kFilterFifo = 0x214;
    static constexpr std::uint32_t kFilterActive = 0x21C;
    static constexpr std::uint32_t kFilterBank0 = 0x240;

    static constexpr std::uint32_t kInitialise = 1U << 0U;  // of kMaster
    static constexpr std::uint32_t kInOrder = 1U << 2U;
    static constexpr std::uint32_t kAutomaticBusOff = 1U << 6U;
    static constexpr std::uint32_t kInitialising = 1U << 0U;  // of kMasterStatus
    static constexpr std::uint32_t kSleeping = 1U << 1U;
    static constexpr std::uint32_t kErrorInterrupt = 1U << 2U;
    static constexpr std::uint32_t kRequestsCompleted = 0x00010101;  // of kTransmitStatus
    static constexpr std::uint32_t kMailboxEmpty = 1U << 26U;
    static constexpr std::uint32_t kFifoPending = 3U;  // of kFifo0
    static constexpr std::uint32_t kFifoOverrun = 1U << 4U;
    static constexpr std::uint32_t kFifoRelease = 1U << 5U;
    /// Mailbox empty, FIFO 0 pending and overrun, passive, bus off, error code.
    static constexpr std::uint32_t kInterruptsOn =
        1U << 0U | 1U << 1U | 1U << 3U | 1U << 9U | 1U << 10U | 1U << 11U | 1U << 15U;
    static constexpr std::uint32_t kErrorPassive = 1U << 1U;  // of kErrors
    static constexpr std::uint32_t kBusOff = 1U << 2U;
    static constexpr std::uint32_t kLastError = 7U << 4U;
    /// Written to the register so that the next error of the same kind is detected; the hardware never sets this code.
    static constexpr std::uint32_t kErrorSetBySoftware = 7U << 4U;
    static constexpr std::uint32_t kRequest = 1U << 0U;  // of a mailbox's identifier
    static constexpr std::uint32_t kRemote = 1U << 1U;
    static constexpr std::uint32_t kExtended = 1U << 2U;

    static constexpr std::uint32_t kQuanta = 14;  // 1 to synchronise
    static constexpr std::uint32_t kSegment1 = 11;
    static constexpr std::uint32_t kSegment2 = 2;
    static constexpr std::uint32_t kLargestPrescaler = 1024;
    static constexpr std::uint32_t kMailboxes = 3;
    /// Polls: eleven recessive bits at 125 kbit/s take 88 us.
    static constexpr std::uint32_t kPatience = 100'000;

    static constexpr std::uint32_t kStateBits = 0xFF;
    [[nodiscard]] static CanState state_of(std::uint32_t look) noexcept
    {
        return static_cast<CanState>(look & kStateBits);
    }
    [[nodiscard]] CanState state() const noexcept { return state_of(look_.load(std::memory_order_relaxed)); }

    static void count(std::atomic<std::uint32_t>& counter) noexcept
    {
        counter.store(counter.load(std::memory_order_relaxed) + 1U, std::memory_order_relaxed);
    }

    [[nodiscard]] bool becomes(std::uint32_t offset, std::uint32_t mask, std::uint32_t value) noexcept
    {
        for (std::uint32_t i = 0; i < kPatience; ++i) {
            if ((registers_.read(offset) & mask) == value) {
                return true;
            }
        }
        return false;
    }

    /// Bank 0: one 32-bit mask that accepts every frame, into FIFO 0.
    void let_all_through() noexcept
    {
        constexpr std::uint32_t kBank0 = 1;
        registers_.write(kFilterMaster, registers_.read(kFilterMaster) | 1U);
        registers_.write(kFilterActive, registers_.read(kFilterActive) & ~kBank0);
        registers_.write(kFilterMode, registers_.read(kFilterMode) & ~kBank0);
        registers_.write(kFilterScale, registers_.read(kFilterScale) | kBank0);
        registers_.write(kFilterFifo, registers_.read(kFilterFifo) & ~kBank0);
        registers_.write(kFilterBank0, 0);
        registers_.write(kFilterBank0 + 4U, 0);
        registers_.write(kFilterActive, registers_.read(kFilterActive) | kBank0);
        registers_.write(kFilterMaster, registers_.read(kFilterMaster) & ~1U);
    }

    [[nodiscard]] Compact take_frame() noexcept
    {
        const std::uint32_t identifier = registers_.read(kFifo0Frame);
        const std::uint32_t length = registers_.read(kFifo0Frame + 4U) & 0xFU;
        Compact item;
        item.extended = (identifier & kExtended) != 0;
        item.remote = (identifier & kRemote) != 0;
        item.id = item.extended ? identifier >> 3U : identifier >> 21U;
        item.length = static_cast<std::uint8_t>(length > 8U ? 8U : length);  // 9..15 mean 8 on a classic bus
        const std::uint32_t words[2] = {registers_.read(kFifo0Frame + 8U), registers_.read(kFifo0Frame + 12U)};
        for (std::size_t i = 0; i < 8; ++i) {
            item.data[i] = static_cast<std::uint8_t>(words[i / 4] >> (8U * (i % 4)));
        }
        return item;
    }

    void put_frame(std::uint32_t box, const Compact& item) noexcept
    {
        std::uint32_t words[2] = {0, 0};
        for (std::size_t i = 0; i < 8; ++i) {
            words[i / 4] |= static_cast<std::uint32_t>(item.data[i]) << (8U * (i % 4));
        }
        registers_.write(box + 4U, item.length);
        registers_.write(box + 8U, words[0]);
        registers_.write(box + 12U, words[1]);
        const std::uint32_t identifier = item.extended ? item.id << 3U | kExtended : item.id << 21U;
        registers_.write(box, identifier | (item.remote ? kRemote : 0U) | kRequest);
    }

    Registers registers_;
    Wake wake_transmit_;
    Ring<Compact, kReceiveFrames> received_;
    Ring<Compact, kTransmitFrames> to_send_;
    CanHealth health_;  ///< the main program's part
    /// The state, and above kStateBits the number of status interrupts: a conclusion of service() is valid only if no
    /// interrupt came.
    std::atomic<std::uint32_t> look_{static_cast<std::uint32_t>(CanState::closed)};
    std::atomic<std::uint32_t> overruns_{0};
    std::atomic<std::uint32_t> bus_errors_{0};
    std::atomic<std::uint32_t> bus_offs_{0};
    std::atomic<std::uint32_t> restarts_{0};  ///< counted by the interrupt
    std::uint32_t restarts_seen_ = 0;         ///< and by service()
};

}  // namespace jink::hal::stm32f4
