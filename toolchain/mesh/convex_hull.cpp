// SPDX-License-Identifier: BSD-3-Clause
#include "toolchain/mesh/convex_hull.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include <Eigen/Dense>

extern "C" {
#include <libqhull_r/qhull_ra.h>
}

#include "core/geometry/mesh_map.hpp"

namespace jink::mesh {
namespace {

/// Tolerance, as a share of a flat set's size, below which a point is not a corner.
constexpr double kCorner = 1e-12;

/// Centre, axes (columns, longest extent first) and size of a set of points.
struct Spread {
    Vec3d centre = Vec3d::Zero();
    Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();
    Vec3d low, high;  ///< along the axes, from the centre
    double size = 0.0;
};

Spread spread_of(const std::vector<Vec3d>& points)
{
    Spread out;
    for (const Vec3d& p : points) {
        out.centre += p / static_cast<double>(points.size());
    }
    Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
    for (const Vec3d& p : points) {
        sum += (p - out.centre) * (p - out.centre).transpose();
        out.size = std::max(out.size, (p - out.centre).norm());
    }
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(sum);
    out.axes = solver.eigenvectors().rowwise().reverse();
    out.low = Vec3d::Constant(std::numeric_limits<double>::max());
    out.high = -out.low;
    for (const Vec3d& p : points) {
        const Vec3d local = out.axes.transpose() * (p - out.centre);
        out.low = out.low.cwiseMin(local);
        out.high = out.high.cwiseMax(local);
    }
    return out;
}

bool is_flat(const std::vector<Vec3d>& points, const Spread& spread)
{
    return points.size() < 4 || spread.high.z() - spread.low.z() <= kFlat * spread.size;
}

/// qhull's memory, released in all cases.
class Qhull {
public:
    Qhull() { qh_zero(&qh_, nullptr); }
    ~Qhull()
    {
        qh_freeqhull(&qh_, !qh_ALL);
        int current = 0;
        int total = 0;
        qh_memfreeshort(&qh_, &current, &total);
    }
    Qhull(const Qhull&) = delete;
    Qhull& operator=(const Qhull&) = delete;

    /// Qt: triangles; Pp: no warnings about narrow hulls.
    bool run(std::vector<double>& coordinates)
    {
        std::string command = "qhull Qt Pp";
        return qh_new_qhull(&qh_, 3, static_cast<int>(coordinates.size() / 3), coordinates.data(), 0, command.data(),
                            nullptr, nullptr) == 0;
    }
    qhT* get() { return &qh_; }

private:
    qhT qh_;
};

std::size_t place_of(std::vector<Vec3d>& vertices, std::map<int, std::size_t>& known, int id, const Vec3d& at)
{
    const auto [place, is_new] = known.try_emplace(id, vertices.size());
    if (is_new) {
        vertices.push_back(at);
    }
    return place->second;
}

/// The corners of points in a plane (Andrew's monotone chain, 1979), which are its two coordinates along `axes`.
std::vector<Vec3d> flat_corners(const std::vector<Vec3d>& points, const Spread& spread)
{
    struct Place {
        double x, y;
        std::size_t index;
    };
    std::vector<Place> order;
    for (std::size_t i = 0; i < points.size(); ++i) {
        const Vec3d local = spread.axes.transpose() * (points[i] - spread.centre);
        order.push_back({local.x(), local.y(), i});
    }
    std::sort(order.begin(), order.end(),
              [](const Place& a, const Place& b) { return a.x != b.x ? a.x < b.x : a.y < b.y; });
    const double least = kCorner * spread.size * spread.size;
    const auto turns = [&](const Place& a, const Place& b, const Place& c) {
        return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x) > least;
    };
    std::vector<Place> chain;
    for (int pass = 0; pass < 2; ++pass) {
        const std::size_t start = chain.size();
        for (const Place& p : order) {
            while (chain.size() >= start + 2 && !turns(chain[chain.size() - 2], chain.back(), p)) {
                chain.pop_back();
            }
            chain.push_back(p);
        }
        chain.pop_back();
        std::reverse(order.begin(), order.end());
    }
    std::vector<Vec3d> out;
    for (const Place& p : chain) {
        out.push_back(points[p.index]);
    }
    if (out.empty()) {
        out.push_back(points[0]);
    }
    return out;
}

/// A flat piece: its corners, and a fan of triangles over them.
std::optional<Piece> flat_piece(const std::vector<Vec3d>& points, const Spread& spread)
{
    Piece piece;
    piece.vertices = flat_corners(points, spread);
    if (piece.vertices.size() > geometry::kMaxPieceVertices) {
        return std::nullopt;
    }
    while (piece.vertices.size() < 3) {
        piece.vertices.push_back(piece.vertices.back());  // a line or a point
    }
    for (std::size_t i = 2; i < piece.vertices.size(); ++i) {
        piece.surface.push_back({0, i - 1, i});
    }
    return piece;
}

using Planes = std::vector<std::pair<Vec3d, double>>;

/// Corners of the polytope bounded by the planes: all intersections of three planes that no other plane cuts off.
std::vector<Vec3d> corners_of(const Planes& planes, double size)
{
    std::vector<Vec3d> out;
    const double thin = 1e-9 * size;
    for (std::size_t i = 0; i < planes.size(); ++i) {
        for (std::size_t j = i + 1; j < planes.size(); ++j) {
            for (std::size_t k = j + 1; k < planes.size(); ++k) {
                Eigen::Matrix3d rows;
                rows << planes[i].first.transpose(), planes[j].first.transpose(), planes[k].first.transpose();
                if (std::abs(rows.determinant()) < 1e-9) {
                    continue;
                }
                const Vec3d corner =
                    rows.partialPivLu().solve(Vec3d(planes[i].second, planes[j].second, planes[k].second));
                const bool inside = std::all_of(planes.begin(), planes.end(), [&](const auto& plane) {
                    return plane.first.dot(corner) <= plane.second + thin;
                });
                const bool known = std::any_of(
                    out.begin(), out.end(), [&](const Vec3d& other) { return (other - corner).norm() <= 10 * thin; });
                if (inside && !known) {
                    out.push_back(corner);
                }
            }
        }
    }
    return out;
}

std::pair<Vec3d, double> plane_around(const Hull& hull, const Vec3d& normal)
{
    double offset = -std::numeric_limits<double>::max();
    for (const Vec3d& v : hull.vertices) {
        offset = std::max(offset, normal.dot(v));
    }
    return {normal, offset};
}

/// From the hull to a corner outside of it: how far, and which way.
std::pair<double, Vec3d> outside_of(const std::vector<Point3>& hull, const Vec3d& centre, const Vec3d& corner)
{
    WorkBudget budget(1'000'000);
    const Vec3 point = (corner - centre).cast<float>();
    const geometry::Separation from = geometry::point_hull_distance(point, hull, {}, budget);
    return {static_cast<double>(from.distance), -from.direction.cast<double>().normalized()};
}

/// A polytope about the hull with as many corners as a piece may have, grown from the box along the axes of the spread.
std::vector<Vec3d> simplified(const Hull& hull, const Spread& spread)
{
    Planes planes;
    std::vector<Point3> near;
    for (const Vec3d& v : hull.vertices) {
        near.push_back(Point3::of((v - spread.centre).cast<float>()));
    }
    for (int axis = 0; axis < 3; ++axis) {
        planes.push_back(plane_around(hull, spread.axes.col(axis)));
        planes.push_back(plane_around(hull, -spread.axes.col(axis)));
    }
    std::vector<Vec3d> best = corners_of(planes, spread.size);
    // Cutting off a corner adds at least three new corners.
    for (std::size_t turn = 0; turn < geometry::kMaxPieceVertices; ++turn) {
        double farthest = 0.0;
        Vec3d normal = Vec3d::UnitZ();
        for (const Vec3d& corner : best) {
            const auto [distance, direction] = outside_of(near, spread.centre, corner);
            if (distance > farthest) {
                farthest = distance;
                normal = direction;
            }
        }
        if (farthest <= 1e-6 * spread.size) {
            break;
        }
        planes.push_back(plane_around(hull, normal));
        const std::vector<Vec3d> cut = corners_of(planes, spread.size);
        if (cut.size() > geometry::kMaxPieceVertices) {
            break;
        }
        best = cut;
    }
    return best;
}

}  // namespace

