// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "firmware/link/mavlink/messages.hpp"
#include "firmware/link/mavlink/parser.hpp"
#include "toolchain/sim/scenario.hpp"
#include "toolchain/sim/wire_file.hpp"

namespace jink::sim {

/// The mission that a recorded autopilot flew, put together from the MISSION_COUNT and MISSION_ITEM_INT messages with
/// which it answered the jinkd of the recording. A replayed endpoint asks for other items at other times, so its requests
/// are answered from here.
///
/// A request at time t is answered with the newest recorded answer up to t, else with the first one after t. An item that
/// the recording does not hold is answered as MAV_CMD 0, which is no command: the endpoint then knows the mission's length
/// but not this item. Memory: 60 bytes per recorded answer.
class RecordedMission {
public:
    explicit RecordedMission(std::span<const WireRecord> records);

    /// Nothing while the recording says nowhere how many items there are.
    [[nodiscard]] std::optional<link::mavlink::MissionCount> count(Micros now) const;
    /// @return nothing for a sequence number outside of the mission
    [[nodiscard]] std::optional<link::mavlink::MissionItemInt> item(std::uint16_t sequence, Micros now) const;

private:
    template <class M>
    struct Answer {
        Micros time = 0;
        M message;
    };
    std::vector<Answer<link::mavlink::MissionCount>> counts_;
    std::vector<Answer<link::mavlink::MissionItemInt>> items_;
};

}  // namespace jink::sim
