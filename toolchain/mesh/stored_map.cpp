// SPDX-License-Identifier: BSD-3-Clause
#include "toolchain/mesh/stored_map.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace jink::mesh {

using geometry::MapStatus;
using geometry::MeshMap;
using geometry::MeshNode;
using geometry::MeshPiece;

std::size_t bytes_of(const MeshMap& map)
{
    return map.pieces.size_bytes() + map.vertices.size_bytes() + map.nodes.size_bytes();
}

namespace {

/// A vertex of a piece, as users add it up.
Vec3 vertex_of(const files::MapTables& map, const MeshPiece& piece, std::size_t i)
{
    return piece.centre.vec() + map.vertices[piece.first_vertex + i].vec();
}

void add_rounded(files::MapTables& map, const Piece& piece)
{
    Vec3d low = piece.vertices.front();
    Vec3d high = low;
    for (const Vec3d& v : piece.vertices) {
        low = low.cwiseMin(v);
        high = high.cwiseMax(v);
    }
    MeshPiece stored;
    stored.centre = Point3::of((0.5 * (low + high)).cast<float>());
    stored.first_vertex = static_cast<std::uint32_t>(map.vertices.size());
    stored.vertices = static_cast<std::uint32_t>(piece.vertices.size());
    const Vec3d centre = stored.centre.vec().cast<double>();
    for (std::size_t i = 0; i < piece.vertices.size(); ++i) {
        const Vec3d& v = piece.vertices[i];
        map.vertices.push_back(Point3::of((v - centre).cast<float>()));
        // The hull of points that have moved by less than this holds the hull of the points, but for this much.
        const double moved = std::max((vertex_of(map, stored, i).cast<double>() - v).norm(),
                                      (centre + map.vertices.back().vec().cast<double>() - v).norm()) +
                             kFlat * v.cwiseAbs().maxCoeff();
        const auto up = std::nextafter(static_cast<float>(moved), std::numeric_limits<float>::max());
        map.slack = std::max(map.slack, up);
    }
    map.pieces.push_back(stored);
}

MeshNode box_of(const files::MapTables& map, const std::vector<std::uint16_t>& order, std::size_t first,
                std::size_t last)
{
    Vec3 low = Vec3::Constant(std::numeric_limits<float>::max());
    Vec3 high = -low;
    for (std::size_t i = first; i < last; ++i) {
        const MeshPiece& piece = map.pieces[order[i]];
        for (std::size_t v = 0; v < piece.vertices; ++v) {
            low = low.cwiseMin(vertex_of(map, piece, v));
            high = high.cwiseMax(vertex_of(map, piece, v));
        }
    }
    return {Point3::of(low), Point3::of(high), 0, last - first == 1 ? order[first] : geometry::kNoPiece};
}

void split(files::MapTables& map, std::vector<std::uint16_t>& order, std::size_t first, std::size_t last)
{
    const std::size_t at = map.nodes.size();
    map.nodes.push_back(box_of(map, order, first, last));
    if (last - first == 1) {
        return;
    }
    int axis = 0;
    (map.nodes[at].high.vec() - map.nodes[at].low.vec()).maxCoeff(&axis);
    const std::size_t middle = (first + last) / 2;
    const auto place = [&](std::size_t i) { return order.begin() + static_cast<std::ptrdiff_t>(i); };
    std::nth_element(place(first), place(middle), place(last), [&](std::uint16_t a, std::uint16_t b) {
        const float x = map.pieces[a].centre.vec()[axis];
        const float y = map.pieces[b].centre.vec()[axis];
        return x != y ? x < y : a < b;
    });
    split(map, order, first, middle);
    map.nodes[at].right = static_cast<std::uint16_t>(map.nodes.size());
    split(map, order, middle, last);
}

}  // namespace

files::MapTables stored_map(std::string name, const std::vector<Piece>& pieces, const geometry::MapOrigin& origin)
{
    if (pieces.empty()) {
        throw CannotBuild("no piece");
    }
    if (pieces.size() > geometry::kMaxMeshPieces) {
        throw CannotBuild(std::to_string(pieces.size()) + " pieces are more than a map may have, " +
                          std::to_string(geometry::kMaxMeshPieces));
    }
    files::MapTables map;
    map.name = std::move(name);
    map.origin = origin;
    for (const Piece& piece : pieces) {
        add_rounded(map, piece);
    }
    std::vector<std::uint16_t> order(pieces.size());
    std::iota(order.begin(), order.end(), std::uint16_t{0});
    split(map, order, 0, order.size());
    map.low = map.nodes.front().low;
    map.high = map.nodes.front().high;
    map.checksum = geometry::checksum_of(map.view());
    if (const MapStatus status = geometry::check(map.view()); status != MapStatus::good) {
        throw CannotBuild(files::to_string(status));
    }
    return map;
}

}  // namespace jink::mesh
