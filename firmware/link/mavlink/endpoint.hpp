// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>

#include "firmware/link/link.hpp"

// MAVLink side of link::Link: NED/FRD and degE7 in, ENU and metres out, and back. Contract for the implementation:
//
// * We are component 196 (OBSTACLE_AVOIDANCE), type 18, autopilot 8, of the autopilot's own system id (learned from its first HEARTBEAT,
//   component 1, unless `Options::system_id` fixes it). Own state, modes and legs are taken from that autopilot alone; traffic
//   (ADSB_VEHICLE) and ranges from any component of our system.
// * Own state: LOCAL_POSITION_NED (position, velocity), ATTITUDE_QUATERNION (yaw), ODOMETRY (position, velocity in its child frame turned
//   by q, sigmas from the covariances when not NaN, reset_counter), stamps mapped from the boot clock by ClockSync. One of ODOMETRY and
//   LOCAL_POSITION_NED is enough; ODOMETRY with frame_id LOCAL_NED (1) or LOCAL_FRD refused as out_of_range when not 1.
// * ClockSync: TIMESYNC requests once a second, lowest-round-trip filter, fallback to the least one-way delay seen; a jump of more than
//   0.2 s seen three times in a row re-locks (clock_relocks), in between such stamps are refused as stale. We answer TIMESYNC requests.
//   time_boot_ms wraps after 49.7 days: handled modulo 2^32.
// * Origin of the local frame: GPS_GLOBAL_ORIGIN; else HOME_POSITION (its lat/lon/alt less its local x, y, z); else GLOBAL_POSITION_INT
//   less LOCAL_POSITION_NED when both are younger than 0.2 s. Until known, ADSB_VEHICLE counts no_origin. Local plane:
//   north = dlat * R, east = dlon * R cos(lat0), R = 6378137 m, from int32 differences (longitude wrap at 180 deg handled).
// * ADSB_VEHICLE: flags say which fields are valid (coordinates 1, altitude 2, heading 4, velocity 8, vertical velocity 128 - verify);
//   emitter_type 19, 20, 21 (point, cluster, line obstacle - verify): TrackReport::at_rest, velocity zero;
//   stamp = now - tslc (the application takes the assumed latency off). Without valid coordinates or altitude: out_of_range.
// * OBSTACLE_DISTANCE frame 0, 1 (north-up) and 12 (body, turned by yaw); increment_f over increment; zero increment refused; 65535 unknown; > max: nothing;
//   0..max: range (a value below min_distance means "nearer than min": kept as min_distance). DISTANCE_SENSOR orientations 0-7, 24, 25.
// * Leg: POSITION_TARGET_LOCAL_NED (position used, frame 1) while not in the external mode: from the position when it changed to the target;
//   mission items: MISSION_CURRENT tells the sequence number, then MISSION_REQUEST_LIST / MISSION_COUNT / MISSION_REQUEST_INT for seq - 1 and seq / MISSION_ACK;
//   frames 0, 3, 5, 6 (global, relative to home altitude) and 1; a mission leg wins over the position target.
// * Modes as in links.md "Taking over and giving back"; requests by COMMAND_LONG DO_SET_MODE (176), base mode 1 plus the armed bit (128) as heard.
// * COMMAND_LONG addressed to us (or to component 0 of our system): passed on; PARAM_* likewise. PARAM_SET with NaN: value_finite = false.
// * set-points: SET_POSITION_TARGET_LOCAL_NED frame 1, mask 0x0DC7, to the autopilot.

namespace jink::link::mavlink {

struct EndpointOptions {
    std::uint8_t system_id = 0;        ///< 0: that of the first autopilot heard
    std::uint8_t component_id = 196;
    float max_stamp_age = 1.0F;        ///< older own-state stamps are refused [s]
};

}  // namespace jink::link::mavlink
