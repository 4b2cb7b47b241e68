// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "core/reach/cylinder.hpp"
#include "core/reach/grid.hpp"

// Cells rated by closed airspace, as the author does (Gomola 6.5.3, 6.6.5). The planner checks movements instead.

namespace jink::reach {

enum class Closure : std::uint8_t { none, soft, hard };

/// Pose of a level grid in the world.
struct GridPose {
    Vec3 position = Vec3::Zero();  ///< of the vehicle [m]
    float yaw = 0.0F;              ///< of the grid's x axis, counter-clockwise from east [rad]
    float unit = 1.0F;             ///< length of the grid's unit [m]
};

/// Heights of a cell of a level grid, relative to the vehicle [grid's unit]: exact. O(1).
struct Heights {
    float bottom = 0.0F;
    float top = 0.0F;
};
[[nodiscard]] Heights heights_of(const Grid<float>& grid, const CellPlace& place) noexcept;

/// Level distance of a point from a cell's plan view, an annular sector, for a level grid: exact. O(1).
/// @param point  relative to the vehicle, in the grid's axes [grid's unit]
[[nodiscard]] float level_distance(const Grid<float>& grid, const CellPlace& place, const Vec2& point) noexcept;

/// Body, margin or nothing, for a cell that the vehicle is in from `from` until `to` [s]; heights in contact overlap,
/// equal distances count. Conservative: for a moving cylinder the cell is replaced by its bounding circle. At one
/// instant, `from` equal to `to`, or for a static cylinder, the distance is exact. O(1).
[[nodiscard]] Closure closure_of(const Grid<float>& grid, const CellPlace& place, const GridPose& pose,
                                 const Cylinder& cylinder, float from, float to) noexcept;

}  // namespace jink::reach
