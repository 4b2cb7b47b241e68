// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include "core/base/time.hpp"
#include "core/base/vec3.hpp"

// Swept and moving tests between the own safety box (world-aligned, moving without turning) and spheres, in closed
// form. The box against a sphere of radius r is a point against the box rounded by r; both moving, the point's motion
// is the relative one. No iteration, no allocation. Oracle: double-precision convex minimisation and bisection.

namespace jink::geometry {

/// Straight motion at constant velocity: position at t = 0 [m], velocity [m/s].
struct Motion {
    Vec3 position = Vec3::Zero();
    Vec3 velocity = Vec3::Zero();
};

/// Closed interval of time [s], first <= last.
struct TimeInterval {
    Seconds first = 0.0F;
    Seconds last = 0.0F;
};

/// Least distance between two moving solids and when it occurs.
struct Approach {
    float distance = 0.0F;  ///< [m], 0 when they touch or overlap
    Seconds when = 0.0F;    ///< first instant of the least distance [s]
};

/// Time interval in which a moving sphere touches a box that moves without turning.
///
/// @param half     half extents of the box [m], >= 0, world-aligned, centred on `own.position`
/// @param own      own motion over the interval
/// @param threat   motion of the sphere's centre
/// @param radius   of the sphere [m], >= 0
/// @param horizon  interval length [s], > 0
/// @return first and last contact within [0, horizon], or nothing. Touching counts as contact, and so does a NaN in
///         `half`, `radius` or either motion where the other numbers do not exclude contact.
///
/// Exact for straight motion but for float rounding, which works to the safe side. With
/// e = 1e-6 * (sum of the relative position's magnitudes + sum of `half` + radius) [m]:
/// no contact is missed, and a reported contact comes within e of touching. `first` is never later and `last` never
/// earlier than the true instant (by more than 2.4e-7 * horizon). At both instants the distance exceeds the radius by e
/// at most, so that an instant's error is e / closing speed, more only where the motion grazes. Speeds below 1e-18 m/s
/// count as zero. O(1): six divisions, two roots. Source: Pinheiro 3.4, made time-aware (geometric planner, section 4).
[[nodiscard]] std::optional<TimeInterval> contact_interval(const Vec3& half, const Motion& own, const Motion& threat,
                                                           float radius, Seconds horizon) noexcept;

/// The same for two spheres: `radius` is the sum of both. Same accuracy. O(1), one root.
[[nodiscard]] std::optional<TimeInterval> contact_interval(const Motion& own, const Motion& threat, float radius,
                                                           Seconds horizon) noexcept;

/// Distance of a point from the box of half extents `half` about the origin; 0 inside. The same to the last bit as
/// least_distance of static objects. O(1), one root.
[[nodiscard]] inline float box_distance(const Vec3& half, const Vec3& point) noexcept
{
    return (point - point.cwiseMax(-half).cwiseMin(half)).norm();
}

/// Least distance in [0, horizon] between the box and the (moving) centre point of a threat; subtract the threat's
/// radius for the margin. horizon >= 0.
///
/// Rounding error of the distance below 5e-7 * (sum of magnitudes of relative position, displacement within `horizon`
/// and `half`); `when` is an instant whose distance is the least one within that error. O(1): a piecewise quadratic of
/// at most six breakpoints.
[[nodiscard]] Approach least_distance(const Vec3& half, const Motion& own, const Motion& threat,
                                      Seconds horizon) noexcept;

/// Distance between the box swept from `own_from` to `own_to` and the segment `threat_from`..`threat_to`, regardless of
/// time [m]: 0 when they touch. Subtract the threat's radius for the margin of Pinheiro's "swept" dynamic security
/// (3.4.2). Holds for zero-length, parallel and nearly parallel segments too.
///
/// Rounding error below 5e-7 * (sum of magnitudes of threat_from - own_from, of both displacements and of `half`).
/// Touching solids may give such an error instead of 0. O(1): four closest approaches and one plane.
[[nodiscard]] float swept_distance(const Vec3& half, const Vec3& own_from, const Vec3& own_to, const Vec3& threat_from,
                                   const Vec3& threat_to) noexcept;

/// Distance of point `p` from the segment a..b [m]. O(1).
[[nodiscard]] float point_segment_distance(const Vec3& p, const Vec3& a, const Vec3& b) noexcept;

}  // namespace jink::geometry
