// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

namespace jink::hal {

enum class PortState : std::uint8_t {
    closed,  ///< not opened
    open,    ///< carries bytes
    lost,    ///< should be open but is absent, unplugged or refused
};

/// Counters of a port. They only grow; 64 bits do not wrap within the life of the hardware.
struct PortHealth {
    PortState state = PortState::closed;
    std::uint64_t bytes_in = 0;       ///< handed to the caller by read()
    std::uint64_t bytes_out = 0;      ///< accepted by write(), delivered or not
    std::uint64_t bytes_refused = 0;  ///< refused by write(); offered twice, counted twice
    std::uint64_t overruns = 0;       ///< losses of received bytes because a buffer was full, by the receiver's count
    std::uint64_t line_errors = 0;    ///< framing and parity errors, breaks
    std::uint64_t read_errors = 0;    ///< failed reads, except when no data was there
    std::uint64_t write_errors = 0;   ///< failed writes, except when the buffer was full
    std::uint64_t open_failures = 0;  ///< attempts to open that failed
    std::uint64_t disconnects = 0;    ///< changes from open to lost
    std::uint64_t reconnects = 0;     ///< changes from lost to open
};

}  // namespace jink::hal
