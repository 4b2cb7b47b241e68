// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "toolchain/mesh/stored_map.hpp"

// Excess of pieces beyond the solid they represent, and gaps of the solid not covered by pieces.

namespace jink::mesh {

/// The surface of a mesh and, if closed, its inside.
class Solid {
public:
    explicit Solid(const TriangleMesh& mesh);

    struct Nearest {
        double distance = 0.0;  ///< [m]
        std::size_t triangle = 0;
    };
    /// The triangle nearest to a point. O(log triangles) in practice.
    [[nodiscard]] Nearest nearest_on_surface(const Vec3d& point) const;
    [[nodiscard]] double distance_from(std::size_t triangle, const Vec3d& point) const;
    /// Whether the point is inside the closed surface; false for an open surface. O(triangles).
    [[nodiscard]] bool holds(const Vec3d& point) const;
    /// Whether the point is directly behind the interior of its nearest triangle, and so within a closed surface; false
    /// also where uncertain. O(1).
    [[nodiscard]] bool is_behind(std::size_t triangle, const Vec3d& point) const;
    [[nodiscard]] bool is_closed() const { return closed_; }

private:
    const TriangleMesh& mesh_;
    bool closed_ = false;
    bool outward_ = false;  ///< closed, and its triangles face outwards in total
    struct Box {
        Vec3d low, high;
        std::size_t first = 0, last = 0;  ///< in order_
        std::size_t right = 0;            ///< its right half; the left half follows the node; 0: a leaf
    };
    std::vector<Box> boxes_;  ///< over the triangles
    std::vector<std::size_t> order_;

    void split(std::size_t first, std::size_t last);
};

/// Greatest distance of the piece's surface from the solid [m], 0 for points inside: the one-sided Hausdorff distance.
/// Never below the true value; above it by at most `tolerance`, or by more where the surface is too large.
///
/// Triangles of the surface are divided while they may hold a point farther than the farthest known point.
[[nodiscard]] double excess_of(const Piece& piece, const Solid& solid, double tolerance);

/// Greatest distance of the mesh's surface from the pieces of the map [m], over points of every triangle no more than
/// `spacing` apart, its corners among them. The map's slack is part of its pieces. 0 when the pieces cover the mesh.
[[nodiscard]] double gap_of(const TriangleMesh& mesh, const geometry::MeshMap& map, double spacing);

}  // namespace jink::mesh
