// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <vector>

#include <Eigen/Dense>

#include "core/geometry/mesh_map.hpp"
#include "toolchain/mesh/triangle_mesh.hpp"

// Which points the pieces of a map hold, by planes in double precision.

namespace jink::test {

using mesh::Vec3d;

/// Vertices of a piece in the map's frame, in double precision.
inline std::vector<Vec3d> corners_of(const geometry::MeshMap& map, std::size_t piece)
{
    std::vector<Vec3d> out;
    for (const Point3& v : map.vertices_of(piece)) {
        out.push_back(map.pieces[piece].centre.vec().cast<double>() + v.vec().cast<double>());
    }
    return out;
}

struct Plane {
    Vec3d normal;
    double offset = 0.0;
};

/// The planes through three of the vertices with all others on one side; none for a flat piece. O(n^4).
inline std::vector<Plane> faces_of(const std::vector<Vec3d>& v)
{
    std::vector<Plane> faces;
    double size = 0;
    for (const Vec3d& corner : v) {
        size = std::max(size, (corner - v[0]).norm());
    }
    for (std::size_t i = 0; i < v.size(); ++i) {
        for (std::size_t j = i + 1; j < v.size(); ++j) {
            for (std::size_t k = j + 1; k < v.size(); ++k) {
                const Vec3d normal = (v[j] - v[i]).cross(v[k] - v[i]);
                if (normal.norm() <= 1e-9 * size * size) {
                    continue;
                }
                const Vec3d unit = normal.normalized();
                double low = 0;
                double high = 0;
                for (const Vec3d& corner : v) {
                    low = std::min(low, unit.dot(corner - v[i]));
                    high = std::max(high, unit.dot(corner - v[i]));
                }
                const double thin = 1e-6 * size;
                if (high <= thin && low >= -thin) {
                    return {};
                }
                if (high <= thin) {
                    faces.push_back({unit, unit.dot(v[i])});
                } else if (low >= -thin) {
                    faces.push_back({-unit, -unit.dot(v[i])});
                }
            }
        }
    }
    return faces;
}

/// The pieces of a map by their planes in double precision, flat ones by their triangles.
class Held {
public:
    explicit Held(const geometry::MeshMap& map)
    {
        for (std::size_t i = 0; i < map.pieces.size(); ++i) {
            pieces_.push_back({corners_of(map, i), {}});
            pieces_.back().faces = faces_of(pieces_.back().corners);
        }
    }
    /// Whether a point lies in some piece, or no farther from it than about `room`.
    [[nodiscard]] bool holds(const Vec3d& point, double room) const
    {
        return std::any_of(pieces_.begin(), pieces_.end(), [&](const Piece& piece) {
            return piece.faces.empty() ? on_flat(piece.corners, point, room)
                                       : std::all_of(piece.faces.begin(), piece.faces.end(), [&](const Plane& face) {
                                             return face.normal.dot(point) <= face.offset + room;
                                         });
        });
    }

private:
    struct Piece {
        std::vector<Vec3d> corners;
        std::vector<Plane> faces;
    };
    [[nodiscard]] static bool on_flat(const std::vector<Vec3d>& v, const Vec3d& point, double room)
    {
        Vec3d low = v[0];
        Vec3d high = low;
        for (const Vec3d& corner : v) {
            low = low.cwiseMin(corner);
            high = high.cwiseMax(corner);
        }
        if ((low - point).cwiseMax(point - high).maxCoeff() > room) {
            return false;
        }
        for (std::size_t k = 2; k < v.size(); ++k) {
            // Barycentric coordinates of the point's foot.
            const Vec3d a = v[0];
            const Vec3d b = v[k - 1] - a;
            const Vec3d c = v[k] - a;
            Eigen::Matrix<double, 3, 2> sides;
            sides << b, c;
            const Eigen::Vector2d share = sides.colPivHouseholderQr().solve(point - a);
            const double off = (sides * share - (point - a)).norm();
            const double beside = 4 * room + 1e-6;  // sides are a quarter of a metre and longer
            if (off <= room + 1e-6 && share.minCoeff() >= -beside && share.sum() <= 1 + beside) {
                return true;
            }
        }
        return false;
    }

    std::vector<Piece> pieces_;
};

}  // namespace jink::test
