// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

// The geometric planner's costs, recomputed in double directly from the formulas (geometric planner, sections 2 to 6),
// as the reference for tests. Shares no code with the product.

namespace jink::oracle {

using P3 = std::array<double, 3>;

inline P3 operator+(const P3& a, const P3& b) { return {a[0] + b[0], a[1] + b[1], a[2] + b[2]}; }
inline P3 operator-(const P3& a, const P3& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
inline P3 operator*(double k, const P3& a) { return {k * a[0], k * a[1], k * a[2]}; }
inline double dot(const P3& a, const P3& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
inline double length(const P3& a) { return std::sqrt(dot(a, a)); }
inline P3 cross(const P3& a, const P3& b)
{
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
/// From anything with x(), y(), z().
template <class V>
P3 to_double(const V& v)
{
    return {static_cast<double>(v.x()), static_cast<double>(v.y()), static_cast<double>(v.z())};
}

struct Vehicle {
    double speed = 5.0, climb = 3.0, descent = 3.0;
    double mass = 3.0, drag = 0.5, area = 2.5, density = 1.225;
    double blades = 2.0, chord = 0.035, rotor_radius = 0.1905, rotors = 4.0, blade_drag = 0.012, tip = 100.0;
};

struct Flight {
    std::vector<P3> p;
    std::vector<P3> v;      ///< per point, the last velocity repeated
    std::vector<double> t;  ///< per point
};

inline Flight fly(const std::vector<P3>& points, const Vehicle& vehicle)
{
    Flight flight;
    flight.p = points;
    flight.t.push_back(0.0);
    for (std::size_t i = 0; i + 1 < points.size(); ++i) {
        const P3 step = points[i + 1] - points[i];
        P3 v = (vehicle.speed / length(step)) * step;
        if (v[2] > vehicle.climb) {
            v = (vehicle.climb / v[2]) * v;
        } else if (v[2] < -vehicle.descent) {
            v = (vehicle.descent / -v[2]) * v;
        }
        flight.v.push_back(v);
        flight.t.push_back(flight.t.back() + length(step) / length(v));
    }
    flight.v.push_back(flight.v.back());
    return flight;
}

inline double energy(const Flight& f, const Vehicle& vehicle)
{
    const auto mechanical = [&](std::size_t i) {
        return 0.5 * vehicle.mass * dot(f.v[i], f.v[i]) + vehicle.mass * 9.81 * f.p[i][2];
    };
    double e1 = 0.0;
    double e2 = 0.0;
    for (std::size_t i = 0; i + 1 < f.p.size(); ++i) {
        e1 += std::abs(mechanical(i + 1) - mechanical(i));
        const P3 sum = f.v[i + 1] + f.v[i];
        e2 += 0.5 * vehicle.drag * vehicle.density * vehicle.area * length(f.p[i + 1] - f.p[i]) * dot(sum, sum) / 2.0;
    }
    return e1 + e2;
}

inline double rotor_power(double climb_rate, const Vehicle& vehicle)
{
    constexpr double pi = std::numbers::pi;
    const double weight = vehicle.mass * 9.81;
    const double disk = vehicle.rotors * pi * vehicle.rotor_radius * vehicle.rotor_radius;
    const double solidity = vehicle.blades * vehicle.chord / (pi * vehicle.rotor_radius);
    const double profile = vehicle.density * disk * std::pow(vehicle.tip, 3) * solidity * vehicle.blade_drag / 8.0;
    const double hover = std::sqrt(weight / (2.0 * vehicle.density * disk));
    constexpr double k = 1.15;
    if (climb_rate == 0.0) {
        return k * std::pow(weight, 1.5) / std::sqrt(2.0 * vehicle.density * disk) + profile;
    }
    if (climb_rate > 0.0) {
        const double root = std::sqrt(climb_rate * climb_rate + 2.0 * weight / (vehicle.density * disk));
        return weight * (climb_rate - k * climb_rate / 2.0 + k / 2.0 * root) + profile;
    }
    const double q = climb_rate / hover;
    if (q > -2.0) {
        const double v = hover * (k - 1.125 * q - 1.372 * q * q - 1.718 * q * q * q - 0.655 * q * q * q * q);
        return weight * (climb_rate + v) + profile;
    }
    const double loading = weight / disk;
    const double v = -climb_rate / 2.0 - 0.5 * std::sqrt(climb_rate * climb_rate - 2.0 * loading / vehicle.density);
    return weight * (climb_rate + k * v) + profile;
}

inline double hover_power(const Flight& f, const Vehicle& vehicle)
{
    double work = 0.0;
    for (std::size_t i = 0; i + 1 < f.v.size(); ++i) {
        work += rotor_power(f.v[i][2], vehicle) * (f.t[i + 1] - f.t[i]);
    }
    return work / (f.t.back() - f.t.front());
}

/// numpy.gradient with unit spacing.
inline std::vector<double> gradient(const std::vector<double>& f)
{
    std::vector<double> g(f.size());
    for (std::size_t i = 1; i + 1 < f.size(); ++i) {
        g[i] = (f[i + 1] - f[i - 1]) / 2.0;
    }
    g.front() = f[1] - f[0];
    g.back() = f[f.size() - 1] - f[f.size() - 2];
    return g;
}

inline double smoothness(const std::vector<double>& x, const std::vector<double>& y)
{
    const auto x1 = gradient(x);
    const auto y1 = gradient(y);
    const auto x2 = gradient(x1);
    const auto y2 = gradient(y1);
    double sum = 0.0;
    const auto squared = [&](std::size_t i) {
        return std::pow(std::abs(x2[i] * y1[i] - x1[i] * y2[i]) / std::pow(x1[i] * x1[i] + y1[i] * y1[i], 1.5), 2);
    };
    for (std::size_t i = 1; i < x.size(); ++i) {
        sum += 0.5 * (squared(i) + squared(i - 1)) * (x[i] - x[i - 1]);
    }
    return sum;
}

struct Moving {
    P3 p{};
    P3 v{};
    double radius = 0.0;
};

/// Eq. 4.11; `swept_for` < 0: at the same instant, else to the path flown in that time.
inline double closeness(const Flight& f, const Moving& threat, double swept_for)
{
    double mean = 0.0;
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < f.p.size(); ++i) {
        double at = f.t[i];
        if (swept_for >= 0.0) {
            const double vv = dot(threat.v, threat.v);
            at = vv > 0.0 ? std::clamp(dot(f.p[i] - threat.p, threat.v) / vv, 0.0, swept_for) : 0.0;
        }
        const double c = length(f.p[i] - (threat.p + at * threat.v)) - threat.radius;
        mean += c / static_cast<double>(f.p.size());
        least = std::min(least, c);
    }
    const double bracket = 0.5 * mean + 0.5 * least;
    return bracket > 0.0 ? 1.0 / bracket : std::numeric_limits<double>::infinity();
}

inline double combine(const std::vector<double>& f)
{
    if (f.empty()) {
        return 0.0;
    }
    double sum = 0.0;
    for (const double value : f) {
        sum += value;
    }
    return 0.5 * *std::max_element(f.begin(), f.end()) + 0.5 * sum / static_cast<double>(f.size());
}

inline double clip(double value) { return std::min(1.0, std::max(0.0, value)); }
inline double normalised_smoothness_penalised(double s) { return clip((std::log(s) + 3.0) / 6.0); }
inline double normalised_smoothness(double s) { return clip((std::log(s) + 3.0) / 5.5); }
inline double normalised_closeness(double m) { return m > 0.0 ? clip((std::log(m) + 3.0) / 3.001) : 0.0; }
inline double normalised_time(double t) { return clip((t - 1.2530) / (1.15 * 7.0814 - 1.2530)); }
inline double normalised_energy(double e) { return clip((e - 249.59) / (1759.0 - 249.59)); }

/// The candidate curve: 3 u^2 - 2 u^3 to the end (simple) or mirrored about u = 1 (symmetric).
inline double curve(bool symmetric, double offset, double distance, double s)
{
    double u = s / distance;
    if (symmetric && u > 1.0) {
        u = 2.0 - u;
    }
    return offset * (3.0 * u * u - 2.0 * u * u * u);
}

/// Points of a candidate; plane angle about the leg, y horizontal, z = x cross y (spec, frames).
inline std::vector<P3> candidate(const P3& origin, const P3& direction, double distance, bool symmetric, double plane,
                                 double offset, int waypoints)
{
    const P3 x = (1.0 / length(direction)) * direction;
    P3 y = cross({0.0, 0.0, 1.0}, x);
    y = length(y) > 1e-9 ? (1.0 / length(y)) * y : P3{0.0, 1.0, 0.0};
    const P3 z = cross(x, y);
    std::vector<P3> points;
    const double end = (symmetric ? 2.0 : 1.5) * distance;
    for (int i = 0; i < waypoints; ++i) {
        const double s = end * i / (waypoints - 1);
        const double out = curve(symmetric, offset, distance, s);
        points.push_back(origin + s * x + (out * std::cos(plane)) * y + (out * std::sin(plane)) * z);
    }
    return points;
}

}  // namespace jink::oracle
