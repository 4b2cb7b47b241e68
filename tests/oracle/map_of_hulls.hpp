// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <numeric>
#include <vector>

#include <Eigen/Geometry>

#include "core/geometry/mesh_map.hpp"

// Maps made of hulls for tests of the core: faces from all triples of vertices, the tree by halves. Shares no code with
// the builder of flown maps.

namespace jink::oracle {

/// Faces of the hull of `vertices`: the planes through three vertices with all others on one side. None for a flat
/// hull.
inline std::vector<geometry::FacePlane> faces_of_hull(const std::vector<Vec3>& vertices)
{
    using Vec3d = Eigen::Vector3d;
    std::vector<geometry::FacePlane> faces;
    const auto add = [&](const Vec3d& normal, double offset) {
        for (const geometry::FacePlane& face : faces) {
            if (face.normal.vec().cast<double>().dot(normal) > 1.0 - 1e-9) {
                return;
            }
        }
        faces.push_back({Point3::of(normal.cast<float>()), static_cast<float>(offset)});
    };
    double size = 0;
    for (const Vec3& v : vertices) {
        size = std::max(size, double((v - vertices[0]).norm()));
    }
    bool flat = false;
    for (std::size_t i = 0; i < vertices.size(); ++i) {
        for (std::size_t j = i + 1; j < vertices.size(); ++j) {
            for (std::size_t k = j + 1; k < vertices.size(); ++k) {
                const Vec3d a = vertices[i].cast<double>();
                const Vec3d normal = (vertices[j].cast<double>() - a).cross(vertices[k].cast<double>() - a);
                if (normal.norm() <= 1e-9 * size * size) {
                    continue;
                }
                const Vec3d unit = normal.normalized();
                double low = 0;
                double high = 0;
                for (const Vec3& v : vertices) {
                    low = std::min(low, unit.dot(v.cast<double>() - a));
                    high = std::max(high, unit.dot(v.cast<double>() - a));
                }
                const double thin = 1e-6 * size;
                flat = flat || (high <= thin && low >= -thin);
                if (high <= thin) {
                    add(unit, unit.dot(a));
                } else if (low >= -thin) {
                    add(-unit, -unit.dot(a));
                }
            }
        }
    }
    return flat ? std::vector<geometry::FacePlane>{} : faces;
}

/// The tables of a map, owned.
class MapOfHulls {
public:
    explicit MapOfHulls(const std::vector<std::vector<Vec3>>& hulls, float slack = 0.0F)
    {
        for (const std::vector<Vec3>& hull : hulls) {
            const std::vector<geometry::FacePlane> faces = faces_of_hull(hull);
            pieces_.push_back({static_cast<std::uint32_t>(vertices_.size()), static_cast<std::uint32_t>(faces_.size()),
                               static_cast<std::uint16_t>(hull.size()), static_cast<std::uint16_t>(faces.size())});
            for (const Vec3& v : hull) {
                vertices_.push_back(Point3::of(v));
            }
            faces_.insert(faces_.end(), faces.begin(), faces.end());
        }
        map_.name = "hulls";
        map_.slack = slack;
        map_.pieces = pieces_;
        map_.vertices = vertices_;
        map_.faces = faces_;
        std::vector<std::uint16_t> order(hulls.size());
        std::iota(order.begin(), order.end(), std::uint16_t{0});
        split(order, 0, order.size());
        map_.nodes = nodes_;
        map_.low = nodes_[0].low;
        map_.high = nodes_[0].high;
        map_.checksum = geometry::checksum_of(map_);
    }
    MapOfHulls(const MapOfHulls&) = delete;
    MapOfHulls& operator=(const MapOfHulls&) = delete;

    [[nodiscard]] const geometry::MeshMap& map() const { return map_; }

    std::vector<geometry::MeshPiece> pieces_;
    std::vector<Point3> vertices_;
    std::vector<geometry::FacePlane> faces_;
    std::vector<geometry::MeshNode> nodes_;

private:
    void split(std::vector<std::uint16_t>& order, std::size_t first, std::size_t last)
    {
        const std::size_t at = nodes_.size();
        geometry::MeshNode node;
        Vec3 low = Vec3::Constant(1e9F);
        Vec3 high = -low;
        for (std::size_t i = first; i < last; ++i) {
            for (const Point3& v : map_.vertices_of(order[i])) {
                low = low.cwiseMin(v.vec());
                high = high.cwiseMax(v.vec());
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
                             return map_.vertices_of(a)[0].vec()[axis] < map_.vertices_of(b)[0].vec()[axis];
                         });
        split(order, first, middle);
        nodes_[at].right = static_cast<std::uint16_t>(nodes_.size());
        split(order, middle, last);
    }

    geometry::MeshMap map_;
};

}  // namespace jink::oracle
