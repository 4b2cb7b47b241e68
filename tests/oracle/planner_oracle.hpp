// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "tests/oracle/cost_oracle.hpp"

// Distances in double by methods other than the product's: minimisation of convex functions of time, dense sampling.

namespace jink::oracle {

struct Box {
    P3 half{1.0, 1.0, 1.0};
};

/// Distance of a point from a box centred on the origin.
inline double box_distance(const Box& box, const P3& p)
{
    double sum = 0.0;
    for (std::size_t i = 0; i < 3; ++i) {
        const double excess = std::max(std::abs(p[i]) - box.half[i], 0.0);
        sum += excess * excess;
    }
    return std::sqrt(sum);
}

/// Minimum of a convex function on [0, 1] by golden section.
template <class F>
double least(const F& f)
{
    constexpr double g = 0.6180339887498949;
    double a = 0.0;
    double b = 1.0;
    double c = b - g * (b - a);
    double d = a + g * (b - a);
    double fc = f(c);
    double fd = f(d);
    for (int i = 0; i < 60; ++i) {
        if (fc < fd) {
            b = d;
            d = c;
            fd = fc;
            c = b - g * (b - a);
            fc = f(c);
        } else {
            a = c;
            c = d;
            fc = fd;
            d = a + g * (b - a);
            fd = f(d);
        }
    }
    return std::min({fc, fd, f(0.0), f(1.0)});
}

/// Least distance between the box flown along segment `i` and a moving sphere's centre.
inline double approach(const Flight& flight, std::size_t i, const Moving& threat, const Box& box)
{
    return least([&](double s) {
        const P3 own = flight.p[i] + s * (flight.p[i + 1] - flight.p[i]);
        const double t = flight.t[i] + s * (flight.t[i + 1] - flight.t[i]);
        return box_distance(box, own - (threat.p + t * threat.v));
    });
}

/// Least distance between the box swept along segment `i` and the segment a..b.
inline double swept_approach(const Flight& flight, std::size_t i, const P3& a, const P3& b, const Box& box)
{
    return least([&](double r) {
        const P3 point = a + r * (b - a);
        return least(
            [&](double s) { return box_distance(box, flight.p[i] + s * (flight.p[i + 1] - flight.p[i]) - point); });
    });
}

/// Margins against one threat over a whole flight, time-aware; the threat's radius is constant.
inline double margin(const Flight& flight, const Moving& threat, const Box& box)
{
    double worst = 1e9;
    for (std::size_t i = 0; i + 1 < flight.p.size(); ++i) {
        worst = std::min(worst, approach(flight, i, threat, box) - threat.radius);
    }
    return worst;
}

/// The same against the whole volume that the threat sweeps from 0 to `end`.
inline double swept_margin(const Flight& flight, const Moving& threat, double end, const Box& box)
{
    double worst = 1e9;
    for (std::size_t i = 0; i + 1 < flight.p.size(); ++i) {
        worst = std::min(worst, swept_approach(flight, i, threat.p, threat.p + end * threat.v, box) - threat.radius);
    }
    return worst;
}

}  // namespace jink::oracle
