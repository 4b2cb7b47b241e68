// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "core/base/vec3.hpp"
#include "core/orca/half_space.hpp"
#include "core/world/passing_side.hpp"

// What another vehicle leaves of the own velocities: half-spaces by optimal reciprocal collision avoidance (van den
// Berg, Guy, Lin, Manocha, "Reciprocal n-body collision avoidance"; Alejo 7.1), for ellipsoids (7.2.3) and with two
// regions around each vehicle (7.2.4). World frame, relative to the own vehicle.

namespace jink::orca {

/// The way out of a velocity obstacle that changes the relative velocity least: by `depth` along `normal`.
struct Exit {
    Vec3 normal = Vec3::UnitZ();  ///< unit length, out of the obstacle
    float depth = 0.0F;           ///< [m/s], positive within the obstacle, negative outside
};

/// The velocity obstacle {v : |t v - position| < radius for a t in (0, horizon]} is left by the shortest way.
///
/// @param position  of the other, less the own one [m]; |position| > radius
/// @param velocity  own one less the other's [m/s]: along `position` is closing
/// @param radius    distance of the centres that has to be kept [m], > 0
/// @param horizon   [s], > 0
///
/// The vector to the obstacle's nearest boundary point is depth * normal (Alejo 7.32, 7.33, van den Berg's u). On the
/// axis, where either side is as near, side() decides. The cone is taken by its own normal, not by the quadratic
/// equation that the public library solves: no root of a difference, nothing divided by the way to the axis. Error
/// below 1e-5 * (1 + |velocity|) for positions up to 1 km. O(1). Source: Alejo 7.1.
[[nodiscard]] Exit nearest_exit(const Vec3& position, const Vec3& velocity, float radius, float horizon) noexcept;

/// The same within the radius as the original has it: apart within one period [s] (Alejo 7.34, 7.35). For comparison:
/// its gain is that of one period, and separating() is what replaces it. |velocity - position / period| > 0.
[[nodiscard]] Exit original_exit(const Vec3& position, const Vec3& velocity, float radius, float period) noexcept;

/// A demand that the distance grows by `speed` [m/s] (Alejo 7.2.4's ramp). @param distance |position| [m]
/// @param above  whether the own vehicle is the one that goes up where both centres are the same point
[[nodiscard]] Exit separating(const Vec3& position, float distance, const Vec3& velocity, float speed,
                              bool above) noexcept;

using world::side;

/// The own share of a change of the relative velocity. Where the partner's is not known their sum has to be 1 at least
/// while somebody has to give way, and 1 at most while both use up what is left between them (from Alejo 7.8).
struct Weights {
    float react = 0.5F;  ///< in [0.5, 1]: within the obstacle; 1 for those that do not give way
    float slack = 0.5F;  ///< in [0, 0.5]: outside of it
};
inline constexpr Weights kShared{};
inline constexpr Weights kAlone{1.0F, 0.5F};

/// What the conflict region asks for while it is not entered.
enum class Conflict : std::uint8_t {
    /// The half-space about the present velocities, as for the warning region (Alejo 7.2.4).
    present,
    /// The half-space about rest: neither closes in by more than half of the gap in one `brake` time. It depends on
    /// the positions alone, holds whatever each does sideways, and leaves standing still to everyone: so where all
    /// vehicles obey it and can stop within one period, all conflict half-spaces hold at once, and no distance falls
    /// below the conflict region, however crowded it is. What it costs is speed within `brake` * 2 * speed of another.
    /// For others that do not give way it takes their velocity as it is, and the whole gap.
    at_rest,
};

/// What is demanded in the warning region.
enum class Ramp : std::uint8_t {
    speed,        ///< a separating speed that grows linearly from its rim to the conflict region
    interpolated  ///< for comparison: the original's two answers mixed, the nearest reading of Alejo 7.2.4
};

/// Rules for every pair; defaults for E_xy = 1.2 m and a delay of 0.5 s (Alejo table 8.1).
struct PairSettings {
    float horizon = 10.0F;        ///< [s] without a collision, > 0
    float conflict_ratio = 0.7F;  ///< conflict region's radius, of the warning region's; in (0, 1)
    float ramp_speed = 0.25F;     ///< [m/s] demanded at the conflict region's rim, >= 0; see limits.hpp
    float recovery_speed = 0.3F;  ///< [m/s] at most demanded within the conflict region, > 0
    float recovery_time = 1.4F;   ///< [s] in which the conflict region is left, > 0
    float brake = 0.25F;          ///< [s] of Conflict::at_rest, > 0: one period at least
    float period = 0.025F;        ///< [s] of Ramp::interpolated
    Conflict conflict = Conflict::present;
    Ramp ramp = Ramp::speed;
};

/// Another vehicle as seen from the own one.
struct Pair {
    Vec3 position = Vec3::Zero();        ///< of the other, less the own one [m]
    Vec3 own_velocity = Vec3::Zero();    ///< [m/s]
    Vec3 other_velocity = Vec3::Zero();  ///< [m/s]
    float across = 1.0F;                 ///< sum of both half widths [m], > 0: the warning region's radius
    float upright = 1.0F;                ///< sum of both half heights [m], > 0
    Weights weights = kShared;
    bool above = false;  ///< the own vehicle is the one to climb (world::climbs)
    /// Counts with the relative velocity where the side of the way out is chosen, and nowhere else [m/s]: towards the
    /// side on which both pass, as large as what an old report hides. The other one's is the opposite.
    Vec3 lean = Vec3::Zero();
    std::uint16_t source = 0;  ///< handed on to the half-spaces
};

/// Semi-axes of the region around a pair: an ellipsoid that holds every sum of the two (Alejo 7.29 - 7.31), or one that
/// holds the cylinder of the same widths too, so that "apart across or apart in height" is kept (sqrt(2) as wide).
inline constexpr float kCylinderCover = 1.41421356F;

/// Half-spaces of a pair.
struct PairPlanes {
    HalfSpace conflict;
    HalfSpace warning;
    float distance = 0.0F;  ///< between the centres, in the space where the region is a sphere [m]
};

/// Both half-spaces of a pair (Alejo 7.1 - 7.2.4): the warning region's gives way, the conflict region's gives way
/// after it. Heights are stretched until the region is a sphere, and the half-spaces brought back (Alejo 7.31), so
/// limits of speed and acceleration keep their meaning. Both sides of a pair get mirrored half-spaces: by the bit,
/// where their positions and velocities are. Input finite. O(1).
[[nodiscard]] PairPlanes pair_planes(const Pair& pair, const PairSettings& settings) noexcept;

/// The warning region's alone, as one region around a pair.
[[nodiscard]] HalfSpace pair_plane(const Pair& pair, const PairSettings& settings) noexcept;

/// Beyond this distance [m] of the centres, in the stretched space, no admissible velocities of the two collide within
/// the horizon: its half-space may be left out and nothing is lost. Speeds are the most each can fly [m/s].
[[nodiscard]] inline float reach(float radius, float horizon, float own_speed, float other_speed,
                                 float stretch) noexcept
{
    return radius + horizon * (own_speed + other_speed) * (stretch > 1.0F ? stretch : 1.0F);
}

/// The horizon [s] that is left where vehicles beyond `limit` [m] of the stretched space are left out all the same
/// (Alejo's neighbour distance, 7.3.2). At most `horizon`.
[[nodiscard]] float effective_horizon(float limit, float radius, float horizon, float own_speed, float other_speed,
                                      float stretch) noexcept;

}  // namespace jink::orca
