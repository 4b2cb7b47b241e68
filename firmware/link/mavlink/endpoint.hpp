// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "firmware/link/link.hpp"
#include "firmware/link/mavlink/clock_sync.hpp"
#include "firmware/link/mavlink/encoder.hpp"
#include "firmware/link/mavlink/geodesy.hpp"
#include "firmware/link/mavlink/limit_requests.hpp"
#include "firmware/link/mavlink/messages.hpp"
#include "firmware/link/mavlink/mission_client.hpp"
#include "firmware/link/mavlink/modes.hpp"
#include "firmware/link/mavlink/neighbours.hpp"
#include "firmware/link/mavlink/parser.hpp"
#include "firmware/link/mavlink/plane_steering.hpp"
#include "firmware/link/mavlink/stream_requests.hpp"
#include "firmware/link/mavlink/transmit_buffer.hpp"
#include "firmware/link/sensor_slots.hpp"
#include "firmware/link/track_ids.hpp"

// MAVLink side of link::Link: NED/FRD and degE7 in, ENU and metres out, and back. docs/guides/messages.md is the
// reference for users. Handling of each message:
//
// * We are component 196 (OBSTACLE_AVOIDANCE), type 18, autopilot 8, of the autopilot's own system id (learned from its
//   first HEARTBEAT, component 1, unless EndpointOptions::system_id fixes it). Before that only HEARTBEAT is sent, as
//   system 1. Own state, modes and legs are accepted from that autopilot alone; ranges from any component of our
//   system. Transponders' traffic is accepted from any component of any system but the autopilots (component 1) of
//   other systems, whose receivers hear us too (traffic_relayed counts other systems' traffic).
// * Own state: LOCAL_POSITION_NED (position, velocity), ATTITUDE_QUATERNION or ATTITUDE (yaw), ODOMETRY (all of it:
//   velocity in its child frame rotated by q, sigmas from the covariances unless NaN, reset_counter; frame_id other
//   than LOCAL_NED is out_of_range). ODOMETRY wins while it is younger than 0.2 s. Stamps are mapped by ClockSync;
//   older than max_stamp_age or from the future: stale_stamp. The wrap of time_boot_ms after 49.7 days is handled.
// * ClockSync: TIMESYNC requests once a second, lowest-round-trip filter, fallback to the least one-way delay observed.
//   Re-locks are counted (clock_relocks). A re-lock backwards counts as the autopilot's restart: origin, mission and
//   own state are discarded. We answer the autopilot's TIMESYNC requests.
// * Origin of the local frame: GPS_GLOBAL_ORIGIN; else GLOBAL_POSITION_INT less LOCAL_POSITION_NED, both extrapolated
//   to one time and 0.2 s apart at most. Until known, ADSB_VEHICLE counts no_origin. Local plane: north = dlat * R,
//   east = dlon * R cos(lat0), R = 6378137 m, from int32 differences (the wrap at 180 degrees is handled). Above 85
//   degrees of latitude there is no origin. A new origin moves home, the mission leg and the traffic that waits in the
//   inbox; reports that the application has read before are its own responsibility.
// * Home: latitude, longitude and altitude of HOME_POSITION, placed by the origin; not reported before both are known.
//   Its local x, y, z are ignored: ArduPilot sends zeros, wherever home is. If origin and home do not come, they are
//   requested by COMMAND_LONG REQUEST_MESSAGE (512), 2 s after the first HEARTBEAT and every 4 s.
// * ADSB_VEHICLE: flags say which fields are valid (coordinates 1, altitude 2, heading 4, velocity 8, vertical velocity
//   128). Without coordinates and altitude: out_of_range; without vertical velocity: level, with a noise of 5 m/s.
//   emitter_type 19 (point obstacle): at_rest, velocity zero; 14 (UAV): unmanned. Ids: track_ids.hpp.
//   Stamp = now - tslc (the application subtracts the assumed latency). altitude_type 1 is geometric: senders differ in
//   whether it is above sea level or above the ellipsoid. If the undulation is known (GPS_RAW_INT of the autopilot with
//   a 3D fix, alt_ellipsoid not 0, at most 120 m apart; the last one counts, however old) the report covers both
//   possible heights (geoid.hpp); until then the altitude as reported. 0 and all others are pressure altitudes. Senders
//   differ in whether these refer to the standard 1013.25 hPa or to QNH. If our own pressure altitude is known
//   (SCALED_PRESSURE not older than 10 s, beside own height), the report covers both possible heights: the altitude as
//   reported and our own height plus the difference of pressure altitudes (HeightSource::compared).
// * GLOBAL_POSITION_INT of other systems' autopilots (component 1): a track by its system id. Stamped by that system's
//   boot clock (Neighbours). Latitude and longitude 0: out_of_range. helpless while its last HEARTBEAT says disarmed.
//   Their LOCAL_POSITION_NED is ignored: it is relative to an origin of their own.
// * UTM_GLOBAL_POSITION of any sender but our autopilot, whose uas_id is our own name: a track by its uas_id, or by
//   sender without one. Own name, from any sender: own_heard. Without position or altitude (flags 4, 8): out_of_range;
//   velocity as flags 32 and 64 say, h_acc, v_acc and vel_acc as standard deviations. flight_state 2, 16, 32: helpless.
//   Its heights are above the ellipsoid. They are converted to sea level by the two altitudes of our GPS_RAW_INT, and
//   are uncertain by 36 m without it. Stamp = now.
// * OBSTACLE_DISTANCE frame 0, 1 (north-up) and 12 (body, rotated by a yaw not older than 1 s, else no_origin);
//   increment_f over increment; an increment below half a degree is out_of_range; 65535 unknown; > max: clear; below
//   min_distance means "nearer than that" and is kept as min_distance. A second scan within a tick replaces the first
//   (inbox_full). DISTANCE_SENSOR orientations 0-7 (by yaw, as above), 24, 25. From ArduPilot's proximity library (the
//   autopilot, ids 10 to 19): a distance at max_distance means clear, and a level field of view of 0 is a sector of 45
//   degrees.
// * OBSTACLE_DISTANCE_3D, if there is a sink for points: frame 12 (body, levelled by a roll and pitch not older than
//   0.3 s) and 1 (a position in the local frame, made relative by own position and yaw), else no_origin; other frames
//   are out_of_range. Farther than max_distance: clear in that direction; nearer than min_distance: at min_distance. A
//   scan is all points with one time stamp and sensor_type, and ends with the next scan or a pause of 0.05 s.
// * Leg: the flight to the mission's current item; endpoint_mission.cpp. Reported while armed and in the mission mode
//   and in an external mode that follows the mission mode directly (ours); lost in any other mode.
//   Start: the own position when the item, its place or the mode changes, or on arming, in that external mode too:
//   ArduCopter flies from its own position when an item starts or AUTO resumes. Or the end of the former leg, if
//   MISSION_ITEM_REACHED reports that it was reached, within 15 m (PX4's acceptance radius is 10 m): both stacks then
//   fly along the line between the items.
//   End: WAYPOINT (16): its place. LOITER_UNLIM, LOITER_TIME (17, 19) of a copter: their place, until within 3 m. LAND
//   (21) of a copter: level to above its place, until within 3 m. TAKEOFF (22) of a copter: straight up to its height;
//   PX4 goes on to its place afterwards. An altitude of 0 means the present one to ArduPilot. The leg to any other item
//   is unknown: LOITER_TURNS, LOITER_TO_ALT, SPLINE_WAYPOINT, RTL, circles of a plane, items without a place of their
//   own, above terrain, or that cannot be placed yet. Frames: 0, 3, 5, 6 (global, or relative to home) and 1.
//   POSITION_TARGET_LOCAL_NED is ignored: PX4 sends its controller's set-point, ArduCopter (0, 0, 0) during a take-off
//   in GUIDED.
// * Sticks: channels 1 to 4 of RC_CHANNELS (1000 to 2000 us), and MANUAL_CONTROL. A report is ignored as a whole, not
//   counted, when it has fewer than four channels, one of the four is 0, 65535 or outside of 800 to 2200 us, or the
//   third is below 1000 us: receivers report a lost transmitter in this way (ArduPilot's FS_THR_VALUE). rssi is
//   ignored: many receivers do not give any. MANUAL_CONTROL: beyond +-1000 (INT16_MAX: no such axis) likewise.
// * Rates: messages that come too seldom are requested by COMMAND_LONG SET_MESSAGE_INTERVAL (511), see StreamRequests.
// * Limits: the parameters that limit what a multirotor flies in the external mode are read from the autopilot by
//   PARAM_REQUEST_READ, see LimitRequests. PARAM_VALUE counts from the autopilot alone, of type REAL32.
// * Modes as in docs/guides/take_over.md; requests by COMMAND_LONG DO_SET_MODE (176), base mode 1 plus the armed bit
//   (128) as received. A HEARTBEAT is requested by COMMAND_LONG REQUEST_MESSAGE (512) with param1 = 0: both stacks send
//   it at once, and answer ACCEPTED. SET_MESSAGE_INTERVAL of HEARTBEAT is refused by PX4.
// * Vehicles that follow velocity set-points: multirotors and helicopters of both stacks, and a VTOL of PX4 while
//   EXTENDED_SYS_STATE reports hover. ArduPlane accepts guided points (below) while EXTENDED_SYS_STATE reports no VTOL.
//   All others are reported as not steerable: QuadPlanes, PX4's fixed wing, rovers, boats, submarines, trackers,
//   airships and vehicles of unknown type.
// * COMMAND_LONG and PARAM_* addressed to us alone are passed on, PARAM_REQUEST_LIST to all components too. A PARAM_SET
//   that is not a finite REAL32 has value_finite = false.
// * TUNNEL addressed to us alone, of the type kConstraintPayload: one closed area of a set (constraint_message.hpp). A
//   malformed payload is answered at once, and counts out_of_range; every other part is passed on.
// * LOGGING_ACK addressed to us alone is passed on. A part of a log goes out as LOGGING_DATA, or as LOGGING_DATA_ACKED
//   where it has to be acknowledged.
// * AUTOPILOT_VERSION on request: MAV_PROTOCOL_CAPABILITY_MAVLINK2 and PARAM_ENCODE_C_CAST, the version as four bytes
//   (major, minor, patch, FIRMWARE_VERSION_TYPE_DEV). All other fields are 0: there is no middleware, system or id.
// * SETUP_SIGNING (256) addressed to us alone: sets another key, or removes the key if the key is zeros and the time 0.
//   Accepted if the owner stores keys, while the autopilot is disarmed, and, if a key is set, only when signed with it.
//   The answer is a text; the message has no other. Counted: keys_set, keys_refused.
// * Set-points: SET_POSITION_TARGET_LOCAL_NED frame 1, mask 0x0DC7, to the autopilot. To ArduPlane: COMMAND_INT
//   DO_REPOSITION (192), frame 5, param1 = -1, param2 to param4 = 0 (no change of mode, own loiter radius, clockwise),
//   at most every 0.5 s, while its HEARTBEAT shows GUIDED and the origin is known (PlaneSteering). After an answer
//   DENIED the next point is nearer.
// * A line that has been silent for 0.1 s in mid-frame: the pending bytes are searched once more (Parser::flush).

