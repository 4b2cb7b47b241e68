// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <cstdint>

#include "core/base/vec3.hpp"

namespace jink::geometry {

/// Result of a quick reject by one plane, for a point moving straight past a box rounded by a radius. Stands for a box
/// and a sphere: the point is the sphere's centre relative to the box.
enum class QuickReject : std::uint8_t { touches, apart, unclear };

/// Point from `from` to `to`, box of half extents `half` about the origin, `radius` >= 0, all finite.
///
/// `touches` and `apart` are given only where contact_interval (sweep.hpp) says the same of the motion, also when its
/// points and its radius differ by a few last bits: both keep off the border by far more than that. Most near misses
/// are `apart`. The plane is perpendicular to the line from the box to the middle of the motion. O(1), one root.
[[nodiscard]] inline QuickReject quick_reject(const Vec3& half, const Vec3& from, const Vec3& to, float radius) noexcept
{
    constexpr float kSlack = 1e-5F;        // of all lengths; contact_interval's slack is a twentieth of that
    constexpr float kWellInside = 0.999F;  // of the squared radius
    const Vec3 middle = 0.5F * (from + to);
    const Vec3 off = middle - middle.cwiseMax(-half).cwiseMin(half);
    const float off_squared = off.squaredNorm();
    const float sizes = from.cwiseAbs().sum() + to.cwiseAbs().sum() + half.sum() + radius;
    // The box lies behind the plane through its nearest point; this is how far both ends lie before it, times |off|.
    const float ends = off_squared - 0.5F * std::abs(off.dot(to - from));
    if (ends > (radius + kSlack * sizes) * std::sqrt(off_squared)) {
        return QuickReject::apart;
    }
    return off_squared <= kWellInside * radius * radius ? QuickReject::touches : QuickReject::unclear;
}

}  // namespace jink::geometry
