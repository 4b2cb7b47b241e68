// SPDX-License-Identifier: BSD-3-Clause
#include <array>
#include <cmath>

#include "core/base/crc.hpp"
#include "core/geometry/mesh_map.hpp"

// Validation of a map, once, when it is loaded.

namespace jink::geometry {

namespace {

/// Largest error of a stored normal's length.
constexpr float kUnitTolerance = 1e-4F;

void add_point(Crc& crc, const Point3& v) noexcept
{
    crc.add(v.x);
    crc.add(v.y);
    crc.add(v.z);
}

bool is_within_map(const Point3& point) noexcept
{
    const Vec3 v = point.vec();
    return is_finite(v) && (v.array().abs() <= kMaxMeshCoordinate).all();
}

bool lies_within(const Point3& point, const Point3& low, const Point3& high) noexcept
{
    const Vec3 v = point.vec();
    return (v.array() >= low.vec().array()).all() && (v.array() <= high.vec().array()).all();
}

MapStatus check_sizes(const MeshMap& m) noexcept
{
    if (m.version != kMeshVersion) {
        return MapStatus::wrong_version;
    }
    if (m.metres_per_unit != 1.0F) {
        return MapStatus::wrong_units;
    }
    if (m.pieces.empty()) {
        return MapStatus::empty;
    }
    if (m.pieces.size() > kMaxMeshPieces) {
        return MapStatus::too_large;
    }
    if (m.nodes.size() != 2 * m.pieces.size() - 1) {
        return MapStatus::sizes_differ;
    }
    return MapStatus::good;
}

MapStatus check_faces(const MeshMap& m, std::size_t piece) noexcept
{
    for (const FacePlane& face : m.faces_of(piece)) {
        const Vec3 normal = face.normal.vec();
        if (!is_finite(normal) || !std::isfinite(face.offset) || !(std::abs(normal.norm() - 1.0F) <= kUnitTolerance)) {
            return MapStatus::bad_face;
        }
        for (const Point3& vertex : m.vertices_of(piece)) {
            if (!(normal.dot(vertex.vec()) <= face.offset + kFaceTolerance)) {
                return MapStatus::bad_face;
            }
        }
    }
    return MapStatus::good;
}

/// Tables without gaps: each piece's vertices and faces follow those of the one before.
MapStatus check_pieces(const MeshMap& m) noexcept
{
    std::size_t vertex = 0;
    std::size_t face = 0;
    for (const MeshPiece& piece : m.pieces) {
        if (piece.vertices > kMaxPieceVertices || piece.faces > kMaxPieceFaces) {
            return MapStatus::too_large;
        }
        if (piece.vertices < 3 || (piece.faces > 0 && piece.faces < 4) || piece.first_vertex != vertex ||
            piece.first_face != face) {
            return MapStatus::sizes_differ;
        }
        vertex += piece.vertices;
        face += piece.faces;
    }
    if (vertex != m.vertices.size() || face != m.faces.size()) {
        return MapStatus::sizes_differ;
    }
    if (!std::isfinite(m.slack) || !(m.slack >= 0.0F) || !is_within_map(m.low) || !is_within_map(m.high)) {
        return MapStatus::bad_coordinate;
    }
    for (const Point3& v : m.vertices) {
        if (!is_within_map(v)) {
            return MapStatus::bad_coordinate;
        }
        if (!lies_within(v, m.low, m.high)) {
            return MapStatus::bad_bounds;
        }
    }
    for (std::size_t piece = 0; piece < m.pieces.size(); ++piece) {
        if (const MapStatus status = check_faces(m, piece); status != MapStatus::good) {
            return status;
        }
    }
    return MapStatus::good;
}

/// Pieces that the tree has referred to so far.
class Met {
public:
    /// False when the piece has been added before.
    [[nodiscard]] bool add(std::size_t piece) noexcept
    {
        std::uint32_t& word = words_[piece / 32];
        const std::uint32_t bit = std::uint32_t{1} << (piece % 32);
        const bool is_new = (word & bit) == 0;
        word |= bit;
        return is_new;
    }

private:
    std::array<std::uint32_t, kMaxMeshPieces / 32> words_{};
};

/// A leaf holds a piece that no other leaf holds, within its box.
MapStatus check_leaf(const MeshMap& m, const MeshNode& node, Met& met) noexcept
{
    if (node.piece >= m.pieces.size() || node.right != 0 || !met.add(node.piece)) {
        return MapStatus::bad_tree;
    }
    for (const Point3& v : m.vertices_of(node.piece)) {
        if (!lies_within(v, node.low, node.high)) {
            return MapStatus::bad_bounds;
        }
    }
    return MapStatus::good;
}

bool holds_box(const MeshNode& parent, const MeshNode& child) noexcept
{
    return lies_within(child.low, parent.low, parent.high) && lies_within(child.high, parent.low, parent.high);
}

MapStatus check_parent(const MeshMap& m, std::size_t i, std::uint8_t depth) noexcept
{
    const MeshNode& node = m.nodes[i];
    if (node.right <= i + 1 || node.right >= m.nodes.size()) {
        return MapStatus::bad_tree;
    }
    if (depth == kMaxMeshDepth) {
        return MapStatus::too_large;
    }
    return holds_box(node, m.nodes[i + 1]) && holds_box(node, m.nodes[node.right]) ? MapStatus::good
                                                                                   : MapStatus::bad_bounds;
}

/// Left children follow their parents, right ones where the left half ends: one pass over all nodes.
MapStatus check_tree(const MeshMap& m) noexcept
{
    Met met;
    std::array<std::uint16_t, kMaxMeshDepth + 1> right{};  // right children that wait for their turn
    std::array<std::uint8_t, kMaxMeshDepth + 1> depths{};
    std::size_t waiting = 0;
    std::uint8_t depth = 0;
    for (std::size_t i = 0; i < m.nodes.size(); ++i) {
        const MeshNode& node = m.nodes[i];
        if (!is_within_map(node.low) || !is_within_map(node.high)) {
            return MapStatus::bad_coordinate;
        }
        if (!node.is_leaf()) {
            if (const MapStatus status = check_parent(m, i, depth); status != MapStatus::good) {
                return status;
            }
            ++depth;
            right[waiting] = node.right;
            depths[waiting++] = depth;
            continue;
        }
        if (const MapStatus status = check_leaf(m, node, met); status != MapStatus::good) {
            return status;
        }
        const bool last = i + 1 == m.nodes.size();
        if (last != (waiting == 0)) {
            return MapStatus::bad_tree;
        }
        if (!last) {
            --waiting;
            if (right[waiting] != i + 1) {
                return MapStatus::bad_tree;
            }
            depth = depths[waiting];
        }
    }
    return MapStatus::good;
}

}  // namespace

std::uint32_t checksum_of(const MeshMap& m) noexcept
{
    Crc crc;
    crc.add16(m.version);
    crc.add(m.metres_per_unit);
    crc.add(m.slack);
    add_point(crc, m.low);
    add_point(crc, m.high);
    for (const MeshPiece& piece : m.pieces) {
        crc.add32(piece.first_vertex);
        crc.add32(piece.first_face);
        crc.add16(piece.vertices);
        crc.add16(piece.faces);
    }
    for (const Point3& vertex : m.vertices) {
        add_point(crc, vertex);
    }
    for (const FacePlane& face : m.faces) {
        add_point(crc, face.normal);
        crc.add(face.offset);
    }
    for (const MeshNode& node : m.nodes) {
        add_point(crc, node.low);
        add_point(crc, node.high);
        crc.add16(node.right);
        crc.add16(node.piece);
    }
    return crc.value();
}

MapStatus check(const MeshMap& m) noexcept
{
    if (const MapStatus status = check_sizes(m); status != MapStatus::good) {
        return status;
    }
    if (const MapStatus status = check_pieces(m); status != MapStatus::good) {
        return status;
    }
    if (const MapStatus status = check_tree(m); status != MapStatus::good) {
        return status;
    }
    return checksum_of(m) == m.checksum ? MapStatus::good : MapStatus::wrong_checksum;
}

}  // namespace jink::geometry
