// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

namespace jink::hal {

enum class PortState : std::uint8_t {
    closed,  ///< nobody wants it open
    open,    ///< carries bytes
    lost,    ///< should be open and is not: absent, unplugged, refused
};

/// What has become of a port so far. Counters only grow; 64 bits do not wrap within the life of the hardware.
struct PortHealth {
    PortState state = PortState::closed;
    std::uint64_t bytes_in = 0;       ///< handed to the caller by read()
    std::uint64_t bytes_out = 0;      ///< taken by write(); whether they arrive is the line's business
    std::uint64_t bytes_refused = 0;  ///< offered to write() and not taken; offered twice, counted twice
    std::uint64_t overruns = 0;       ///< losses of received bytes for want of room, as the receiver counts them
    std::uint64_t line_errors = 0;    ///< framing and parity errors, breaks
    std::uint64_t read_errors = 0;    ///< reads that failed for another reason than "nothing there"
    std::uint64_t write_errors = 0;   ///< writes that failed for another reason than "no room"
    std::uint64_t open_failures = 0;  ///< attempts to open that failed
    std::uint64_t disconnects = 0;    ///< changes from open to lost
    std::uint64_t reconnects = 0;     ///< changes from lost to open
};

}  // namespace jink::hal
