// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <span>
#include <string_view>
#include <utility>

#include "core/base/work_budget.hpp"
#include "core/base/work_units.hpp"
#include "core/geometry/hull_distance.hpp"

// Known surroundings: convex pieces, made from meshes on the host (`jink mesh build`) and kept as constant tables with
// a bounding-volume tree (Alejo 7.2.2).

namespace jink::geometry {

/// Limits of a map. A map that exceeds any limit is refused as a whole. A piece is a few vertices and planes in flash:
/// a full map of 32 vertices a piece is 5.5 MiB, one of triangles 416 KiB.
inline constexpr std::size_t kMaxMeshPieces = 4096;
/// Fewer where the build's capacity is smaller (kMaxHullVertices).
inline constexpr std::size_t kMaxPieceVertices = kMaxHullVertices < 32 ? kMaxHullVertices : 32;
/// 32 vertices have 60 triangles.
inline constexpr std::size_t kMaxPieceFaces = 2 * kMaxPieceVertices - 4;
inline constexpr std::size_t kMaxMeshDepth = 20;
/// Largest magnitude of a coordinate [m]. Beyond it floats are coarser than 6e-5 m.
inline constexpr float kMaxMeshCoordinate = 1000.0F;
/// Version of the stored format; any other version is refused.
inline constexpr std::uint16_t kMeshVersion = 1;
/// Largest distance of a vertex beyond a face of its piece [m]: normals are rounded, 6e-8 of a kilometre each.
inline constexpr float kFaceTolerance = 1e-3F;

/// One convex piece: the hull of its vertices.
struct MeshPiece {
    std::uint32_t first_vertex = 0;
    std::uint32_t first_face = 0;
    std::uint16_t vertices = 0;  ///< 3..kMaxPieceVertices
    std::uint16_t faces = 0;     ///< 0 for a flat piece, else 4..kMaxPieceFaces
};

inline constexpr std::uint16_t kNoPiece = 0xFFFF;

/// A node of the tree of boxes. Nodes are stored so that a left child follows its parent.
struct MeshNode {
    Point3 low;                      ///< [m]
    Point3 high;                     ///< [m]
    std::uint16_t right = 0;         ///< index of the right child; of a leaf: 0
    std::uint16_t piece = kNoPiece;  ///< of a leaf: the piece that it holds

    [[nodiscard]] bool is_leaf() const noexcept { return piece != kNoPiece; }
};

/// A view of constant tables. World frame: local ENU about the map's origin, z up, metres.
///
/// Memory: 12 bytes a piece, 12 a vertex, 16 a face, 28 a node (2 * pieces - 1 of them): 104 bytes for a triangle,
/// about 530 for a piece of 12 vertices and 20 faces.
struct MeshMap {
    std::string_view name;
    std::uint16_t version = kMeshVersion;
    float metres_per_unit = 1.0F;  ///< of all coordinates; maps with any other value are refused
    /// Largest distance of the mesh beyond the pieces [m], >= 0: the part that rounding to float may have removed.
    /// Every query answers as if the pieces were larger by `slack`.
    float slack = 0.0F;
    Point3 low;  ///< bounds of all pieces [m]
    Point3 high;
    std::span<const MeshPiece> pieces;
    std::span<const Point3> vertices;
    std::span<const FacePlane> faces;
    std::span<const MeshNode> nodes;
    std::uint32_t checksum = 0;  ///< of all of the above but the name (`checksum_of`)

