// SPDX-License-Identifier: BSD-3-Clause
#include <array>
#include <cmath>

#include "core/base/crc.hpp"
#include "core/geometry/mesh_map.hpp"

// Validation of a map, once, when it is loaded.

namespace jink::geometry {

namespace {

/// Where maps may lie on the globe: degrees * 1e7, and millimetres.
constexpr std::int32_t kHighestLatitude = 850'000'000;
constexpr std::int32_t kHighestLongitude = 1'800'000'000;
constexpr std::int32_t kHighestAltitude = 1'000'000'000;

void add_point(Crc& crc, const Point3& v) noexcept
{
    crc.add(v.x);
    crc.add(v.y);
    crc.add(v.z);
}

bool is_within(std::int32_t value, std::int32_t limit) noexcept { return value >= -limit && value <= limit; }

bool is_on_globe(const MapOrigin& origin) noexcept
{
    return is_within(origin.latitude, kHighestLatitude) && is_within(origin.longitude, kHighestLongitude) &&
           is_within(origin.altitude, kHighestAltitude);
}

bool is_within_map(const Vec3& v) noexcept { return is_finite(v) && (v.array().abs() <= kMaxMeshCoordinate).all(); }

bool lies_within(const Vec3& v, const Point3& low, const Point3& high) noexcept
{
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
    if (!is_on_globe(m.origin)) {
        return MapStatus::wrong_origin;
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

/// Tables without gaps: each piece's vertices follow those of the piece before.
MapStatus check_pieces(const MeshMap& m) noexcept
{
    std::size_t vertex = 0;
    for (const MeshPiece& piece : m.pieces) {
        if (piece.vertices > kMaxPieceVertices) {
            return MapStatus::too_large;
        }
        if (piece.vertices < 3 || piece.first_vertex != vertex) {
            return MapStatus::sizes_differ;
        }
        vertex += piece.vertices;
    }
    if (vertex != m.vertices.size()) {
        return MapStatus::sizes_differ;
    }
    if (!std::isfinite(m.slack) || !(m.slack >= 0.0F) || !is_within_map(m.low.vec()) || !is_within_map(m.high.vec())) {
        return MapStatus::bad_coordinate;
    }
    for (std::size_t piece = 0; piece < m.pieces.size(); ++piece) {
        const Vec3 centre = m.pieces[piece].centre.vec();
        for (const Point3& v : m.vertices_of(piece)) {
            if (!is_within_map(centre) || !is_within_map(centre + v.vec())) {
                return MapStatus::bad_coordinate;
            }
            if (!lies_within(centre + v.vec(), m.low, m.high)) {
                return MapStatus::bad_bounds;
            }
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
    const Vec3 centre = m.pieces[node.piece].centre.vec();
    for (const Point3& v : m.vertices_of(node.piece)) {
        if (!lies_within(centre + v.vec(), node.low, node.high)) {
            return MapStatus::bad_bounds;
        }
    }
    return MapStatus::good;
}

bool holds_box(const MeshNode& parent, const MeshNode& child) noexcept
{
    return lies_within(child.low.vec(), parent.low, parent.high) &&
           lies_within(child.high.vec(), parent.low, parent.high);
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
        if (!is_within_map(node.low.vec()) || !is_within_map(node.high.vec())) {
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
    crc.add16(m.origin.known ? 1 : 0);
    for (const std::int32_t number : {m.origin.latitude, m.origin.longitude, m.origin.altitude}) {
        crc.add32(static_cast<std::uint32_t>(number));
    }
    add_point(crc, m.low);
    add_point(crc, m.high);
    for (const MeshPiece& piece : m.pieces) {
        add_point(crc, piece.centre);
        crc.add32(piece.first_vertex);
        crc.add32(piece.vertices);
    }
    for (const Point3& vertex : m.vertices) {
        add_point(crc, vertex);
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
