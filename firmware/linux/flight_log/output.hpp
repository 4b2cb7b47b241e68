// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace jink::flightlog {

/// Counters of losses and failures of a log.
struct LogCounts {
    std::uint32_t messages = 0;        ///< accepted
    std::uint32_t dropped = 0;         ///< whole messages that found the queue full, or were too large
    std::uint32_t write_failures = 0;  ///< of files: not created, not written, not synchronised
    std::uint32_t files = 0;           ///< begun
    std::uint32_t peak = 0;            ///< greatest number of bytes in the queue
};

/// The record of the step at the head of messages: its parts.
struct Records {
    std::size_t bytes = 0;
    std::uint32_t count = 0;
};

/// Takes whole messages of the data section, one after the other. Never waits.
class Output {
public:
    /// @param messages  whole ones, `count` of them
    /// @param records   those at the head of them that are no use to whoever shows the flight
    /// @return false: all dropped, and counted; of several outputs by one at least
    virtual bool add(std::span<const std::byte> messages, std::uint32_t count, Records records) noexcept = 0;
    /// A message that could not be composed.
    virtual void lose() noexcept = 0;
    [[nodiscard]] virtual LogCounts counts() const noexcept = 0;

protected:
    ~Output() = default;
};

}  // namespace jink::flightlog
