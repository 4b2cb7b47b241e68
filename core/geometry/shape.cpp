// SPDX-License-Identifier: BSD-3-Clause
#include "core/geometry/shape.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

#include <Eigen/Geometry>

#include "core/capacity.hpp"

namespace jink::geometry {

namespace {

/// Axes count as orthonormal if no element of axes^T * axes differs from the identity's by more than this.
constexpr float kAxesTolerance = 1e-3F;
/// Such axes stretch a vector by sqrt(1 + 3 * kAxesTolerance) at most; a rounding margin is included.
constexpr float kAxesStretch = 1.002F;

/// `direction` scaled to length 1, or zero. Scaled by its largest component first: squares neither overflow nor vanish.
Vec3 unit_or_zero(const Vec3& direction) noexcept
{
    const float largest = direction.cwiseAbs().maxCoeff();
    if (!(largest > 0.0F)) {
        return Vec3::Zero();
    }
    const Vec3 scaled = direction / largest;
    return scaled / scaled.norm();
}

float signed_like(float magnitude, float sign) noexcept { return sign < 0.0F ? -magnitude : magnitude; }

/// `from` pulled to within `radius` of `core`.
Vec3 on_sphere(const Vec3& core, float radius, const Vec3& from) noexcept
{
    const Vec3 out = from - core;
    const float distance = out.norm();
    return distance <= radius ? from : Vec3(core + out * (radius / distance));
}

Vec3 hull_support(const Shape& shape, const Vec3& local) noexcept
{
    assert(!shape.vertices.empty());
    const Point3* best = &shape.vertices.front();
    float most = best->vec().dot(local);
    for (const Point3& vertex : shape.vertices.subspan(1)) {
        const float along = vertex.vec().dot(local);
        if (along > most) {
            most = along;
            best = &vertex;
        }
    }
    return best->vec();
}

/// Farthest point in the solid's own frame; `local` is the direction in that frame, of length 1 or zero.
Vec3 local_support(const Shape& shape, const Vec3& local) noexcept
{
    switch (shape.kind) {
    case ShapeKind::box:
        return {signed_like(shape.half.x(), local.x()), signed_like(shape.half.y(), local.y()),
                signed_like(shape.half.z(), local.z())};
    case ShapeKind::cylinder: {
        const Vec3 radial = unit_or_zero({local.x(), local.y(), 0.0F});
        return {shape.radius * radial.x(), shape.radius * radial.y(), signed_like(shape.half.z(), local.z())};
    }
    case ShapeKind::capsule: return {0.0F, 0.0F, signed_like(shape.half.z(), local.z())};
    case ShapeKind::hull: return hull_support(shape, local);
    case ShapeKind::sphere: break;
    }
    return Vec3::Zero();
}

/// Frame whose z axis runs from `a` to `b`; the world's when they coincide.
Mat3 frame_along(const Vec3& a, const Vec3& b) noexcept
{
    const Vec3 z = unit_or_zero(b - a);
    if (z.isZero(0.0F)) {
        return Mat3::Identity();
    }
    const Vec3 x = z.unitOrthogonal();
    Mat3 axes;
    axes.col(0) = x;
    axes.col(1) = z.cross(x);
    axes.col(2) = z;
    return axes;
}

Shape make_along(ShapeKind kind, const Vec3& a, const Vec3& b, float radius) noexcept
{
    Shape shape;
    shape.kind = kind;
    shape.centre = a + 0.5F * (b - a);
    shape.axes = frame_along(a, b);
    shape.radius = radius;
    shape.half = {0.0F, 0.0F, 0.5F * (b - a).norm()};
    return shape;
}

bool has_valid_vertices(const Shape& shape) noexcept
{
    const auto& v = shape.vertices;
    return !v.empty() && v.size() <= kMaxHullVertices &&
           std::all_of(v.begin(), v.end(), [](const Point3& p) { return is_finite(p.vec()); });
}

}  // namespace

Shape make_sphere(const Vec3& centre, float radius) noexcept
{
    Shape shape;
    shape.centre = centre;
    shape.radius = radius;
    return shape;
}

Shape make_box(const Vec3& centre, const Vec3& half_extents, const Mat3& axes) noexcept
{
    Shape shape;
    shape.kind = ShapeKind::box;
    shape.centre = centre;
    shape.axes = axes;
    shape.half = half_extents;
    return shape;
}

Shape make_capsule(const Vec3& a, const Vec3& b, float radius) noexcept
{
    return make_along(ShapeKind::capsule, a, b, radius);
}

Shape make_cylinder(const Vec3& a, const Vec3& b, float radius) noexcept
{
    return make_along(ShapeKind::cylinder, a, b, radius);
}

Shape make_hull(std::span<const Point3> vertices, const Vec3& centre, const Mat3& axes) noexcept
{
    Shape shape;
    shape.kind = ShapeKind::hull;
    shape.centre = centre;
    shape.axes = axes;
    shape.vertices = vertices;
    return shape;
}

bool is_valid(const Shape& shape) noexcept
{
    if (!is_finite(shape.centre) || !std::isfinite(shape.radius) || !(shape.radius >= 0.0F)) {
        return false;
    }
    if (!is_finite(shape.half) || !(shape.half.minCoeff() >= 0.0F)) {
        return false;
    }
    const Mat3 deviation = shape.axes.transpose() * shape.axes - Mat3::Identity();
    // Written so that a NaN fails.
    if (!(deviation.cwiseAbs().array() <= kAxesTolerance).all()) {
        return false;
    }
    switch (shape.kind) {
    case ShapeKind::hull: return has_valid_vertices(shape);
    case ShapeKind::sphere:
    case ShapeKind::box:
    case ShapeKind::capsule:
    case ShapeKind::cylinder: return true;
    }
    return false;
}

Vec3 support(const Shape& shape, const Vec3& direction) noexcept
{
    const Vec3 unit = unit_or_zero(direction);
    switch (shape.kind) {
    case ShapeKind::sphere: return shape.centre + shape.radius * unit;
    case ShapeKind::capsule:
        return shape.centre + shape.axes * local_support(shape, shape.axes.transpose() * unit) + shape.radius * unit;
    case ShapeKind::box:
    case ShapeKind::cylinder:
    case ShapeKind::hull: break;
    }
    return shape.centre + shape.axes * local_support(shape, shape.axes.transpose() * unit);
}

Vec3 nearest_point(const Shape& shape, const Vec3& from) noexcept
{
    const Vec3 local = shape.axes.transpose() * (from - shape.centre);
    switch (shape.kind) {
    case ShapeKind::sphere: return on_sphere(shape.centre, shape.radius, from);
    case ShapeKind::capsule: {
        const float along = std::clamp(local.z(), -shape.half.z(), shape.half.z());
        return on_sphere(shape.centre + shape.axes.col(2) * along, shape.radius, from);
    }
    case ShapeKind::box: return shape.centre + shape.axes * local.cwiseMax(-shape.half).cwiseMin(shape.half);
    case ShapeKind::cylinder: {
        const float aside = std::hypot(local.x(), local.y());
        const float share = aside > shape.radius ? shape.radius / aside : 1.0F;
        const float along = std::clamp(local.z(), -shape.half.z(), shape.half.z());
        return shape.centre + shape.axes * Vec3(share * local.x(), share * local.y(), along);
    }
    case ShapeKind::hull: break;
    }
    return on_sphere(shape.centre, bounding_radius(shape), from);
}

float bounding_radius(const Shape& shape) noexcept
{
    switch (shape.kind) {
    case ShapeKind::sphere: return shape.radius;
    case ShapeKind::box: return kAxesStretch * shape.half.norm();
    case ShapeKind::capsule: return kAxesStretch * shape.half.z() + shape.radius;
    case ShapeKind::cylinder: return kAxesStretch * std::hypot(shape.half.z(), shape.radius);
    case ShapeKind::hull: break;
    }
    float squared = 0.0F;
    for (const Point3& vertex : shape.vertices) {
        squared = std::max(squared, vertex.vec().squaredNorm());
    }
    return kAxesStretch * std::sqrt(squared);
}

}  // namespace jink::geometry
