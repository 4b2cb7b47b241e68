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
/// which it answered the jinkd of the recording. A replayed endpoint asks for other items at other times, so its
/// requests are answered from here.
///
/// MISSION_CURRENT of PX4 announces the mission's id and length; then both are as announced, and items are those that
/// were recorded behind a MISSION_COUNT with this id. Otherwise a request at time t is answered with the newest
/// recorded answer up to t that is as long as announced, else with the first one after t. An item that the recording
/// does not hold is answered as MAV_CMD 0, which is no command: the endpoint then knows the mission's length but not
/// this item. Memory: 64 bytes per recorded answer.
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
    /// Of a mission as an answer belongs to it; 0: not said.
    struct Item {
        link::mavlink::MissionItemInt message;
        std::uint32_t mission = 0;
    };
    std::vector<Answer<link::mavlink::MissionCurrent>> announcements_;  ///< changes alone
    std::vector<Answer<link::mavlink::MissionCount>> counts_;
    std::vector<Answer<Item>> items_;
};

}  // namespace jink::sim
