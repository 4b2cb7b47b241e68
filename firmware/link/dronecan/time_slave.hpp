// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>

#include "core/base/time.hpp"

namespace jink::link::dronecan {

struct TimeSlaveDiagnostics {
    std::uint32_t updates = 0;        ///< of the offset
    std::uint32_t not_a_pair = 0;     ///< no earlier message, a gap in the transfer ids, or told nothing
    std::uint32_t other_masters = 0;  ///< messages of a master that is outranked
    std::uint32_t master_changes = 0;
    std::uint32_t jumps = 0;  ///< of the common clock by more than kJump
};

/// Follows the bus's common clock (uavcan.protocol.GlobalTimeSync).
///
/// Each message of the master tells at what time its former message began; together with when that one arrived here
/// it makes the offset. As exact as the stamps of arrival: a step of the application, unless the port stamps frames.
/// Of several masters that with the lowest node id is followed; one that is silent for kMasterTimeout has gone.
/// 56 bits of microseconds wrap after 2284 years: not followed. O(1).
class TimeSlave {
public:
    static constexpr Seconds kMasterTimeout = 2.2F;  ///< twice the longest period at which a master speaks
    static constexpr std::int64_t kJump = 200'000;   ///< [us]

    /// A message of `master` whose first frame arrived at `arrived`; `previous`: what it says [us].
    void receive(std::uint8_t master, std::uint8_t transfer, std::uint64_t previous, TimePoint arrived) noexcept;

    /// Our time of a stamp of the common clock; nothing without a master.
    [[nodiscard]] std::optional<TimePoint> to_local(std::uint64_t stamp, TimePoint now) const noexcept;
    /// 0: none.
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
