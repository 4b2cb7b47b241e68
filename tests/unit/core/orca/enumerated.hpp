// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "core/base/random.hpp"
#include "core/orca/half_space.hpp"

// Small velocity programs solved by enumeration of every set of half-spaces that may be active, in doubles. Independent
// of the solver: no order, no search, no spheres. Eigen's decompositions are in enumerated.cpp: many tests include
// this.

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
[[nodiscard]] std::optional<Vec3d> nearest(const std::vector<Plane>& planes, const Vec3d& goal);

/// The least d for which all planes hold after each yields by d * yield, and its point, for four planes of which at
/// least one yields. Non-negative shares prove a lower bound; the largest over all sets is the result.
struct Least {
    double d = -1e9;
    Vec3d x = Vec3d::Zero();
    double least_share = 0.0;  ///< of the four
    double shares = 0.0;       ///< their sum
};
[[nodiscard]] Least least_violation(const std::vector<Plane>& planes);

/// Shares of the columns whose sum is nearest to `sum`.
[[nodiscard]] Eigen::VectorXd shares_of(const Eigen::MatrixXd& columns, const Vec3d& sum);

}  // namespace jink::orca::enumerated
