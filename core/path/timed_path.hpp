// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>

#include "core/base/static_vector.hpp"
#include "core/capacity.hpp"
#include "core/vehicle/vehicle.hpp"

namespace jink::path {

/// A point of a timed path. The velocity holds from this point's time to the next one's, so the motion is piecewise
/// straight: position(i+1) = position(i) + velocity(i) * (time(i+1) - time(i)). The last point repeats its
/// predecessor's velocity.
struct PathPoint {
    Vec3 position = Vec3::Zero();  ///< [m]
    Vec3 velocity = Vec3::Zero();  ///< [m/s]
    Seconds time = 0.0F;           ///< since the start of the path, strictly increasing [s]
};

/// kMaxPathPoints * 28 bytes + counter.
struct TimedPath {
    StaticVector<PathPoint, kMaxPathPoints> points;

    [[nodiscard]] Seconds duration() const noexcept { return points.empty() ? 0.0F : points.back().time; }
};

struct PathSample {
    Vec3 position = Vec3::Zero();
    Vec3 velocity = Vec3::Zero();
};

/// Position and velocity at time `t` after the path's start; before the start those of the first point, past the end
/// those of the last point. Path not empty. O(log points).
[[nodiscard]] PathSample sample(const TimedPath& path, Seconds t) noexcept;

/// Sum of segment lengths [m]. O(points).
[[nodiscard]] float arc_length(const TimedPath& path) noexcept;

/// Fills `out` with the points `positions` (2..kMaxPathPoints, first at t = 0), with velocities and times by Pinheiro's
/// rule (`clamped_velocity` at `speed` > 0 along each segment; 3.3). Drops a point nearer than 1e-6 m to the last kept
/// one, or so near that its time would not differ in float. False, with `out` empty, when fewer than two points remain
/// or there are too many. O(points).
[[nodiscard]] bool make_timed_path(std::span<const Vec3> positions, float speed, const vehicle::VehicleLimits& limits,
                                   TimedPath& out) noexcept;

}  // namespace jink::path
