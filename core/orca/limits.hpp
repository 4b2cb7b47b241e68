// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "core/base/vec3.hpp"
#include "core/orca/agent_plane.hpp"
#include "core/orca/half_space.hpp"

// What a vehicle can fly within one period, as spheres and half-spaces of velocities (Alejo 7.2.1), and whether
// settings fit to what it can fly.

namespace jink::orca {

/// A vehicle's limits; what is 0 and optional is not there. Periods are of the avoidance loop.
struct MotionLimits {
    float max_speed = 1.5F;           ///< [m/s], > 0
    float min_speed = 0.0F;           ///< [m/s], in [0, max_speed): a wing's
    float acceleration = 2.0F;        ///< [m/s2], > 0; across, where the two below are given
    float climb_acceleration = 0.0F;  ///< [m/s2] upwards, optional, with the next
    float sink_acceleration = 0.0F;   ///< [m/s2] downwards, optional
    float turn_radius = 0.0F;         ///< [m] at least, optional: heading changes by speed / radius
    float climb_rate = 0.0F;          ///< [m/s], optional
    float sink_rate = 0.0F;           ///< [m/s], optional
    float period = 0.025F;            ///< [s], > 0
};

/// Half-spaces of limits at most: the least speed, two of the turn, two of the climb.
inline constexpr std::size_t kMaxLimitPlanes = 5;

/// The limits' share of a program. The reference keeps to all of it, so it is never empty.
struct LimitSet {
    std::array<HalfSpace, kMaxLimitPlanes> planes{};
    std::size_t size = 0;
    /// The speed first (Alejo 7.17), then what one period's acceleration can reach (7.16).
    std::array<Sphere, 2> spheres{};
    Vec3 reference = Vec3::Zero();  ///< [m/s], clamped into the limits
    bool stalled = false;  ///< a least speed is asked for, but the reference has no direction across: it is left out

    [[nodiscard]] std::span<const HalfSpace> half_spaces() const noexcept { return {planes.data(), size}; }
};

/// The velocity that the next one is reached from: the last command, so that the loop and the vehicle's lag can not
/// wind each other up; the predicted velocity where both are apart by more than `most` [m/s].
struct Reference {
    Vec3 velocity = Vec3::Zero();
    bool resynchronised = false;  ///< the predicted one
};
[[nodiscard]] Reference reference_velocity(const Vec3& last_command, const Vec3& predicted, float most) noexcept;

/// `velocity` [m/s] within speed, climb and sink limits; finite input. The least speed is made up across.
[[nodiscard]] Vec3 clamped(const MotionLimits& limits, const Vec3& velocity) noexcept;

/// Spheres and half-spaces about the reference, which is clamped. The least speed, which is not convex, becomes the
/// half-space beyond it in the reference's direction; the turn, two upright half-spaces through 0 (left out below
/// kHover of speed across: what hovers turns on the spot). O(1).
[[nodiscard]] LimitSet limit_set(const MotionLimits& limits, const Vec3& reference) noexcept;
inline constexpr float kHover = 0.2F;  ///< [m/s]

/// From the greatest speed to a stand, across, up or down [s].
[[nodiscard]] Seconds braking_time(const MotionLimits& limits) noexcept;

/// Brings the speed sphere down to `cap` [m/s], or as far as one period's acceleration lets it. False where that is not
/// all the way. A least speed stays: it is a limit of flight.
[[nodiscard]] bool cap_speed(LimitSet& set, float cap) noexcept;

/// What settings are refused for; one cause each.
enum class Unsafe : std::uint8_t {
    none,
    not_positive,             ///< a limit, a horizon or a radius that is no number above zero
    regions,                  ///< the conflict region is not within the warning region
    stretch,                  ///< wider or higher than kMaxStretch of the other
    obstacle_horizon_brakes,  ///< too short to brake within it
    obstacle_horizon_delay,   ///< too short for the delay: it would overshoot
    horizon_brakes,           ///< the same between vehicles, the other one not giving way
    horizon_delay,
    ramp_gain,          ///< the separating speed grows too fast for the delay
    ramp_acceleration,  ///< it is more than one second's acceleration
    recovery_delay,     ///< the conflict region would be left too fast for the delay
    rest_brake,         ///< Conflict::at_rest: too short to brake within PairSettings::brake, or for the delay
};

/// Settings beside each other.
struct SafetyQuestion {
    MotionLimits limits;
    PairSettings pair;
    float across = 1.2F;            ///< warning region's half axes [m]
    float upright = 0.6F;           ///< [m]
    float obstacle_horizon = 2.4F;  ///< [s]
    float delay = 0.5F;             ///< [s] from sensing to flying, filters included
};
inline constexpr float kMaxStretch = 4.0F;
inline constexpr float kMinStretch = 0.5F;

/// Whether one period's limits let the vehicle stop in time later on: horizons of max_speed / acceleration for
/// obstacles and twice that between vehicles, and e delays each, below which a delayed loop overshoots. O(1).
[[nodiscard]] Unsafe check(const SafetyQuestion& question) noexcept;

/// The separating speed [m/s] at the conflict region's rim that the delay and the acceleration bear: 0.3 m/s at most.
[[nodiscard]] float ramp_speed_for(float across, float conflict_ratio, float delay, float acceleration) noexcept;

}  // namespace jink::orca