namespace jink::link::mavlink {

struct EndpointOptions {
    std::uint8_t system_id = 0;  ///< 0: that of the first autopilot received
    std::uint8_t component_id = 196;
    float max_stamp_age = 1.0F;  ///< older own-state stamps are refused [s]
};

/// See the head of this file. Memory: about 6 KiB, most of it the transmit buffer, and 20 bytes per mission item. The
/// parser counts refused frames, `diagnostics` refused reports.
class Endpoint final : public Link {
public:
    /// Several times the longest burst of one step (a heartbeat, a set-point, texts, three parameters).
    static constexpr std::size_t kTransmitBytes = 4096;

    explicit Endpoint(const EndpointOptions& options = {}, Signing* signing = nullptr) noexcept;

    void receive(std::span<const std::byte> bytes, TimePoint now, Inbox& inbox) noexcept override;
    void service(TimePoint now) noexcept override;
    void ask_for_rates(bool on) noexcept override { asks_for_rates_ = on; }
    void report_points_to(CloudSink& sink) noexcept override { points_to_ = &sink; }

    [[nodiscard]] std::span<const std::byte> pending() const noexcept override { return transmit_.pending(); }
    void consume(std::size_t n) noexcept override { transmit_.consume(n); }
    void discard_pending() noexcept override
    {
        diagnostics_.bytes_discarded += static_cast<std::uint32_t>(transmit_.pending().size());
        transmit_.clear();
    }
    void drop_setpoint() noexcept override { take_back(Perishable::setpoint); }
    void drop_mode_request() noexcept override { take_back(Perishable::mode_request); }

