// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <vector>

#include "core/geometry/hull_distance.hpp"
#include "toolchain/mesh/triangle_mesh.hpp"

// Convex hulls for maps: few vertices, and never smaller than the points they contain.

namespace jink::mesh {

/// Below this height a set of points is flat; points are within their piece up to this tolerance. Both as a share of
/// the set's size.
inline constexpr double kFlat = 1e-9;

/// A convex polyhedron.
struct Hull {
    std::vector<Vec3d> vertices;
    std::vector<std::array<std::size_t, 3>> triangles;  ///< of its surface, counter-clockwise from outside
    std::vector<std::pair<Vec3d, double>> planes;       ///< outward unit normal and offset of each face
};

/// Hull of at least four points that span a solid; nothing for flat sets (height below 1e-9 of their size).
[[nodiscard]] std::optional<Hull> hull_of(const std::vector<Vec3d>& points);

/// A piece of a map before its numbers are rounded.
struct Piece {
    std::vector<Vec3d> vertices;                      ///< 3..geometry::kMaxPieceVertices
    std::vector<std::pair<Vec3d, double>> planes;     ///< none for a flat piece
    std::vector<std::array<std::size_t, 3>> surface;  ///< triangles of the surface
    double excess = 0.0;  ///< excess beyond the solid or surface that the piece represents [m] (excess_of)
};

/// A convex piece that contains all points (at least one) and stays within the limits of a map.
///
/// If the hull has few enough vertices, the hull. Otherwise a polytope with fewer, larger faces: planes that bound the
/// points are added where the excess is largest, until another plane would cost too many vertices. For flat sets with
/// too many corners returns nothing: the caller must divide them.
[[nodiscard]] std::optional<Piece> piece_around(const std::vector<Vec3d>& points);

}  // namespace jink::mesh
