// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>
#include <string_view>

#include "core/base/point3.hpp"
#include "core/capacity.hpp"
#include "core/geometry/shape.hpp"

// Known surroundings: convex pieces, made of meshes on the host (`jink mesh build`) and kept as constant tables with a
// tree of boxes over them (Alejo 7.2.2). core/world/map_obstacles.hpp makes obstacles of the pieces near the vehicle.

namespace jink::geometry {

/// Limits of a map; one that exceeds any is refused as a whole. A piece is a few vertices in flash: a full map of 32
/// vertices a piece is 1.9 MiB, one of triangles 464 KiB.
inline constexpr std::size_t kMaxMeshPieces = 4096;
/// Fewer where the build's capacity is smaller (kMaxHullVertices).
inline constexpr std::size_t kMaxPieceVertices = kMaxHullVertices < 32 ? kMaxHullVertices : 32;
inline constexpr std::size_t kMaxMeshDepth = 20;
/// Largest magnitude of a coordinate [m]. Beyond it floats are coarser than 6e-5 m.
inline constexpr float kMaxMeshCoordinate = 1000.0F;
/// Of how maps are stored; another one is refused.
inline constexpr std::uint16_t kMeshVersion = 2;

/// One convex piece: the hull of its vertices, which lie about a centre of its own. So a piece is placed by moving the
/// centre alone, and keeps the precision of small numbers however far from the map's origin it is.
struct MeshPiece {
    Point3 centre;  ///< [m]
    std::uint32_t first_vertex = 0;
    std::uint32_t vertices = 0;  ///< 3..kMaxPieceVertices
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

/// Where on the globe a map's origin lies.
struct MapOrigin {
    bool known = false;
    std::int32_t latitude = 0;   ///< degrees * 1e7, no nearer to the poles than 85 degrees
    std::int32_t longitude = 0;  ///< degrees * 1e7
    std::int32_t altitude = 0;   ///< above mean sea level [mm], within 1000 km
};

/// A view of constant tables. World frame: local ENU about the map's origin, z up, metres.
///
/// Memory: 20 bytes a piece, 12 a vertex, 28 a node (2 * pieces - 1 of them): 112 bytes for a triangle, 220 for a piece
/// of 12 vertices.
struct MeshMap {
    std::string_view name;
    std::uint16_t version = kMeshVersion;
    float metres_per_unit = 1.0F;  ///< of all coordinates; maps in any other unit are refused
    /// How far the mesh may stand out of the pieces [m], >= 0: what rounding to float may have taken off. Every use
    /// has to take the pieces for larger by it.
    float slack = 0.0F;
    MapOrigin origin;
    Point3 low;  ///< bounds of all pieces [m]
    Point3 high;
    std::span<const MeshPiece> pieces;
    std::span<const Point3> vertices;  ///< about the centres of their pieces [m]
    std::span<const MeshNode> nodes;
    std::uint32_t checksum = 0;  ///< of all of the above but the name (`checksum_of`)

    [[nodiscard]] std::span<const Point3> vertices_of(std::size_t piece) const noexcept
    {
        return vertices.subspan(pieces[piece].first_vertex, pieces[piece].vertices);
    }
    /// A piece as a solid, without the slack.
    [[nodiscard]] Shape shape_of(std::size_t piece) const noexcept
    {
        return make_hull(vertices_of(piece), pieces[piece].centre.vec());
    }
};

/// Result of `check`. A map is accepted as a whole or refused as a whole.
enum class MapStatus : std::uint8_t {
    good,
    empty,           ///< no piece
    wrong_version,   ///< stored in another format
    wrong_units,     ///< not metres
    wrong_origin,    ///< not on the globe, or too near to a pole
    too_large,       ///< more pieces or vertices than the capacity, or a deeper tree
    sizes_differ,    ///< the tables do not belong together
    bad_coordinate,  ///< not finite, or beyond kMaxMeshCoordinate
    bad_bounds,      ///< a box that does not hold what it should
    bad_tree,        ///< a piece that is no leaf or several ones, or a child that does not follow its parent
    wrong_checksum,
};

/// CRC-32 (IEEE 802.3) of the tables and of the map's numbers, in a byte order that is the same on every machine.
/// O(bytes).
[[nodiscard]] std::uint32_t checksum_of(const MeshMap& map) noexcept;
/// Everything that users of a map rely on; once, when a map is taken. O(pieces * vertices + bytes).
[[nodiscard]] MapStatus check(const MeshMap& map) noexcept;

/// Distance of the point from a node's box, never above the true one [m]. O(1).
[[nodiscard]] inline float box_distance(const MeshNode& node, const Vec3& point) noexcept
{
    constexpr float kRounding = 1e-6F;  // what rounding may add, as a share
    const Vec3 off = (node.low.vec() - point).cwiseMax(point - node.high.vec()).cwiseMax(0.0F);
    return off.norm() * (1.0F - kRounding);
}

}  // namespace jink::geometry
