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

/// The mission of a recorded autopilot, assembled from its MISSION_COUNT and MISSION_ITEM_INT answers to the recorded
/// jinkd. A replayed endpoint requests other items at other times; this class answers those requests.
///
/// If MISSION_CURRENT of PX4 announces the mission's id and length, both are as announced, and items are those recorded
/// behind a MISSION_COUNT with this id. Otherwise a request at time t is answered with the newest recorded answer up to
/// t that has the announced length, else with the first answer after t. A missing item is answered as MAV_CMD 0 (no
/// command): the endpoint then knows the mission's length but not this item. Memory: 64 bytes per recorded answer.
class RecordedMission {
public:
    explicit RecordedMission(std::span<const WireRecord> records);

    /// Nothing if the recording holds no item count.
    [[nodiscard]] std::optional<link::mavlink::MissionCount> count(Micros now) const;
    /// @return nothing for a sequence number outside of the mission
    [[nodiscard]] std::optional<link::mavlink::MissionItemInt> item(std::uint16_t sequence, Micros now) const;

private:
    template <class M>
    struct Answer {
        Micros time = 0;
        M message;
    };
    /// Mission id that an answer belongs to; 0: unknown.
    struct Item {
        link::mavlink::MissionItemInt message;
        std::uint32_t mission = 0;
    };
    std::vector<Answer<link::mavlink::MissionCurrent>> announcements_;  ///< changes alone
    std::vector<Answer<link::mavlink::MissionCount>> counts_;
    std::vector<Answer<Item>> items_;
};

}  // namespace jink::sim
