// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

#include "core/geometry/past_box.hpp"
#include "core/geometry/sweep.hpp"

// Relative to the box, the threat's point less the own point fills the parallelogram corner + s * threat - t * own, 0
// <= s, t <= 1. The box's distance from the parallelogram is attained on one of its four edges (a point moving past the
// box: closed form), or between its inside and a corner of the box, or the box pierces the parallelogram. The last two
// need one point of the box only: the point nearest to the parallelogram's plane. Where that point is not unique, the
// nearest points are an edge or a face parallel to the plane. Such an edge or face covers the parallelogram's border,
// which the edges find, or lies inside the parallelogram as a whole, or misses it.

namespace jink::geometry {

namespace {

using detail::PastBox;

/// A second side shorter than this share of its length across the first is rounding: the parallelogram is a segment.
constexpr float kFlatShare = 16.0F * 0x1p-24F;

float edge_distance_squared(const Vec3& half, const Vec3& from, const Vec3& along) noexcept
{
    const PastBox past(half, from, along);
    return past.distance_squared(past.closest(past.instants(1.0F)));
}

/// High part of a number, with at most 12 significant bits (Dekker 1971): products of such parts are exact.
float high_part(float x) noexcept
{
    const float spread = 4097.0F * x;
    return spread - (spread - x);
}

/// y - factor * x, rounded once: the product's rounding error is computed and subtracted (Dekker 1971).
float difference_exactly(float y, float factor, float x) noexcept
{
    const float product = factor * x;
    const float fh = high_part(factor);
    const float fl = factor - fh;
    const float xh = high_part(x);
    const float xl = x - xh;
    const float error = ((fh * xh - product) + fh * xl + fl * xh) + fl * xl;
    return (y - product) - error;
}

/// Squared distance between the box and a candidate for the closest point of the parallelogram corner + s * u + t * v;
/// |u| >= |v|. The candidate is the closest point if the closest point lies inside. Never below the true distance.
///
/// v is replaced by its part across u, free of cancellation, so that slender parallelograms lose no accuracy.
float inside_distance_squared(const Vec3& half, const Vec3& corner, const Vec3& u, const Vec3& v) noexcept
{
    constexpr float kNone = std::numeric_limits<float>::infinity();
    const float length_squared = u.squaredNorm();
    if (!(length_squared > 0.0F)) {
        return kNone;
    }
    const float shear = u.dot(v) / length_squared;
    const Vec3 across(difference_exactly(v.x(), shear, u.x()), difference_exactly(v.y(), shear, u.y()),
                      difference_exactly(v.z(), shear, u.z()));
    const Vec3 normal = u.cross(across);
    const float normal_squared = normal.squaredNorm();
    if (!(across.squaredNorm() > kFlatShare * kFlatShare * v.squaredNorm()) || !(normal_squared > 0.0F)) {
        return kNone;
    }
    const float plane = normal.dot(corner);
    const float extent = normal.cwiseAbs().dot(half);
    const float share = std::abs(plane) < extent ? plane / extent : std::copysign(1.0F, plane);
    const Vec3 nearest(std::copysign(share * half.x(), share * normal.x()),
                       std::copysign(share * half.y(), share * normal.y()),
                       std::copysign(share * half.z(), share * normal.z()));
    const Vec3 w = nearest - corner;
    const float t = std::clamp(u.cross(w).dot(normal) / normal_squared, 0.0F, 1.0F);
    const float s = std::clamp(w.cross(across).dot(normal) / normal_squared - t * shear, 0.0F, 1.0F);
    const Vec3 point = corner + s * u + t * v;
    return (point - point.cwiseMax(-half).cwiseMin(half)).squaredNorm();
}

}  // namespace

float swept_distance(const Vec3& half, const Vec3& own_from, const Vec3& own_to, const Vec3& threat_from,
                     const Vec3& threat_to) noexcept
{
    const Vec3 own = own_from - own_to;
    const Vec3 threat = threat_to - threat_from;
    const Vec3 corner = threat_from - own_from;
    const float edges = std::min(
        std::min(edge_distance_squared(half, corner, threat),
                 edge_distance_squared(half, threat_from - own_to, threat)),
        std::min(edge_distance_squared(half, corner, own), edge_distance_squared(half, threat_to - own_from, own)));
    const bool threat_is_longer = threat.squaredNorm() >= own.squaredNorm();
    const float inside = threat_is_longer ? inside_distance_squared(half, corner, threat, own)
                                          : inside_distance_squared(half, corner, own, threat);
    return std::sqrt(std::min(edges, inside));
}

}  // namespace jink::geometry
