// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/path/timed_path.hpp"

namespace jink::path {

/// Gains of the follower.
struct FollowerGains {
    float position_gain = 1.0F;   ///< [1/s] on the position error; 1 / (4 lag) damps a first-order vehicle critically
    float max_correction = 2.0F;  ///< bound of the correction [m/s]
};

/// Planners predict candidates with a command at least this often [s] until the vehicle has found the path. The chosen
/// path is checked with set-points as they are sent (prediction.hpp).
inline constexpr Seconds kFollowerPeriod = 0.1F;

/// Velocity command [m/s] that keeps a vehicle on a timed path: the path's velocity one loop lag ahead, blended across
/// the path's corners, plus a bounded correction of the position error. Climb and descent stay within limits. The speed
/// stays within cruise speed, or the path's speed where the mission flies faster: a faster command is scaled down and
/// keeps its direction. So a vehicle that is late on a path at cruise speed stays late. The time-aware check relies on
/// the planned position at the planned time; so the follower tracks time, not only the line. Past the end: the end
/// point is held (velocity 0 + correction). Path not empty. O(log points).
///
/// Accuracy, measured with the vehicle model (tests/property/core/path) on curves of 25 points, for a vehicle with a
/// lag of up to 0.4 s. At 0.9 of cruise speed the vehicle stays within 0.25 m of the timed point on curves that use at
/// most half of the acceleration limits, and within 0.4 m on curves that use all of them. At cruise speed the distances
/// are 0.4 m and 0.95 m.
[[nodiscard]] Vec3 follow(const TimedPath& path, Seconds t, const Vec3& position, const vehicle::VehicleLimits& limits,
                          const FollowerGains& gains) noexcept;

/// The flight from `state` while `command` is held for `horizon` > 0 seconds; a zero command brakes. Steps of `dt`
/// (exact at each point), the last step shortened, or until `out` is full. Between two points the flight leaves the
/// chord by max_acceleration * dt^2 / 8 at most, which prediction.hpp states chord by chord. O(steps).
void predict_velocity_command(const vehicle::VehicleState& state, const Vec3& command, Seconds horizon, Seconds dt,
                              const vehicle::VehicleLimits& limits, TimedPath& out) noexcept;

}  // namespace jink::path
