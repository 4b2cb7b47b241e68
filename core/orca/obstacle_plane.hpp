// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <limits>
#include <span>

#include "core/base/static_vector.hpp"
#include "core/base/time.hpp"
#include "core/base/work_budget.hpp"
#include "core/capacity.hpp"
#include "core/geometry/hull_distance.hpp"
#include "core/orca/half_space.hpp"
#include "core/world/world.hpp"

// Velocities that keep clear of static obstacles: one half-space for each of them, tangent to what it
// forbids at its nearest point (Alejo 7.19-7.25, theorem 7.2.1). The vehicle's envelope is an ellipsoid of revolution;
// space is stretched along z until it is a sphere (Alejo 7.29-7.31), and half-spaces are mapped back.

namespace jink::orca {

struct ObstacleSettings {
    float horizontal = 1.1F;       ///< least distance of the vehicle's centre from any obstacle, level [m], > 0
    float vertical = 0.8F;         ///< and upright [m], > 0
    bool covers_cylinder = false;  ///< keep the cylinder of these sizes, not only the ellipsoid in it: sqrt(2) of both
    Seconds horizon = 2.4F;        ///< no obstacle is met for so long [s], > 0
    float recovery_speed = 0.3F;   ///< out of an obstacle's margin, at most [m/s], >= 0
    Seconds recovery_time = 1.0F;  ///< and in about so long [s], > 0
    /// What the vehicle can brake with [m/s2]; above 0, half-spaces also bound the speed from which it can still stop
    /// before the margin. 0: they do not.
    float braking = 0.0F;
    Seconds delay = 0.0F;      ///< until a command has an effect, for `braking` [s], >= 0
    float resolution = 1e-4F;  ///< of distances [m], > 0
};

/// Finite and in the ranges above, and the stretch (horizontal / vertical) in [0.5, 4].
[[nodiscard]] bool is_valid(const ObstacleSettings& settings) noexcept;

/// The ellipsoid as a sphere in the stretched space.
struct Envelope {
    float stretch = 1.0F;  ///< of z
    float radius = 0.0F;   ///< [m]
};
[[nodiscard]] Envelope envelope_of(const ObstacleSettings& settings) noexcept;

/// Obstacles at rest, by their `solid`, which may be in the way. What is not known of the own place is in the envelope.
/// The `source` of what comes from an obstacle is its place among them.
using Obstacles = std::span<const world::Threat>;

/// The vehicle at the planning instant.
struct OwnMotion {
    Vec3 position = Vec3::Zero();  ///< [m]
    Vec3 velocity = Vec3::Zero();  ///< [m/s]
    float reach_speed = 0.0F;      ///< no velocity that is asked for is faster [m/s], >= 0
};

/// Half-spaces of everything within reach, nearest first.
struct ObstaclePlanes {
    StaticVector<HalfSpace, kMaxObstaclePlanes> planes;
    /// Not every obstacle has a half-space of its own: velocities have to be no faster than this [m/s] beside the
    /// planes, which then keeps clear of all others. Infinite when nothing was dropped.
    float speed_cap = std::numeric_limits<float>::infinity();
    /// Of the nearest obstacle: its distance in the stretched space less the envelope's radius [m], infinite when
    /// nothing is within reach; below 0 in its margin.
    float margin = std::numeric_limits<float>::infinity();
    std::uint16_t nearest = 0;  ///< its source
    bool truncated = false;     ///< there is a speed cap: more obstacles than planes, or the budget ran out
    bool penetrating = false;   ///< the vehicle's envelope meets some obstacle
    bool bounded = false;       ///< of some obstacle less than its distance is proven (searches that were cut short)
};

/// The half-space of one obstacle that lies at `distance` [m] (a lower bound) and more along `direction` (unit vector),
/// in the space stretched for `envelope`.
///
/// Outside of the margin: x' . direction <= (distance - radius) / horizon, x' the stretched velocity: no admitted one
/// comes within the envelope of the obstacle before `horizon`, whatever else that looks like (theorem 7.2.1). In it:
/// away from the obstacle, at `recovery_speed` or what takes `recovery_time`. Continuous where both meet, unlike
/// Alejo 7.19, which says nothing there and turns round beyond. Rounding below 1e-6 * (distance + radius) / horizon.
/// O(1).
[[nodiscard]] HalfSpace obstacle_half_space(float distance, const Vec3& direction, const Envelope& envelope,
                                            const OwnMotion& own, const ObstacleSettings& settings) noexcept;

/// How far away obstacles are checked, in the stretched space [m]: none beyond gives a half-space that any velocity
/// within `own.reach_speed` could violate.
[[nodiscard]] float obstacle_reach(const Envelope& envelope, const OwnMotion& own,
                                   const ObstacleSettings& settings) noexcept;

/// Half-spaces of all obstacles within reach.
///
/// Each keeps to `obstacle_half_space` with a distance that is proven, never above the true one. A half-space that
/// another one implies for all velocities within `own.reach_speed` is left out. Where the nearest kMaxObstaclePlanes do
/// not do, or `budget` runs out, `speed_cap` does for the rest, down to standstill.
/// O(obstacles * (kMaxDistanceTurns * vertices + kMaxObstaclePlanes)) at worst.
[[nodiscard]] ObstaclePlanes obstacle_planes(Obstacles obstacles, const OwnMotion& own,
                                             const ObstacleSettings& settings, WorkBudget& budget) noexcept;

}  // namespace jink::orca
