// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>

#include "core/base/exponential.hpp"
#include "core/vehicle/vehicle.hpp"

// The vehicle model of `advance`, inline for predictions that call it thousands of times. Private to modules that
// predict.

namespace jink::vehicle::detail {

/// Remaining share of a velocity error after dt, less 1: e^(-dt / lag) - 1. Values are cached for the few step lengths
/// of a prediction; results are the same to the bit without the cache. 64 bytes.
class Fading {
public:
    explicit Fading(float lag) noexcept : lag_(lag) {}

    /// dt > 0, lag > 0.
    [[nodiscard]] float operator()(Seconds dt) noexcept
    {
        const auto bits = std::bit_cast<std::uint32_t>(dt);
        Entry& entry = entries_[(bits ^ (bits >> 4)) % entries_.size()];
        if (entry.dt != dt) {
            entry = {dt, -faded_share(dt / lag_)};
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

/// Change of a velocity error over dt, as shares of the error: its direction stays.
struct Decay {
    float left = 0.0F;      ///< after dt, of the error
    float integral = 0.0F;  ///< over dt, of the error [s]
};

/// Decay of an error of the given squared size, which shrinks at rate min(error / lag, limit): a straight ramp down to
/// limit * lag, an exponential from there. No root is needed below limit * lag.
inline Decay decay(float squared_error, float lag, float limit, Seconds dt, Fading& fading) noexcept
{
    const float knee = limit * lag;
    if (squared_error <= knee * knee) {
        if (lag <= 0.0F) {
            return {};  // zero error
        }
        const float rest = fading(dt);  // in [-1, 0]
        return {1.0F + rest, -lag * rest};
    }
    const float error = std::sqrt(squared_error);
    const float per_error = 1.0F / error;
    const Seconds ramp = (error - knee) / limit;
    if (ramp >= dt) {
        const float left = error - limit * dt;
        return {left * per_error, 0.5F * (error + left) * dt * per_error};
    }
    const float of_ramp = 0.5F * (error + knee) * ramp;
    if (lag <= 0.0F) {
        return {0.0F, of_ramp * per_error};
    }
    const float rest = fading(dt - ramp);
    return {(knee + knee * rest) * per_error, (of_ramp - knee * lag * rest) * per_error};
}

/// A level command slower than this has no course [m/s].
inline constexpr float kNoCourse = 1.0F;

/// The velocity to which a command leads: climb and descent bounded. A fixed wing keeps its speed: it flies the course
/// of the command at cruise speed. If the command has no course, the wing keeps its own course.
[[nodiscard]] inline Vec3 goal_of(const Vec3& command, const Vec3& velocity, const VehicleLimits& limits) noexcept
{
    Vec3 goal = command;
    goal.z() = std::clamp(command.z(), -limits.max_descent, limits.max_climb);
    if (limits.kind == VehicleKind::fixed_wing) {
        float squared = command.x() * command.x() + command.y() * command.y();
        const Vec3& course = squared >= kNoCourse * kNoCourse ? command : velocity;
        squared = course.x() * course.x() + course.y() * course.y();
        const float scale = squared > 0.0F ? limits.cruise_speed / std::sqrt(squared) : 0.0F;
        goal.x() = scale * course.x();
        goal.y() = scale * course.y();
    }
    return goal;
}

/// `move` where the velocity's goal and its `error`, velocity - goal, are known. Inline in each caller: a call would
/// pass both through memory.
[[gnu::always_inline]] inline void decay_to(const Vec3& goal, const Vec3& error, Vec3& position, Vec3& velocity,
                                            const VehicleLimits& limits, Seconds dt, Fading& fading) noexcept
{
    const Decay level =
        decay(error.x() * error.x() + error.y() * error.y(), limits.velocity_lag, limits.max_acceleration, dt, fading);
    const Decay vertical =
        decay(error.z() * error.z(), limits.velocity_lag, limits.max_vertical_acceleration, dt, fading);

    position += goal * dt + error.cwiseProduct(Vec3(level.integral, level.integral, vertical.integral));
    velocity = goal + error.cwiseProduct(Vec3(level.left, level.left, vertical.left));
}

/// `advance` without its stamp. `fading`: made with limits.velocity_lag.
inline void move(Vec3& position, Vec3& velocity, const Vec3& command, const VehicleLimits& limits, Seconds dt,
                 Fading& fading) noexcept
{
    const Vec3 goal = goal_of(command, velocity, limits);
    decay_to(goal, velocity - goal, position, velocity, limits, dt, fading);
}

}  // namespace jink::vehicle::detail
