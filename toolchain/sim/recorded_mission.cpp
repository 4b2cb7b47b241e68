// SPDX-License-Identifier: BSD-3-Clause
#include "toolchain/sim/recorded_mission.hpp"

#include "firmware/link/mavlink/codec.hpp"

namespace jink::sim {
namespace {

constexpr std::uint8_t kFlightController = 1;
constexpr std::uint8_t kMissionType = 0;   ///< MAV_MISSION_TYPE_MISSION; others are fences and rally points
constexpr std::uint16_t kNoTotal = 65535;  ///< MISSION_CURRENT.total without a mission; 0: unknown
constexpr std::uint8_t kMissionFrame = 2;  ///< MAV_FRAME_MISSION: an item without a place

/// Newest answer up to `now` that `fits`, else the first such answer after `now`.
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
    std::uint32_t mission = 0;
    for (const WireRecord& record : records) {
        if (record.direction != WireDirection::from_autopilot) {
            continue;
        }
        std::span<const std::byte> bytes(record.bytes);
        while (const auto frame = parser.next(bytes)) {
            link::mavlink::MissionCount count;
            link::mavlink::MissionItemInt item;
            link::mavlink::MissionCurrent current;
            if (frame->header.component_id != kFlightController) {
                continue;
            }
            if (link::mavlink::decode(*frame, count) && count.mission_type == kMissionType) {
                counts_.push_back({to_micros(record.time), count});
                mission = count.opaque_id;
            } else if (link::mavlink::decode(*frame, item) && item.mission_type == kMissionType) {
                items_.push_back({to_micros(record.time), {item, mission}});
            } else if (link::mavlink::decode(*frame, current)) {
                const bool same = !announcements_.empty() && announcements_.back().message.total == current.total &&
                                  announcements_.back().message.mission_id == current.mission_id;
                if (!same) {
                    announcements_.push_back({to_micros(record.time), current});
                }
            }
        }
    }
}

std::optional<link::mavlink::MissionCount> RecordedMission::count(Micros now) const
{
    const auto* const announced = nearest(announcements_, now, [](const auto&) { return true; });
    const std::uint16_t total = announced != nullptr ? announced->message.total : std::uint16_t{0};
    const bool says_total = total != 0 && total != kNoTotal;
    if (says_total && announced->message.mission_id != 0) {
        link::mavlink::MissionCount count;
        count.count = total;
        count.opaque_id = announced->message.mission_id;
        return count;
    }
    const auto fits = [&](const link::mavlink::MissionCount& count) { return !says_total || count.count == total; };
    const auto* answer = nearest(counts_, now, fits);
    answer = answer != nullptr ? answer : nearest(counts_, now, [](const auto&) { return true; });
    return answer != nullptr ? std::optional(answer->message) : std::nullopt;
}

std::optional<link::mavlink::MissionItemInt> RecordedMission::item(std::uint16_t sequence, Micros now) const
{
    const auto whole = count(now);
    if (!whole || sequence >= whole->count) {
        return std::nullopt;
    }
    if (const auto* const answer = nearest(items_, now, [&](const Item& item) {
            return item.message.seq == sequence && item.mission == whole->opaque_id;
        })) {
        return answer->message.message;
    }
    link::mavlink::MissionItemInt unknown;
    unknown.seq = sequence;
    unknown.frame = kMissionFrame;
    return unknown;
}

}  // namespace jink::sim
