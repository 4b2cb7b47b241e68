// SPDX-License-Identifier: BSD-3-Clause
#include "tests/unit/core/orca/enumerated.hpp"

#include <cmath>

#include <Eigen/Dense>

namespace jink::orca::enumerated {

std::optional<Vec3d> nearest(const std::vector<Plane>& planes, const Vec3d& goal)
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

Least least_violation(const std::vector<Plane>& planes)
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

Eigen::VectorXd shares_of(const Eigen::MatrixXd& columns, const Vec3d& sum)
{
    return columns.colPivHouseholderQr().solve(sum);
}

}  // namespace jink::orca::enumerated
