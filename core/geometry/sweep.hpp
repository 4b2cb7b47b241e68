// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include "core/base/time.hpp"
#include "core/base/vec3.hpp"

// Swept and moving tests between the own safety box (world-aligned, moving without turning) and spheres, in closed form.
// The box against a sphere of radius r is a point against the box rounded by r; both moving, the point's motion is the
// relative one. No iteration, no allocation. Oracle: double-precision convex minimisation and bisection.

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
/// @return first and last contact within [0, horizon], or nothing. Touching counts as contact.
///
/// Exact for straight motion; error of the instants below 3e-5 * horizon for coordinates up to 1 km (float rounding);
/// a motion that comes within 1e-5 * (1 + largest coordinate) of touching may be reported as contact, a true contact
/// deeper than that is never missed. O(1). Source: geometric planner, section 4 (Pinheiro 3.4, made time-aware).
[[nodiscard]] std::optional<TimeInterval> contact_interval(const Vec3& half, const Motion& own, const Motion& threat,
                                                           float radius, Seconds horizon) noexcept;

/// The same for two spheres: `radius` is the sum of both. O(1), one quadratic.
[[nodiscard]] std::optional<TimeInterval> contact_interval(const Motion& own, const Motion& threat, float radius,
                                                           Seconds horizon) noexcept;

/// Least distance in [0, horizon] between the box and the (moving) centre point of a threat; subtract the threat's radius
/// for the margin. Accuracy as above. horizon >= 0. O(1): piecewise quadratic with at most six breakpoints.
[[nodiscard]] Approach least_distance(const Vec3& half, const Motion& own, const Motion& threat, Seconds horizon) noexcept;

/// Distance between the box swept from `own_from` to `own_to` and the segment `threat_from`..`threat_to`, regardless of
/// time [m]: 0 when they touch. Subtract the threat's radius for the margin of the source's "swept" dynamic security
/// (Pinheiro 3.4.2). Exact up to rounding (1e-5 * (1 + largest coordinate)); degenerate (zero-length) segments allowed. O(1).
[[nodiscard]] float swept_distance(const Vec3& half, const Vec3& own_from, const Vec3& own_to, const Vec3& threat_from,
                                   const Vec3& threat_to) noexcept;

/// Distance of point `p` from the segment a..b [m]. O(1).
[[nodiscard]] float point_segment_distance(const Vec3& p, const Vec3& a, const Vec3& b) noexcept;

}  // namespace jink::geometry
