// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "tests/property/core/geometry/convex_oracle.hpp"
#include "tests/unit/core/world/scene.hpp"

// Margins by brute force in double precision: time is sampled, distances come from their definition (a point and a box
// by clamping, general solids by Wolfe's method), the growth and the escape rule are reimplemented from their headers.

namespace jink::world::oracle {

using test::Scene;

using geometry::oracle::Vec3d;

/// The straight-motion flight at time t.
inline Vec3d position_at(const path::TimedPath& path, double t)
{
    std::size_t i = 0;
    while (i + 2 < path.points.size() && double(path.points[i + 1].time) <= t) {
        ++i;
    }
    const path::PathPoint& p = path.points[i];
    return p.position.cast<double>() + p.velocity.cast<double>() * (t - double(p.time));
}

/// Distance of a point from a box about the origin.
inline double point_box(const Vec3d& point, const Vec3d& half)
{
    return (point.cwiseAbs() - half).cwiseMax(0.0).norm();
}

/// Speed by which a cooperative vehicle may have changed its velocity since its report, but for the last 0.3 s [m/s].
inline double hidden_speed(const Scene& scene, const Track& track)
{
    const double age = std::max(0.0, double(scene.now.us - track.stamp.us) * 1e-6 - 0.3);
    const double hidden = double(scene.limits.max_acceleration) - double(track.max_acceleration);
    return track.cooperative ? std::max(0.0, hidden) * age : 0.0;
}

/// By how much its motion differs for that, until the own vehicle stands and 0.75 s [m].
inline double hidden_motion(const Scene& scene, const Track& track, double t)
{
    const double age = std::max(0.0, double(scene.now.us - track.stamp.us) * 1e-6 - 0.3);
    const double stands = double(scene.own.velocity.norm()) / double(scene.limits.max_acceleration) + 0.75;
    return hidden_speed(scene, track) * (0.5 * age + std::min(t, stands));
}

inline double radius_of(const Scene& scene, const Track& track, double t)
{
    const double age = std::max(0.0, double(scene.now.us - track.stamp.us) * 1e-6 + t);
    return double(track.radius) +
           double(scene.rules.k_sigma) * (std::hypot(double(scene.own.sigma_position), double(track.sigma_position)) +
                                          double(track.sigma_velocity) * age) +
           0.5 * double(track.max_acceleration) * age * age + hidden_motion(scene, track, t);
}

/// Minimum of margin(t) + the escape rule's reduction of the surface, over [0, end], by samples and refinement around
/// the best sample.
template <class Margin>
double least(const Margin& margin, double end, const EscapeRule& escape, double* when = nullptr)
{
    const double start = margin(0.0);
    const double shrunk = start < 0 ? double(escape.slack) - start : 0.0;
    const auto judged = [&](double t) {
        return margin(t) + std::max(0.0, shrunk > 0 ? shrunk - double(escape.speed) * t : 0.0);
    };
    const int samples = end > 0 ? std::max(64, static_cast<int>(end / 0.02)) : 0;
    std::vector<double> values;
    for (int i = 0; i <= samples; ++i) {
        values.push_back(judged(samples > 0 ? end * i / samples : 0.0));
    }
    double best = values[0];
    double at = 0;
    for (std::size_t i = 0; i < values.size(); ++i) {
        const bool valley =
            (i == 0 || values[i] <= values[i - 1]) && (i + 1 == values.size() || values[i] <= values[i + 1]);
        if (!valley || values[i] > best + 1.0) {
            continue;  // nothing moves a metre between two samples
        }
        double t = samples > 0 ? end * double(i) / samples : 0.0;
        double value = values[i];
        for (double step = samples > 0 ? end / samples : 0; step > 1e-6; step /= 2) {
            for (const double near : {std::max(0.0, t - step), std::min(end, t + step)}) {
                if (judged(near) < value) {
                    value = judged(near);
                    t = near;
                }
            }
        }
        if (value < best) {
            best = value;
            at = t;
        }
    }
    if (when != nullptr) {
        *when = at;
    }
    return best;
}

inline double flight_end(const path::TimedPath& path, double horizon)
{
    return std::min(double(path.points.back().time), std::max(horizon, 0.0));
}

inline double track_margin_at(const Scene& scene, const path::TimedPath& path, std::size_t index, double t)
{
    const Track& track = scene.tracks[index];
    const Vec3d threat = track.position.cast<double>() + track.velocity.cast<double>() * t;
    return point_box(threat - position_at(path, t), scene.limits.half_extents.cast<double>()) -
           radius_of(scene, track, t);
}

inline double track_margin(const Scene& scene, const path::TimedPath& path, std::size_t index, double horizon,
                           const EscapeRule& escape)
{
    return least([&](double t) { return track_margin_at(scene, path, index, t); }, flight_end(path, horizon), escape);
}

/// Sphere or capsule, any direction: the nearest point of its axis by golden section (the distance is convex along the
/// axis).
inline double sphere_margin_at(const Scene& scene, const path::TimedPath& path, const geometry::Shape& shape, double t)
{
    const Vec3d own = position_at(path, t);
    const Vec3d half = scene.limits.half_extents.cast<double>();
    const Vec3d axis = shape.kind == geometry::ShapeKind::capsule
                           ? Vec3d(shape.axes.col(2).cast<double>() * double(shape.half.z()))
                           : Vec3d(Vec3d::Zero());
    const auto distance = [&](double u) { return point_box(shape.centre.cast<double>() + u * axis - own, half); };
    double low = -1, high = 1;
    for (int i = 0; i < 45 && axis.norm() > 0; ++i) {
        const double a = low + 0.382 * (high - low);
        const double b = low + 0.618 * (high - low);
        (distance(a) <= distance(b) ? high : low) = distance(a) <= distance(b) ? b : a;
    }
    return distance(0.5 * (low + high)) - double(shape.radius) -
           double(scene.rules.k_sigma) * double(scene.own.sigma_position);
}

/// Any solid, no escape rule: distance of the swept box, piece by piece; 0 for contact.
inline double solid_distance(const Scene& scene, const path::TimedPath& path, const geometry::Shape& shape,
                             double horizon)
{
    double best = std::numeric_limits<double>::infinity();
    const double end = flight_end(path, horizon);
    for (std::size_t i = 0; i == 0 || (i + 1 < path.points.size() && double(path.points[i].time) < end); ++i) {
        const double to = i + 1 < path.points.size() ? std::min(end, double(path.points[i + 1].time)) : 0.0;
        const Vec3d a = path.points[i].position.cast<double>();
        const Vec3d b = a + path.points[i].velocity.cast<double>() * (to - double(path.points[i].time));
        best = std::min(best, geometry::oracle::swept_box_bounds(scene.limits.half_extents, a.cast<float>(),
                                                                 b.cast<float>(), shape, 1e-4)
                                  .lower);
    }
    return best;
}

/// Signed distance from a cylinder's body at one instant: outside by the level and vertical excess, inside to the
/// nearest surface.
inline double cylinder_margin_at(const Scene& scene, const Vec3d& own, const Cylinder& cylinder, double t)
{
    const Vec3d half = scene.limits.half_extents.cast<double>();
    const Eigen::Vector2d centre = cylinder.circle.centre.cast<double>() + cylinder.velocity.cast<double>() * t;
    const Vec3d level(centre.x() - own.x(), centre.y() - own.y(), 0.0);
    const double beside = point_box(level, half) - double(cylinder.circle.radius);
    const double beyond =
        std::max(double(cylinder.bottom) - own.z() - half.z(), own.z() - half.z() - double(cylinder.top));
    const double distance = beside <= 0.0 && beyond <= 0.0 ? std::max(beside, beyond)
                                                           : std::hypot(std::max(beside, 0.0), std::max(beyond, 0.0));
    return distance - double(scene.rules.k_sigma) * double(scene.own.sigma_position);
}

/// Margin to a bound at one instant.
inline double bound_margin_at(const Scene& scene, const Vec3d& own, ThreatKind kind)
{
    const Airspace& air = scene.airspace;
    const double extra = double(scene.rules.k_sigma) * double(scene.own.sigma_position);
    const Vec3d half = scene.limits.half_extents.cast<double>();
    switch (kind) {
    case ThreatKind::floor: return own.z() - half.z() - double(air.floor) - extra;
    case ThreatKind::ceiling: return double(air.ceiling) - own.z() - half.z() - extra;
    default: break;
    }
    const Vec3d home = air.home.cast<double>();
    return double(air.keep_in_radius) - std::hypot(own.x() - home.x(), own.y() - home.y()) -
           std::hypot(half.x(), half.y()) - extra;
}

inline double bound_margin(const Scene& scene, const path::TimedPath& path, ThreatKind kind, double horizon,
                           const EscapeRule& escape)
{
    return least([&](double t) { return bound_margin_at(scene, position_at(path, t), kind); },
                 flight_end(path, horizon), escape);
}

}  // namespace jink::world::oracle
