// SPDX-License-Identifier: BSD-3-Clause
#include "toolchain/mesh/stored_map.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace jink::mesh {

using geometry::FacePlane;
using geometry::MapStatus;
using geometry::MeshMap;
using geometry::MeshNode;
using geometry::MeshPiece;

std::size_t bytes_of(const MeshMap& map)
{
    return map.pieces.size_bytes() + map.vertices.size_bytes() + map.faces.size_bytes() + map.nodes.size_bytes();
}

StoredMap::StoredMap(std::string name, const std::vector<Piece>& pieces) : name_(std::move(name))
{
    if (pieces.empty()) {
        throw CannotBuild("no piece");
    }
    if (pieces.size() > geometry::kMaxMeshPieces) {
        throw CannotBuild(std::to_string(pieces.size()) + " pieces are more than a map may have, " +
                          std::to_string(geometry::kMaxMeshPieces));
    }
    for (const Piece& piece : pieces) {
        round(piece);
    }
    std::vector<std::uint16_t> order(pieces.size());
    std::iota(order.begin(), order.end(), std::uint16_t{0});
    split(order, 0, order.size());
    low_ = nodes_.front().low;
    high_ = nodes_.front().high;
    checksum_ = geometry::checksum_of(view());
    if (const MapStatus status = geometry::check(view()); status != MapStatus::good) {
        throw CannotBuild(to_string(status));
    }
}

void StoredMap::round(const Piece& piece)
{
    MeshPiece stored;
    stored.first_vertex = static_cast<std::uint32_t>(vertices_.size());
    stored.first_face = static_cast<std::uint32_t>(faces_.size());
    stored.vertices = static_cast<std::uint16_t>(piece.vertices.size());
    stored.faces = static_cast<std::uint16_t>(piece.planes.size());
    for (const Vec3d& v : piece.vertices) {
        const Vec3 rounded = v.cast<float>();
        vertices_.push_back(Point3::of(rounded));
        // If points move by less than `moved`, the hull of the moved points contains the original hull up to this
        // distance.
        const double moved = (rounded.cast<double>() - v).norm() + kFlat * v.cwiseAbs().maxCoeff();
        const auto up = std::nextafter(static_cast<float>(moved), std::numeric_limits<float>::max());
        slack_ = std::max(slack_, up);
    }
    for (const auto& plane : piece.planes) {
        const Vec3 normal = plane.first.cast<float>();
        double offset = -std::numeric_limits<double>::max();
        for (std::size_t i = stored.first_vertex; i < vertices_.size(); ++i) {
            offset = std::max(offset, normal.cast<double>().dot(vertices_[i].vec().cast<double>()));
        }
        faces_.push_back({Point3::of(normal), static_cast<float>(offset)});
    }
    pieces_.push_back(stored);
}

void StoredMap::split(std::vector<std::uint16_t>& order, std::size_t first, std::size_t last)
{
    const std::size_t at = nodes_.size();
    const auto centre_of = [&](std::uint16_t piece, int axis) {
        float sum = 0.0F;
        for (std::size_t i = 0; i < pieces_[piece].vertices; ++i) {
            sum += vertices_[pieces_[piece].first_vertex + i].vec()[axis];
        }
        return sum / static_cast<float>(pieces_[piece].vertices);
    };
    MeshNode node;
    Vec3 low = Vec3::Constant(std::numeric_limits<float>::max());
    Vec3 high = -low;
    for (std::size_t i = first; i < last; ++i) {
        const MeshPiece& piece = pieces_[order[i]];
        for (std::size_t v = 0; v < piece.vertices; ++v) {
            low = low.cwiseMin(vertices_[piece.first_vertex + v].vec());
            high = high.cwiseMax(vertices_[piece.first_vertex + v].vec());
        }
    }
    node.low = Point3::of(low);
    node.high = Point3::of(high);
    node.piece = last - first == 1 ? order[first] : geometry::kNoPiece;
    nodes_.push_back(node);
    if (last - first == 1) {
        return;
    }
    int axis = 0;
    (high - low).maxCoeff(&axis);
    const std::size_t middle = (first + last) / 2;
    const auto place = [&](std::size_t i) { return order.begin() + static_cast<std::ptrdiff_t>(i); };
    std::nth_element(place(first), place(middle), place(last), [&](std::uint16_t a, std::uint16_t b) {
        const float x = centre_of(a, axis);
        const float y = centre_of(b, axis);
        return x != y ? x < y : a < b;
    });
    split(order, first, middle);
    nodes_[at].right = static_cast<std::uint16_t>(nodes_.size());
    split(order, middle, last);
}

MeshMap StoredMap::view() const
{
    MeshMap map;
    map.name = name_;
    map.version = version_;
    map.metres_per_unit = metres_per_unit_;
    map.slack = slack_;
    map.low = low_;
    map.high = high_;
    map.pieces = pieces_;
    map.vertices = vertices_;
    map.faces = faces_;
    map.nodes = nodes_;
    map.checksum = checksum_;
    return map;
}

const char* to_string(MapStatus status)
{
    switch (status) {
    case MapStatus::good: return "good";
    case MapStatus::empty: return "no piece";
    case MapStatus::wrong_version: return "stored in another version";
    case MapStatus::wrong_units: return "not in metres";
    case MapStatus::too_large: return "more pieces, vertices or faces than a map may have, or too deep a tree";
    case MapStatus::sizes_differ: return "tables that do not belong together";
    case MapStatus::bad_coordinate: return "a coordinate that is not finite, or beyond 1000 m";
    case MapStatus::bad_bounds: return "a box that does not hold its piece";
    case MapStatus::bad_tree: return "a tree that does not hold every piece once";
    case MapStatus::bad_face: return "a face that cuts its piece";
    case MapStatus::wrong_checksum: return "wrong checksum";
    }
    return "unknown";
}

}  // namespace jink::mesh
