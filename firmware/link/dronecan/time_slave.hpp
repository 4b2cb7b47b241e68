// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>

#include "core/base/time.hpp"

namespace jink::link::dronecan {

struct TimeSlaveDiagnostics {
    std::uint32_t updates = 0;        ///< of the offset
    std::uint32_t not_a_pair = 0;     ///< no earlier message, a gap in the transfer ids, or no time given
    std::uint32_t other_masters = 0;  ///< messages of a master with a higher node id than the followed one
    std::uint32_t master_changes = 0;
    std::uint32_t jumps = 0;  ///< of the common clock by more than kJump
};

/// Follows the bus's common clock (uavcan.protocol.GlobalTimeSync).
///
/// Each message of the master gives the time at which its previous message began. That time and the arrival of the
/// previous message here give the offset. The accuracy is that of the arrival stamps: a step of the application, unless
/// the port stamps frames. Of several masters the one with the lowest node id is followed; a master that is silent for
/// kMasterTimeout is dropped. The wrap of 56 bits of microseconds after 2284 years is not handled. O(1).
class TimeSlave {
public:
    static constexpr Seconds kMasterTimeout = 2.2F;  ///< twice the longest period of a master's messages
    static constexpr std::int64_t kJump = 200'000;   ///< [us]

    /// Processes a message of `master` whose first frame arrived at `arrived`; `previous`: the time it gives [us].
    void receive(std::uint8_t master, std::uint8_t transfer, std::uint64_t previous, TimePoint arrived) noexcept;

    /// Local time of a stamp of the common clock; nothing without a master.
    [[nodiscard]] std::optional<TimePoint> to_local(std::uint64_t stamp, TimePoint now) const noexcept;
    /// Node id of the master; 0: none.
    [[nodiscard]] std::uint8_t master(TimePoint now) const noexcept;
    [[nodiscard]] const TimeSlaveDiagnostics& diagnostics() const noexcept { return diagnostics_; }

private:
    std::uint8_t master_ = 0;
    std::uint8_t transfer_ = 0;
    TimePoint arrived_;
    bool has_offset_ = false;
    std::int64_t offset_ = 0;  ///< ours less the master's [us]
    TimeSlaveDiagnostics diagnostics_;
};

}  // namespace jink::link::dronecan
