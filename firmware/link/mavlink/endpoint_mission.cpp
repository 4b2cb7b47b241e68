// SPDX-License-Identifier: BSD-3-Clause
// The autopilot's mission, and its present leg.
#include <algorithm>
#include <cmath>
#include <limits>
#include <string_view>

#include "firmware/link/mavlink/endpoint.hpp"
#include "firmware/link/mavlink/numbers.hpp"

namespace jink::link::mavlink {
namespace {

// MAV_FRAME
constexpr std::uint8_t kFrameGlobalRelative = 3;
constexpr std::uint8_t kFrameGlobalRelativeInt = 6;
/// Not a MAV_FRAME: an item without a height cannot be placed.
constexpr std::uint8_t kNoFrame = 255;

// MAV_CMD
constexpr std::uint16_t kWaypoint = 16;
constexpr std::uint16_t kLoiterUnlimited = 17;
constexpr std::uint16_t kLoiterTime = 19;
constexpr std::uint16_t kLand = 21;
constexpr std::uint16_t kTakeoff = 22;

constexpr std::uint8_t kStateComplete = 5;  // MISSION_STATE_COMPLETE

/// PX4 accepts a waypoint 10 m before it (NAV_ACC_RAD), and MISSION_CURRENT follows up to 0.5 s later [m].
constexpr float kCorner = 15.0F;
/// ArduPlane accepts a waypoint at WP_RADIUS (90 m by default) or its L1 distance, whichever is less: 4.1 s of flight
/// with NAVL1_PERIOD 17 (AP_L1_Control::turn_distance), and MISSION_CURRENT follows up to 0.5 s later [m].
constexpr float kPlaneCorner = 120.0F;
/// MISSION_ITEM_REACHED and MISSION_CURRENT of one switch arrive within this time of each other [s].
constexpr Seconds kSwitchTime = 3.0F;
/// A loiter or landing item counts as flown to its place until this near [m].
constexpr float kArrival = 3.0F;
/// A take-off counts as complete this far below its height (NAV_MC_ALT_RAD is 0.8 m) [m].
constexpr float kClimbed = 1.5F;

bool has_coordinates(const MissionItem& item) noexcept
{
    // Latitude and longitude 0 mean "here" in ArduPilot's items; the greatest integer means "not given".
    return is_on_earth({item.x, item.y, 0}) && (item.x != 0 || item.y != 0);
}

bool is_relative(std::uint8_t frame) noexcept
{
    return frame == kFrameGlobalRelative || frame == kFrameGlobalRelativeInt;
}
bool is_absolute(std::uint8_t frame) noexcept { return frame == kFrameGlobal || frame == kFrameGlobalInt; }

}  // namespace

template <class M>
bool Endpoint::asks_autopilot(const Frame& frame) const noexcept
{
    M m;
    return frame.message_id == M::kInfo.id && decode(frame, m) && m.target_system == system_;
}

void Endpoint::note_others_transfer(bool upload, bool ended, TimePoint now) noexcept
{
    ++diagnostics_.frames_ignored;
    mission_.others(upload, ended, now);
}

/// True if the frame belongs to the mission protocol. Transfers of other systems are visible if both share our line.
bool Endpoint::dispatch_mission(const Context& c) noexcept
{
    const bool own = from_autopilot(c.frame);
    const std::uint32_t id = c.frame.message_id;
    if (own) {
        mission_.heard(c.now);
    }
    if (!own) {
        const bool download = asks_autopilot<MissionRequestList>(c.frame) || asks_autopilot<MissionRequestInt>(c.frame);
        const bool upload = asks_autopilot<MissionCount>(c.frame) || asks_autopilot<MissionItemInt>(c.frame);
        if (download || upload) {
            note_others_transfer(upload, false, c.now);
        }
        return download || upload;
    }
    if (id == MissionRequest::kInfo.id || id == MissionRequestInt::kInfo.id) {
        note_others_transfer(true, false, c.now);  // from the uploading system
    } else if (id == MissionCurrent::kInfo.id) {
        streams_.heard(id);
        on_mission_current(c);
    } else if (id == MissionCount::kInfo.id) {
        on_mission_count(c);
    } else if (id == MissionItemInt::kInfo.id) {
        on_mission_item(c);
    } else if (id == MissionAck::kInfo.id) {
        on_mission_ack(c);
    } else if (id == MissionItemReached::kInfo.id) {
        on_mission_reached(c);
    } else {
        return false;
    }
    return true;
}

void Endpoint::on_mission_current(const Context& c) noexcept
{
    MissionCurrent m;
    static_cast<void>(decode(c.frame, m));
    mission_.current({m.seq, m.total, m.mission_id, m.mission_state == kStateComplete}, c.now);
}

void Endpoint::on_mission_count(const Context& c) noexcept
{
    MissionCount m;
    static_cast<void>(decode(c.frame, m));
    if (!for_us(m.target_system, m.target_component)) {
        note_others_transfer(false, false, c.now);
    } else if (m.mission_type != 0) {
        ++diagnostics_.frames_ignored;
    } else {
        mission_.count(m.count, m.opaque_id, c.now);
    }
}

void Endpoint::on_mission_item(const Context& c) noexcept
{
    MissionItemInt m;
    static_cast<void>(decode(c.frame, m));
    if (!for_us(m.target_system, m.target_component)) {
        note_others_transfer(false, false, c.now);
        return;
    }
    if (m.mission_type != 0) {
        ++diagnostics_.frames_ignored;
        return;
    }
    const bool finite = std::isfinite(m.z);
    diagnostics_.not_finite += finite ? 0U : 1U;
    const MissionItem item{true, finite ? m.frame : kNoFrame, m.command, m.x, m.y, finite ? m.z : 0.0F, 0.0F};
    if (!mission_.item(m.seq, item, m.param1, m.param2, c.now)) {
        ++diagnostics_.frames_ignored;
    }
}

void Endpoint::on_mission_ack(const Context& c) noexcept
{
    MissionAck m;
    static_cast<void>(decode(c.frame, m));
    if (for_us(m.target_system, m.target_component)) {
        mission_.refused(m.type, c.now);
    } else {
        note_others_transfer(true, true, c.now);
    }
}

void Endpoint::on_mission_reached(const Context& c) noexcept
{
    MissionItemReached m;
    static_cast<void>(decode(c.frame, m));
    has_reached_ = true;
    reached_sequence_ = m.seq;
    reached_ = c.now;
}

void Endpoint::on_status_text(const Context& c) noexcept
{
    constexpr std::string_view kRestarted = "Auto mission changed";  // ArduPilot restarts the current item
    Statustext m;
    static_cast<void>(decode(c.frame, m));
    if (std::string_view(m.text.data(), m.text.size()).substr(0, kRestarted.size()) == kRestarted) {
        mission_.suspect();
    }
    dispatch_sensors(c);
}

/// Updates the mission state after a HEARTBEAT.
void Endpoint::note_mode(FlightMode before, bool was_armed) noexcept
{
    const bool is_mission = autopilot_.mode == FlightMode::mission;
    const bool goes_on = autopilot_.mode == FlightMode::external && is_mission_flown_;
    const bool begins = is_mission && (before != FlightMode::mission || !was_armed);
    is_mission_flown_ = autopilot_.armed && (is_mission || goes_on);
    if (begins || !is_mission_flown_) {
        has_anchor_ = has_former_ = false;
    }
}

bool Endpoint::place_on_map(const MissionItem& item, Vec3& local) const noexcept
{
    if (item.frame == kFrameLocalNed) {
        local = swap_ned_enu({static_cast<float>(item.x) * 1e-4F, static_cast<float>(item.y) * 1e-4F, 0.0F});
        return true;
    }
    if (origin_rank_ == 0 || !has_coordinates(item) || (!is_relative(item.frame) && !is_absolute(item.frame))) {
        return false;
    }
    local = to_local({item.x, item.y, origin_.alt}, origin_);
    return true;
}

bool Endpoint::place_height(const MissionItem& item, float& height) const noexcept
{
    if (item.frame == kFrameLocalNed) {
        height = -item.z;
        return true;
    }
    if (is_relative(item.frame)) {
        height = home_.z() + item.z;
        return has_home_;
    }
    height = item.z - static_cast<float>(origin_.alt) * 1e-3F;
    return is_absolute(item.frame) && origin_rank_ > 0;
}

/// Straight up to the item's height; then, for PX4, to its place. ArduCopter uses the height alone.
bool Endpoint::find_takeoff_goal(const MissionItem& item, Vec3& goal) noexcept
{
    float height = 0.0F;
    if (!place_height(item, height)) {
        return false;
    }
    Vec3 place;
    const bool goes_on = autopilot_.stack == AutopilotStack::px4 && place_on_map(item, place);
    if (goes_on && !is_goal_reached_ && own_.position.z() >= height - kClimbed) {
        is_goal_reached_ = true;
        anchor_ = own_.position;
    }
    const bool is_above = goes_on && is_goal_reached_;
    goal =
        is_above ? Vec3(place.x(), place.y(), height) : Vec3(anchor_.x(), anchor_.y(), std::max(height, anchor_.z()));
    return true;
}

/// Destination of the item, from `anchor_`; false while unknown. See the head of endpoint.hpp.
bool Endpoint::find_goal(const MissionItem& item, Vec3& goal) noexcept
{
    const bool circles = vehicle_class_ == VehicleClass::plane && item.command != kWaypoint;
    const bool stays = item.command == kLoiterUnlimited || item.command == kLoiterTime;
    if (circles) {
        return false;
    }
    if (item.command == kTakeoff) {
        return find_takeoff_goal(item, goal);
    }
    if ((item.command != kWaypoint && !stays && item.command != kLand) || !place_on_map(item, goal)) {
        return false;
    }
    const bool same_height = item.command == kLand || (autopilot_.stack == AutopilotStack::ardupilot && item.z == 0.0F);
    float height = anchor_.z();
    if (!same_height && !place_height(item, height)) {
        return false;
    }
    goal.z() = height;
    const Vec3 left = goal - own_.position;
    const bool near = item.command == kLand ? left.head<2>().norm() < kArrival : stays && left.norm() < kArrival;
    is_goal_reached_ = is_goal_reached_ || near;
    return !is_goal_reached_;
}

void Endpoint::anchor_leg(TimePoint now) noexcept
{
    has_former_ = has_anchor_ && had_leg_;
    had_leg_ = false;
    former_end_ = leg_.end;
    former_sequence_ = anchor_sequence_;
    has_anchor_ = true;
    anchor_ = own_.position;
    anchored_ = now;
    anchor_version_ = mission_.version();
    anchor_sequence_ = mission_.sequence();
    is_goal_reached_ = false;
}

/// If the former item was reached, this item is flown along the line between the two. Either message may come first.
void Endpoint::settle_anchor() noexcept
{
    const float corner = vehicle_class_ == VehicleClass::plane ? kPlaneCorner : kCorner;
    const bool reached = has_former_ && has_reached_ && reached_sequence_ == former_sequence_ &&
                         std::abs(reached_ - anchored_) <= kSwitchTime && (former_end_ - anchor_).norm() <= corner;
    if (reached && !is_goal_reached_) {
        anchor_ = former_end_;
        has_former_ = false;
    }
}

std::optional<world::Leg> Endpoint::find_leg(TimePoint now) noexcept
{
    const MissionItem* const item = mission_.goal();
    if (!is_mission_flown_ || !has_local_ || item == nullptr) {
        return std::nullopt;
    }
    if (!has_anchor_ || anchor_version_ != mission_.version()) {
        anchor_leg(now);
    }
    settle_anchor();
    Vec3 goal;
    if (!find_goal(*item, goal) || !(goal.norm() <= kLargestPosition)) {
        return std::nullopt;
    }
    return world::Leg{anchor_, goal, item->speed};
}

void Endpoint::update_leg(Inbox& inbox, TimePoint now) noexcept
{
    const std::optional<world::Leg> leg = find_leg(now);
    if (!leg) {
        if (has_leg_) {
            inbox.has_leg = false;
            inbox.leg_lost = true;
        }
        has_leg_ = false;
        return;
    }
    const bool same = has_leg_ && leg->start == leg_.start && leg->end == leg_.end && leg->speed == leg_.speed;
    has_leg_ = had_leg_ = true;
    leg_ = *leg;
    if (!same) {
        inbox.leg.leg = leg_;
        inbox.has_leg = true;
    }
}

}  // namespace jink::link::mavlink
