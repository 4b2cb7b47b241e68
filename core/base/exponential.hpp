// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace jink {

// Exponential and logarithm from +, -, *, conversions and comparisons alone, the same bits on every target, as in
// core/base/angle.hpp. Coefficients: Cephes, single precision (Moshier). Checked against double precision
// (tests/property/core/base).

/// 1 - e^-x: share of an error that has decayed after x time constants, x >= 0 or infinite; NaN for NaN.
///
/// Relative error below 2e-7. O(1).
[[nodiscard]] float faded_share(float x) noexcept;

/// Natural logarithm of a finite value > 0, subnormal values included.
///
/// Error below 1e-7 + 1e-7 of the result. O(1).
[[nodiscard]] float natural_log(float value) noexcept;

}  // namespace jink
