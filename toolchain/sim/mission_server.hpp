// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "firmware/link/mavlink/messages.hpp"
#include "firmware/link/mavlink/parser.hpp"
#include "toolchain/sim/frame_writer.hpp"
#include "toolchain/sim/scenario.hpp"

namespace jink::sim {

/// Mission download server of each stack.
///
/// ArduPilot answers each request with its item, in any order. PX4 (MavlinkMissionManager) serves a transfer:
/// MISSION_REQUEST_LIST opens it, items follow in order from 0, a repeated request repeats the last item, MISSION_ACK
/// ends it. The following end the transfer with a CRITICAL text to the pilot: every other request, a pause of 5 s, and
/// a request or MISSION_ACK of a system that is not the transfer's partner.
class MissionServer {
public:
    /// @param writer  outlives the server
    MissionServer(Stack stack, FrameWriter& writer) : stack_(stack), writer_(writer) {}

    [[nodiscard]] static bool is_for(const link::mavlink::Frame& frame) noexcept;
    /// A frame of the mission protocol.
    void receive(const link::mavlink::Frame& frame, const std::vector<link::mavlink::MissionItemInt>& items,
                 std::uint32_t id, Micros now);
    /// Ends a transfer that pauses too long.
    void step(Micros now);
    /// After a restart the server has no partner.
    void restart();

    /// Sends and keeps a text of severity CRITICAL to the pilot.
    void complain(const char* text);
    /// Those that the co-processor caused.
    [[nodiscard]] const std::vector<std::string>& critical() const noexcept { return critical_; }

private:
    void begin(link::mavlink::Header from, std::uint16_t count, std::uint32_t id, Micros now);
    void answer(const link::mavlink::MissionRequestInt& request, link::mavlink::Header from,
                const std::vector<link::mavlink::MissionItemInt>& items, Micros now);
    void end(link::mavlink::Header from);
    void refuse(link::mavlink::Header to, std::uint8_t result);
    void send(link::mavlink::MissionItemInt item, link::mavlink::Header to);
    [[nodiscard]] bool is_partner(link::mavlink::Header from) const noexcept;

    Stack stack_;
    FrameWriter& writer_;
    bool sends_ = false;  ///< PX4: a transfer is open
    std::uint8_t partner_system_ = 0;
    std::uint8_t partner_component_ = 0;
    std::uint16_t next_ = 0;
    std::uint16_t count_ = 0;
    Micros received_ = 0;
    std::vector<std::string> critical_;
};

}  // namespace jink::sim
