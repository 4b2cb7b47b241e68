// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "toolchain/mesh/convex_hull.hpp"
#include "toolchain/mesh/solid.hpp"

// From a mesh to convex pieces (Alejo 7.2.2). Whatever the method, each triangle lies in one piece as a whole.

namespace jink::mesh {

enum class Method {
    hull,       ///< one hull for each object: fewest pieces, closes passages
    decompose,  ///< clusters of triangles of a bounded concavity, each replaced by its hull
    soup,       ///< each triangle a piece: exact, and as many pieces as triangles
};

struct Recipe {
    Method method = Method::decompose;
    /// Of `decompose`: no piece stands out of the mesh by more than this [m], > 0, but for what a division into single
    /// triangles cannot mend.
    double concavity = 0.2;
    /// Take meshes that are not closed where a solid is asked for (`hull`, `decompose`): pieces are then measured from
    /// their surface.
    bool open = false;
};

/// The pieces, with what each stands out by of its object (Piece::excess).
///
/// `decompose`: clusters by hierarchical approximate convex decomposition (Mamou & Ghorbel 2009, Bullet's HACD); what
/// stands out too far all the same, or has no hull within a map's limits, is halved until it does not.
/// @throws CannotBuild when a mesh is not closed and has to be, is too large to be decomposed (50 000 triangles), or
///         more pieces come out than a map may have
[[nodiscard]] std::vector<Piece> pieces_of(const TriangleMesh& mesh, const Recipe& recipe);

}  // namespace jink::mesh
