// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "toolchain/mesh/convex_hull.hpp"
#include "toolchain/mesh/solid.hpp"

// From a mesh to convex pieces (Alejo 7.2.2). With every method, each triangle is whole within one piece.

namespace jink::mesh {

enum class Method {
    hull,       ///< one hull per object: fewest pieces, closes passages
    decompose,  ///< clusters of triangles of a bounded concavity, each replaced by its hull
    soup,       ///< one piece per triangle: exact, with as many pieces as triangles
};

struct Recipe {
    Method method = Method::decompose;
    /// Of `decompose`: largest excess of a piece beyond the mesh [m], > 0; single triangles may exceed it.
    double concavity = 0.2;
    /// Accept open meshes where a solid is required (`hull`, `decompose`): excess is then measured from their surface.
    bool open = false;
};

/// The pieces, each with its excess beyond its object (Piece::excess).
///
/// `decompose`: clusters by hierarchical approximate convex decomposition (Mamou & Ghorbel 2009, Bullet's HACD); pieces
/// with too large an excess, or without a hull within a map's limits, are halved repeatedly.
/// @throws CannotBuild when an open mesh must be closed, a mesh is too large to be decomposed (50 000 triangles), or
///         the pieces exceed a map's limit
[[nodiscard]] std::vector<Piece> pieces_of(const TriangleMesh& mesh, const Recipe& recipe);

}  // namespace jink::mesh