    void send_heartbeat(SystemState state) noexcept override;
    void send_velocity(const Vec3& velocity, TimePoint now) noexcept override;
    void send_collision(const CollisionWarning& warning) noexcept override;
    void send_text(Severity severity, std::string_view text) noexcept override;
    void send_param(const ParamName& name, float value, std::uint16_t index, std::uint16_t count) noexcept override;
    void acknowledge(const CommandRequest& request, CommandResult result) noexcept override;
    void acknowledge(const ConstraintPart& part, ConstraintResult result) noexcept override;
    [[gnu::cold]] void send_version(const Version& version) noexcept override;
    [[nodiscard, gnu::cold]] bool send_log(const LogPart& part) noexcept override;
    void request_external_mode() noexcept override;
    void request_mode(std::uint32_t custom_mode) noexcept override;
    void request_heartbeat() noexcept override;
    void request_hold_mode() noexcept override;
    /// O(bytes), and a SHA-256 per frame if frames are signed.
    [[nodiscard]] std::size_t compose_last_words(std::span<std::byte> out, bool hold,
                                                 std::string_view text) noexcept override;

    [[nodiscard]] std::optional<GlobalPosition> origin() const noexcept override
    {
        return origin_rank_ > 0 ? std::optional(origin_) : std::nullopt;
    }
    [[nodiscard]] std::optional<std::int32_t> undulation() const noexcept override { return undulation_; }
    [[nodiscard]] world::TrackId own_track() const noexcept override
    {
        return system_ != 0 ? track_of_system(system_) : 0;
    }
    [[nodiscard]] const LinkDiagnostics& diagnostics() const noexcept override { return diagnostics_; }
    [[nodiscard]] const ParserDiagnostics& parser_diagnostics() const noexcept { return parser_.diagnostics(); }
    /// 0 before the first autopilot.
    [[nodiscard]] std::uint8_t system_id() const noexcept { return system_; }
    [[nodiscard]] bool has_origin() const noexcept { return origin_rank_ > 0; }
    [[nodiscard]] bool has_home() const noexcept { return has_home_; }

private:
    struct Context {
        const Frame& frame;
        TimePoint now;
        Inbox& inbox;
    };

