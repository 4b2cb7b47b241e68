// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>

#include <Eigen/Core>

namespace jink {

/// Point [m], velocity [m/s] or direction [-] in the world frame: local ENU, right-handed, z up.
using Vec3 = Eigen::Vector3f;
/// Rotation: columns are the axes of the turned frame, written in the world frame.
using Mat3 = Eigen::Matrix3f;

inline constexpr float kPi = 3.14159265358979323846F;
/// Standard gravity [m/s2] as Pinheiro rounds it.
inline constexpr float kGravity = 9.81F;

/// True when no component is NaN or infinite.
[[nodiscard]] inline bool is_finite(const Vec3& v) noexcept
{
    return std::isfinite(v.x()) && std::isfinite(v.y()) && std::isfinite(v.z());
}

}  // namespace jink
