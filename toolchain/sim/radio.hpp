// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <deque>
#include <span>
#include <vector>

#include "core/base/random.hpp"
#include "toolchain/sim/vec.hpp"

namespace jink::sim {

/// Broadcast radio. Losses are independent per message and receiver; the delay is the same for all. The same seed and
/// calls give the same losses.
class Radio {
public:
    /// @param loss  share of messages lost at a receiver, [0, 1]
    /// @param delay  from sending to arrival [us], >= 0
    Radio(std::size_t stations, double loss, Micros delay, std::uint64_t seed)
        : loss_(loss), delay_(delay), random_(seed), waiting_(stations)
    {
    }

    /// O(stations + bytes).
    void send(std::size_t from, std::span<const std::byte> message, Micros now);
    /// Messages that have arrived at a station, in the order of sending.
    [[nodiscard]] std::vector<std::byte> take(std::size_t at, Micros now);

private:
    struct Message {
        Micros arrives = 0;
        std::vector<std::byte> bytes;
    };

    double loss_;
    Micros delay_;
    Random random_;
    std::vector<std::deque<Message>> waiting_;
};

}  // namespace jink::sim