    void dispatch(const Context& c) noexcept;
    void dispatch_autopilot(const Context& c) noexcept;
    void dispatch_sensors(const Context& c) noexcept;
    void dispatch_requests(const Context& c) noexcept;

    void on_heartbeat(const Context& c) noexcept;
    void on_local_position(const Context& c) noexcept;
    void on_attitude(const Context& c) noexcept;
    void on_euler_attitude(const Context& c) noexcept;
    void on_odometry(const Context& c) noexcept;
    void on_global_position(const Context& c) noexcept;
    void on_origin(const Context& c) noexcept;
    void on_home(const Context& c) noexcept;
    [[nodiscard]] bool dispatch_mission(const Context& c) noexcept;
    template <class M>
    [[nodiscard]] bool asks_autopilot(const Frame& frame) const noexcept;
    void on_mission_current(const Context& c) noexcept;
    void on_mission_count(const Context& c) noexcept;
    void on_mission_item(const Context& c) noexcept;
    void on_mission_ack(const Context& c) noexcept;
    void on_mission_reached(const Context& c) noexcept;
    void on_status_text(const Context& c) noexcept;
    void on_command_ack(const Context& c) noexcept;
    void on_timesync(const Context& c) noexcept;
    void on_adsb(const Context& c) noexcept;
    void on_neighbour(const Context& c) noexcept;
    void on_gps(const Context& c) noexcept;
    void on_pressure(const Context& c) noexcept;
    void judge_height(const AdsbVehicle& m, TimePoint now, TrackReport& report) noexcept;
    [[nodiscard]] bool can_place(bool is_sound) noexcept;
    void on_utm(const Context& c) noexcept;
    [[nodiscard]] bool is_own(const Frame& frame, const UtmGlobalPosition& m, bool named) noexcept;
    void deliver(const TrackReport& report, Inbox& inbox) noexcept;
    void on_obstacle_distance(const Context& c) noexcept;
    void on_distance_sensor(const Context& c) noexcept;
    void on_point(const Context& c) noexcept;
    [[nodiscard]] bool make_level(const ObstacleDistance3d& m, TimePoint now, Vec3& point) noexcept;
    void follow_scan(const ObstacleDistance3d& m, TimePoint now) noexcept;
    void end_pausing_scan(TimePoint now) noexcept;
    void on_sticks(const Context& c) noexcept;
    void on_command(const Context& c) noexcept;
    void on_param(const Context& c) noexcept;
    void on_tunnel(const Context& c) noexcept;
    void on_setup_signing(const Context& c) noexcept;
    [[gnu::cold]] void on_limit(const Context& c) noexcept;
    [[gnu::cold]] void on_log_ack(const Context& c) noexcept;

