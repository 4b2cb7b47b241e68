// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "core/base/time.hpp"
#include "core/base/vec3.hpp"

namespace jink::vehicle {

/// Own state at `stamp`, world frame (ENU).
struct VehicleState {
    TimePoint stamp;
    Vec3 position = Vec3::Zero();  ///< [m]
    Vec3 velocity = Vec3::Zero();  ///< [m/s]
    float yaw = 0.0F;              ///< [rad], counter-clockwise from east
    float sigma_position = 0.0F;   ///< one standard deviation per axis [m]; 0 where the autopilot gives none
    float sigma_velocity = 0.0F;   ///< [m/s]
};

enum class VehicleKind : std::uint8_t { multirotor, fixed_wing };

/// Limits of the vehicle. Defaults: Pinheiro's default vehicle (tab. 1.1); own values ("ours") where Pinheiro gives
/// none.
struct VehicleLimits {
    VehicleKind kind = VehicleKind::multirotor;
    float cruise_speed = 5.0F;               ///< [m/s], > 0
    float max_climb = 3.0F;                  ///< rate of climb [m/s], > 0
    float max_descent = 3.0F;                ///< rate of descent [m/s], > 0; ours, Pinheiro has one limit for both
    float max_acceleration = 5.0F;           ///< horizontal, and the deceleration when braking [m/s2], > 0; ours
    float max_vertical_acceleration = 3.0F;  ///< [m/s2], > 0; ours
    float velocity_lag = 0.25F;              ///< time constant of the autopilot's velocity loop [s], >= 0; ours
    Vec3 half_extents = Vec3::Ones();  ///< safety box, world-aligned [m], > 0: body, position and tracking uncertainty
};

/// The same limits with a safety box that is larger by `extra` [m] to every side.
[[nodiscard]] inline VehicleLimits widened(VehicleLimits limits, float extra) noexcept
{
    limits.half_extents += Vec3::Constant(extra);
    return limits;
}

/// Parameters of the costs beyond the limits (Pinheiro tab. 1.1 and 4.5).
struct Airframe {
    float mass = 3.0F;              ///< [kg]
    float drag_coefficient = 0.5F;  ///< [-]
    float effective_area = 2.5F;    ///< [m2]
    float blades = 2.0F;            ///< per rotor
    float chord = 0.035F;           ///< of a blade [m]
    float rotor_radius = 0.1905F;   ///< [m]
    float rotors = 4.0F;
    float air_density = 1.225F;             ///< [kg/m3]
    float blade_drag_coefficient = 0.012F;  ///< of a blade's section [-]; ours. Pinheiro reads the body's 0.5 here
    float tip_speed = 100.0F;  ///< of a blade in hover [m/s]; ours. Pinheiro takes its bound, 0.8 of the speed of sound
};

/// The limits of a vehicle that flies at `velocity`. A fixed wing keeps its own airspeed, so its cruise speed becomes
/// its present level speed. Below half of its cruise speed, and for a multirotor, the limits are unchanged. O(1).
[[nodiscard]] VehicleLimits limits_in_flight(const VehicleLimits& limits, const Vec3& velocity) noexcept;

/// Velocity along `direction` (any length > 0) at `speed`. If the vertical component exceeds the climb or descent
/// limit, the whole vector is scaled down, so that the direction stays (Pinheiro eq. 3.11, 3.12). Zero direction gives
/// zero. O(1).
[[nodiscard]] Vec3 clamped_velocity(const Vec3& direction, float speed, const VehicleLimits& limits) noexcept;

/// Speeds below this count as standstill [m/s]: a first-order loop never stops entirely.
inline constexpr float kStandstillSpeed = 0.05F;

/// Distance to stop from the horizontal speed `speed` [m/s] >= 0 on the command zero, as `advance` flies it: full
/// deceleration, then the loop's lag. Includes the whole decay to speed 0. O(1).
[[nodiscard]] float stopping_distance(float speed, const VehicleLimits& limits) noexcept;
/// Time until the vehicle is slower than kStandstillSpeed on the command zero. O(1).
[[nodiscard]] Seconds stopping_time(float speed, const VehicleLimits& limits) noexcept;
/// From any velocity, level and vertically, each with its own deceleration. O(1).
[[nodiscard]] Seconds stopping_time(const Vec3& velocity, const VehicleLimits& limits) noexcept;

/// One step of the vehicle model used for prediction. Velocity follows `command` with the loop's lag (first order). Its
/// change is bounded by the acceleration limits (horizontally as a vector, vertically by itself), and the command's
/// climb and descent are bounded. A fixed wing flies the course of the command at cruise speed, whatever the command's
/// speed. A level command below 1 m/s has no course: the wing keeps its own course. In a turn the model cuts the corner
/// between the two velocities: it is slower there than a wing (0.87 of the speed at most in 60 degrees).
///
/// Integrated in closed form, position too: a step of 2 dt equals two steps of dt, for any dt > 0 (float rounding). The
/// stamp advances by dt. O(1), two exponentials.
void advance(VehicleState& state, const Vec3& command, const VehicleLimits& limits, Seconds dt) noexcept;

/// Whether all fields are finite and within the ranges stated above.
[[nodiscard]] bool is_valid(const VehicleLimits& limits) noexcept;
[[nodiscard]] bool is_valid(const Airframe& airframe) noexcept;

}  // namespace jink::vehicle
