// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <vector>

#include <Eigen/Geometry>

#include "core/reach/grid.hpp"

// Gomola's own intruder models, by clouds of points and in double (Gomola 6.6.3, 6.6.4 with the corrections of the
// avoidance specification, sections 2.6 and 2.7): reference for core's closed forms. Slow, for tests only.

namespace jink::reach::reference {

using P = Point<double>;

struct Intruder {
    P position = P::Zero();
    P velocity = P::Zero();
    double radius = 0.0;
    double horizontal = 0.0;
    double vertical = 0.0;
};
/// Result of the clouds for a cell.
struct Touch {
    double from = std::numeric_limits<double>::infinity();
    double to = -std::numeric_limits<double>::infinity();
    double sum = 0.0;  ///< of weights
    int instants = 0;  ///< number of instants with overlap
    [[nodiscard]] double space() const { return sum / instants; }
};
using Touched = std::map<CellIndex, Touch>;

enum class SpreadLaw { tangent, sine };
inline double lateral(double angle, double axial, SpreadLaw law)
{
    return axial * (law == SpreadLaw::tangent ? std::tan(angle) : std::sin(angle));
}

/// In-plane axes: to the intruder's left, and up.
inline std::array<P, 2> axes_of(const P& velocity)
{
    const P along = velocity.normalized();
    const P across = P::UnitZ().cross(along);
    const P left = across.norm() < 1e-3 ? P(P::UnitX()) : P(across.normalized());
    return {left, along.cross(left)};
}

/// A point of the ellipse in its plane, and its share of the probability.
struct Weighted {
    double p1 = 0.0;
    double p2 = 0.0;
    double weight = 0.0;
};
/// N(u; 0, s) with s the standard deviation; of an axis without extent nothing.
inline double normal(double u, double s)
{
    return s > 0.0 ? std::exp(-u * u / (2.0 * s * s)) / (s * std::sqrt(2.0 * 3.14159265358979323846)) : 0.0;
}
/// Equations 6.133 to 6.144: lattice points of spacing m inside the ellipse, weights before they are scaled.
inline std::vector<Weighted> ellipse_cloud(double a, double b, double m)
{
    std::vector<Weighted> points;
    const auto share = [](double p, double axis, double half) {
        return axis > 0.0 ? (p / axis) * (p / axis) : std::abs(p) <= half ? 0.0 : 2.0;
    };
    const int across = static_cast<int>(a / m + 1e-9);
    const int upwards = static_cast<int>(b / m + 1e-9);
    for (int i = -across; i <= across; ++i) {
        for (int j = -upwards; j <= upwards; ++j) {
            const double p1 = m * i;
            const double p2 = m * j;
            if (share(p1, a, 0.5 * m) + share(p2, b, 0.5 * m) <= 1.0 + 1e-12) {
                points.push_back({p1, p2, 0.5 * (normal(p1, a) + normal(p2, b))});
            }
        }
    }
    return points;
}
inline double sum_of(const std::vector<Weighted>& points)
{
    double sum = 0.0;
    for (const Weighted& p : points) {
        sum += p.weight;
    }
    return sum;
}

/// Most points of one slice; a larger slice is built with twice the spacing until it fits, and reported.
inline constexpr std::size_t kMaxSlicePoints = 1024;
struct Slice {
    std::vector<Weighted> points;
    bool cloud_coarsened = false;
};
inline Slice slice_of(double a, double b, double m)
{
    Slice slice;
    for (double spacing = m;; spacing *= 2.0) {
        slice.points = ellipse_cloud(a, b, spacing);
        if (slice.points.size() <= kMaxSlicePoints) {
            break;
        }
        slice.cloud_coarsened = true;
    }
    const double sum = sum_of(slice.points);
    for (Weighted& p : slice.points) {
        p.weight = sum > 0.0 ? p.weight / sum : 1.0;
    }
    return slice;
}

/// The spread model, equations 6.139 to 6.146 as corrected: instants no farther apart than one spacing, until the
/// ellipse has left the grid.
struct SpreadResult {
    Touched cells;
    bool cloud_coarsened = false;
    std::size_t points = 0;
};
inline SpreadResult spread(const Grid<double>& grid, const Intruder& intruder, double m, SpreadLaw law)
{
    SpreadResult result;
    const double speed = intruder.velocity.norm();
    const auto [left, up] = axes_of(intruder.velocity);
    const double most = grid.distance() + intruder.position.norm();
    for (double axial = 0.0; axial <= most; axial += m) {
        const P centre = intruder.position + axial * intruder.velocity / speed;
        const Slice slice =
            slice_of(lateral(intruder.horizontal, axial, law), lateral(intruder.vertical, axial, law), m);
        result.cloud_coarsened = result.cloud_coarsened || slice.cloud_coarsened;
        std::map<CellIndex, bool> touched;
        for (const Weighted& w : slice.points) {
            const P at = centre + w.p1 * left + w.p2 * up;
            const Located in = grid.locate(at);
            ++result.points;
            if (in.status != LocateStatus::inside) {
                continue;
            }
            Touch& touch = result.cells[grid.index(in.place)];
            const double arrival = (at - intruder.position).norm() / speed;
            touch.from = std::min(touch.from, arrival);
            touch.to = std::max(touch.to, arrival);
            touch.sum += w.weight;
            touched[grid.index(in.place)] = true;
        }
        for (const auto& [cell, is] : touched) {
            result.cells[cell].instants += is ? 1 : 0;
        }
    }
    return result;
}

/// The body model, equations 6.125 to 6.128: a sphere full of points no farther than `thickness` from the next one,
/// moved along the line; every point has the time of the sphere's middle.
inline Touched body(const Grid<double>& grid, const Intruder& intruder, double thickness)
{
    Touched cells;
    const double speed = intruder.velocity.norm();
    const int count = static_cast<int>(intruder.radius / thickness);
    std::vector<P> sphere;
    for (int i = -count; i <= count; ++i) {
        for (int j = -count; j <= count; ++j) {
            for (int k = -count; k <= count; ++k) {
                const P p = thickness * P(i, j, k);
                if (p.norm() <= intruder.radius) {
                    sphere.push_back(p);
                }
            }
        }
    }
    const double most = (grid.distance() + intruder.position.norm() + intruder.radius) / speed;
    for (double t = 0.0; t <= most; t += thickness / speed) {
        for (const P& p : sphere) {
            const Located in = grid.locate(P(intruder.position + t * intruder.velocity + p));
            if (in.status == LocateStatus::inside) {
                Touch& touch = cells[grid.index(in.place)];
                touch.from = std::min(touch.from, t);
                touch.to = std::max(touch.to, t);
                touch.sum = 1.0;
                touch.instants = 1;
            }
        }
    }
    return cells;
}

}  // namespace jink::reach::reference
