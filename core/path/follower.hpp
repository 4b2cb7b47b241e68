// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/path/timed_path.hpp"

namespace jink::path {

/// How hard the follower pulls towards the timed point.
struct FollowerGains {
    float position_gain = 1.0F;   ///< [1/s] on the position error; 1 / (4 lag) damps a first-order vehicle critically
    float max_correction = 2.0F;  ///< bound of the correction [m/s]
};

/// The follower is taken to command at least this often [s]; predictions step no coarser inside.
inline constexpr Seconds kFollowerPeriod = 0.1F;

/// Velocity command [m/s] that keeps a vehicle on a timed path: the path's velocity one loop lag ahead, blended across
/// the path's corners, plus a bounded correction of the position error. Climb and descent are within limits, and the
/// whole is no faster than cruise speed, nor than the path where the mission flies faster: what would be faster is
/// shrunk and keeps its direction, so a vehicle that is late on a path at cruise speed stays late. Being where the plan
/// says, when it says, is what the time-aware check relies on; so this follows time, not only the line. Past the end:
/// the end point is held (velocity 0 + correction). Path not empty. O(log points).
///
/// Accuracy, measured with the vehicle model (tests/property/core/path): on curves of 25 points at 0.9 of cruise speed
/// that ask for at most half of the acceleration limits a vehicle with a lag of up to 0.4 s stays within 0.25 m of the
/// timed point, and within 0.4 m on those that ask for all of it; at cruise speed within 0.4 m and 0.95 m.
[[nodiscard]] Vec3 follow(const TimedPath& path, Seconds t, const Vec3& position, const vehicle::VehicleLimits& limits,
                          const FollowerGains& gains) noexcept;

/// What the vehicle will really fly: `follow` and the vehicle model stepped from `state` (taken as being at path time
/// `start`), in steps of `dt` > 0, to the end of the path or until `out` is full; the last step is shortened to end
/// with the path. out.points[0] is the present position at time 0. Each step is flown in sub-steps of kFollowerPeriod
/// at most; between two points of `out` the flight bends away from the chord by max_acceleration * dt^2 / 8 at most.
/// Path not empty. When nothing of the path is left, one point remains. O(steps * dt / kFollowerPeriod * log points).
void predict_flight(const vehicle::VehicleState& state, const TimedPath& path, Seconds start, Seconds dt,
                    const vehicle::VehicleLimits& limits, const FollowerGains& gains, TimedPath& out) noexcept;

/// Adds to `out`, which ends where `state` is, the flight from there on when `command` is held for `horizon` > 0
/// seconds: steps of `dt`, the last one shortened, or until `out` is full. The velocity of the point that it ends with
/// becomes that of its first step. O(steps).
void extend_by_velocity_command(const vehicle::VehicleState& state, const Vec3& command, Seconds horizon, Seconds dt,
                                const vehicle::VehicleLimits& limits, TimedPath& out) noexcept;

/// The flight from `state` when `command` is held for `horizon` > 0 seconds: brake when it is zero. As above, steps of
/// `dt` (exact at each point), the last one shortened, or until `out` is full. O(steps).
void predict_velocity_command(const vehicle::VehicleState& state, const Vec3& command, Seconds horizon, Seconds dt,
                              const vehicle::VehicleLimits& limits, TimedPath& out) noexcept;

}  // namespace jink::path
