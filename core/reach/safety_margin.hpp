// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>

// How far to keep from what is avoided (Gomola 6.7.5).

namespace jink::reach {

/// What a margin is made of [m], [m/s], [s]; all not negative.
struct MarginTerms {
    float body_radius = 0.0F;     ///< of the own vehicle, greatest
    float base = 0.0F;            ///< asked for by whoever operates it
    float own_sigma = 0.0F;       ///< standard deviation of the own position
    float intruder_sigma = 0.0F;  ///< and of the intruder's
    float intruder_speed = 0.0F;
    float intruder_frame = 0.0F;  ///< its decision frame: the worst that the two clocks may differ by
    float weather = 0.0F;
    float airspace = 0.0F;
    float directive = 0.0F;  ///< margin that the traffic management orders, in place of the sum if it is larger
};
/// Deviations from the mean position that are kept clear: 3, with a normal error 0.3 % are beyond.
inline constexpr float kMarginSigmas = 3.0F;

struct SafetyMargin {
    float margin = 0.0F;     ///< [m]
    float directive = 0.0F;  ///< by how much a directive, where there is one, differs from the sum [m]; else 0
};

/// What an intruder flies within one of its decision frames (Gomola eq. 6.180).
[[nodiscard]] constexpr float synchronization_bloat(float speed, float frame) noexcept { return speed * frame; }

/// The greater of the sum of all terms and a directive. Never below the vehicle's own radius (Gomola eq. 6.179, lower
/// limit; the upper one, two turning radii, is a matter of comfort). O(1).
[[nodiscard]] constexpr SafetyMargin safety_margin(const MarginTerms& t) noexcept
{
    const float sum = std::max(t.body_radius, t.base) + kMarginSigmas * (t.own_sigma + t.intruder_sigma) +
                      synchronization_bloat(t.intruder_speed, t.intruder_frame) + t.weather + t.airspace;
    return {std::max(sum, t.directive), t.directive > 0.0F ? t.directive - sum : 0.0F};
}

/// What has to be added to a margin that is looked at only at points `spacing` apart on a straight way: half-way
/// between two that are just clear the way is nearer by less than this. Holds for margins from 0.29 of the spacing on
/// (half of it over the root of 3); for less look at the segments. O(1).
[[nodiscard]] inline float discretization_bloat(float margin, float spacing) noexcept
{
    return margin - std::sqrt(std::max(0.0F, margin * margin - 0.25F * spacing * spacing));
}

}  // namespace jink::reach
