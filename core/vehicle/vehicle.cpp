// SPDX-License-Identifier: BSD-3-Clause
#include "core/vehicle/vehicle.hpp"

#include <algorithm>
#include <cmath>

#include "core/base/exponential.hpp"
#include "core/base/finite.hpp"
#include "core/vehicle/motion.hpp"

namespace jink::vehicle {

VehicleLimits limits_in_flight(const VehicleLimits& limits, const Vec3& velocity) noexcept
{
    constexpr float kFlying = 0.5F;
    VehicleLimits flown = limits;
    const float speed = velocity.head<2>().norm();
    const bool flies = std::isfinite(speed) && speed >= kFlying * limits.cruise_speed;
    if (limits.kind == VehicleKind::fixed_wing && flies) {
        flown.cruise_speed = speed;
    }
    return flown;
}

Vec3 clamped_velocity(const Vec3& direction, float speed, const VehicleLimits& limits) noexcept
{
    const float largest = direction.cwiseAbs().maxCoeff();
    if (!(largest > 0.0F)) {
        return Vec3::Zero();
    }
    const Vec3 scaled = direction / largest;  // so that no square over- or underflows
    Vec3 velocity = scaled * (speed / scaled.norm());
    const float bound = velocity.z() > 0.0F ? limits.max_climb : limits.max_descent;
    const float vertical = std::abs(velocity.z());
    if (vertical > bound) {
        velocity *= bound / vertical;
        velocity.z() = std::copysign(bound, velocity.z());
    }
    return velocity;
}

float stopping_distance(float speed, const VehicleLimits& limits) noexcept
{
    const float knee = limits.max_acceleration * limits.velocity_lag;
    if (speed <= knee) {
        return speed * limits.velocity_lag;
    }
    return 0.5F * (speed + knee) * (speed - knee) / limits.max_acceleration + knee * limits.velocity_lag;
}

Seconds stopping_time(float speed, const VehicleLimits& limits) noexcept
{
    const float knee = std::max(limits.max_acceleration * limits.velocity_lag, kStandstillSpeed);
    const Seconds ramp = std::max(speed - knee, 0.0F) / limits.max_acceleration;
    const float rest = std::min(speed, knee);
    return rest > kStandstillSpeed ? ramp + limits.velocity_lag * natural_log(rest / kStandstillSpeed) : ramp;
}

Seconds stopping_time(const Vec3& velocity, const VehicleLimits& limits) noexcept
{
    VehicleLimits vertical = limits;
    vertical.max_acceleration = limits.max_vertical_acceleration;
    return std::max(stopping_time(velocity.norm(), limits), stopping_time(std::abs(velocity.z()), vertical));
}

void advance(VehicleState& state, const Vec3& command, const VehicleLimits& limits, Seconds dt) noexcept
{
    detail::Fading fading(limits.velocity_lag);
    detail::move(state.position, state.velocity, command, limits, dt, fading);
    state.stamp = state.stamp + dt;
}

bool is_valid(const VehicleLimits& limits) noexcept
{
    return is_positive(limits.cruise_speed) && is_positive(limits.max_climb) && is_positive(limits.max_descent) &&
           is_positive(limits.max_acceleration) && is_positive(limits.max_vertical_acceleration) &&
           is_not_negative(limits.velocity_lag) && is_finite(limits.half_extents) &&
           limits.half_extents.minCoeff() > 0.0F;
}

bool is_valid(const Airframe& airframe) noexcept
{
    return is_positive(airframe.mass) && is_not_negative(airframe.drag_coefficient) &&
           is_not_negative(airframe.effective_area) && is_not_negative(airframe.blade_drag_coefficient) &&
           is_positive(airframe.tip_speed) && is_positive(airframe.blades) && is_positive(airframe.chord) &&
           is_positive(airframe.rotor_radius) && is_positive(airframe.rotors) && is_positive(airframe.air_density);
}

}  // namespace jink::vehicle
