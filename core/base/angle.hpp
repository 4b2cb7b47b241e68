// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace jink {

// Sine, cosine and arc tangent from +, -, *, / and comparisons alone. C libraries differ in their rounding; these
// functions give the same bits on every target. Coefficients: Cephes, single precision (Moshier), on [0, pi/4] and [0,
// tan(pi/8)]. Checked against double precision (tests/property/core/base).

struct SineCosine {
    float sine = 0.0F;
    float cosine = 1.0F;
};

/// Largest magnitude of an angle that sine_cosine() accepts [rad].
inline constexpr float kMaxAngle = 1000.0F;

/// Sine and cosine of an angle [rad]; both NaN beyond kMaxAngle and for non-finite angles.
///
/// Absolute error below 1e-7; below 0.5 rad the sine's relative error is below 1e-7 too. O(1).
[[nodiscard]] SineCosine sine_cosine(float angle) noexcept;

/// Direction of (x, y), counter-clockwise from the x axis, within [-pi, pi] [rad]; 0 where both are 0. As std::atan2,
/// but for signed zeros: y = -0 counts as 0. NaN where a component is NaN or both are infinite.
///
/// Error below 3e-7 rad for components within [1e-18, 1e18] or 0. O(1), one division.
[[nodiscard]] float direction_angle(float y, float x) noexcept;

}  // namespace jink
