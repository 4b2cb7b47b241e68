// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/base/vec3.hpp"
#include "core/orca/optimum.hpp"

// Where planes meet, in single precision, also those of nearly the same or nearly opposite direction: what rounding
// leaves of a violation is a long way there, so that violations are computed as if in twice the precision.

namespace jink::orca {

/// Sine of an angle between planes that rounding of normals does not tell from 0.
inline constexpr float kSameDirection = 1e-6F;

/// row.violation(x) as if in twice the precision, rounded once (Ogita, Rump and Oishi's Dot2). Some 80 operations.
[[nodiscard]] float exact_violation(const Row& row, const Vec3& x) noexcept;

/// The line that both planes have in common, from its point nearest to `near`, which lies on plane `one`, along a unit
/// vector. False where they are parallel. O(1).
[[nodiscard]] bool line_of(const Row& one, const Row& other, const Vec3& near, Vec3& from, Vec3& along) noexcept;

/// Brings a corner of three planes that hardly differ in direction to where they meet, if that is within the balls;
/// others stay as they are. O(1).
void settle(const Row& a, const Row& b, const Row& c, Balls balls, float tolerance, Vec3& x) noexcept;

}  // namespace jink::orca
