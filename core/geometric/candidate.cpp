// SPDX-License-Identifier: BSD-3-Clause
#include "core/geometric/candidate.hpp"

#include <Eigen/Geometry>
#include <cmath>

namespace jink::geometric {
namespace {

/// A leg within this of the vertical has no horizontal normal worth the name [rad].
constexpr float kVertical = 1e-4F;

}  // namespace

PathFrame make_path_frame(const Vec3& origin, const Vec3& direction) noexcept
{
    const Vec3 x = (direction / direction.cwiseAbs().maxCoeff()).normalized();
    Vec3 y(-x.y(), x.x(), 0.0F);
    if (y.norm() < kVertical) {
        y = Vec3::UnitY() - x.y() * x;
    }
    y.normalize();
    PathFrame frame;
    frame.origin = origin;
    frame.axes.col(0) = x;
    frame.axes.col(1) = y;
    frame.axes.col(2) = x.cross(y);
    return frame;
}

float unit_offset(Family family, float u) noexcept
{
    const float v = family == Family::symmetric && u > 1.0F ? 2.0F - u : u;
    return v * v * (3.0F - 2.0F * v);
}

float curve_offset(const CandidateShape& shape, float distance, float s) noexcept
{
    return shape.offset * unit_offset(shape.family, s / distance);
}

float curve_length_x(Family family, float distance) noexcept
{
    return (family == Family::simple ? kSimpleLength : kSymmetricLength) * distance;
}

}  // namespace jink::geometric
