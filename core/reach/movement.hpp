// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include <Eigen/Core>

#include "core/base/vec3.hpp"

// The movements of the automaton: short commands of equal length, each with a turn at constant rate (Gomola 6.2.5).
//
// Frame: x forward, y left, z up, origin at the vehicle. Pitch > 0 is nose down, yaw > 0 nose left. Unless stated
// otherwise, lengths are in units of one movement's length, so that one set of tables serves every speed.

namespace jink::reach {

/// The alphabet, in Gomola's order (eq. 6.35). Everything that is built from the alphabet has the same order.
enum class Movement : std::uint8_t { straight, left, right, up, down, down_left, down_right, up_left, up_right };
inline constexpr std::size_t kMovements = 9;
inline constexpr std::array<Movement, kMovements> kAllMovements{
    Movement::straight,  Movement::left,       Movement::right,   Movement::up,      Movement::down,
    Movement::down_left, Movement::down_right, Movement::up_left, Movement::up_right};

/// Turn of a movement, in steps of the automaton: -1, 0 or 1 each. In Gomola's table 6.2 the pitch of the four
/// diagonals and the y of two of them have the wrong sign.
struct Turn {
    std::int8_t pitch = 0;
    std::int8_t yaw = 0;
};
[[nodiscard]] constexpr Turn turn_of(Movement movement) noexcept
{
    switch (movement) {
    case Movement::straight: return {0, 0};
    case Movement::left: return {0, 1};
    case Movement::right: return {0, -1};
    case Movement::up: return {-1, 0};
    case Movement::down: return {1, 0};
    case Movement::down_left: return {1, 1};
    case Movement::down_right: return {1, -1};
    case Movement::up_left: return {-1, 1};
    case Movement::up_right: return {-1, -1};
    }
    return {};
}
/// Straight flight is smooth; every other movement is not (Gomola eq. 6.79).
[[nodiscard]] constexpr bool is_smooth(Movement movement) noexcept { return movement == Movement::straight; }

/// Displacement of a movement that turns. arc: turns at a constant rate throughout, exact. end_heading: has its final
/// heading from the start (Gomola eq. 6.31), which no vehicle can fly; for comparison.
enum class DisplacementModel : std::uint8_t { arc, end_heading };

/// Sizes of one movement in a segment of the automaton.
template <class T>
struct MovementStep {
    T length = T(1);                   ///< along the arc
    T pitch = T(0.26179938779914943);  ///< of one step up or down [rad]: 15 degrees
    T yaw = T(0.26179938779914943);    ///< of one step to a side [rad]
};

template <class T>
using Point = Eigen::Matrix<T, 3, 1>;

/// Position and heading of a vehicle.
template <class T>
struct Pose {
    Point<T> position = Point<T>::Zero();
    T pitch = T(0);  ///< [rad], nose down
    T yaw = T(0);    ///< [rad], nose left
};

/// sin(u) / u; its relative error is that of the sine.
template <class T>
[[nodiscard]] T cardinal_sine(T u) noexcept
{
    constexpr T kSmall = sizeof(T) == sizeof(float) ? T(1e-3) : T(1e-4);
    return std::abs(u) < kSmall ? T(1) - u * u / T(6) : std::sin(u) / u;
}

/// Displacement of a flight of `length` from attitude (pitch, yaw) that turns by (by_pitch, by_yaw) at constant rates:
/// the integral of x' = cos(pitch) cos(yaw), y' = cos(pitch) sin(yaw), z' = -sin(pitch) (Gomola eq. 6.28) in closed
/// form. Exact. O(1): six sines.
template <class T>
[[nodiscard]] Point<T> arc_displacement(T length, T pitch, T yaw, T by_pitch, T by_yaw) noexcept
{
    const T p = pitch + by_pitch / T(2);
    const T y = yaw + by_yaw / T(2);
    const T same = cardinal_sine((by_pitch + by_yaw) / T(2));
    const T opposite = cardinal_sine((by_pitch - by_yaw) / T(2));
    return {length / T(2) * (std::cos(p - y) * opposite + std::cos(p + y) * same),
            length / T(2) * (std::sin(p + y) * same + std::sin(y - p) * opposite),
            -length * std::sin(p) * cardinal_sine(by_pitch / T(2))};
}

/// The pose at `share` in (0, 1] of a movement that begins at `from`. O(1).
template <class T>
[[nodiscard]] Pose<T> at_share(const Pose<T>& from, Movement movement, T share, const MovementStep<T>& step,
                               DisplacementModel model = DisplacementModel::arc) noexcept
{
    const Turn turn = turn_of(movement);
    const T by_pitch = static_cast<T>(turn.pitch) * step.pitch;
    const T by_yaw = static_cast<T>(turn.yaw) * step.yaw;
    Pose<T> to;
    if (model == DisplacementModel::arc) {
        to.pitch = from.pitch + share * by_pitch;
        to.yaw = from.yaw + share * by_yaw;
        to.position = from.position +
                      arc_displacement(share * step.length, from.pitch, from.yaw, share * by_pitch, share * by_yaw);
        return to;
    }
    to.pitch = from.pitch + by_pitch;
    to.yaw = from.yaw + by_yaw;
    const T along = share * step.length;
    to.position = from.position + Point<T>(along * std::cos(to.pitch) * std::cos(to.yaw),
                                           along * std::cos(to.pitch) * std::sin(to.yaw), -along * std::sin(to.pitch));
    return to;
}

/// The pose at the end of a movement.
template <class T>
[[nodiscard]] Pose<T> apply(const Pose<T>& from, Movement movement, const MovementStep<T>& step,
                            DisplacementModel model = DisplacementModel::arc) noexcept
{
    return at_share(from, movement, T(1), step, model);
}

}  // namespace jink::reach
