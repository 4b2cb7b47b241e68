// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/orca/obstacle_plane.hpp"

// Whether a command keeps clear of all obstacles along its straight way, whatever half-spaces it was chosen from: what
// was relaxed, dropped or left out shows here.

namespace jink::orca {

/// Steps along the way for one obstacle. A velocity that keeps to the obstacle's half-space needs one;
/// none of the 300 random ways of test ClearanceAlong.EndsAtTheFirstContact used up all eight.
inline constexpr std::uint32_t kMaxWaySteps = 8;

struct WayClearance {
    /// Until then the envelope meets no obstacle [s]: the length that was asked for, or less.
    Seconds clear_until = 0.0F;
    std::uint16_t source = 0;  ///< of the obstacle that ends it
    bool clear = false;        ///< all of the way is
    /// The end is a bound: steps or budget were used up, the obstacle may be farther on or none.
    bool bounded = false;
};

/// How long the envelope keeps clear of the obstacles when it flies from `position` at `velocity` [m/s] for `length`
/// [s].
///
/// Conservative advancement (Mirtich 1996) on proven distances: never past a contact. Where it ends before the true
/// contact and is not `bounded`, it is by what takes the vehicle `resolution` nearer to the obstacle. An obstacle whose
/// margin the vehicle is in already counts as met as soon as it comes nearer than it is.
/// O(obstacles * kMaxWaySteps * kMaxDistanceTurns * vertices) at worst.
[[nodiscard]] WayClearance clearance_along(Obstacles obstacles, const Vec3& position, const Vec3& velocity,
                                           Seconds length, const ObstacleSettings& settings,
                                           WorkBudget& budget) noexcept;

}  // namespace jink::orca
