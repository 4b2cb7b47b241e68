// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <vector>

#include "core/geometry/hull_distance.hpp"
#include "toolchain/mesh/triangle_mesh.hpp"

// Convex hulls as a map keeps them: few vertices, and never smaller than what they stand for.

namespace jink::mesh {

/// A set of points is flat below this height, and lies within its piece but for this much, as a share of its size.
inline constexpr double kFlat = 1e-9;

/// A convex polyhedron.
struct Hull {
    std::vector<Vec3d> vertices;
    std::vector<std::array<std::size_t, 3>> triangles;  ///< of its surface, counter-clockwise from outside
    std::vector<std::pair<Vec3d, double>> planes;       ///< outward unit normal and offset of each face
};

/// Hull of the points, at least four that span a solid; nothing where they do not (a height below 1e-9 of their size).
[[nodiscard]] std::optional<Hull> hull_of(const std::vector<Vec3d>& points);

/// A piece of a map before its numbers are rounded.
struct Piece {
    std::vector<Vec3d> vertices;                      ///< 3..geometry::kMaxPieceVertices
    std::vector<std::pair<Vec3d, double>> planes;     ///< none for a flat piece
    std::vector<std::array<std::size_t, 3>> surface;  ///< triangles of it
    double excess = 0.0;  ///< how far it stands out of the solid or the surface it stands for [m] (excess_of)
};

/// A convex piece that holds all points (at least one) and keeps to the limits of a map.
///
/// The hull itself where that has few enough vertices; else one with fewer, larger faces: planes that bound the points
/// where the piece stands out farthest are added until another one would cost too many vertices. Flat sets of points
/// with too many corners get no piece: nothing is returned, and they have to be divided.
[[nodiscard]] std::optional<Piece> piece_around(const std::vector<Vec3d>& points);

}  // namespace jink::mesh
