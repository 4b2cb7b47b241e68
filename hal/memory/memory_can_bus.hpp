// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "hal/can_port.hpp"
#include "hal/clock.hpp"

namespace jink::hal {

/// Capacities: controllers on one bus, and frames that each holds in either direction, 88 bytes each: 352 KiB in all.
inline constexpr std::size_t kMemoryCanPorts = 4;
inline constexpr std::size_t kMemoryCanFrames = 512;

/// Faults of a bus in memory.
struct CanFaults {
    std::uint32_t loss_per_million = 0;              ///< chance that one receiver misses a frame
    std::uint32_t duplicate_per_million = 0;         ///< chance that one receiver gets a frame twice
    bool unacknowledged = false;                     ///< no receiver acknowledges: frames wait, as on a cut cable
    std::size_t transmit_frames = kMemoryCanFrames;  ///< capacity of each port, 0 .. kMemoryCanFrames; Linux has 10
    std::size_t receive_frames = kMemoryCanFrames;
};

/// A classic CAN bus in memory, with faults on demand. Frames take time: each counts (80 + 10 bytes) bits, the worst
/// case of a 29-bit identifier with bit stuffing (Davis, Burns, Bril & Lukkien 2007, eq. 2). Of the frames at the heads
/// of the ports' queues the lowest identifier is sent first.
///
/// The same seed, faults and calls give the same frames. Allocation-free. Not thread-safe; neither copied nor moved.
class MemoryCanBus {
public:
    class Port final : public CanPort {
    public:
        [[nodiscard]] bool receive(CanFrame& frame) noexcept override;
        [[nodiscard]] bool send(const CanFrame& frame) noexcept override;
        [[nodiscard]] CanHealth health() const noexcept override { return health_; }

        /// Changes of the controller's state. Down, closed or bus off: waiting frames are lost, and no frame is
        /// received. Counted as in a driver.
        void become(CanState state) noexcept;
        /// Frames that wait to be sent.
        [[nodiscard]] std::size_t waiting() const noexcept { return to_send_.size; }

    private:
        friend class MemoryCanBus;
        struct Item {
            CanFrame frame;
            std::int64_t due_us = 0;  ///< when the frame was queued, or when it arrived
        };
        struct Queue {
            std::array<Item, kMemoryCanFrames> items{};
            std::size_t first = 0;
            std::size_t size = 0;
            [[nodiscard]] const Item& front() const noexcept { return items[first]; }
            void push(const Item& item) noexcept { items[(first + size++) % kMemoryCanFrames] = item; }
            void pop() noexcept
            {
                first = (first + 1) % kMemoryCanFrames;
                --size;
            }
        };
        [[nodiscard]] bool takes_part() const noexcept
        {
            return health_.state == CanState::active || health_.state == CanState::error_passive;
        }

        MemoryCanBus* bus_ = nullptr;
        Queue to_send_;
        Queue received_;
        CanHealth health_;
    };

    /// @param clock  outlives this bus
    MemoryCanBus(Clock& clock, std::uint64_t seed, std::uint32_t bit_rate = 1'000'000) noexcept;
    MemoryCanBus(const MemoryCanBus&) = delete;
    MemoryCanBus& operator=(const MemoryCanBus&) = delete;

    /// All ports start active.
    [[nodiscard]] Port& port(std::size_t i) noexcept { return ports_[i]; }
    void set_faults(const CanFaults& faults) noexcept { faults_ = faults; }

private:
    void run() noexcept;
    [[nodiscard]] Port* next(std::int64_t& begin) noexcept;
    void deliver(Port& from, std::int64_t at) noexcept;
    [[nodiscard]] bool chance(std::uint32_t per_million) noexcept;

    Clock& clock_;
    std::uint64_t random_state_;
    std::int64_t bit_rate_;
    std::int64_t free_us_ = 0;  ///< when the bus is idle again
    CanFaults faults_;
    std::array<Port, kMemoryCanPorts> ports_{};
};

}  // namespace jink::hal