std::optional<Hull> hull_of(const std::vector<Vec3d>& points)
{
    const Spread spread = spread_of(points);
    if (is_flat(points, spread)) {
        return std::nullopt;
    }
    std::vector<double> coordinates;
    for (const Vec3d& p : points) {
        const Vec3d local = p - spread.centre;
        coordinates.insert(coordinates.end(), local.data(), local.data() + 3);
    }
    Qhull qhull;
    if (!qhull.run(coordinates)) {
        return std::nullopt;
    }
    qhT* qh = qhull.get();
    Hull out;
    std::map<int, std::size_t> known;
    facetT* facet = nullptr;
    vertexT* vertex = nullptr;
    vertexT** vertexp = nullptr;
    FORALLfacets
    {
        std::vector<std::size_t> corners;
        FOREACHvertex_(facet->vertices)
        {
            const int id = qh_pointid(qh, vertex->point);
            corners.push_back(place_of(out.vertices, known, id, points[static_cast<std::size_t>(id)]));
        }
        if (corners.size() != 3) {
            return std::nullopt;
        }
        const Vec3d normal(facet->normal[0], facet->normal[1], facet->normal[2]);
        const Vec3d turned = (out.vertices[corners[1]] - out.vertices[corners[0]])
                                 .cross(out.vertices[corners[2]] - out.vertices[corners[0]]);
        if (turned.dot(normal) < 0.0) {
            std::swap(corners[1], corners[2]);
        }
        out.triangles.push_back({corners[0], corners[1], corners[2]});
        const bool reported = std::any_of(out.planes.begin(), out.planes.end(),
                                          [&](const auto& plane) { return plane.first.dot(normal) > 1.0 - 1e-12; });
        if (!reported) {
            out.planes.emplace_back(normal, 0.0);
        }
    }
    for (auto& plane : out.planes) {
        plane = plane_around(out, plane.first);
    }
    return out;
}

std::optional<Piece> piece_around(const std::vector<Vec3d>& points)
{
    const Spread spread = spread_of(points);
    if (is_flat(points, spread)) {
        return flat_piece(points, spread);
    }
    std::optional<Hull> hull = hull_of(points);
    if (hull && hull->vertices.size() > geometry::kMaxPieceVertices) {
        hull = hull_of(simplified(*hull, spread));
    }
    // What is too thin for a hull and too thick for a plane has to be divided.
    const bool fits = hull && hull->vertices.size() <= geometry::kMaxPieceVertices && hull->planes.size() >= 4;
    return fits ? std::optional<Piece>(Piece{hull->vertices, hull->planes, hull->triangles, 0.0}) : std::nullopt;
}

}  // namespace jink::mesh
