// SPDX-License-Identifier: BSD-3-Clause
#include "toolchain/sim/radio.hpp"

namespace jink::sim {

void Radio::send(std::size_t from, std::span<const std::byte> message, Micros now)
{
    for (std::size_t i = 0; i < waiting_.size(); ++i) {
        if (i == from) {
            continue;
        }
        const bool lost = static_cast<double>(random_.uniform()) < loss_;
        if (!lost) {
            waiting_[i].push_back({now + delay_, {message.begin(), message.end()}});
        }
    }
}

std::vector<std::byte> Radio::take(std::size_t at, Micros now)
{
    std::vector<std::byte> arrived;
    std::deque<Message>& queue = waiting_[at];
    while (!queue.empty() && queue.front().arrives <= now) {
        arrived.insert(arrived.end(), queue.front().bytes.begin(), queue.front().bytes.end());
        queue.pop_front();
    }
    return arrived;
}

}  // namespace jink::sim
