// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "toolchain/sim/vec.hpp"

namespace jink::sim {

/// Limits of the simulated vehicle. Differs on purpose from core's vehicle model, which is of first order.
struct TruthLimits {
    double cruise = 5.0;                     ///< [m/s]
    double omega = 5.0;                      ///< natural frequency of the velocity loop [rad/s]
    double damping = 0.9;                    ///< of the velocity loop [-]
    double max_acceleration = 5.0;           ///< horizontal [m/s2]
    double max_vertical_acceleration = 3.0;  ///< [m/s2]
    double max_climb = 3.0;                  ///< [m/s]
    double max_descent = 3.0;                ///< [m/s]
    double max_yaw_rate = 1.5;               ///< largest rate at which the nose follows the course [rad/s]
    double min_speed = 0.0;                  ///< of a fixed wing (arduplane.hpp) [m/s]; 0: a multirotor
    double max_course_rate =
        0.0;  ///< turn rate of the velocity above 0.5 m/s [rad/s]; 0: only the acceleration bounds it
    /// > 0: a multirotor that PX4's velocity controller flies against this drag, as PX4's own simulator does at
    /// kRecordedDrag (test replay.recordings); `omega` and `damping` do not matter then [1/s].
    double drag = 0.0;
    double reported_jerk = 0.0;  ///< ArduCopter's answer for PSC_JERK_XY [m/s3]; 0: none, the name is unknown to it
};

struct Truth {
    Vec position = Vec::Zero();
    Vec velocity = Vec::Zero();
    Vec acceleration = Vec::Zero();
    double yaw = 0.0;        ///< [rad], counter-clockwise from east
    Vec held = Vec::Zero();  ///< with drag: what the velocity controller's integrator adds [m/s2]
};

/// Drag of the vehicle in PX4's simulator [1/s].
inline constexpr double kRecordedDrag = 0.9;

/// As PX4 in the recordings answers in OFFBOARD, with its parameters as delivered (test replay.recordings).
inline void answer_as_px4(TruthLimits& limits) noexcept
{
    limits.drag = kRecordedDrag;
    limits.max_acceleration = limits.max_vertical_acceleration = 8.0;
    limits.max_climb = 3.0;
    limits.max_descent = 1.5;
}
/// As ArduCopter in the recordings answers in GUIDED, with its parameters as delivered (test replay.recordings).
inline void answer_as_arducopter(TruthLimits& limits) noexcept
{
    limits.omega = 3.5;
    limits.damping = 0.9;
    limits.max_acceleration = 2.5;
    limits.max_vertical_acceleration = 1.0;
    limits.reported_jerk = 5.0;
}

/// The velocity is flown for long: what the integrator holds then.
[[nodiscard]] inline Vec held_at(const Vec& velocity, const TruthLimits& limits) { return limits.drag * velocity; }

/// One step of the vehicle under a velocity command: second-order response, bounded acceleration, climb, descent and
/// turn rates. Accurate for dt well below 1 / omega; the simulator uses kStep. O(1).
void fly(Truth& truth, const Vec& command, const TruthLimits& limits, double dt) noexcept;

/// The same with a fixed nose; the positions do not depend on the nose. For callers that fly many commands and use
/// positions alone; half the work.
void move(Truth& truth, const Vec& command, const TruthLimits& limits, double dt) noexcept;

/// Velocity along `direction` at `speed`, slowed where needed to stay within the climb and descent limits in the same
/// direction.
[[nodiscard]] Vec along(const Vec& direction, double speed, const TruthLimits& limits) noexcept;

}  // namespace jink::sim
