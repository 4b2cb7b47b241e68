// SPDX-License-Identifier: BSD-3-Clause
#include "toolchain/mesh/solid.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <queue>

#include <Eigen/Geometry>

namespace jink::mesh {
namespace {

using Corners = std::array<Vec3d, 3>;

constexpr std::size_t kLeaf = 4;  ///< largest number of triangles in a leaf box
/// Largest number of parts of a piece's surface that are checked; the result then stays an upper bound.
constexpr std::size_t kMaxParts = 10'000;

double distance_from_segment(const Vec3d& p, const Vec3d& a, const Vec3d& b)
{
    const Vec3d ab = b - a;
    const double squared = ab.squaredNorm();
    const double share = squared > 0.0 ? std::clamp((p - a).dot(ab) / squared, 0.0, 1.0) : 0.0;
    return (p - (a + share * ab)).norm();
}

/// Distance along the normal over the triangle's interior, else distance from one of its sides.
double distance_from_triangle(const Vec3d& p, const Corners& t)
{
    const Vec3d normal = (t[1] - t[0]).cross(t[2] - t[0]);
    const double squared = normal.squaredNorm();
    if (squared > 0.0) {
        bool over = true;
        for (std::size_t i = 0; i < 3; ++i) {
            over = over && normal.dot((t[(i + 1) % 3] - t[i]).cross(p - t[i])) >= 0.0;
        }
        if (over) {
            return std::abs(normal.dot(p - t[0])) / std::sqrt(squared);
        }
    }
    return std::min({distance_from_segment(p, t[0], t[1]), distance_from_segment(p, t[1], t[2]),
                     distance_from_segment(p, t[2], t[0])});
}

/// Solid angle of the triangle as seen from `p` (Van Oosterom & Strackee 1983).
double solid_angle(const Vec3d& p, const Corners& t)
{
    const Vec3d a = t[0] - p;
    const Vec3d b = t[1] - p;
    const Vec3d c = t[2] - p;
    const double la = a.norm();
    const double lb = b.norm();
    const double lc = c.norm();
    return 2.0 * std::atan2(a.dot(b.cross(c)), la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb);
}

/// A part of a piece's surface and an upper bound on its points' excess.
struct Part {
    Corners corners;
    double bound = 0.0;

