// SPDX-License-Identifier: BSD-3-Clause
// The autopilot's telemetry and its rates.
#include <cmath>
#include <limits>
#include <numbers>

#include "core/base/random.hpp"
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
/// HEARTBEAT.base_mode of an armed vehicle, as recorded: ArduCopter; PX4 in AUTO and in OFFBOARD.
constexpr std::uint8_t kArdupilotArmed = 217;
constexpr std::uint8_t kPx4Auto = 157;
constexpr std::uint8_t kPx4Offboard = 145;
constexpr std::uint8_t kStateActive = 4;
constexpr std::uint8_t kInAir = 2;
constexpr std::uint8_t kReal32 = 9;
constexpr std::uint8_t kBodyFrd = 12;
constexpr std::uint8_t kPointObstacle = 19;
constexpr std::uint8_t kLightAircraft = 1;
/// Coordinates, altitude, heading, velocity, vertical velocity are valid; simulated.
constexpr std::uint16_t kAdsbFlags = 1 + 2 + 4 + 8 + 64 + 128;
constexpr std::uint16_t kPositionMask = 0x0DF8;
/// ArduPilot's mask for a velocity set-point in POSITION_TARGET_LOCAL_NED: yaw is ignored, yaw rate too.
constexpr std::uint16_t kArdupilotVelocityTarget = 0x0C07;
/// PX4's mask for a velocity set-point: x, y and z are NaN.
constexpr std::uint16_t kPositionIgnored = 0x0007;
/// PX4's height of home, as recorded: changes every few seconds by up to this, up or down [us], [m].
constexpr Micros kHomeSteady = 8 * kSecond;
constexpr double kHomeWander = 1.0;
/// Variances of PX4's ODOMETRY, as recorded in flight [m2, m2/s2].
constexpr float kOdometryPosition = 0.042F;
constexpr float kOdometryVelocity = 0.0105F;
constexpr std::uint8_t kEstimatorAutopilot = 8;
/// Time by which the controller's place leads the vehicle [s].
constexpr double kPlaceAhead = 0.1;

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
    heartbeat.base_mode = scenario_.stack == Stack::ardupilot ? kArdupilotArmed
                          : mode_ == Mode::external           ? kPx4Offboard
                                                              : kPx4Auto;
    heartbeat.system_status = kStateActive;
    return heartbeat;
}

void Autopilot::send_heartbeat() { writer_.write(heartbeat()); }

void Autopilot::send_own_state()
{
    const bool px4 = scenario_.stack == Stack::px4;
    const Truth& own = estimate_.reported();
    const Vec& p = own.position;
    const Vec& v = own.velocity;
    const double heading = compass(own.yaw);
    if (often(px4 ? 30 : 50)) {
        writer_.write(LocalPositionNed{boot_ms(), as_float(p.y()), as_float(p.x()), as_float(-p.z()), as_float(v.y()),
                                       as_float(v.x()), as_float(-v.z())});
    }
    if (often(px4 ? 50 : 10)) {
        AttitudeQuaternion attitude;
        attitude.time_boot_ms = boot_ms();
        attitude.q1 = as_float(std::cos(0.5 * heading));
        attitude.q4 = as_float(std::sin(0.5 * heading));
        writer_.write(attitude);
    }
    if (!px4) {
        return;
    }
    if (often(100)) {
        Attitude attitude;
        attitude.time_boot_ms = boot_ms();
        attitude.yaw = as_float(std::remainder(heading, 2.0 * std::numbers::pi));
        writer_.write(attitude);
    }
    if (often(50)) {
        writer_.write(global_position());
    }
    if (often(30)) {
        send_odometry();
    }
}

void Autopilot::send_odometry()
{
    const Truth& own = estimate_.reported();
    const double half = 0.5 * compass(own.yaw);
    Odometry m;
    m.time_usec = static_cast<std::uint64_t>(boot_us());
    m.x = as_float(own.position.y());
    m.y = as_float(own.position.x());
    m.z = as_float(-own.position.z());
    m.q = {as_float(std::cos(half)), 0.0F, 0.0F, as_float(std::sin(half))};
    m.vx = as_float(own.velocity.y());
    m.vy = as_float(own.velocity.x());
    m.vz = as_float(-own.velocity.z());
    m.pose_covariance.fill(std::numeric_limits<float>::quiet_NaN());
    m.velocity_covariance.fill(std::numeric_limits<float>::quiet_NaN());
    for (const std::size_t diagonal : {0U, 6U, 11U}) {
        m.pose_covariance[diagonal] = kOdometryPosition;
        m.velocity_covariance[diagonal] = kOdometryVelocity;
    }
    m.frame_id = kLocalNed;
    m.child_frame_id = kLocalNed;
    m.estimator_type = kEstimatorAutopilot;
    writer_.write(m);
}

