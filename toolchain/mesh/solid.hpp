// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "toolchain/mesh/stored_map.hpp"

// How far pieces stand out of what they stand for, and whether they hold all of it.

namespace jink::mesh {

/// The surface of a mesh and, where it is closed, its inside.
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
    /// Whether a closed surface goes round the point; false where it is not closed. O(triangles).
    [[nodiscard]] bool holds(const Vec3d& point) const;
    /// Whether the point lies right behind the inside of the triangle, the nearest one, and so within a closed surface;
    /// false also where that is not sure. O(1).
    [[nodiscard]] bool is_behind(std::size_t triangle, const Vec3d& point) const;
    [[nodiscard]] bool is_closed() const { return closed_; }

private:
    const TriangleMesh& mesh_;
    bool closed_ = false;
    bool outward_ = false;  ///< closed, and its triangles face outwards on the whole
    struct Box {
        Vec3d low, high;
        std::size_t first = 0, last = 0;  ///< in order_
        std::size_t right = 0;            ///< its right half; the left one follows it; 0: a leaf
    };
    std::vector<Box> boxes_;  ///< over the triangles
    std::vector<std::size_t> order_;

    void split(std::size_t first, std::size_t last);
};

/// Greatest distance of the piece's surface from the solid [m], what lies inside of it being none: the one-sided
/// Hausdorff distance. Never below the truth; above it by `tolerance`, or by more where the surface is too large for
/// it.
///
/// Triangles of the surface are divided while they may hold a point that is farther than the farthest one known.
[[nodiscard]] double excess_of(const Piece& piece, const Solid& solid, double tolerance);

/// Greatest distance of the mesh's surface from the pieces of the map [m], over points of every triangle no more than
/// `spacing` apart, its corners among them. The map's slack is part of its pieces: 0 when nothing stands out.
[[nodiscard]] double gap_of(const TriangleMesh& mesh, const geometry::MeshMap& map, double spacing);

}  // namespace jink::mesh