    bool operator<(const Part& other) const { return bound < other.bound; }
};

}  // namespace

Solid::Solid(const TriangleMesh& mesh) : mesh_(mesh), order_(mesh.triangles.size())
{
    std::iota(order_.begin(), order_.end(), std::size_t{0});
    closed_ = open_edges(mesh, order_) == 0;
    double volume = 0.0;  // six times the volume
    for (const std::size_t triangle : order_) {
        const Corners c = mesh.corners(triangle);
        const Vec3d& from = mesh.vertices[0];
        volume += (c[0] - from).dot((c[1] - from).cross(c[2] - from));
    }
    outward_ = closed_ && volume > 0.0;
    split(0, order_.size());
}

void Solid::split(std::size_t first, std::size_t last)
{
    const std::size_t at = boxes_.size();
    Box box{Vec3d::Constant(std::numeric_limits<double>::max()), Vec3d::Constant(-std::numeric_limits<double>::max()),
            first, last, 0};
    for (std::size_t i = first; i < last; ++i) {
        for (const Vec3d& v : mesh_.corners(order_[i])) {
            box.low = box.low.cwiseMin(v);
            box.high = box.high.cwiseMax(v);
        }
    }
    boxes_.push_back(box);
    if (last - first <= kLeaf) {
        return;
    }
    int axis = 0;
    (box.high - box.low).maxCoeff(&axis);
    const std::size_t middle = (first + last) / 2;
    const auto place = [&](std::size_t i) { return order_.begin() + static_cast<std::ptrdiff_t>(i); };
    const auto centre = [&](std::size_t t) {
        const Corners c = mesh_.corners(t);
        return c[0][axis] + c[1][axis] + c[2][axis];
    };
    std::nth_element(place(first), place(middle), place(last),
                     [&](std::size_t a, std::size_t b) { return centre(a) < centre(b); });
    split(first, middle);
    boxes_[at].right = boxes_.size();
    split(middle, last);
}

Solid::Nearest Solid::nearest_on_surface(const Vec3d& point) const
{
    Nearest nearest{std::numeric_limits<double>::max(), 0};
    double& least = nearest.distance;
    std::vector<std::pair<double, std::size_t>> stack;
    const auto put = [&](std::size_t at) {
        const Box& box = boxes_[at];
        const double off = (box.low - point).cwiseMax(point - box.high).cwiseMax(0.0).norm();
        if (off < least) {
            stack.emplace_back(off, at);
        }
    };
    put(0);
    while (!stack.empty()) {
        const auto [off, at] = stack.back();
        stack.pop_back();
        const Box& box = boxes_[at];
        if (off >= least) {
            continue;
        }
        if (box.right == 0) {
            for (std::size_t i = box.first; i < box.last; ++i) {
                const double distance = distance_from_triangle(point, mesh_.corners(order_[i]));
                if (distance < least) {
                    nearest = {distance, order_[i]};
                }
            }
            continue;
        }
        put(box.right);
        put(at + 1);
        if (stack.size() >= 2 && stack[stack.size() - 2].first < stack.back().first) {
            std::swap(stack[stack.size() - 2], stack.back());
        }
    }
    return nearest;
}

double Solid::distance_from(std::size_t triangle, const Vec3d& point) const
{
    return distance_from_triangle(point, mesh_.corners(triangle));
}

bool Solid::is_behind(std::size_t triangle, const Vec3d& point) const
{
    const Corners t = mesh_.corners(triangle);
    const Vec3d normal = (t[1] - t[0]).cross(t[2] - t[0]);
    if (!outward_ || normal.dot(point - t[0]) >= 0.0) {
        return false;
    }
    for (std::size_t i = 0; i < 3; ++i) {
        if (normal.dot((t[(i + 1) % 3] - t[i]).cross(point - t[i])) <= 0.0) {
            return false;
        }
    }
    return true;
}

bool Solid::holds(const Vec3d& point) const
{
    if (!closed_) {
        return false;
    }
    double sum = 0.0;
    for (std::size_t i = 0; i < mesh_.triangles.size(); ++i) {
        sum += solid_angle(point, mesh_.corners(i));
    }
    return std::abs(sum) > 2.0 * std::numbers::pi;
}

double excess_of(const Piece& piece, const Solid& solid, double tolerance)
{
    std::priority_queue<Part> parts;
    double known = 0.0;                                                              // largest excess of a checked
                                                                                     // point
    const double touching = 1e-9 * piece.vertices[0].cwiseAbs().maxCoeff() + 1e-12;  // on the surface, up to rounding
    const auto put = [&](const Corners& corners) {
        const Vec3d centre = (corners[0] + corners[1] + corners[2]) / 3.0;
        double radius = 0.0;
        for (const Vec3d& corner : corners) {
            radius = std::max(radius, (corner - centre).norm());
        }
        const auto [off, triangle] = solid.nearest_on_surface(centre);
        // The distance from a triangle, which is convex, is greatest at a corner.
        double from_one = 0.0;
        for (const Vec3d& corner : corners) {
            from_one = std::max(from_one, solid.distance_from(triangle, corner));
        }
        const double bound = std::min(off + radius, from_one);
        if (bound <= known + (known > 0.0 ? tolerance : touching)) {
            return;
        }
        // If the centre is inside, all points within `off` are inside too.
        const bool inside = solid.is_behind(triangle, centre) || solid.holds(centre);
        known = std::max(known, inside || off <= touching ? 0.0 : off);
        parts.push({corners, inside ? std::min(radius - off, bound) : bound});
    };
    for (const auto& t : piece.surface) {
        put({piece.vertices[t[0]], piece.vertices[t[1]], piece.vertices[t[2]]});
    }
    for (std::size_t count = 0; !parts.empty(); ++count) {
        const Part part = parts.top();
        if (part.bound <= known + tolerance) {
            break;
        }
        if (count == kMaxParts) {
            return part.bound;
        }
        parts.pop();
        const auto& c = part.corners;
        const Vec3d ab = 0.5 * (c[0] + c[1]);
        const Vec3d bc = 0.5 * (c[1] + c[2]);
        const Vec3d ca = 0.5 * (c[2] + c[0]);
        for (const Corners& quarter :
             {Corners{c[0], ab, ca}, Corners{ab, c[1], bc}, Corners{ca, bc, c[2]}, Corners{ab, bc, ca}}) {
            put(quarter);
        }
    }
    // No part exceeds the known excess by more than the tolerance.
    return known > 0.0 ? known + tolerance : (parts.empty() ? 0.0 : std::max(0.0, parts.top().bound));
}

namespace {

/// Distance of the nearest piece below `node` where that is less than `least` [m].
float nearest_piece(const geometry::MeshMap& map, std::size_t node, const Vec3& point, float least)
{
    const geometry::MeshNode& at = map.nodes[node];
    if (geometry::box_distance(at, point) >= least) {
        return least;
    }
    if (!at.is_leaf()) {
        return nearest_piece(map, at.right, point, nearest_piece(map, node + 1, point, least));
    }
    geometry::DistanceQuery query;
    query.resolution = 0.0F;
    WorkBudget budget(1'000'000'000);
    return std::min(least, geometry::point_shape_distance(point, map.shape_of(at.piece), query, budget).distance);
}

}  // namespace

double gap_of(const TriangleMesh& mesh, const geometry::MeshMap& map, double spacing)
{
    double gap = 0.0;
    const auto look = [&](const Vec3d& point) {
        const float distance = nearest_piece(map, 0, point.cast<float>(), 1e4F);
        gap = std::max(gap, static_cast<double>(distance) - static_cast<double>(map.slack));
    };
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
        const Corners c = mesh.corners(i);
        const double longest = std::max({(c[1] - c[0]).norm(), (c[2] - c[1]).norm(), (c[0] - c[2]).norm()});
        const auto steps = static_cast<std::size_t>(std::ceil(longest / spacing)) + 1;
        for (std::size_t u = 0; u <= steps; ++u) {
            for (std::size_t v = 0; u + v <= steps; ++v) {
                const double a = static_cast<double>(u) / static_cast<double>(steps);
                const double b = static_cast<double>(v) / static_cast<double>(steps);
                look(c[0] + a * (c[1] - c[0]) + b * (c[2] - c[0]));
            }
        }
    }
    return gap;
}

}  // namespace jink::mesh
