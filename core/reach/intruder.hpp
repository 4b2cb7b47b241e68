// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <span>

#include "core/base/static_vector.hpp"
#include "core/reach/grid.hpp"

// Which cells an intruder meets, and when (Gomola 6.6.1 to 6.6.4). All in the grid's frame and unit of length; times
// count from when the grid is entered. The grid stands while the vehicle flies through it, so velocities are absolute.

namespace jink::reach {

/// An intruder as the models see it.
struct Intruder {
    Vec3 position = Vec3::Zero();  ///< at time 0
    Vec3 velocity = Vec3::Zero();
    float radius = 0.0F;       ///< of its body, and what is kept from it
    float horizontal = 0.0F;   ///< by this angle it may turn to a side [rad], 0 to kMostSpread
    float vertical = 0.0F;     ///< and up or down [rad]
    float speed_share = 0.1F;  ///< its speed may be wrong by this share, below 1
};
/// Greatest spread: 75 degrees, beyond which the tangent tells nothing.
inline constexpr float kMostSpread = 1.3089969F;
/// Slower ones stand: they are where they are, for ever.
inline constexpr float kStandsBelow = 0.1F;

/// When something is in a cell [s], first to last.
struct Stay {
    float from = 0.0F;
    float to = 0.0F;
};
struct CellStay {
    CellIndex cell = kNoCell;
    Stay stay;
};

/// A cell as a ball: about the middle of its ranges, through its farthest corner or edge.
struct CellBall {
    Vec3 centre = Vec3::Zero();
    float radius = 0.0F;
};
/// O(1).
[[nodiscard]] CellBall ball_of(const Grid<float>& grid, const CellPlace& place) noexcept;

/// Cells on a straight line, in the order of flight: for small intruders.
inline constexpr std::size_t kMostCrossings = 2 * (kMaxLayers + 1) + (kMaxColumns + 1) + 2 * (kMaxRows + 1) + 1;
using CrossedCells = StaticVector<CellStay, kMostCrossings>;
/// Exact: where the line meets the spheres, planes and cones between cells. A velocity of zero meets nothing here.
/// O(n log n) for n = 2 (layers + rows + 2) + columns + 2.
void cross(const Grid<float>& grid, const Vec3& position, const Vec3& velocity, CrossedCells& out) noexcept;

/// When the body, flying straight, may touch the cell. Never misses what it does; says more than it does by the cell's
/// ball. O(1).
[[nodiscard]] std::optional<Stay> body_in(const CellBall& cell, const Intruder& intruder) noexcept;

/// When the body may touch the cell if the intruder deviates from its line within its spread: an elliptic cone. Never
/// misses; says more by the cell's ball. O(1).
[[nodiscard]] std::optional<Stay> spread_in(const CellBall& cell, const Intruder& intruder) noexcept;

/// Share of the vehicle's stay in a cell during which the intruder is there too (Gomola eq. 6.119): 0 to 1. Stays that
/// only touch count as 2e-7, above the threshold of a threat, so that an intruder that is seen for an instant is not
/// lost. O(1).
[[nodiscard]] float time_rate(const Stay& vehicle, const Stay& intruder) noexcept;

/// Models of one intruder, and their weights against each other (Gomola eq. 6.150, 6.151).
struct ModelRates {
    float line = 0.0F;    ///< weight 2.5
    float body = 0.0F;    ///< weight 2.6
    float spread = 0.0F;  ///< weight 2.7
};

}  // namespace jink::reach
