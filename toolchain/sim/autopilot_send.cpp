// SPDX-License-Identifier: BSD-3-Clause
// What the autopilot tells, and how often.
#include <cmath>
#include <numbers>

#include "firmware/link/mavlink/text.hpp"
#include "toolchain/sim/autopilot.hpp"
#include "toolchain/sim/geodesy.hpp"
#include "toolchain/sim/modes.hpp"

namespace jink::sim {

using namespace link::mavlink;

namespace {

constexpr std::uint8_t kFixedWing = 1;
constexpr std::uint8_t kQuadrotor = 2;
constexpr std::uint8_t kArdupilot = 3;
constexpr std::uint8_t kPx4 = 12;
constexpr std::uint8_t kArmedAndCustom = 128 + 1;
constexpr std::uint8_t kStateActive = 4;
constexpr std::uint8_t kInAir = 2;
constexpr std::uint8_t kReal32 = 9;
constexpr std::uint16_t kNavWaypoint = 16;
constexpr std::uint8_t kFrameGlobal = 0;
constexpr std::uint8_t kFrameRelative = 3;
constexpr std::uint8_t kFrameRelativeInt = 6;
constexpr std::uint8_t kBodyFrd = 12;
constexpr std::uint8_t kPointObstacle = 19;
constexpr std::uint8_t kLightAircraft = 1;
/// Coordinates, altitude, heading, velocity, vertical velocity are valid; simulated.
constexpr std::uint16_t kAdsbFlags = 1 + 2 + 4 + 8 + 64 + 128;
constexpr std::uint16_t kPositionMask = 0x0DF8;

float as_float(double value) noexcept { return static_cast<float>(value); }
std::int16_t centi(double metres_per_second) noexcept
{
    return static_cast<std::int16_t>(std::lround(metres_per_second * 100.0));
}

/// Clockwise from north in [0, 2 pi).
double compass(double yaw) noexcept
{
    const double heading = std::remainder(0.5 * std::numbers::pi - yaw, 2.0 * std::numbers::pi);
    return heading < 0.0 ? heading + 2.0 * std::numbers::pi : heading;
}

std::uint16_t centidegrees(double radians) noexcept
{
    return static_cast<std::uint16_t>(std::lround(radians * 18000.0 / std::numbers::pi) % 36000);
}

}  // namespace

Heartbeat Autopilot::heartbeat() const
{
    Heartbeat heartbeat;
    heartbeat.custom_mode = custom_mode(scenario_.stack, mode_, is_plane());
    heartbeat.type = is_plane() ? kFixedWing : kQuadrotor;
    heartbeat.autopilot = scenario_.stack == Stack::ardupilot ? kArdupilot : kPx4;
    heartbeat.base_mode = kArmedAndCustom;
    heartbeat.system_status = kStateActive;
    return heartbeat;
}

void Autopilot::send_heartbeat() { writer_.write(heartbeat()); }

void Autopilot::send_own_state()
{
    const Truth& own = world_.own();
    const Vec& p = own.position;
    const Vec& v = own.velocity;
    if (due(20'000)) {
        writer_.write(LocalPositionNed{boot_ms(), as_float(p.y()), as_float(p.x()), as_float(-p.z()), as_float(v.y()),
                                       as_float(v.x()), as_float(-v.z())});
    }
    if (due(40'000)) {
        AttitudeQuaternion attitude;
        attitude.time_boot_ms = boot_ms();
        const double half = 0.5 * compass(own.yaw);
        attitude.q1 = as_float(std::cos(half));
        attitude.q4 = as_float(std::sin(half));
        writer_.write(attitude);
    }
    if (due(200'000)) {
        writer_.write(global_position());
    }
}

GlobalPositionInt Autopilot::global_position() const
{
    const Truth& own = world_.own();
    const Vec& v = own.velocity;
    const GlobalPosition global = to_global(own.position, scenario_.stack);
    return {boot_ms(),
            global.lat,
            global.lon,
            global.alt,
            static_cast<std::int32_t>(std::lround(own.position.z() * 1e3)),
            centi(v.y()),
            centi(v.x()),
            centi(-v.z()),
            centidegrees(compass(own.yaw))};
}

bool Autopilot::send_message(int id)
{
    const GlobalPosition home = to_global(Vec::Zero(), scenario_.stack);
    if (id == static_cast<int>(GpsGlobalOrigin::kInfo.id)) {
        writer_.write(GpsGlobalOrigin{home.lat, home.lon, home.alt, static_cast<std::uint64_t>(boot_us())});
    } else if (id == static_cast<int>(HomePosition::kInfo.id)) {
        HomePosition position;
        position.latitude = home.lat;
        position.longitude = home.lon;
        position.altitude = home.alt;
        position.q = {1.0F, 0.0F, 0.0F, 0.0F};
        writer_.write(position);
    } else if (id == static_cast<int>(ExtendedSysState::kInfo.id)) {
        writer_.write(ExtendedSysState{0, kInAir});
    } else if (id == static_cast<int>(Heartbeat::kInfo.id)) {
        send_heartbeat();  // as both stacks do
    } else {
        return false;
    }
    return true;
}

std::uint16_t Autopilot::home_items() const noexcept
{
    // ArduPilot's item 0 is home, its mission starts with item 1.
    return scenario_.stack == Stack::ardupilot ? 1 : 0;
}

void Autopilot::send_slow()
{
    if (due(kSecond)) {
        send_heartbeat();
        static_cast<void>(send_message(static_cast<int>(ExtendedSysState::kInfo.id)));
        writer_.write(Timesync{0, boot_us() * 1000, 0, 0});
    }
    if (due(5 * kSecond)) {
        static_cast<void>(send_message(static_cast<int>(GpsGlobalOrigin::kInfo.id)));
        static_cast<void>(send_message(static_cast<int>(HomePosition::kInfo.id)));
    }
    if (due(kSecond / 2)) {
        MissionCurrent current;
        current.seq = static_cast<std::uint16_t>(mission_.target() + home_items());
        current.total = static_cast<std::uint16_t>(scenario_.mission.size() + home_items());
        writer_.write(current);
    }
}

void Autopilot::send_target()
{
    if (!due(kSecond / 5, 10'000) || (mode_ != Mode::mission && mode_ != Mode::external)) {
        return;
    }
    const Vec& place = scenario_.mission[mission_.target()];
    PositionTargetLocalNed target;
    target.time_boot_ms = boot_ms();
    target.coordinate_frame = kLocalNed;
    if (mode_ == Mode::mission) {
        target.type_mask = kPositionMask;
        target.x = as_float(place.y());
        target.y = as_float(place.x());
        target.z = as_float(-place.z());
    } else {
        target.type_mask = kVelocityMask;
        target.vx = as_float(setpoint_.y());
        target.vy = as_float(setpoint_.x());
        target.vz = as_float(-setpoint_.z());
    }
    writer_.write(target);
}

void Autopilot::send_parameters()
{
    if (!due(kSecond / 4, 100'000)) {
        return;
    }
    for (const Wanted& wanted : wanted_) {
        if (wanted.verified) {
            continue;
        }
        ParamSet set;
        set.param_value = wanted.value;
        set.target_system = scenario_.system;
        set.target_component = kJink;
        set.param_type = kReal32;
        static_cast<void>(set_text(set.param_id, wanted.name));
        writer_.write(set, kGroundStation);
    }
}

void Autopilot::send_telemetry()
{
    send_slow();
    send_own_state();
    send_target();
    send_parameters();
}

void Autopilot::send_traffic()
{
    for (const Sighting& seen : receiver_.poll()) {
        const bool rests = scenario_.threats[seen.threat].sensed_by == SensedBy::point;
        const GlobalPosition global = to_global(seen.position, scenario_.stack);
        AdsbVehicle vehicle;
        vehicle.ICAO_address = static_cast<std::uint32_t>(0xABC000U + seen.threat);
        vehicle.lat = global.lat;
        vehicle.lon = global.lon;
        vehicle.altitude = global.alt;
        vehicle.altitude_type = 1;  // geometric
        vehicle.flags = kAdsbFlags;
        vehicle.emitter_type = rests ? kPointObstacle : kLightAircraft;
        const double speed = std::hypot(seen.velocity.x(), seen.velocity.y());
        vehicle.heading = centidegrees(compass(std::atan2(seen.velocity.y(), seen.velocity.x())));
        vehicle.hor_velocity = static_cast<std::uint16_t>(std::lround(speed * 100.0));
        vehicle.ver_velocity = centi(seen.velocity.z());
        writer_.write(vehicle, kAdsbReceiver);
        told_[seen.threat] = told_[seen.threat] < 0 ? world_.now() : told_[seen.threat];
    }
}

void Autopilot::send_scan()
{
    bool any = false;
    for (std::size_t i = 0; i < scenario_.threats.size(); ++i) {
        any = any || (scenario_.threats[i].sensed_by == SensedBy::scan && world_.visible(i));
    }
    if (!any || !due(to_micros(1.0 / scenario_.scan.rate), scenario_.scan.phase)) {
        return;
    }
    ObstacleDistance message;
    message.time_usec = static_cast<std::uint64_t>(boot_us());
    message.min_distance = 20;
    message.max_distance = static_cast<std::uint16_t>(std::lround(scenario_.scan.range * 100.0));
    message.sensor_type = 0;
    message.increment = static_cast<std::uint8_t>(kScanIncrement);
    message.increment_f = as_float(kScanIncrement);
    message.frame = kBodyFrd;
    const auto ranges = scan(world_);
    for (std::size_t i = 0; i < kScanSectors; ++i) {
        message.distances[i] = ranges[i] < 0.0 ? static_cast<std::uint16_t>(message.max_distance + 1)
                                               : static_cast<std::uint16_t>(std::lround(ranges[i] * 100.0));
    }
    writer_.write(message, kRangefinder);
}

void Autopilot::send_mission_item(std::uint16_t seq, std::uint8_t frame, const Vec& place, std::uint8_t system,
                                  std::uint8_t component)
{
    const GlobalPosition global = to_global(place, scenario_.stack);
    MissionItemInt item;
    item.x = global.lat;
    item.y = global.lon;
    item.z = frame == kFrameGlobal ? as_float(kHomeAltitude + place.z()) : as_float(place.z());
    item.seq = seq;
    item.command = kNavWaypoint;
    item.target_system = system;
    item.target_component = component;
    item.frame = frame;
    item.current = seq == mission_.target() + home_items() ? 1 : 0;
    item.autocontinue = 1;
    writer_.write(item);
}

void Autopilot::answer_mission(const Frame& frame)
{
    MissionRequestList list;
    MissionRequestInt request;
    const std::uint16_t total = static_cast<std::uint16_t>(scenario_.mission.size() + home_items());
    const std::uint8_t system = frame.header.system_id;
    const std::uint8_t component = frame.header.component_id;
    if (decode(frame, list)) {
        MissionCount count;
        count.count = total;
        count.target_system = system;
        count.target_component = component;
        writer_.write(count);
    } else if (decode(frame, request)) {
        if (request.seq >= total) {
            constexpr std::uint8_t kInvalidSequence = 13;
            writer_.write(MissionAck{system, component, kInvalidSequence, 0, 0});
            return;
        }
        const bool home = request.seq < home_items();
        const Vec place = home ? Vec(Vec::Zero()) : scenario_.mission[request.seq - home_items()];
        const std::uint8_t relative = scenario_.stack == Stack::ardupilot ? kFrameRelative : kFrameRelativeInt;
        send_mission_item(request.seq, home ? kFrameGlobal : relative, place, system, component);
    }
}

}  // namespace jink::sim
