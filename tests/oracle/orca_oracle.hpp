// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

// Velocity programs by an interior-point method in doubles: a barrier and Newton's method, independent of the tested
// incremental programs. Unknowns are a velocity and a common violation, (x, y, z, d).

namespace jink::orca::oracle {

using Vec4 = std::array<double, 4>;

/// a . (x, y, z, d) >= b
struct Constraint {
    Vec4 a{};
    double b = 0.0;
};
/// radius^2 + slack * d >= |x - centre|^2; slack 1 if the ball yields too
struct BallConstraint {
    std::array<double, 3> centre{};
    double radius = 0.0;
    double slack = 0.0;
};

/// The objective: d, or |x - goal|^2 / 2 with d fixed.
struct Barrier {
    std::vector<Constraint> planes;
    std::vector<BallConstraint> balls;
    bool nearest = false;
    std::array<double, 3> goal{};

    [[nodiscard]] double margin(const Constraint& c, const Vec4& z) const
    {
        return c.a[0] * z[0] + c.a[1] * z[1] + c.a[2] * z[2] + c.a[3] * z[3] - c.b;
    }
    [[nodiscard]] double margin(const BallConstraint& c, const Vec4& z) const
    {
        double sum = c.radius * c.radius + c.slack * z[3];
        for (std::size_t i = 0; i < 3; ++i) {
            sum -= (z[i] - c.centre[i]) * (z[i] - c.centre[i]);
        }
        return sum;
    }
    [[nodiscard]] bool is_inside(const Vec4& z) const
    {
        const auto positive = [&](const auto& c) { return margin(c, z) > 0.0; };
        return std::all_of(planes.begin(), planes.end(), positive) && std::all_of(balls.begin(), balls.end(), positive);
    }

    /// Barrier's value at weight t; infinite outside.
    [[nodiscard]] double value(const Vec4& z, double t) const
    {
        double sum = 0.0;
        if (nearest) {
            for (std::size_t i = 0; i < 3; ++i) {
                sum += 0.5 * t * (z[i] - goal[i]) * (z[i] - goal[i]);
            }
        } else {
            sum = t * z[3];
        }
        const auto add = [&](const auto& c) {
            const double m = margin(c, z);
            sum -= m > 0.0 ? std::log(m) : -std::numeric_limits<double>::infinity();
        };
        std::for_each(planes.begin(), planes.end(), add);
        std::for_each(balls.begin(), balls.end(), add);
        return sum;
    }

    /// Newton's step; `decrement` is half of the expected descent.
    [[nodiscard]] Vec4 step(const Vec4& z, double t, double& decrement) const
    {
        std::array<Vec4, 4> h{};
        Vec4 g{};
        const auto add = [&](const Vec4& slope, double m) {
            for (std::size_t i = 0; i < 4; ++i) {
                g[i] -= slope[i] / m;
                for (std::size_t j = 0; j <= i; ++j) {
                    h[i][j] += slope[i] * slope[j] / (m * m);
                }
            }
        };
        for (const Constraint& c : planes) {
            add(c.a, margin(c, z));
        }
        for (const BallConstraint& c : balls) {
            const double m = margin(c, z);
            add({2.0 * (c.centre[0] - z[0]), 2.0 * (c.centre[1] - z[1]), 2.0 * (c.centre[2] - z[2]), c.slack}, m);
            for (std::size_t i = 0; i < 3; ++i) {
                h[i][i] += 2.0 / m;
            }
        }
        if (nearest) {
            for (std::size_t i = 0; i < 3; ++i) {
                g[i] += t * (z[i] - goal[i]);
                h[i][i] += t;
            }
            g[3] = 0.0;
            h[3] = {0.0, 0.0, 0.0, 1.0};
        } else {
            g[3] += t;
        }
        return solved(h, g, decrement);
    }

    /// -h^-1 g by Cholesky's factors.
    static Vec4 solved(std::array<Vec4, 4>& h, const Vec4& g, double& decrement)
    {
        Vec4 y{};
        for (std::size_t i = 0; i < 4; ++i) {
            for (std::size_t j = 0; j <= i; ++j) {
                double sum = h[i][j];
                for (std::size_t k = 0; k < j; ++k) {
                    sum -= h[i][k] * h[j][k];
                }
                h[i][j] = i == j ? std::sqrt(std::max(sum, 1e-300)) : sum / h[j][j];
            }
            double sum = -g[i];
            for (std::size_t k = 0; k < i; ++k) {
                sum -= h[i][k] * y[k];
            }
            y[i] = sum / h[i][i];
        }
        decrement = 0.0;
        for (const double part : y) {
            decrement += 0.5 * part * part;
        }
        for (std::size_t i = 4; i-- > 0;) {
            for (std::size_t k = i + 1; k < 4; ++k) {
                y[i] -= h[k][i] * y[k];
            }
            y[i] /= h[i][i];
        }
        return y;
    }

