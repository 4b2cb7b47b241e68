// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>

#include "core/geometric/curve.hpp"

// Boxes about curves: quick rejects before exact tests. Private to this module.

namespace jink::geometric::detail {

/// Share of all lengths that quick rejects leave as clearance, so that rounding never passes over a contact.
inline constexpr float kExtentRounding = 1e-5F;

/// Axis-aligned box about the start of the manoeuvre [m].
struct Extent {
    Vec3 low = Vec3::Zero();
    Vec3 high = Vec3::Zero();

    [[nodiscard]] Vec3 middle() const noexcept { return 0.5F * (low + high); }
    [[nodiscard]] Vec3 half() const noexcept { return 0.5F * (high - low); }
};

[[nodiscard]] inline Extent about(const Vec3& a, const Vec3& b) noexcept { return {a.cwiseMin(b), a.cwiseMax(b)}; }

/// Whether two boxes, one of them grown by `half` + `radius`, are apart along some axis.
[[nodiscard]] inline bool apart(const Vec3& low_a, const Vec3& high_a, const Vec3& low_b, const Vec3& high_b,
                                const Vec3& half, float radius) noexcept
{
    for (int i = 0; i < 3; ++i) {
        const float edge = (half[i] + radius) * (1.0F + kExtentRounding) +
                           kExtentRounding * (1.0F + std::abs(low_b[i]) + std::abs(high_b[i]));
        if (low_a[i] > high_b[i] + edge || high_a[i] < low_b[i] - edge) {
            return true;
        }
    }
    return false;
}

/// A curve as something sees it that moves at `velocity` [m/s]: positions less the way which that has made by then.
struct View {
    const Curve& curve;
    Vec3 velocity = Vec3::Zero();
    Seconds begins = 0.0F;  ///< so long it has moved when the curve begins
    Extent extent{};        ///< of all points

    [[nodiscard]] std::size_t last() const noexcept { return curve.points - 1; }
    [[nodiscard]] Vec3 position(std::size_t i) const noexcept
    {
        return curve.position(i) - (begins + curve.t[i]) * velocity;
    }
};
/// With its extent. O(points).
[[nodiscard]] View view_of(const Curve& curve, const Vec3& velocity = Vec3::Zero(), Seconds begins = 0.0F) noexcept;
/// Last point of the longest run from point `i` on that is straight along `along` (unit vector), forwards and within
/// kStraight; i + 1 at least. O(run).
[[nodiscard]] std::size_t straight_until(const View& view, std::size_t i, const Vec3& along) noexcept;
/// What is that straight counts as straight [m].
inline constexpr float kStraight = 1e-4F;

[[nodiscard]] inline Extent extent_of(const Curve& curve) noexcept { return view_of(curve).extent; }

}  // namespace jink::geometric::detail
