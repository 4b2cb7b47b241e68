// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "core/base/static_vector.hpp"
#include "core/base/time.hpp"
#include "core/base/vec3.hpp"
#include "core/world/world.hpp"
#include "firmware/link/constraint.hpp"
#include "firmware/link/log_part.hpp"

// Reports of a link to the application, free of any wire format: frames are ENU, units SI, stamps on the co-processor's
// clock. Every number in here is finite; the link refuses and counts reports with non-finite values.

namespace jink::link {

/// Places farther from the origin are implausible [m], and so are speeds above this [m/s]: refused and counted.
inline constexpr float kLargestPosition = 200000.0F;
inline constexpr float kLargestSpeed = 400.0F;

/// Autopilot stack behind the link; decides how modes are requested.
enum class AutopilotStack : std::uint8_t { unknown, ardupilot, px4 };

/// What the autopilot is doing, as far as a takeover is concerned.
enum class FlightMode : std::uint8_t {
    unknown,
    mission,     ///< flies a mission by itself (AUTO): the mode that may be taken over
    external,    ///< follows set-points of a companion (GUIDED, OFFBOARD)
    hold,        ///< LOITER, BRAKE, AUTO.LOITER
    going_home,  ///< RTL and the like
    manual,      ///< a pilot steers
    other,
};

/// One HEARTBEAT of the autopilot, with the landed state last received.
struct AutopilotReport {
    TimePoint stamp;
    AutopilotStack stack = AutopilotStack::unknown;
    FlightMode mode = FlightMode::unknown;
    std::uint32_t custom_mode = 0;  ///< as on the wire, to be restored later
    bool armed = false;
    bool landed = false;
    bool fixed_wing = false;
    bool steerable = true;  ///< a kind of vehicle that flies the velocities that Link sends in the external mode
    bool rebooted = false;  ///< its boot clock or sequence restarted since the last report
};

/// Own state. Fields not known keep their last value.
struct OwnStateReport {
    vehicle::VehicleState state;
    bool has_yaw = false;          ///< the heading was received within the last second
    bool estimator_reset = false;  ///< position jumped by a reset of the estimator
};

/// How the height of another aircraft was measured.
enum class HeightSource : std::uint8_t {
    geometric,  ///< by satellites, or reported as exact
    pressure,   ///< pressure altitude without an own one: the air pressure at sea level is unknown
    compared,   ///< pressure altitude, compared with the own one
};

/// A report of another aircraft.
struct TrackReport {
    world::TrackId id = 0;
    TimePoint stamp;  ///< of validity: arrival less the time since last communication
    Vec3 position = Vec3::Zero();
    Vec3 velocity = Vec3::Zero();
    bool has_velocity = false;
    float radius = 0.0F;          ///< [m], 0: not given
    float sigma_position = 0.0F;  ///< [m], 0: not given
    float sigma_velocity = 0.0F;
    world::TrackSource source = world::TrackSource::adsb;
    bool at_rest = false;   ///< reported as a static obstacle (ADS-B emitter category point, cluster or line obstacle)
    bool unmanned = false;  ///< reports so, or is a vehicle like ours
    bool helpless = false;  ///< reports that it will not give way: disarmed, on the ground, in an emergency
    HeightSource height = HeightSource::geometric;
    /// All possible heights lie within this of `position` [m]. compared: the height as reported, and the height by the
    /// difference of pressures. geometric: above sea level and above the ellipsoid; 0: both are the same or unknown.
    float height_spread = 0.0F;
};

/// Track reports within one step: more than a line of 921600 baud carries in 20 ms to a board (kMaxTracks 32).
inline constexpr std::size_t kMaxTrackReports = kMaxTracks + kMaxTracks / 2;

inline constexpr std::size_t kMaxScanSectors = 72;

/// Horizontal range scan. Sector i is centred on yaw_first + i * increment (world frame, counter-clockwise), width
/// |increment|.
struct RangeScan {
    TimePoint stamp;
    float yaw_first = 0.0F;                       ///< [rad]
    float increment = 0.0F;                       ///< [rad], != 0; negative: clockwise
    float min_range = 0.0F;                       ///< [m]
    float max_range = 0.0F;                       ///< [m]
    std::uint16_t sensor = 0;                     ///< below kMaxScanSensors
    StaticVector<float, kMaxScanSectors> ranges;  ///< [m]; kNothing: clear; kUnknown: unknown
    static constexpr std::uint16_t kMaxScanSensors = 16384;
    static constexpr float kNothing = 1e9F;
    static constexpr float kUnknown = -1.0F;
};

/// Single range reading along a direction in the world frame.
struct RangeReading {
    TimePoint stamp;
    Vec3 direction = Vec3::UnitX();  ///< unit vector, world frame
    float range = 0.0F;              ///< [m]; RangeScan::kNothing beyond the sensor's reach
    float max_range = 0.0F;
    float half_angle = 0.0F;  ///< of the beam [rad]
    std::uint8_t sensor = 0;
};

/// Straight leg that the autopilot flies by itself, from its beginning.
struct LegReport {
    world::Leg leg;  ///< speed: ground speed of the mission, which the autopilot may not reach; 0: not given
};

/// What the autopilot's own parameters say about the vehicle. 0: not reported.
struct ReportedLimits {
    float acceleration = 0.0F;           ///< level [m/s2]
    float vertical_acceleration = 0.0F;  ///< [m/s2]
    float climb = 0.0F;                  ///< greatest rate [m/s]
    float descent = 0.0F;                ///< greatest rate [m/s]
    Seconds lag = 0.0F;                  ///< time constant of its velocity loop
};

inline constexpr std::size_t kParamNameLength = 16;
using ParamName = std::array<char, kParamNameLength>;  ///< padded with NUL, no terminator when full

enum class ParamRequestKind : std::uint8_t { read_by_name, read_by_index, list, set };
struct ParamRequest {
    ParamRequestKind kind = ParamRequestKind::list;
    ParamName name{};
    std::int16_t index = -1;
    float value = 0.0F;
    bool value_finite = true;
};

struct CommandRequest {
    std::uint16_t command = 0;
    std::array<float, 7> params{};  ///< NaN allowed: "not given"
    std::uint8_t from_system = 0;
    std::uint8_t from_component = 0;
};

enum class CommandResult : std::uint8_t {
    accepted = 0,
    temporarily_rejected = 1,
    denied = 2,
    unsupported = 3,
    failed = 4
};

/// The autopilot's answer to our mode request.
struct ModeAnswer {
    bool accepted = false;
    std::uint8_t result = 0;  ///< as on the wire
};

/// Positions of the pilot's sticks, as the autopilot receives them. Reports of a receiver that has lost its
/// transmitter, or that gives no state, are dropped.
struct SticksReport {
    bool from_radio = true;         ///< false: a joystick of a ground station
    std::array<float, 4> sticks{};  ///< share of half the travel, -1 to 1 and a little beyond; in the sender's order
};

/// All reports since the last tick. Filled by the link, emptied by the application. About 5 KiB.
struct Inbox {
    bool has_own_state = false;
    OwnStateReport own_state;  ///< as the autopilot estimates it
    bool has_bus_state = false;
    OwnStateReport bus_state;  ///< as a receiver on the sensor bus measures it
    bool has_autopilot = false;
    AutopilotReport autopilot;  ///< the newest
    /// Earlier ones of the same step that reported another mode, in order. When full, the last one is replaced.
    StaticVector<AutopilotReport, 3> earlier_autopilot;
    bool has_leg = false;
    LegReport leg;
    bool leg_lost = false;  ///< the autopilot flies to an unknown destination: earlier legs are no longer valid
    bool has_home = false;  ///< only if both home and the origin are known; a later report replaces the earlier
    Vec3 home = Vec3::Zero();
    bool has_limits = false;
    ReportedLimits limits;  ///< all that are known so far
    bool has_sticks = false;
    SticksReport sticks;               ///< the newest
    StaticVector<RangeScan, 4> scans;  ///< the newest of each sensor
    StaticVector<TrackReport, kMaxTrackReports> tracks;
    StaticVector<RangeReading, 16> readings;
    StaticVector<ParamRequest, 16> params;
    StaticVector<CommandRequest, 8> commands;
    StaticVector<ConstraintPart, 4> constraints;
    StaticVector<ModeAnswer, 4> mode_answers;
    StaticVector<LogAck, 4> log_acks;

    void clear() noexcept
    {
        has_sticks = has_limits = false;
        earlier_autopilot.clear();
        has_own_state = has_bus_state = has_autopilot = has_leg = leg_lost = has_home = false;
        own_state.estimator_reset = bus_state.estimator_reset = false;
        scans.clear();
        tracks.clear();
        readings.clear();
        params.clear();
        commands.clear();
        constraints.clear();
        mode_answers.clear();
        log_acks.clear();
    }
};

}  // namespace jink::link