    [[nodiscard]] bool from_autopilot(const Frame& frame) const noexcept;
    [[nodiscard]] bool for_us(std::uint8_t system, std::uint8_t component) const noexcept;
    void note(ClockEvent event) noexcept;
    [[nodiscard]] bool stamp_of(std::int64_t boot_us, TimePoint now, TimePoint& stamp) noexcept;
    void note_attitude(float roll, float pitch, float heading, TimePoint now) noexcept;
    [[nodiscard]] bool knows_yaw(TimePoint now) const noexcept;
    void set_origin(const std::optional<GlobalPosition>& origin, int rank, Inbox& inbox) noexcept;
    void place_home(Inbox& inbox) noexcept;
    void note_mode(FlightMode before, bool was_armed) noexcept;
    void note_others_transfer(bool upload, bool ended, TimePoint now) noexcept;
    [[nodiscard]] bool place_on_map(const MissionItem& item, Vec3& local) const noexcept;
    [[nodiscard]] bool place_height(const MissionItem& item, float& height) const noexcept;
    [[nodiscard]] bool find_goal(const MissionItem& item, Vec3& goal) noexcept;
    [[nodiscard]] bool find_takeoff_goal(const MissionItem& item, Vec3& goal) noexcept;
    [[nodiscard]] std::optional<world::Leg> find_leg(TimePoint now) noexcept;
    void anchor_leg(TimePoint now) noexcept;
    void settle_anchor() noexcept;
    void update_leg(Inbox& inbox, TimePoint now) noexcept;
    void ask_for_places(TimePoint now) noexcept;
    void service_mission(TimePoint now) noexcept;
    void deliver_own_state(Inbox& inbox, TimePoint stamp) noexcept;
    [[nodiscard]] CommandLong mode_command(std::uint32_t custom_mode) const noexcept;
    void send_mode(std::uint32_t custom_mode) noexcept;
    [[nodiscard]] bool takes_guided_points() const noexcept;
    void send_guided_point(const Vec3& velocity, TimePoint now) noexcept;
    /// A structure of a message, whose kind the code below does not know: once for all messages.
    struct Unsent {
        const std::byte* object;
        Layout layout;
        bool is_heartbeat;
    };
    template <Message M>
    [[nodiscard]] static Unsent unsent(const M& message) noexcept
    {
        return {
            reinterpret_cast<const std::byte*>(&message), {M::kInfo, M::kFields}, M::kInfo.id == Heartbeat::kInfo.id};
    }
    [[nodiscard]] std::size_t encode_as(const Unsent& message, std::uint8_t sequence,
                                        std::span<std::byte> out) noexcept;
    bool send_unsent(const Unsent& message, Perishable kind) noexcept;
    void ask_for_streams(TimePoint now) noexcept;
    void ask_for_limits(TimePoint now) noexcept;
    template <Message M>
    bool send(const M& message, Perishable kind = Perishable::no) noexcept
    {
        return send_unsent(unsent(message), kind);
    }
    void take_back(Perishable kind) noexcept;

