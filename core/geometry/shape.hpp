// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>

#include "core/base/point3.hpp"
#include "core/base/vec3.hpp"

namespace jink::geometry {

enum class ShapeKind : std::uint8_t { sphere, box, capsule, cylinder, hull };

/// A static convex solid in the world frame. A value of 88 bytes at most; a hull refers to vertices that outlive it.
///
/// Made by the functions below, which accept any values. Callers check `is_valid` where the numbers come from outside.
struct Shape {
    ShapeKind kind = ShapeKind::sphere;
    Vec3 centre = Vec3::Zero();    ///< [m]
    Mat3 axes = Mat3::Identity();  ///< columns: the solid's own axes in the world frame, orthonormal
    float radius = 0.0F;           ///< sphere, capsule, cylinder [m]
    Vec3 half = Vec3::Zero();  ///< box: half extents [m]; capsule, cylinder: z = half length of the axis segment [m]
    std::span<const Point3> vertices{};  ///< hull: in its own frame [m], at most kMaxHullVertices
};

[[nodiscard]] Shape make_sphere(const Vec3& centre, float radius) noexcept;
[[nodiscard]] Shape make_box(const Vec3& centre, const Vec3& half_extents,
                             const Mat3& axes = Mat3::Identity()) noexcept;
/// Capsule: all points within `radius` of the segment from `a` to `b` [m].
[[nodiscard]] Shape make_capsule(const Vec3& a, const Vec3& b, float radius) noexcept;
/// Flat-ended cylinder with its axis from `a` to `b` [m].
[[nodiscard]] Shape make_cylinder(const Vec3& a, const Vec3& b, float radius) noexcept;
/// Convex hull of `vertices`, placed by rotation `axes` and translation `centre`.
[[nodiscard]] Shape make_hull(std::span<const Point3> vertices, const Vec3& centre,
                              const Mat3& axes = Mat3::Identity()) noexcept;

/// Finite, non-negative sizes, orthonormal axes (1e-3), 1..kMaxHullVertices vertices for a hull.
[[nodiscard]] bool is_valid(const Shape& shape) noexcept;

/// Farthest point of the solid in `direction` (any length; zero gives some point of the solid) [m].
/// O(1), O(vertices) for a hull.
[[nodiscard]] Vec3 support(const Shape& shape, const Vec3& direction) noexcept;

/// Point of the solid that is nearest to `from` [m]; `from` itself where that lies inside.
///
/// Exact for all but hulls, which count as their bounding sphere: nearer than they are, never farther. O(1),
/// O(vertices) for a hull.
[[nodiscard]] Vec3 nearest_point(const Shape& shape, const Vec3& from) noexcept;

/// Radius of the smallest sphere about `centre` that this function can prove to hold the solid [m].
[[nodiscard]] float bounding_radius(const Shape& shape) noexcept;

}  // namespace jink::geometry
