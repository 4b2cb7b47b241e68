// SPDX-License-Identifier: BSD-3-Clause
#include "core/geometric/candidate.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace jink::geometric {
namespace {

/// A leg within this of the vertical has no horizontal normal worth the name [rad].
constexpr float kVertical = 1e-4F;

/// From 0 to 1 with no slope and no curvature at either end.
float least_jerk(float v) noexcept { return v * v * v * (10.0F + v * (6.0F * v - 15.0F)); }

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

PathFrame make_path_frame(const Vec3& origin, const Vec3& direction, const Vec3& across) noexcept
{
    PathFrame frame;
    const Vec3 x = (direction / direction.cwiseAbs().maxCoeff()).normalized();
    const Vec3 scaled = across / across.cwiseAbs().maxCoeff();
    frame.origin = origin;
    frame.axes.col(0) = x;
    frame.axes.col(1) = (scaled - scaled.dot(x) * x).normalized();
    frame.axes.col(2) = x.cross(Vec3(frame.axes.col(1)));
    return frame;
}

std::string_view to_string(Family family) noexcept
{
    switch (family) {
    case Family::simple: return "simple";
    case Family::symmetric: return "symmetric";
    case Family::smooth: return "smooth";
    case Family::plateau: return "plateau";
    case Family::wait: return "wait";
    }
    return "";
}

float unit_offset(Family family, float u) noexcept
{
    const float back = family != Family::simple && u > 1.0F ? 2.0F - u : u;
    switch (family) {
    case Family::simple:
    case Family::symmetric: return back * back * (3.0F - 2.0F * back);
    case Family::smooth: return least_jerk(back);
    case Family::plateau: return least_jerk(std::min(back * (1.0F / kPlateauRise), 1.0F));
    case Family::wait: break;
    }
    return 0.0F;
}

float curve_offset(const CandidateShape& shape, float distance, float s) noexcept
{
    return shape.offset * unit_offset(shape.family, s / distance);
}

float curve_length_x(Family family, float distance) noexcept
{
    return (family == Family::simple || family == Family::wait ? kSimpleLength : kSymmetricLength) * distance;
}

}  // namespace jink::geometric
