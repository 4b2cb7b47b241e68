// SPDX-License-Identifier: BSD-3-Clause
#include "core/geometry/simplex.hpp"

#include <cassert>
#include <cmath>

#include <Eigen/Geometry>

namespace jink::geometry::detail {

namespace {

/// Relative rounding error of a cross product and a dot product after it, with a reserve.
constexpr float kSumRounding = 8.0F * 0x1p-24F;

/// A triangle whose height is below this share of its sides counts as a line.
constexpr float kFlat = 1e-6F;

Vec3 keep_one(Simplex& s, const Vec3& a) noexcept
{
    s.points[0] = a;
    s.size = 1;
    return a;
}

/// Nearest point on the line through a and b, at a + share * (b - a).
///
/// Where the line passes close to the origin, a + share * (b - a) cancels and its direction is lost. Subtracting the
/// remaining component along the line restores the direction.
Vec3 keep_two(Simplex& s, const Vec3& a, const Vec3& b, float share) noexcept
{
    s.points = {a, b, Vec3::Zero(), Vec3::Zero()};
    s.size = 2;
    const Vec3 ab = b - a;
    const Vec3 point = a + share * ab;
    return point - (point.dot(ab) / ab.squaredNorm()) * ab;
}

Vec3 nearest_on_segment(Simplex& s, const Vec3& a, const Vec3& b) noexcept
{
    const Vec3 ab = b - a;
    const float along = -ab.dot(a);
    const float length_squared = ab.squaredNorm();
    if (!(along > 0.0F)) {
        return keep_one(s, a);
    }
    return along < length_squared ? keep_two(s, a, b, along / length_squared) : keep_one(s, b);
}

/// For a triangle that is a line up to rounding: the nearest of its sides, each of which is exact.
Vec3 nearest_on_sides(Simplex& s, const Vec3& a, const Vec3& b, const Vec3& c) noexcept
{
    Vec3 nearest = nearest_on_segment(s, a, b);
    for (const Vec3* other : {&a, &b}) {
        Simplex candidate;
        const Vec3 point = nearest_on_segment(candidate, *other, c);
        if (point.squaredNorm() < nearest.squaredNorm()) {
            nearest = point;
            s = candidate;
        }
    }
    return nearest;
}

Vec3 nearest_on_triangle(Simplex& s, const Vec3& a, const Vec3& b, const Vec3& c) noexcept
{
    const Vec3 ab = b - a;
    const Vec3 ac = c - a;
    const Vec3 normal = ab.cross(ac);
    if (!(normal.squaredNorm() > kFlat * kFlat * ab.squaredNorm() * ac.squaredNorm())) {
        return nearest_on_sides(s, a, b, c);
    }
    const float ab_a = -ab.dot(a);
    const float ac_a = -ac.dot(a);
    if (ab_a <= 0.0F && ac_a <= 0.0F) {
        return keep_one(s, a);
    }
    const float ab_b = -ab.dot(b);
    const float ac_b = -ac.dot(b);
    if (ab_b >= 0.0F && ac_b <= ab_b) {
        return keep_one(s, b);
    }
    const float ab_c = -ab.dot(c);
    const float ac_c = -ac.dot(c);
    if (ac_c >= 0.0F && ab_c <= ac_c) {
        return keep_one(s, c);
    }
    // Signed areas across the sides as triple products: as differences of the dot products above they would cancel.
    const float on_c = normal.dot(a.cross(b));
    if (on_c <= 0.0F && ab_a >= 0.0F && ab_b <= 0.0F) {
        return keep_two(s, a, b, ab_a / (ab_a - ab_b));
    }
    const float on_b = normal.dot(c.cross(a));
    if (on_b <= 0.0F && ac_a >= 0.0F && ac_c <= 0.0F) {
        return keep_two(s, a, c, ac_a / (ac_a - ac_c));
    }
    const float on_a = normal.dot(b.cross(c));
    const float towards_c = ac_b - ab_b;
    const float towards_b = ab_c - ac_c;
    if (on_a <= 0.0F && towards_c >= 0.0F && towards_b >= 0.0F) {
        return keep_two(s, b, c, towards_c / (towards_c + towards_b));
    }
    s.points = {a, b, c, Vec3::Zero()};
    s.size = 3;
    // Along the normal, not as a sum of the points, which would cancel close to the origin.
    return (normal.dot(a) / normal.squaredNorm()) * normal;
}

/// Whether the origin may lie beyond the plane of a, b, c, on the other side than `inner`. Within rounding of the
/// plane, or of a flat tetrahedron, the answer is yes: unless the origin is surely inside, the faces are searched one
/// by one.
bool may_be_beyond(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& inner) noexcept
{
    const Vec3 normal = (b - a).cross(c - a);
    const float height = normal.dot(inner - a);
    const float origin = -normal.dot(a);
    const float rounding = kSumRounding * (b - a).norm() * (c - a).norm();
    if (std::abs(height) <= rounding * (inner - a).norm() || std::abs(origin) <= rounding * a.norm()) {
        return true;
    }
    return (height > 0.0F) != (origin > 0.0F);
}

Vec3 nearest_on_tetrahedron(Simplex& s) noexcept
{
    using Face = std::array<std::size_t, 4>;  // three corners and the one across
    constexpr std::array<Face, 4> kFaces{Face{0, 1, 2, 3}, Face{0, 1, 3, 2}, Face{0, 2, 3, 1}, Face{1, 2, 3, 0}};
    Simplex best;
    Vec3 nearest = Vec3::Zero();
    for (const Face& face : kFaces) {
        const Vec3& a = s.points[face[0]];
        const Vec3& b = s.points[face[1]];
        const Vec3& c = s.points[face[2]];
        if (may_be_beyond(a, b, c, s.points[face[3]])) {
            Simplex candidate;
            const Vec3 point = nearest_on_triangle(candidate, a, b, c);
            if (best.size == 0 || point.squaredNorm() < nearest.squaredNorm()) {
                nearest = point;
                best = candidate;
            }
        }
    }
    if (best.size > 0) {
        s = best;
    }
    return nearest;
}

}  // namespace

Vec3 reduce_to_nearest(Simplex& simplex) noexcept
{
    assert(simplex.size >= 1 && simplex.size <= 4);
    // Copies: the helpers write into the simplex.
    const auto p = simplex.points;
    switch (simplex.size) {
    case 1: return p[0];
    case 2: return nearest_on_segment(simplex, p[0], p[1]);
    case 3: return nearest_on_triangle(simplex, p[0], p[1], p[2]);
    default: return nearest_on_tetrahedron(simplex);
    }
}

}  // namespace jink::geometry::detail