    [[nodiscard]] std::span<const Point3> vertices_of(std::size_t piece) const noexcept
    {
        return vertices.subspan(pieces[piece].first_vertex, pieces[piece].vertices);
    }
    [[nodiscard]] std::span<const FacePlane> faces_of(std::size_t piece) const noexcept
    {
        return faces.subspan(pieces[piece].first_face, pieces[piece].faces);
    }
};

/// Result of `check`. A map is accepted as a whole or refused as a whole.
enum class MapStatus : std::uint8_t {
    good,
    empty,           ///< no piece
    wrong_version,   ///< stored in another format
    wrong_units,     ///< not metres
    too_large,       ///< more pieces, vertices or faces than the capacities, or a deeper tree
    sizes_differ,    ///< the tables do not belong together
    bad_coordinate,  ///< not finite, or beyond kMaxMeshCoordinate
    bad_bounds,      ///< a box that does not contain its content
    bad_tree,        ///< a piece in no leaf or in several leaves, or a left child that does not follow its parent
    bad_face,        ///< not a unit normal, or a vertex of the piece beyond the plane
    wrong_checksum,
};

/// CRC-32 (IEEE 802.3) of the tables and of the map's numbers, in a byte order that is the same on every machine.
/// O(bytes).
[[nodiscard]] std::uint32_t checksum_of(const MeshMap& map) noexcept;
/// Checks everything that queries rely on; once, when a map is loaded. O(pieces * vertices * faces + bytes).
[[nodiscard]] MapStatus check(const MeshMap& map) noexcept;

/// A piece near a point, in the stretched space.
struct NearPiece {
    std::uint16_t piece = kNoPiece;
    /// From the point to the piece, with the map's slack subtracted from `distance`.
    Separation from;
};

/// The map's slack in the stretched space [m].
[[nodiscard]] inline float stretched_slack(const MeshMap& map, float stretch) noexcept
{
    return std::max(1.0F, stretch) * map.slack;
}

/// Distance of a point from one piece: `point_hull_distance`, less the map's slack.
[[nodiscard]] Separation piece_distance(const MeshMap& map, std::size_t piece, const Vec3& point,
                                        const DistanceQuery& query, WorkBudget& budget) noexcept;
/// Exit of a point from one piece: by its faces, or by the sides of a flat piece. The map's slack is added to `depth`.
[[nodiscard]] Exit piece_exit(const MeshMap& map, std::size_t piece, const Vec3& point, float stretch) noexcept;

/// Nodes that may wait while others are checked: the right children on the way down, and one spare.
inline constexpr std::size_t kMeshStack = 24;
static_assert(kMeshStack > kMaxMeshDepth + 1);

/// Distance of the point from a node's box in the stretched space, rounded down, less the map's slack [m].
[[nodiscard]] inline float node_distance(const MeshMap& map, const MeshNode& node, const Vec3& point,
                                         float stretch) noexcept
{
    constexpr float kBoxRounding = 1e-6F;  // share that rounding may add
    const auto off = [](float low, float high, float at) { return std::max(std::max(low - at, at - high), 0.0F); };
    const float x = off(node.low.x, node.high.x, point.x());
    const float y = off(node.low.y, node.high.y, point.y());
    const float z = off(node.low.z, node.high.z, point.z()) * stretch;
    return std::max(std::sqrt(x * x + y * y + z * z) * (1.0F - kBoxRounding) - stretched_slack(map, stretch), 0.0F);
}

/// Visits the pieces about `point`, roughly the nearest first.
///
/// @param map      good (`check`)
/// @param stretch  weight of z against x and y
/// @param reach    pieces farther than this are not visited [m], in the stretched space
/// @param budget   each node takes kMeshNode units; the work of `visit` takes its own units
/// @param visit    visit(piece index, lower bound of its distance) -> the new reach: no more than before; called once
///                 for each piece that may be within it
/// @return a lower bound of the distance of all pieces that were not visited although they may be within the first
///         reach [m]; the first reach itself when no such piece is known
///
/// Every piece within the returned distance has been visited, also when the budget runs out. O(nodes).
template <class Visit>
float visit_near(const MeshMap& map, const Vec3& point, float stretch, float reach, WorkBudget& budget, Visit&& visit)
{
    struct Waiting {
        std::uint16_t node = 0;
        float distance = 0.0F;
    };
    std::array<Waiting, kMeshStack> stack;
    std::size_t waiting = 0;
    float passed_over = reach;
    const auto put = [&](std::size_t node) {
        const float distance = node_distance(map, map.nodes[node], point, stretch);
        if (distance > reach || waiting == stack.size()) {
            passed_over = std::min(passed_over, distance);
            return;
        }
        stack[waiting++] = {static_cast<std::uint16_t>(node), distance};
    };
    put(0);
    while (waiting > 0) {
        const Waiting next = stack[--waiting];
        if (next.distance > reach || !budget.spend(units::kMeshNode)) {
            passed_over = std::min(passed_over, next.distance);
            continue;
        }
        const MeshNode& node = map.nodes[next.node];
        if (node.is_leaf()) {
            reach = std::min(reach, visit(node.piece, next.distance));
            continue;
        }
        // The nearer child is put last and so is visited first.
        const std::size_t at = waiting;
        put(node.right);
        put(std::size_t{next.node} + 1);
        if (waiting == at + 2 && stack[at].distance < stack[at + 1].distance) {
            std::swap(stack[at], stack[at + 1]);
        }
    }
    return passed_over;
}

struct NearestPieces {
    std::size_t found = 0;  ///< pieces in the answer
    /// No piece outside the answer is nearer than this [m]; query.reach where `out` is not full.
    float dropped = 0.0F;
};
/// The pieces nearest to `point` within `query.reach` of it, nearest first, into `out`.
///
/// Distances as `query` specifies; its `start` is not used. When `budget` runs out, `dropped` is the distance within
/// which the answer is complete. O(pieces * kMostDistanceTurns * vertices) at worst; the tree leaves a few in practice.
[[nodiscard]] NearestPieces nearest_pieces(const MeshMap& map, const Vec3& point, const DistanceQuery& query,
                                           std::span<NearPiece> out, WorkBudget& budget) noexcept;

}  // namespace jink::geometry
