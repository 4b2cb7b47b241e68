// SPDX-License-Identifier: BSD-3-Clause
#include "toolchain/sim/mission_server.hpp"

#include "firmware/link/mavlink/text.hpp"

namespace jink::sim {

using namespace link::mavlink;

namespace {

constexpr std::uint8_t kMissionError = 1;      // MAV_MISSION_ERROR
constexpr std::uint8_t kInvalidSequence = 13;  // MAV_MISSION_INVALID_SEQUENCE
constexpr std::uint8_t kCritical = 2;          // MAV_SEVERITY_CRITICAL
constexpr Micros kTransferTime = 5 * kSecond;  // MAVLINK_MISSION_PROTOCOL_TIMEOUT_DEFAULT

}  // namespace

bool MissionServer::is_for(const Frame& frame) noexcept
{
    return frame.message_id == MissionRequestList::kInfo.id || frame.message_id == MissionRequestInt::kInfo.id ||
           frame.message_id == MissionAck::kInfo.id;
}

void MissionServer::complain(const char* text)
{
    Statustext message;
    message.severity = kCritical;
    static_cast<void>(set_text(message.text, text));
    writer_.write(message);
    critical_.emplace_back(text);
}

void MissionServer::restart()
{
    sends_ = false;
    partner_system_ = partner_component_ = 0;
    next_ = count_ = 0;
}

bool MissionServer::is_partner(Header from) const noexcept
{
    return from.system_id == partner_system_ && from.component_id == partner_component_;
}

void MissionServer::refuse(Header to, std::uint8_t result)
{
    writer_.write(MissionAck{to.system_id, to.component_id, result, 0, 0});
}

void MissionServer::send(MissionItemInt item, Header to)
{
    item.target_system = to.system_id;
    item.target_component = to.component_id;
    writer_.write(item);
}

void MissionServer::begin(Header from, std::uint16_t count, std::uint32_t id, Micros now)
{
    if (stack_ == Stack::px4) {
        sends_ = sends_ && next_ != count_;
        if (sends_ && !is_partner(from)) {
            return;  // "Mission download request ignored, already active", a text of severity INFO
        }
        sends_ = true;
        partner_system_ = from.system_id;
        partner_component_ = from.component_id;
        next_ = 0;
        count_ = count;
        received_ = now;
    }
    MissionCount message;
    message.count = count;
    message.target_system = from.system_id;
    message.target_component = from.component_id;
    message.opaque_id = id;
    writer_.write(message);
}

void MissionServer::answer(const MissionRequestInt& request, Header from, const std::vector<MissionItemInt>& items,
                           Micros now)
{
    if (stack_ == Stack::ardupilot) {
        if (request.seq >= items.size()) {
            refuse(from, kInvalidSequence);
        } else {
            send(items[request.seq], from);
        }
        return;
    }
    if (!is_partner(from)) {
        complain("WPM: REJ. CMD: partner id mismatch");
        return;
    }
    if (!sends_) {
        return;
    }
    received_ = now;
    const bool next = request.seq == next_ && next_ < count_;
    const bool again = request.seq + 1 == next_;
    if ((!next && !again) || request.seq >= items.size()) {
        sends_ = false;
        refuse(from, kMissionError);
        complain("WPM: REJ. CMD: Req. WP was unexpected");
        return;
    }
    next_ = static_cast<std::uint16_t>(next_ + (next ? 1 : 0));
    send(items[request.seq], from);
}

void MissionServer::end(Header from)
{
    if (stack_ == Stack::ardupilot) {
        return;
    }
    if (is_partner(from)) {
        sends_ = false;
    } else {
        complain("REJ. WP CMD: partner id mismatch");
    }
}

void MissionServer::receive(const Frame& frame, const std::vector<MissionItemInt>& items, std::uint32_t id, Micros now)
{
    MissionRequestList list;
    MissionRequestInt request;
    MissionAck ack;
    if (decode(frame, list)) {
        begin(frame.header, static_cast<std::uint16_t>(items.size()), id, now);
    } else if (decode(frame, request)) {
        answer(request, frame.header, items, now);
    } else if (decode(frame, ack)) {
        end(frame.header);
    }
}

void MissionServer::step(Micros now)
{
    if (sends_ && now - received_ > kTransferTime) {
        sends_ = false;
        complain("Operation timeout");
    }
}

}  // namespace jink::sim