GlobalPositionInt Autopilot::global_position() const
{
    const Truth& own = estimate_.reported();
    const Vec& v = own.velocity;
    const GlobalPosition global = to_global(own.position, scenario_.stack);
    return {boot_ms(),
            global.lat,
            global.lon,
            global.alt,
            static_cast<std::int32_t>(std::lround((own.position.z() - scenario_.home.z()) * 1e3)),
            centi(v.y()),
            centi(v.x()),
            centi(-v.z()),
            centidegrees(compass(own.yaw))};
}

/// ArduPilot's x, y and z are 0 always. PX4's height of home wanders, local and global alike.
HomePosition Autopilot::home_position() const
{
    HomePosition message;
    Vec home = scenario_.home;
    if (scenario_.stack == Stack::px4) {
        Random random(scenario_.seed * 7919U + static_cast<std::uint64_t>(world_.now() / kHomeSteady));
        home.z() += kHomeWander * (2.0 * static_cast<double>(random.uniform()) - 1.0);
        message.x = as_float(home.y());
        message.y = as_float(home.x());
        message.z = as_float(-home.z());
    }
    const GlobalPosition global = to_global(home, scenario_.stack);
    message.latitude = global.lat;
    message.longitude = global.lon;
    message.altitude = global.alt;
    message.q = {1.0F, 0.0F, 0.0F, 0.0F};
    return message;
}

bool Autopilot::send_message(int id)
{
    if (id == static_cast<int>(GpsGlobalOrigin::kInfo.id)) {
        const GlobalPosition origin = to_global(Vec::Zero(), scenario_.stack);
        writer_.write(GpsGlobalOrigin{origin.lat, origin.lon, origin.alt, static_cast<std::uint64_t>(boot_us())});
    } else if (id == static_cast<int>(HomePosition::kInfo.id)) {
        writer_.write(home_position());
    } else if (id == static_cast<int>(ExtendedSysState::kInfo.id)) {
        writer_.write(ExtendedSysState{0, kInAir});
    } else if (id == static_cast<int>(Heartbeat::kInfo.id)) {
        send_heartbeat();  // as both stacks do
    } else {
        return false;
    }
    return true;
}

void Autopilot::send_slow()
{
    const bool px4 = scenario_.stack == Stack::px4;
    if (often(1)) {
        send_heartbeat();
    }
    if (often(px4 ? 5 : 1)) {
        static_cast<void>(send_message(static_cast<int>(ExtendedSysState::kInfo.id)));
    }
    if (px4 ? often(10) : due(10 * kSecond)) {
        writer_.write(Timesync{0, boot_us() * 1000, 0, 0});
    }
    // PX4 reports the origin once; ArduPilot as often as home, because the co-processor requested both.
    if (px4 ? !reported_origin_ : due(5 * kSecond)) {
        static_cast<void>(send_message(static_cast<int>(GpsGlobalOrigin::kInfo.id)));
        reported_origin_ = true;
    }
    if (due(px4 ? 2 * kSecond : 5 * kSecond)) {
        static_cast<void>(send_message(static_cast<int>(HomePosition::kInfo.id)));
    }
    send_mission_state();
}

/// ArduPilot reports the set-point of GUIDED only. PX4 always reports its controller's set-point: a place right ahead
/// of the vehicle, without a place in OFFBOARD by velocities.
void Autopilot::send_target()
{
    const bool px4 = scenario_.stack == Stack::px4;
    if (!often(px4 ? 10 : 2) || (!px4 && mode_ != Mode::external && mode_ != Mode::guided)) {
        return;
    }
    PositionTargetLocalNed target;
    target.time_boot_ms = boot_ms();
    target.coordinate_frame = kLocalNed;
    Vec velocity = command_;
    Vec place = estimate_.reported().position + kPlaceAhead * command_;
    if (mode_ == Mode::external) {
        velocity = setpoint_;
        target.type_mask = px4 ? kPositionIgnored : kArdupilotVelocityTarget;
        place = px4 ? Vec(Vec::Constant(std::numeric_limits<double>::quiet_NaN())) : Vec(Vec::Zero());
    } else if (!px4) {
        velocity.setZero();
        target.type_mask = kPositionMask;
        place = scenario_.flight ? scenario_.flight->target : place;
    }
    target.x = as_float(place.y());
    target.y = as_float(place.x());
    target.z = as_float(-place.z());
    target.vx = as_float(velocity.y());
    target.vy = as_float(velocity.x());
    target.vz = as_float(-velocity.z());
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
        // PX4 forwards the ground station's reports under its own id.
        writer_.write(vehicle, scenario_.stack == Stack::px4 ? kAutopilot : kAdsbReceiver);
        Reported& reported = reported_[seen.threat];
        reported.first = reported.first < 0 ? world_.now() : reported.first;
        reported.course = reported.course < 0 || seen.turns > reported.turns ? world_.now() : reported.course;
        reported.turns = std::max(reported.turns, seen.turns);
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

}  // namespace jink::sim
