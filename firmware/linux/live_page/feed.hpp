// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <span>

#include "firmware/linux/flight_log/output.hpp"
#include "firmware/linux/flight_log/queue.hpp"

namespace jink::livepage {

/// The control loop's side of the live page: copies the messages of the flight log, but for records, into a queue.
/// Never waits; what does not fit is dropped and counted. Memory: the queue.
class Feed final : public flightlog::Output {
public:
    /// @param queue_bytes  a power of two
    explicit Feed(std::size_t queue_bytes) : queue_(queue_bytes) {}

    /// The control loop's. The messages behind the records are kept or dropped together. O(bytes).
    bool add(std::span<const std::byte> messages, std::uint32_t count, flightlog::Records records) noexcept override
    {
        return queue_.add(messages.subspan(records.bytes), 0, count - records.count);
    }
    void lose() noexcept override {}
    [[nodiscard]] flightlog::LogCounts counts() const noexcept override
    {
        return {queue_.messages(), queue_.dropped(), 0, 0, queue_.peak()};
    }

    /// The page's. Whole messages where `into` is as large as the queue. @return bytes taken
    [[nodiscard]] std::size_t take(std::span<std::byte> into) noexcept { return queue_.take(into); }
    /// Messages dropped. For either side.
    [[nodiscard]] std::uint32_t dropped() const noexcept { return queue_.dropped(); }

private:
    flightlog::Queue queue_;
};

}  // namespace jink::livepage
