// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <optional>
#include <vector>

#include <Eigen/Dense>

#include "core/base/random.hpp"
#include "core/orca/half_space.hpp"

// Small velocity programs solved by enumeration of every set of half-spaces that may be active, in doubles. Independent
// of the solver: no order, no search, no spheres.

namespace jink::orca::enumerated {

using Vec3d = Eigen::Vector3d;

inline Vec3 unit(Random& random)
{
    while (true) {
        const Vec3 v(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
        if (v.squaredNorm() > 1e-2F && v.squaredNorm() < 1.0F) {
            return v.normalized();
        }
    }
}

struct Plane {
    Vec3d normal;
    double offset = 0.0;
    double yield = 1.0;  ///< 0: does not yield

    [[nodiscard]] double violation(const Vec3d& x) const { return offset - normal.dot(x); }
};

/// The rows of a program; rows from `hard` on yield.
inline std::vector<Plane> planes_of(const std::vector<HalfSpace>& planes, std::size_t hard = 0)
{
    std::vector<Plane> out;
    for (std::size_t i = 0; i < planes.size(); ++i) {
        const Vec3d n = planes[i].normal.cast<double>();
        // A normal's length is 1 up to rounding.
        out.push_back({n / n.norm(), static_cast<double>(planes[i].offset) / n.norm(),
                       i < hard ? 0.0 : static_cast<double>(planes[i].yield)});
    }
    return out;
}

inline double worst(const std::vector<Plane>& planes, const Vec3d& x)
{
    double out = -1e9;
    for (const Plane& plane : planes) {
        out = std::max(out, plane.violation(x));
    }
    return out;
}

/// The feasible point nearest to `goal`, if any.
inline std::optional<Vec3d> nearest(const std::vector<Plane>& planes, const Vec3d& goal)
{
    if (worst(planes, goal) <= 1e-10) {
        return goal;
    }
    const std::size_t n = planes.size();
    const auto held_by = [&](const std::vector<std::size_t>& rows) -> std::optional<Vec3d> {
        const auto count = static_cast<Eigen::Index>(rows.size());
        Eigen::MatrixXd a(count, 3);
        Eigen::VectorXd missing(count);
        for (Eigen::Index k = 0; k < count; ++k) {
            const Plane& plane = planes[rows[static_cast<std::size_t>(k)]];
            a.row(k) = plane.normal.transpose();
            missing[k] = plane.violation(goal);
        }
        const Eigen::VectorXd shares = (a * a.transpose()).fullPivLu().solve(missing);
        const Vec3d x = goal + a.transpose() * shares;
        const bool holds = (a * a.transpose() * shares - missing).norm() < 1e-9;
        return holds && shares.minCoeff() >= -1e-9 && worst(planes, x) <= 1e-8 ? std::optional<Vec3d>(x) : std::nullopt;
    };
    for (std::size_t i = 0; i < n; ++i) {
        if (const auto x = held_by({i})) {
            return x;
        }
        for (std::size_t j = 0; j < i; ++j) {
            if (const auto x = held_by({i, j})) {
                return x;
            }
            for (std::size_t k = 0; k < j; ++k) {
                if (const auto x = held_by({i, j, k})) {
                    return x;
                }
            }
        }
    }
    return std::nullopt;
}

/// The least d for which all planes hold after each yields by d * yield, and its point, for four planes of which at
/// least one yields. Non-negative shares prove a lower bound; the largest over all sets is the result.
struct Least {
    double d = -1e9;
    Vec3d x = Vec3d::Zero();
    double least_share = 0.0;  ///< of the four
    double shares = 0.0;       ///< their sum
};
inline Least least_violation(const std::vector<Plane>& planes)
{
    Least out;
    const std::size_t n = planes.size();
    for (std::size_t i = 0; i < n; ++i) {
        for (std::size_t j = 0; j < i; ++j) {
            for (std::size_t k = 0; k < j; ++k) {
                for (std::size_t l = 0; l < k; ++l) {
                    Eigen::Matrix4d m;
                    Eigen::Vector4d offsets;
                    int column = 0;
                    for (const std::size_t row : {i, j, k, l}) {
                        m.col(column) << planes[row].normal, planes[row].yield;
                        offsets[column++] = planes[row].offset;
                    }
                    if (std::fabs(m.determinant()) < 1e-9) {
                        continue;
                    }
                    const Eigen::Vector4d shares = m.inverse() * Eigen::Vector4d(0, 0, 0, 1);
                    if (shares.minCoeff() < -1e-9 || shares.dot(offsets) <= out.d) {
                        continue;
                    }
                    out.d = shares.dot(offsets);
                    out.x = (m.transpose().inverse() * offsets).head<3>();
                    out.least_share = shares.minCoeff();
                    out.shares = shares.sum();
                }
            }
        }
    }
    return out;
}

}  // namespace jink::orca::enumerated
