// SPDX-License-Identifier: BSD-3-Clause
#include "tests/property/core/geometry/convex_oracle.hpp"

#include <Eigen/Dense>

namespace jink::geometry::oracle {

std::vector<double> affine_weights(const std::vector<Vec3d>& points)
{
    std::vector<double> weights(points.size(), 0.0);
    weights[0] = 1;
    if (points.size() > 1) {
        // In place: the core forbids Eigen's heap.
        Eigen::Matrix<double, 3, Eigen::Dynamic, Eigen::ColMajor, 3, kMaxPoints> sides(
            3, static_cast<Eigen::Index>(points.size()) - 1);
        for (Eigen::Index i = 0; i < sides.cols(); ++i) {
            sides.col(i) = points[static_cast<std::size_t>(i) + 1] - points[0];
        }
        const Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, kMaxPoints, 1> along =
            sides.completeOrthogonalDecomposition().solve(-points[0]);
        for (Eigen::Index i = 0; i < sides.cols(); ++i) {
            weights[static_cast<std::size_t>(i) + 1] = along(i);
            weights[0] -= along(i);
        }
    }
    return weights;
}

}  // namespace jink::geometry::oracle
