// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "core/reach/grid.hpp"
#include "tests/reference/reach/cylinder_closure.hpp"
#include "tests/reference/reach/fusion.hpp"

// Obstacles of a map: surveyed bodies in few numbers each, and their cells (Gomola 6.5.2). No cloud of points is
// stored: a cell is checked in closed form, or the points are generated in sequence.

namespace jink::reach {

enum class MapShape : std::uint8_t { sphere, line, plane, cuboid };

/// One entry of a map, in the world frame. The local x axis is the main axis; lengths that a shape does not list are
/// ignored.
struct MapObstacle {
    MapShape shape = MapShape::sphere;
    Vec3 position = Vec3::Zero();  ///< of the middle [m]
    float roll = 0.0F;             ///< [rad], turned first
    float pitch = 0.0F;            ///< [rad], main axis down, turned second
    float yaw = 0.0F;              ///< [rad], counter-clockwise from east, turned last
    float margin = 1.0F;           ///< about the body [m], > 0
    float length = 0.0F;           ///< along x [m]: line, plane, cuboid
    float width = 0.0F;            ///< along y [m]: plane, cuboid
    float depth = 0.0F;            ///< along z [m]: cuboid
    float radius = 0.0F;           ///< of a sphere's body [m]: Gomola has a point, 0
};

enum class MapStatus : std::uint8_t { good, not_a_number, bad_margin, bad_size };
[[nodiscard]] MapStatus check(const MapObstacle& obstacle) noexcept;

/// Within the margin's reach of a grid of radius `range` [m] about the vehicle (Gomola eq. 6.101). O(1).
[[nodiscard]] bool is_near(const MapObstacle& obstacle, const Vec3& vehicle, float range) noexcept;

/// An obstacle in a level grid: a box, which may be flat, with rounding and margin. In the grid's frame and unit.
struct MapBody {
    Vec3 centre = Vec3::Zero();
    Mat3 axes = Mat3::Identity();  ///< columns
    Vec3 half = Vec3::Zero();      ///< extents from the centre along the axes
    float rounding = 0.0F;         ///< of the body about the box: a sphere's radius
    float margin = 0.0F;           ///< about the body
};
/// Once per obstacle and frame. O(1).
[[nodiscard]] MapBody in_grid(const MapObstacle& obstacle, const GridPose& pose) noexcept;

/// A cell as a box: along the direction to its middle, to the left of it and up.
struct CellBox {
    Vec3 centre = Vec3::Zero();
    Mat3 axes = Mat3::Identity();  ///< columns
    Vec3 half = Vec3::Zero();
};
/// Contains the whole cell. Once per grid. O(1).
[[nodiscard]] CellBox box_of(const Grid<float>& grid, const CellPlace& place) noexcept;

/// The part of an obstacle that a cell may overlap: body, else margin, else nothing. Conservative: uses the cell's box,
/// and box corners for margins. O(1): 15 axes, 2 spheres, 2 planes.
[[nodiscard]] Closure closure_of(const Grid<float>& grid, const CellPlace& place, const CellBox& box,
                                 const MapBody& body) noexcept;

/// Bodies are obstacles, margins soft constraints (Gomola eq. 6.102, 6.103); both count where no sensor sees (6.158).
void add_map_obstacle(CellRating& cell, Closure closure) noexcept;

/// Most points of one obstacle's cloud; a larger obstacle has a wider spacing.
inline constexpr std::size_t kMaxCloudPoints = 4096;

/// Generation of clouds, and the weight of a point.
struct CloudRule {
    float spacing = 0.05F;  ///< between neighbours [grid's unit], > 0
    /// Volume in a cell that makes it an obstacle with certainty [grid's unit^3] (Gomola eq. 6.104). 0: that of one
    /// point, so that every overlapped cell is an obstacle, Gomola's rule.
    float threshold = 0.0F;
};
struct CloudReport {
    std::size_t points = 0;
    float spacing = 0.0F;    ///< that was used
    bool coarsened = false;  ///< spacing is wider than requested: cells may be missed
};
/// Ratings of all cells by one obstacle's points, each worth an equal share of the cloud's volume (Gomola eq. 6.105
/// to 6.107, with the minimum where Gomola prints the maximum): the reference for `closure_of`, with graded ratings. A
/// point is in the body or in the margin, never in both.
/// @param bodies, margins  out, of each cell
/// O(cells + kMaxCloudPoints).
CloudReport rate_by_cloud(const Grid<float>& grid, const MapBody& body, const CloudRule& rule, std::span<float> bodies,
                          std::span<float> margins) noexcept;

}  // namespace jink::reach
