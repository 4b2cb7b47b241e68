// SPDX-License-Identifier: BSD-3-Clause
#include "core/geometry/hull_distance.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

#include <Eigen/Geometry>

#include "core/geometry/origin_search.hpp"

namespace jink::geometry {

namespace {

/// Largest relative error of one float operation.
constexpr float kUnitRoundoff = 0x1p-24F;
/// Rounding of a vertex's product with a unit vector, in roundings of the vertex's sum of magnitudes: the difference
/// and its stretching, three products, two sums, the vector's own length, and as much again as a reserve.
constexpr float kProductRoundings = 16.0F;

Vec3 stretched(const Vec3& v, float stretch) noexcept { return {v.x(), v.y(), stretch * v.z()}; }

/// The vertices seen from `origin`, in the stretched space.
struct Seen {
    std::span<const Point3> vertices;
    Vec3 origin;
    float stretch = 1.0F;

    [[nodiscard]] Vec3 at(std::size_t i) const noexcept { return stretched(vertices[i].vec() - origin, stretch); }
    [[nodiscard]] Vec3 support(const Vec3& direction) const noexcept
    {
        const Vec3 along = stretched(direction, stretch);
        std::size_t best = 0;
        float most = along.dot(vertices[0].vec() - origin);
        for (std::size_t i = 1; i < vertices.size(); ++i) {
            const float product = along.dot(vertices[i].vec() - origin);
            if (product > most) {
                most = product;
                best = i;
            }
        }
        return at(best);
    }
    /// Largest sum of magnitudes; the vertex nearest to the origin.
    [[nodiscard]] float size(Vec3& nearest) const noexcept
    {
        float largest = 0.0F;
        float least = std::numeric_limits<float>::max();
        for (std::size_t i = 0; i < vertices.size(); ++i) {
            const Vec3 v = at(i);
            largest = std::max(largest, v.cwiseAbs().sum());
            if (v.squaredNorm() < least) {
                least = v.squaredNorm();
                nearest = v;
            }
        }
        return largest;
    }
};

/// Whether the direction is long enough to start the search.
bool is_start(const Vec3& v) noexcept { return v.squaredNorm() > std::numeric_limits<float>::min(); }

template <class Support>
Separation search(const Support& support, const detail::SearchBegin& begin, float size, const DistanceQuery& query,
                  std::uint32_t turn, WorkBudget& budget) noexcept
{
    if (!is_start(begin.nearest)) {
        return {};
    }
    const detail::SearchLimits limits{0.0F, query.reach, query.resolution, 2 * kMaxDistanceTurns};
    const detail::SearchResult found =
        detail::search_origin(support, begin, kProductRoundings * kUnitRoundoff * size, limits, turn, budget);
    Separation out{found.proven, found.upper, found.towards};
    if (found.upper == std::numeric_limits<float>::max()) {
        out.upper = std::numeric_limits<float>::infinity();
    }
    return out;
}

/// Starts from the last answer if there is one, else from the nearest of a few points.
detail::SearchBegin begin_with(const DistanceQuery& query, const Vec3& nearest) noexcept
{
    return {is_start(query.start) ? query.start : nearest, nullptr, std::numeric_limits<float>::max()};
}

/// Of a sphere about a point `offset` away.
Separation from_sphere(const Vec3& offset, float radius, float slack) noexcept
{
    const float length = offset.norm();
    const float distance = length - radius - slack;
    if (!(distance > 0.0F)) {
        return {0.0F, std::max(length - radius, 0.0F) + slack, Vec3::Zero()};
    }
    return {distance, length - radius + slack, offset / length};
}

/// From `point` to the nearest point of the shape's axis, which is the centre for all but capsules and cylinders.
Vec3 to_axis(const Vec3& point, const Shape& shape) noexcept
{
    Vec3 offset = shape.centre - point;
    if (shape.kind != ShapeKind::capsule && shape.kind != ShapeKind::cylinder) {
        return offset;
    }
    const Vec3 axis = shape.axes.col(2);
    const float along = std::clamp(-offset.dot(axis) / axis.squaredNorm(), -shape.half.z(), shape.half.z());
    return offset + along * axis;
}

/// A sphere about a point or a segment: axes within their tolerance affect nothing else.
bool is_rounded(const Shape& shape) noexcept
{
    return shape.kind == ShapeKind::sphere || shape.kind == ShapeKind::capsule;
}

/// Keeps the exit along `direction`, of any length, if it is shorter than the best exit so far.
template <class Support>
void try_exit(const Support& support, const Vec3& direction, Exit& best) noexcept
{
    const float length = direction.norm();
    if (!(length > std::numeric_limits<float>::min())) {
        return;
    }
    const Vec3 unit = direction / length;
    const float depth = unit.dot(support(unit));
    if (depth < best.depth) {
        best = {depth, unit};
    }
}

/// Of a triangle by its nearest point, where the plane across the way there proves it. False where it does not: thin
/// triangles, and points on it.
bool distance_from_triangle(const Seen& seen, const DistanceQuery& query, Separation& out) noexcept
{
    const Vec3 a = seen.at(0);
    const Vec3 b = seen.at(1);
    const Vec3 c = seen.at(2);
    detail::Simplex simplex{{a, b, c, Vec3::Zero()}, 3};
    const Vec3 nearest = detail::reduce_to_nearest(simplex);
    const float length = nearest.norm();
    const float size = std::max({a.cwiseAbs().sum(), b.cwiseAbs().sum(), c.cwiseAbs().sum()});
    const float slack = kProductRoundings * kUnitRoundoff * size;
    const Vec3 towards = nearest / length;
    const float proven = std::min({towards.dot(a), towards.dot(b), towards.dot(c)}) - slack;
    // A point without a direction gives NaN, which fails too.
    if (!(proven > 0.0F && (proven >= query.reach || length - proven <= query.resolution + 2.0F * slack))) {
        return false;
    }
    out = {proven, length, towards};
    return true;
}

}  // namespace

Separation point_hull_distance(const Vec3& point, std::span<const Point3> vertices, const DistanceQuery& query,
                               WorkBudget& budget) noexcept
{
    assert(!vertices.empty() && query.stretch > 0.0F && query.reach > 0.0F);
    const Seen seen{vertices, point, query.stretch};
    const std::uint32_t turn = distance_turn_units(vertices.size());
    if (Separation out; vertices.size() == 3) {
        if (!budget.spend(turn)) {
            return {};
        }
        if (distance_from_triangle(seen, query, out)) {
            return out;
        }
    }
    Vec3 nearest = Vec3::Zero();
    const float size = seen.size(nearest);
    const auto support = [&](const Vec3& direction) { return seen.support(direction); };
    detail::SearchBegin begin = begin_with(query, nearest);
    detail::Simplex simplex;
    if (vertices.size() <= 3) {
        // All vertices at once: one turn proves the result.
        simplex.points.fill(Vec3::Zero());
        simplex.size = vertices.size();
        for (std::size_t i = 0; i < vertices.size(); ++i) {
            simplex.points[i] = seen.at(i);
        }
        begin.nearest = detail::reduce_to_nearest(simplex);
        begin.simplex = &simplex;
        begin.upper = begin.nearest.norm();
    }
    return search(support, begin, size, query, turn, budget);
}

Separation point_shape_distance(const Vec3& point, const Shape& shape, const DistanceQuery& query,
                                WorkBudget& budget) noexcept
{
    assert(is_valid(shape) && query.stretch > 0.0F && query.reach > 0.0F);
    if (shape.kind == ShapeKind::hull && shape.axes == Mat3::Identity()) {
        return point_hull_distance(point - shape.centre, shape.vertices, query, budget);
    }
    const Vec3 offset = stretched(shape.centre - point, query.stretch);
    const float size = offset.cwiseAbs().sum() + std::max(1.0F, query.stretch) * bounding_radius(shape);
    const std::uint32_t turn = distance_turn_units(shape.vertices.size());
    if (query.stretch == 1.0F && is_rounded(shape)) {
        if (!budget.spend(turn)) {
            return {0.0F, std::numeric_limits<float>::infinity(), Vec3::Zero()};
        }
        return from_sphere(to_axis(point, shape), shape.radius, kProductRoundings * kUnitRoundoff * size);
    }
    Shape centred = shape;
    centred.centre = Vec3::Zero();
    const auto support = [&](const Vec3& direction) -> Vec3 {
        return offset + stretched(geometry::support(centred, stretched(direction, query.stretch)), query.stretch);
    };
    return search(support, begin_with(query, offset), size, query, turn, budget);
}

Exit exit_of_shape(const Vec3& point, const Shape& shape, float stretch) noexcept
{
    const Vec3 offset = stretched(shape.centre - point, stretch);
    Shape centred = shape;
    centred.centre = Vec3::Zero();
    const auto support = [&](const Vec3& direction) -> Vec3 {
        return offset + stretched(geometry::support(centred, stretched(direction, stretch)), stretch);
    };
    Exit best{std::numeric_limits<float>::max(), Vec3::UnitZ()};
    // A normal of the unstretched space is mapped to the stretched space by S^-1.
    const Vec3 local = shape.axes.transpose() * (point - shape.centre);
    try_exit(support, stretched(-to_axis(point, shape), 1.0F / stretch), best);
    try_exit(support, stretched(shape.axes * Vec3(local.x(), local.y(), 0.0F), 1.0F / stretch), best);
    try_exit(support, -offset, best);
    for (int axis = 0; axis < 3; ++axis) {
        const Vec3 normal = stretched(shape.axes.col(axis), 1.0F / stretch);
        try_exit(support, normal, best);
        try_exit(support, -normal, best);
    }
    if (shape.vertices.size() >= 3) {
        const Vec3 corner = shape.vertices[0].vec();
        const Vec3 across = (shape.vertices[1].vec() - corner).cross(shape.vertices[2].vec() - corner);
        const Vec3 normal = stretched(shape.axes * across, 1.0F / stretch);
        try_exit(support, normal, best);
        try_exit(support, -normal, best);
    }
    return best;
}

}  // namespace jink::geometry
