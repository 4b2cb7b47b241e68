// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <numeric>
#include <vector>

#include "core/geometry/mesh_map.hpp"

// Maps made of hulls for tests of the core, the tree by halves. It shares nothing with what makes the maps that are
// flown.

namespace jink::oracle {

/// The tables of a map, owned. Pieces lie about their first vertex.
class MapOfHulls {
public:
    explicit MapOfHulls(const std::vector<std::vector<Vec3>>& hulls, float slack = 0.0F)
    {
        for (const std::vector<Vec3>& hull : hulls) {
            pieces_.push_back({Point3::of(hull[0]), static_cast<std::uint32_t>(vertices_.size()),
                               static_cast<std::uint32_t>(hull.size())});
            for (const Vec3& v : hull) {
                vertices_.push_back(Point3::of(v - hull[0]));
            }
        }
        map_.name = "hulls";
        map_.slack = slack;
        map_.pieces = pieces_;
        map_.vertices = vertices_;
        std::vector<std::uint16_t> order(hulls.size());
        std::iota(order.begin(), order.end(), std::uint16_t{0});
        split(order, 0, order.size());
        map_.nodes = nodes_;
        map_.low = nodes_[0].low;
        map_.high = nodes_[0].high;
        seal();
    }
    MapOfHulls(const MapOfHulls&) = delete;
    MapOfHulls& operator=(const MapOfHulls&) = delete;

    void set_origin(const geometry::MapOrigin& origin)
    {
        map_.origin = origin;
        seal();
    }
    [[nodiscard]] const geometry::MeshMap& map() const { return map_; }
    /// Vertices of a piece in the map's frame.
    [[nodiscard]] std::vector<Vec3> hull(std::size_t piece) const
    {
        std::vector<Vec3> out;
        for (const Point3& v : map_.vertices_of(piece)) {
            out.emplace_back(map_.pieces[piece].centre.vec() + v.vec());
        }
        return out;
    }

    std::vector<geometry::MeshPiece> pieces_;
    std::vector<Point3> vertices_;
    std::vector<geometry::MeshNode> nodes_;

private:
    void seal() { map_.checksum = geometry::checksum_of(map_); }
    void split(std::vector<std::uint16_t>& order, std::size_t first, std::size_t last)
    {
        const std::size_t at = nodes_.size();
        geometry::MeshNode node;
        Vec3 low = Vec3::Constant(1e9F);
        Vec3 high = -low;
        for (std::size_t i = first; i < last; ++i) {
            for (const Vec3& v : hull(order[i])) {
                low = low.cwiseMin(v);
                high = high.cwiseMax(v);
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
        std::nth_element(order.begin() + long(first), order.begin() + long(middle), order.begin() + long(last),
                         [&](std::uint16_t a, std::uint16_t b) {
                             return pieces_[a].centre.vec()[axis] < pieces_[b].centre.vec()[axis];
                         });
        split(order, first, middle);
        nodes_[at].right = static_cast<std::uint16_t>(nodes_.size());
        split(order, middle, last);
    }

    geometry::MeshMap map_;
};

}  // namespace jink::oracle
