// SPDX-License-Identifier: BSD-3-Clause
#include "toolchain/sim/recorded_mission.hpp"

#include "firmware/link/mavlink/codec.hpp"

namespace jink::sim {
namespace {

constexpr std::uint8_t kFlightController = 1;
constexpr std::uint8_t kMissionType = 0;  ///< MAV_MISSION_TYPE_MISSION; others are fences and rally points
constexpr std::uint8_t kMissionFrame = 2;  ///< MAV_FRAME_MISSION: an item without a place

/// Newest answer up to `now` that `fits`, else the first one after it.
template <class Answer, class Fits>
const Answer* nearest(const std::vector<Answer>& answers, Micros now, Fits fits)
{
    const Answer* found = nullptr;
    for (const Answer& answer : answers) {
        if (fits(answer.message) && (found == nullptr || answer.time <= now)) {
            found = &answer;
        }
    }
    return found;
}

}  // namespace

RecordedMission::RecordedMission(std::span<const WireRecord> records)
{
    link::mavlink::Parser parser;
    for (const WireRecord& record : records) {
        if (record.direction != WireDirection::from_autopilot) {
            continue;
        }
        std::span<const std::byte> bytes(record.bytes);
        while (const auto frame = parser.next(bytes)) {
            link::mavlink::MissionCount count;
            link::mavlink::MissionItemInt item;
            if (frame->header.component_id != kFlightController) {
                continue;
            }
            if (link::mavlink::decode(*frame, count) && count.mission_type == kMissionType) {
                counts_.push_back({to_micros(record.time), count});
            } else if (link::mavlink::decode(*frame, item) && item.mission_type == kMissionType) {
                items_.push_back({to_micros(record.time), item});
            }
        }
    }
}

std::optional<link::mavlink::MissionCount> RecordedMission::count(Micros now) const
{
    const auto* const answer = nearest(counts_, now, [](const auto&) { return true; });
    return answer != nullptr ? std::optional(answer->message) : std::nullopt;
}

std::optional<link::mavlink::MissionItemInt> RecordedMission::item(std::uint16_t sequence, Micros now) const
{
    const auto whole = count(now);
    if (!whole || sequence >= whole->count) {
        return std::nullopt;
    }
    if (const auto* const answer = nearest(items_, now, [&](const auto& item) { return item.seq == sequence; })) {
        return answer->message;
    }
    link::mavlink::MissionItemInt unknown;
    unknown.seq = sequence;
    unknown.frame = kMissionFrame;
    return unknown;
}

}  // namespace jink::sim
