// SPDX-License-Identifier: BSD-3-Clause
// Traffic: reports of transponders, and reports of other vehicles about themselves.
#include <algorithm>
#include <cmath>

#include "core/base/angle.hpp"
#include "firmware/link/geoid.hpp"
#include "firmware/link/mavlink/endpoint.hpp"
#include "firmware/link/mavlink/numbers.hpp"
#include "firmware/link/track_ids.hpp"

namespace jink::link::mavlink {
namespace {

// ADSB_FLAGS and ADSB_EMITTER_TYPE
constexpr unsigned kValidCoordinates = 1;
constexpr unsigned kValidAltitude = 2;
constexpr unsigned kValidHeading = 4;
constexpr unsigned kValidVelocity = 8;
constexpr unsigned kValidVerticalVelocity = 128;
constexpr std::uint8_t kUnmanned = 14;
constexpr std::uint8_t kPointObstacle = 19;
/// Noise of a velocity with unknown vertical component, one standard deviation [m/s]: equal to that of a track without
/// any velocity (world::TrackTableSettings). Three of them hold climbs of 15 m/s; later reports narrow it down.
constexpr float kUnknownClimb = 5.0F;

// UTM_DATA_AVAIL_FLAGS and UTM_FLIGHT_STATE
constexpr unsigned kUtmHasName = 2;
constexpr unsigned kUtmHasPosition = 4;
constexpr unsigned kUtmHasAltitude = 8;
constexpr unsigned kUtmHasLevelVelocity = 32;
constexpr unsigned kUtmHasVerticalVelocity = 64;
constexpr std::uint8_t kUtmOnGround = 2;
constexpr std::uint8_t kUtmEmergency = 16;
constexpr std::uint8_t kUtmNoControl = 32;

constexpr std::uint8_t kFix3d = 3;  // GPS_FIX_TYPE
/// The geoid is within this of the ellipsoid everywhere (EGM96: 107 m below to 86 m above it) [mm].
constexpr std::int32_t kLargestUndulation = 120'000;
/// Uncertainty of a height that is known above the ellipsoid alone, one standard deviation: three of them hold the
/// geoid [m].
constexpr float kUnknownUndulation = 36.0F;

constexpr std::uint8_t kGeometricAltitude = 1;  // ADSB_ALTITUDE_TYPE
/// Own height and own pressure form a pair when they are this close in time [s].
constexpr Seconds kPressurePair = 1.0F;
/// The difference of height and pressure altitude is valid for this long: weather changes more slowly [s].
constexpr Seconds kPressureFresh = 10.0F;
/// The air pressure at sea level stays within 60 hPa of the standard; a larger difference is implausible [m].
constexpr float kLargestPressureError = 600.0F;
/// Plausible pressures of a barometer in the air [hPa].
constexpr float kMinPressure = 100.0F;
constexpr float kMaxPressure = 1200.0F;

constexpr float kMillimetre = 1e-3F;
constexpr float kCentimetrePerSecond = 0.01F;
constexpr float kCentidegree = 0.01F * kPi / 180.0F;

/// Velocity [m/s, ENU] from NED in cm/s.
Vec3 velocity_of(std::int16_t north, std::int16_t east, std::int16_t down) noexcept
{
    return kCentimetrePerSecond *
           swap_ned_enu({static_cast<float>(north), static_cast<float>(east), static_cast<float>(down)});
}

/// Pressure altitude [m] of a pressure [hPa]: ICAO standard atmosphere, below 11 km.
float pressure_altitude(float pressure) noexcept
{
    constexpr float kSeaLevel = 1013.25F;
    constexpr float kScale = 44330.77F;
    constexpr float kExponent = 0.190263F;
    return kScale * (1.0F - std::pow(pressure / kSeaLevel, kExponent));
}

/// Some senders report zeros for an unknown position.
bool is_place(const GlobalPosition& p) noexcept { return is_on_earth(p) && (p.lat != 0 || p.lon != 0); }

bool is_name(const std::array<std::uint8_t, 18>& name) noexcept
{
    return std::any_of(name.begin(), name.end(), [](std::uint8_t byte) { return byte != 0; });
}

}  // namespace

void Endpoint::deliver(const TrackReport& report, Inbox& inbox) noexcept
{
    if (!inbox.tracks.try_push_back(report)) {
        ++diagnostics_.inbox_full;
    }
}

/// Whether a valid place can be converted to the local frame; counts the cause if not.
bool Endpoint::can_place(bool is_sound) noexcept
{
    diagnostics_.out_of_range += is_sound ? 0U : 1U;
    diagnostics_.no_origin += is_sound && origin_rank_ == 0 ? 1U : 0U;
    return is_sound && origin_rank_ > 0;
}

void Endpoint::on_adsb(const Context& c) noexcept
{
    AdsbVehicle m;
    static_cast<void>(decode(c.frame, m));
    const GlobalPosition where{m.lat, m.lon, m.altitude};
    constexpr unsigned kNeeded = kValidCoordinates | kValidAltitude;
    if (!can_place((m.flags & kNeeded) == kNeeded && is_on_earth(where))) {
        return;
    }
    TrackReport report;
    report.id = track_of_address(m.ICAO_address);
    report.stamp = c.now - static_cast<Seconds>(m.tslc);
    report.position = to_local(where, origin_);
    report.at_rest = m.emitter_type == kPointObstacle;
    report.unmanned = m.emitter_type == kUnmanned;
    const bool level = (m.flags & kValidHeading) != 0 && (m.flags & kValidVelocity) != 0;
    report.has_velocity = report.at_rest || level;
    if (level && !report.at_rest) {
        const float yaw = swap_heading_yaw(static_cast<float>(m.heading) * kCentidegree);
        const float speed = static_cast<float>(m.hor_velocity) * kCentimetrePerSecond;
        const bool climb_known = (m.flags & kValidVerticalVelocity) != 0;
        const float climb = climb_known ? static_cast<float>(m.ver_velocity) * kCentimetrePerSecond : 0.0F;
        const SineCosine course = sine_cosine(yaw);
        report.velocity = Vec3(speed * course.cosine, speed * course.sine, climb);
        report.sigma_velocity = climb_known ? 0.0F : kUnknownClimb;
    }
    judge_height(m, c.now, report);
    deliver(report, c.inbox);
}

/// A pressure altitude may refer to the standard pressure (as transponders send it) or to QNH (as the message's name
/// says). The report covers both possible heights if our own pressure altitude is known. A geometric altitude is above
/// sea level by the message's definition, and above the ellipsoid if a transponder's value is relayed.
void Endpoint::judge_height(const AdsbVehicle& m, TimePoint now, TrackReport& report) noexcept
{
    if (m.altitude_type == kGeometricAltitude) {
        hold_both_readings(report, undulation_);
        return;
    }
    ++diagnostics_.pressure_heights;
    report.height = HeightSource::pressure;
    if (has_pressure_ && now - pressure_heard_ <= kPressureFresh) {
        ++diagnostics_.heights_compared;
        report.height = HeightSource::compared;
        report.position.z() += 0.5F * height_over_pressure_;
        report.height_spread = 0.5F * std::abs(height_over_pressure_);
    }
}

/// Updates our own pressure altitude relative to our own height.
void Endpoint::on_pressure(const Context& c) noexcept
{
    ScaledPressure m;
    static_cast<void>(decode(c.frame, m));
    if (!std::isfinite(m.press_abs)) {
        ++diagnostics_.not_finite;
        return;
    }
    if (m.press_abs < kMinPressure || m.press_abs > kMaxPressure) {
        ++diagnostics_.out_of_range;
        return;
    }
    if (origin_rank_ == 0 || !has_local_ || c.now - local_heard_ > kPressurePair) {
        return;  // a later one follows
    }
    const float height = static_cast<float>(origin_.alt) * kMillimetre + own_.position.z();
    height_over_pressure_ = height - pressure_altitude(m.press_abs);
    has_pressure_ = std::abs(height_over_pressure_) <= kLargestPressureError;
    diagnostics_.out_of_range += has_pressure_ ? 0U : 1U;
    pressure_heard_ = c.now;
}

/// Position reported by another system. Its local position is not used: it is relative to an origin of its own and adds
/// nothing.
void Endpoint::on_neighbour(const Context& c) noexcept
{
    GlobalPositionInt m;
    static_cast<void>(decode(c.frame, m));
    const GlobalPosition where{m.lat, m.lon, m.alt};
    if (!can_place(is_place(where))) {
        return;
    }
    const std::uint8_t system = c.frame.header.system_id;
    TrackReport report;
    report.id = track_of_system(system);
    report.source = world::TrackSource::datalink;
    report.stamp = neighbours_.stamp(system, m.time_boot_ms, c.now);
    report.position = to_local(where, origin_);
    report.velocity = velocity_of(m.vx, m.vy, m.vz);
    report.has_velocity = true;
    report.unmanned = true;
    report.helpless = neighbours_.is_disarmed(system);
    deliver(report, c.inbox);
}

/// Undulation between mean sea level, the reference of own heights, and the ellipsoid, the reference of
/// UTM_GLOBAL_POSITION: in this region it is the same for all vehicles.
void Endpoint::on_gps(const Context& c) noexcept
{
    GpsRawInt m;
    static_cast<void>(decode(c.frame, m));
    const std::int64_t undulation = static_cast<std::int64_t>(m.alt_ellipsoid) - m.alt;
    if (m.fix_type < kFix3d || m.alt_ellipsoid == 0 || std::abs(undulation) > kLargestUndulation) {
        ++diagnostics_.frames_ignored;
        return;
    }
    undulation_ = static_cast<std::int32_t>(undulation);
}

/// Our own autopilot's message gives our own name.
bool Endpoint::is_own(const Frame& frame, const UtmGlobalPosition& m, bool named) noexcept
{
    if (from_autopilot(frame)) {
        own_name_ = named ? m.uas_id : own_name_;
        return true;
    }
    return named && m.uas_id == own_name_;
}

void Endpoint::on_utm(const Context& c) noexcept
{
    UtmGlobalPosition m;
    static_cast<void>(decode(c.frame, m));
    const bool named = (m.flags & kUtmHasName) != 0 && is_name(m.uas_id);
    if (is_own(c.frame, m, named)) {
        ++diagnostics_.own_heard;
        return;
    }
    constexpr unsigned kNeeded = kUtmHasPosition | kUtmHasAltitude;
    const std::int64_t height = static_cast<std::int64_t>(m.alt) - undulation_.value_or(0);
    const GlobalPosition where{m.lat, m.lon, static_cast<std::int32_t>(height)};
    if (!can_place((m.flags & kNeeded) == kNeeded && is_place(where) && height == where.alt)) {
        return;
    }
    TrackReport report;
    const std::array<std::uint8_t, 2> sender{c.frame.header.system_id, c.frame.header.component_id};
    report.id = track_of_name(named ? std::span<const std::uint8_t>(m.uas_id) : sender);
    report.source = world::TrackSource::utm;
    report.stamp = c.now;
    report.position = to_local(where, origin_);
    report.sigma_position = kMillimetre * static_cast<float>(std::max(m.h_acc, m.v_acc));
    report.sigma_position = undulation_ ? report.sigma_position : report.sigma_position + kUnknownUndulation;
    report.has_velocity = (m.flags & kUtmHasLevelVelocity) != 0;
    if (report.has_velocity) {
        const bool climb_known = (m.flags & kUtmHasVerticalVelocity) != 0;
        report.velocity = velocity_of(m.vx, m.vy, climb_known ? m.vz : std::int16_t{0});
        report.sigma_velocity = kCentimetrePerSecond * static_cast<float>(m.vel_acc);
        report.sigma_velocity = climb_known ? report.sigma_velocity : report.sigma_velocity + kUnknownClimb;
    }
    report.unmanned = true;
    report.helpless =
        m.flight_state == kUtmOnGround || m.flight_state == kUtmEmergency || m.flight_state == kUtmNoControl;
    deliver(report, c.inbox);
}

}  // namespace jink::link::mavlink
