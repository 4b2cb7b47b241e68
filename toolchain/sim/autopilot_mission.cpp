// SPDX-License-Identifier: BSD-3-Clause
// The autopilot's mission download and progress reports.
#include "firmware/link/mavlink/text.hpp"
#include "toolchain/sim/autopilot.hpp"
#include "toolchain/sim/geodesy.hpp"

namespace jink::sim {

using namespace link::mavlink;

namespace {

// MAV_FRAME
constexpr std::uint8_t kFrameGlobal = 0;
constexpr std::uint8_t kFrameMission = 2;
constexpr std::uint8_t kFrameRelative = 3;
constexpr std::uint8_t kFrameRelativeInt = 6;
/// MISSION_CURRENT: state active, mode in the mission or suspended.
constexpr std::uint8_t kMissionActive = 3;
constexpr std::uint8_t kMissionPaused = 4;
constexpr std::uint8_t kInMission = 1;
constexpr std::uint8_t kMissionSuspended = 2;
// DO_CHANGE_SPEED: SPEED_TYPE. ArduPlane uses a ground speed only as the minimum ground speed.
constexpr float kAirspeed = 0.0F;
constexpr float kGroundSpeed = 1.0F;
constexpr float kNoChange = -1.0F;

std::uint16_t command_of(ItemKind kind) noexcept
{
    switch (kind) {
    case ItemKind::waypoint: return 16;
    case ItemKind::circle: return 17;
    case ItemKind::turns: return 18;
    case ItemKind::wait: return 19;
    case ItemKind::home: return 20;
    case ItemKind::land: return 21;
    case ItemKind::take_off: return 22;
    case ItemKind::spline: return 82;
    case ItemKind::jump: return 177;
    case ItemKind::speed: break;
    }
    return 178;
}

}  // namespace

std::uint16_t Autopilot::home_items() const noexcept
{
    // ArduPilot's item 0 is home, its mission starts with item 1.
    return scenario_.stack == Stack::ardupilot ? 1 : 0;
}

std::uint16_t Autopilot::sequence() const noexcept
{
    return static_cast<std::uint16_t>((items_ ? items_->index() : mission_.target()) + home_items());
}

/// PX4's checksum of the mission; ArduPilot reports none.
std::uint32_t Autopilot::mission_id() const noexcept
{
    return scenario_.stack == Stack::px4 ? kMissionId + (uploaded_ ? 1U : 0U) : 0U;
}

MissionItemInt Autopilot::item_at(const Item& item, std::size_t index) const
{
    MissionItemInt message;
    message.seq = static_cast<std::uint16_t>(index);
    message.command = command_of(item.kind);
    message.frame = scenario_.stack == Stack::ardupilot ? kFrameRelative : kFrameRelativeInt;
    message.autocontinue = 1;
    message.current = index == sequence() ? 1 : 0;
    const auto value = static_cast<float>(item.value);
    switch (item.kind) {
    case ItemKind::jump:
        message.frame = kFrameMission;
        message.param1 = value + static_cast<float>(home_items());
        message.param2 = static_cast<float>(item.count);
        return message;
    case ItemKind::speed:
        message.frame = kFrameMission;
        message.param1 = is_plane() ? kAirspeed : kGroundSpeed;
        message.param2 = value;
        message.param3 = kNoChange;
        return message;
    case ItemKind::home: message.frame = kFrameMission; return message;
    case ItemKind::turns:
        message.param1 = static_cast<float>(item.count);
        message.param3 = value;
        break;
    case ItemKind::wait: message.param1 = value; break;
    default: break;
    }
    // ArduPilot's TAKEOFF has no place, its LAND may have none.
    const bool placed = item.kind != ItemKind::take_off || scenario_.stack == Stack::px4;
    const GlobalPosition global = to_global(item.place, scenario_.stack);
    message.x = placed ? global.lat : 0;
    message.y = placed ? global.lon : 0;
    message.z = item.kind == ItemKind::land ? 0.0F : static_cast<float>(item.place.z() - scenario_.home.z());
    return message;
}

std::vector<MissionItemInt> Autopilot::mission_items() const
{
    std::vector<MissionItemInt> items;
    if (home_items() > 0) {
        const GlobalPosition home = to_global(scenario_.home, scenario_.stack);
        MissionItemInt item;
        item.command = command_of(ItemKind::waypoint);
        item.frame = kFrameGlobal;
        item.x = home.lat;
        item.y = home.lon;
        item.z = static_cast<float>(kHomeAltitude + scenario_.home.z());
        item.autocontinue = 1;
        items.push_back(item);
    }
    if (items_) {
        for (const Item& item : items_->items()) {
            items.push_back(item_at(item, items.size()));
        }
    } else {
        for (const Vec& place : scenario_.mission) {
            items.push_back(item_at({ItemKind::waypoint, place, 0.0, 0}, items.size()));
        }
    }
    return items;
}

void Autopilot::send_mission_state()
{
    const bool px4 = scenario_.stack == Stack::px4;
    const bool moved_on = sequence() != reported_sequence_;
    if (moved_on && reported_sequence_ > 0) {
        writer_.write(MissionItemReached{reported_sequence_});
    }
    // PX4 reports a new current item at once.
    if (often(px4 ? 1 : 2) || (px4 && moved_on)) {
        MissionCurrent current;
        current.seq = sequence();
        // ArduPilot's total excludes home.
        current.total = static_cast<std::uint16_t>(items_ ? items_->items().size() : scenario_.mission.size());
        current.mission_state = mode_ == Mode::mission ? kMissionActive : kMissionPaused;
        current.mission_mode = mode_ == Mode::mission ? kInMission : kMissionSuspended;
        current.mission_id = mission_id();
        writer_.write(current);
    }
    reported_sequence_ = sequence();
}

}  // namespace jink::sim