    EndpointOptions options_;
    Signing* signing_;
    Parser parser_;
    TransmitBuffer<kTransmitBytes> transmit_;
    LinkDiagnostics diagnostics_;
    ClockSync clock_;
    MissionClient mission_;
    StreamRequests streams_;
    LimitRequests limits_;
    Neighbours neighbours_;
    bool asks_for_rates_ = false;
    std::uint8_t system_;
    std::uint8_t sequence_ = 0;
    TimePoint last_byte_;
    TimePoint last_timesync_;
    bool timesync_asked_ = false;

    AutopilotReport autopilot_;
    VehicleClass vehicle_class_ = VehicleClass::copter;
    std::uint8_t vtol_state_ = kVtolUnheard;  ///< MAV_VTOL_STATE
    PlaneSteering plane_;
    bool rebooted_ = false;

    vehicle::VehicleState own_;
    bool has_yaw_ = false;
    TimePoint yaw_heard_;
    float roll_ = 0.0F;   ///< received with the yaw [rad]
    float pitch_ = 0.0F;  ///< [rad]
    bool has_odometry_ = false;
    TimePoint last_odometry_;
    std::uint8_t reset_counter_ = 0;
    bool has_local_ = false;
    bool has_local_boot_ = false;  ///< local_boot_ms_ is the stamp of own_.position
    std::uint32_t local_boot_ms_ = 0;
    TimePoint local_heard_;

    int origin_rank_ = 0;  ///< 0 none, 1 own global less local position, 2 GPS_GLOBAL_ORIGIN
    GlobalPosition origin_;
    bool has_pressure_ = false;
    float height_over_pressure_ = 0.0F;  ///< own height less own pressure altitude [m]
    TimePoint pressure_heard_;
    std::optional<std::int32_t> undulation_;   ///< of the geoid over the ellipsoid, here [mm]
    std::array<std::uint8_t, 18> own_name_{};  ///< in traffic management; zeros: unknown
    bool has_home_on_globe_ = false;
    GlobalPosition home_on_globe_;
    bool has_home_ = false;  ///< both home and origin are known
    Vec3 home_ = Vec3::Zero();
    TimePoint places_asked_;

    bool is_mission_flown_ = false;  ///< in the mission mode, or in an external mode that followed it
    bool has_leg_ = false;           ///< as reported
    world::Leg leg_;
    bool has_anchor_ = false;
    Vec3 anchor_ = Vec3::Zero();  ///< start of the leg
    bool had_leg_ = false;        ///< leg_ started at this anchor
    TimePoint anchored_;
    std::uint32_t anchor_version_ = 0;
    std::uint16_t anchor_sequence_ = 0;
    bool is_goal_reached_ = false;  ///< of the anchored item: from there on it is not flown towards its place
    bool has_former_ = false;       ///< the leg that was flown before the present one, in the same mission
    Vec3 former_end_ = Vec3::Zero();
    std::uint16_t former_sequence_ = 0;
    bool has_reached_ = false;
    std::uint16_t reached_sequence_ = 0;
    TimePoint reached_;

    SensorSlots<kMavlinkSensors> range_sensors_;
    /// State of a scan of single points.
    bool is_scan_open_ = false;
    std::uint8_t scan_sensor_ = 0;
    std::uint8_t scans_in_step_ = 0;  ///< begun at last_point_
    std::uint32_t scan_boot_ms_ = 0;  ///< of its newest point
    float scan_max_range_ = 0.0F;     ///< [m]
    CloudSink* points_to_ = nullptr;
    TimePoint last_point_;
};

}  // namespace jink::link::mavlink
