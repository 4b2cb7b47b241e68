// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "core/base/work_budget.hpp"
#include "core/geometry/mesh_map.hpp"
#include "core/world/obstacle_table.hpp"

// A map of known surroundings as a source of threats: the pieces near the vehicle become obstacles, which everybody
// meets like those that sensors see.

namespace jink::world {

/// Ids of a map's obstacles: the first one, and from there the index of the node in the map's tree.
inline constexpr ObstacleId kFirstMapId = 0x40000000;

/// Where a map lies.
struct MapPlace {
    Vec3 origin = Vec3::Zero();  ///< of the map, in the world frame [m]
    float uncertainty = 0.0F;    ///< of the pieces within reach, beside the map's slack [m], >= 0
};

/// What the obstacles stand for.
struct MapSelection {
    std::uint16_t pieces = 0;  ///< obstacles that are a piece of the map each
    std::uint16_t boxes = 0;   ///< obstacles that are a box which holds several pieces
    /// Nearer than this there is no box: every piece is known by its own shape [m]. The reach where there are no boxes.
    float exact_within = 0.0F;
};

/// Appends obstacles to `table` that hold every piece of the map within `reach` of `point`.
///
/// The map's tree is opened from its root, always the node nearest to `point`, while there are places (kMaxMapObstacles
/// of the table) and budget. A leaf becomes its piece's hull; a node that is not opened becomes the box that holds all
/// pieces below it. So nothing within reach is left out: where places or budget run out, more is closed than needed,
/// the farther from `point` the coarser. The obstacles depend on the arguments alone, in the order of their ids.
///
/// @param map     good (geometry::check); its tables outlive the obstacles
/// @param point   finite, in the world frame [m]
/// @param reach   nodes farther than this are left out [m], >= 0
/// @param budget  each node that is opened takes kMeshNode units
///
/// Each obstacle's uncertainty holds the map's slack, that of `place`, and what rounding moves its shape by. O(nodes
/// opened * log places). Memory: 12 bytes of stack for each of kMaxMapObstacles.
MapSelection append_map(const geometry::MeshMap& map, const MapPlace& place, const Vec3& point, float reach,
                        WorkBudget& budget, ObstacleTable& table) noexcept;

}  // namespace jink::world
