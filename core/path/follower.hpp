// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/path/timed_path.hpp"

namespace jink::path {

/// How hard the follower pulls towards the timed point.
struct FollowerGains {
    float position_gain = 1.0F;    ///< [1/s] on the position error
    float max_correction = 2.0F;   ///< bound of the correction [m/s]
};

/// Velocity command [m/s] that keeps a vehicle on a timed path: the path's velocity one loop lag ahead, plus a bounded correction
/// of the position error, climb and descent within limits. Being where the plan says, when it says, is what the time-aware
/// check relies on; so this follows time, not only the line. Past the end: the end point is held (velocity 0 + correction). O(log points).
[[nodiscard]] Vec3 follow(const TimedPath& path, Seconds t, const Vec3& position, const vehicle::VehicleLimits& limits,
                          const FollowerGains& gains) noexcept;

/// What the vehicle will really fly: `follow` and the vehicle model stepped from `state` (taken as being at path time
/// `start`), in steps of `dt`, to the end of the path or until `out` is full. out.points[0] is the present state at time 0.
/// O(steps * log points).
void predict_flight(const vehicle::VehicleState& state, const TimedPath& path, Seconds start, Seconds dt,
                    const vehicle::VehicleLimits& limits, const FollowerGains& gains, TimedPath& out) noexcept;

/// The flight from `state` when `command` is held for `horizon` seconds: brake when it is zero. As above, steps of `dt`.
void predict_velocity_command(const vehicle::VehicleState& state, const Vec3& command, Seconds horizon, Seconds dt,
                              const vehicle::VehicleLimits& limits, TimedPath& out) noexcept;

}  // namespace jink::path
