// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>

#include "core/vehicle/vehicle.hpp"

// The vehicle model of `advance`, inline for predictions that take it thousands of times. Private to rooms that
// predict.

namespace jink::vehicle::detail {

/// What is left of a velocity error after dt, less 1: e^(-dt / lag) - 1, remembered for the few lengths of steps that a
/// prediction takes. To the bit what it would be without memory. 64 bytes.
class Fading {
public:
    explicit Fading(float lag) noexcept : lag_(lag) {}

    /// dt > 0, lag > 0.
    [[nodiscard]] float operator()(Seconds dt) noexcept
    {
        const auto bits = std::bit_cast<std::uint32_t>(dt);
        Entry& entry = entries_[(bits ^ (bits >> 4)) % entries_.size()];
        if (entry.dt != dt) {
            entry = {dt, std::expm1(-dt / lag_)};
        }
        return entry.rest;
    }

private:
    struct Entry {
        Seconds dt = -1.0F;
        float rest = 0.0F;
    };
    std::array<Entry, 8> entries_;
    float lag_;
};

/// Size of a velocity error after dt, and its integral over dt.
struct Decay {
    float error = 0.0F;     ///< [m/s]
    float integral = 0.0F;  ///< [m]
};

/// An error that shrinks at rate min(error / lag, limit): a straight ramp down to limit * lag, an exponential from
/// there. Its direction stays, so one number says it all.
inline Decay decay(float error, float lag, float limit, Seconds dt, Fading& fading) noexcept
{
    const float knee = limit * lag;
    float integral = 0.0F;
    if (error > knee) {
        const Seconds ramp = (error - knee) / limit;
        if (ramp >= dt) {
            const float left = error - limit * dt;
            return {left, 0.5F * (error + left) * dt};
        }
        integral = 0.5F * (error + knee) * ramp;
        error = knee;
        dt -= ramp;
    }
    if (lag <= 0.0F) {
        return {0.0F, integral};
    }
    const float rest = fading(dt);  // in [-1, 0]
    return {error + error * rest, integral - error * lag * rest};
}

/// `advance` without its stamp. `fading`: made with limits.velocity_lag.
inline void move(Vec3& position, Vec3& velocity, const Vec3& command, const VehicleLimits& limits, Seconds dt,
                 Fading& fading) noexcept
{
    Vec3 goal = command;
    goal.z() = std::clamp(command.z(), -limits.max_descent, limits.max_climb);
    const Vec3 error = velocity - goal;

    const float horizontal = std::sqrt(error.x() * error.x() + error.y() * error.y());
    const Decay level = decay(horizontal, limits.velocity_lag, limits.max_acceleration, dt, fading);
    const Decay vertical =
        decay(std::abs(error.z()), limits.velocity_lag, limits.max_vertical_acceleration, dt, fading);
    const float per_metre = horizontal > 0.0F ? 1.0F / horizontal : 0.0F;
    const Vec3 direction(error.x() * per_metre, error.y() * per_metre, std::copysign(1.0F, error.z()));

    position += goal * dt + direction.cwiseProduct(Vec3(level.integral, level.integral, vertical.integral));
    velocity = goal + direction.cwiseProduct(Vec3(level.error, level.error, vertical.error));
}

}  // namespace jink::vehicle::detail
