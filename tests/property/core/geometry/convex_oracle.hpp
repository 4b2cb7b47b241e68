// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <limits>
#include <vector>

#include <Eigen/Geometry>

#include "core/base/random.hpp"
#include "core/geometry/shape.hpp"
#include "tests/oracle/points.hpp"
#include "tests/property/core/geometry/oracle.hpp"

// Distance of convex solids in double precision by Wolfe's least-norm-point method (Wolfe 1976) with its own support
// functions: an upper bound (a point of the difference) and a lower bound (a separating plane) that converge to the
// true value.

namespace jink::geometry::oracle {

using Vec3d = Eigen::Vector3d;

struct Bounds {
    double lower = 0;  ///< proven by a plane, 0 in contact
    double upper = 0;  ///< norm of a point of the difference
};

/// Support of `shape` in double precision, from its definition.
inline Vec3d exact_support(const Shape& shape, const Vec3d& direction)
{
    const Eigen::Matrix3d axes = shape.axes.cast<double>();
    const Vec3d local = axes.transpose() * direction;
    const Vec3d half = shape.half.cast<double>();
    const double radius = double(shape.radius);
    const auto sign = [](double x) { return x < 0 ? -1.0 : 1.0; };
    Vec3d point = Vec3d::Zero();
    switch (shape.kind) {
    case ShapeKind::sphere: break;
    case ShapeKind::box:
        point = Vec3d(sign(local.x()) * half.x(), sign(local.y()) * half.y(), sign(local.z()) * half.z());
        break;
    case ShapeKind::capsule: point.z() = sign(local.z()) * half.z(); break;
    case ShapeKind::cylinder: {
        const double flat = std::hypot(local.x(), local.y());
        point = Vec3d(flat > 0 ? radius * local.x() / flat : 0, flat > 0 ? radius * local.y() / flat : 0,
                      sign(local.z()) * half.z());
        break;
    }
    case ShapeKind::hull: {
        double most = -std::numeric_limits<double>::infinity();
        for (const Point3& corner : shape.vertices) {
            const Vec3 vertex = corner.vec();
            const double along = vertex.cast<double>().dot(local);
            if (along > most) {
                most = along;
                point = vertex.cast<double>();
            }
        }
        break;
    }
    }
    return shape.centre.cast<double>() + axes * point;
}

/// Capacity of the point set. Four points span a simplex; affinely dependent points may stay for some iterations.
inline constexpr int kMaxPoints = 16;

/// Least-norm point of the affine hull of `points`, as weights.
std::vector<double> affine_weights(const std::vector<Vec3d>& points);

/// Distance of the origin from the convex set with support function `reach(direction)`, without the radius of spheres
/// and capsules.
template <class Support>
Bounds distance_from_origin(const Support& reach, double tolerance)
{
    std::vector<Vec3d> points{reach(Vec3d(1, 0, 0))};
    std::vector<double> share{1.0};
    Bounds bounds{0, points[0].norm()};
    for (int round = 0; round < 1000; ++round) {
        Vec3d x = Vec3d::Zero();
        for (std::size_t i = 0; i < points.size(); ++i) {
            x += share[i] * points[i];
        }
        bounds.upper = std::min(bounds.upper, x.norm());
        if (x.norm() <= tolerance) {
            return bounds;
        }
        const Vec3d next = reach(-x);
        bounds.lower = std::max(bounds.lower, x.dot(next) / x.norm());
        if (bounds.upper - bounds.lower <= tolerance) {
            return bounds;
        }
        if (points.size() > kMaxPoints) {
            return bounds;
        }
        points.push_back(next);
        share.push_back(0.0);
        for (int drop = 0; drop < 8; ++drop) {
            const std::vector<double> target = affine_weights(points);
            double step = 1;
            for (std::size_t i = 0; i < points.size(); ++i) {
                const double to = target[i];
                if (to < 0) {
                    step = std::min(step, share[i] / (share[i] - to));
                }
            }
            for (std::size_t i = 0; i < points.size(); ++i) {
                share[i] += step * (target[i] - share[i]);
            }
            for (std::size_t i = points.size(); i-- > 0;) {
                if (share[i] <= 1e-15 && points.size() > 1) {
                    points.erase(points.begin() + static_cast<std::ptrdiff_t>(i));
                    share.erase(share.begin() + static_cast<std::ptrdiff_t>(i));
                }
            }
            if (step >= 1) {
                break;
            }
        }
    }
    return bounds;
}

/// Distance between the swept box and the shape.
inline Bounds swept_box_bounds(const Vec3& half, const Vec3& from, const Vec3& to, const Shape& shape, double tolerance)
{
    const Vec3d a = from.cast<double>();
    const Vec3d b = to.cast<double>();
    const Vec3d h = half.cast<double>();
    const auto own = [&](const Vec3d& d) -> Vec3d {
        const Vec3d corner(d.x() < 0 ? -h.x() : h.x(), d.y() < 0 ? -h.y() : h.y(), d.z() < 0 ? -h.z() : h.z());
        return (d.dot(a) > d.dot(b) ? a : b) + corner;
    };
    Bounds bounds =
        distance_from_origin([&](const Vec3d& d) -> Vec3d { return own(d) - exact_support(shape, -d); }, tolerance);
    if (shape.kind == ShapeKind::sphere || shape.kind == ShapeKind::capsule) {
        bounds.lower = std::max(bounds.lower - double(shape.radius), 0.0);
        bounds.upper = std::max(bounds.upper - double(shape.radius), 0.0);
    }
    return bounds;
}

inline Mat3 any_rotation(Random& random)
{
    const auto axis = [&] {
        Vec3 v = in_cube(random, 1.0F);
        return v.norm() > 0.1F ? Vec3(v.normalized()) : Vec3(Vec3::UnitX());
    };
    return (Eigen::AngleAxisf(random.uniform(0.0F, 6.2831853F), axis())).toRotationMatrix();
}

/// Some vertices; now and then flat, a line, or a point.
inline std::vector<Vec3> any_vertices(Random& random, float size)
{
    std::vector<Vec3> vertices(1 + random.below(20));
    for (Vec3& v : vertices) {
        v = in_cube(random, size);
    }
    if (random.below(5) == 0) {
        const auto axis = static_cast<int>(random.below(3));
        for (Vec3& v : vertices) {
            v[axis] = 0.0F;
        }
    }
    return vertices;
}

/// A shape of about `size` around `centre`; a hull's vertices go to `vertices`.
inline Shape any_shape(Random& random, ShapeKind kind, const Vec3& centre, float size, std::vector<Point3>& vertices)
{
    const Vec3 arm = in_cube(random, size);
    switch (kind) {
    case ShapeKind::sphere: return make_sphere(centre, random.uniform(0.0F, size));
    case ShapeKind::box: {
        const Mat3 axes = random.below(4) == 0 ? Mat3(Mat3::Identity()) : any_rotation(random);
        return make_box(centre, in_cube(random, size).cwiseAbs(), axes);
    }
    case ShapeKind::capsule: return make_capsule(centre - arm, centre + arm, random.uniform(0.0F, size));
    case ShapeKind::cylinder: return make_cylinder(centre - arm, centre + arm, random.uniform(0.0F, size));
    case ShapeKind::hull: break;
    }
    vertices = jink::oracle::points_of(any_vertices(random, size));
    return make_hull(vertices, centre, any_rotation(random));
}

}  // namespace jink::geometry::oracle