    /// Follows the path from an interior point until the objective is within `gap` of its minimum. Stops earlier when d
    /// falls below `enough`.
    [[nodiscard]] Vec4 minimum(Vec4 z, double gap, double enough = -std::numeric_limits<double>::infinity()) const
    {
        const double count = static_cast<double>(planes.size() + balls.size());
        for (double t = 1.0; t * gap < 20.0 * count; t *= 20.0) {
            for (int turn = 0; turn < 60; ++turn) {
                double decrement = 0.0;
                const Vec4 way = step(z, t, decrement);
                if (!(decrement > 1e-7)) {
                    break;
                }
                const double here = value(z, t);
                double length = 1.0;
                Vec4 next{};
                for (int half = 0; half < 50; ++half, length *= 0.5) {
                    for (std::size_t i = 0; i < 4; ++i) {
                        next[i] = z[i] + length * way[i];
                    }
                    if (value(next, t) <= here - 0.2 * length * decrement) {
                        break;
                    }
                }
                if (!is_inside(next) || value(next, t) >= here) {
                    break;
                }
                z = next;
            }
            if (!nearest && z[3] < enough) {
                return z;
            }
        }
        return z;
    }
};

/// Half-space n . x >= b, with its yield relative to the others.
struct Plane {
    std::array<double, 3> n{};
    double b = 0.0;
    double yield = 1.0;
};

struct Question {
    std::vector<Plane> planes;
    std::vector<BallConstraint> balls;
    std::array<double, 3> goal{};
};

struct Least {
    bool hard_hold = false;  ///< the first `hard` planes and the balls have a common interior
    double d = 0.0;          ///< least common violation of the others, over the yield; negative if all have a common
                             ///< interior
    std::array<double, 3> x{};
};

/// The least d for planes from `hard` on, within the balls and the first `hard` planes.
inline Least least_violation(const Question& q, std::size_t hard, double gap = 1e-9)
{
    Least out;
    Barrier first;
    // First all constraints yield, balls too: any point is inside for a large d.
    for (std::size_t i = 0; i < hard; ++i) {
        first.planes.push_back({{q.planes[i].n[0], q.planes[i].n[1], q.planes[i].n[2], 1.0}, q.planes[i].b});
    }
    first.balls = q.balls;
    double most = 1.0;
    Vec4 z{q.balls.back().centre[0], q.balls.back().centre[1], q.balls.back().centre[2], 0.0};
    for (BallConstraint& ball : first.balls) {
        ball.slack = 1.0;
        most = std::max(most, 1.0 - first.margin(ball, z));
    }
    for (const Constraint& c : first.planes) {
        most = std::max(most, 1.0 - first.margin(c, z));
    }
    z[3] = most;
    first.planes.push_back({{0.0, 0.0, 0.0, 1.0}, -1.0});  // d >= -1: bounded below
    z = first.minimum(z, 1e-11, -1e-4);
    out.hard_hold = z[3] < -1e-9;
    if (!out.hard_hold) {
        out.d = z[3];
        return out;
    }
    Barrier second;
    second.balls = q.balls;
    most = 1.0;
    for (std::size_t i = 0; i < q.planes.size(); ++i) {
        const Plane& p = q.planes[i];
        second.planes.push_back({{p.n[0], p.n[1], p.n[2], i < hard ? 0.0 : p.yield}, p.b});
        if (i >= hard) {
            z[3] = 0.0;
            most = std::max(most, 1.0 - second.margin(second.planes.back(), z) / p.yield);
        }
    }
    second.planes.push_back({{0.0, 0.0, 0.0, 1.0}, -100.0});
    z[3] = most;
    z = second.minimum(z, gap);
    out.d = z[3];
    out.x = {z[0], z[1], z[2]};
    return out;
}

/// The point nearest to the goal, starting from a point inside all constraints.
inline std::array<double, 3> nearest(const Question& q, const std::array<double, 3>& inside, double gap = 1e-13)
{
    Barrier barrier;
    barrier.nearest = true;
    barrier.goal = q.goal;
    barrier.balls = q.balls;
    for (const Plane& p : q.planes) {
        barrier.planes.push_back({{p.n[0], p.n[1], p.n[2], 0.0}, p.b});
    }
    const Vec4 z = barrier.minimum({inside[0], inside[1], inside[2], 0.0}, gap);
    return {z[0], z[1], z[2]};
}

}  // namespace jink::orca::oracle
