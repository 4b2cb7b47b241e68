// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <type_traits>

#include <Eigen/Geometry>

#include "core/orca/optimum.hpp"

// Where planes meet, also those of nearly the same or nearly opposite direction.

namespace jink::orca {

/// Sine of an angle between planes that rounding does not tell from 0: of normals in single precision, or of what is
/// computed from them in twice that.
template <class Real>
// NOLINTNEXTLINE(bugprone-dynamic-static-initializers): constexpr, hence constant
inline constexpr float kSameDirection = std::is_same_v<Real, float> ? 1e-6F : 1e-10F;

/// The line that both planes have in common, from its point nearest to `near`, which lies on plane `one`, along a unit
/// vector. False where they are parallel. To rounding over the sine of the angle between the planes. O(1).
template <class Real>
[[nodiscard]] bool line_of(const RowOf<Real>& one, const RowOf<Real>& other, const Vec3Of<Real>& near,
                           Vec3Of<Real>& from, Vec3Of<Real>& along) noexcept
{
    // Normals of nearly the same direction, or nearly opposite ones: their difference, or sum, is exact where the cross
    // product of both would be a difference of products that are nearly equal.
    const bool is_opposite = one.normal.dot(other.normal) < 0.0F;
    const Vec3Of<Real> turn =
        is_opposite ? Vec3Of<Real>(other.normal + one.normal) : Vec3Of<Real>(other.normal - one.normal);
    along = turn.cross(one.normal);
    const Real sine = along.norm();
    if (sine <= kSameDirection<Real>) {
        return false;
    }
    along /= sine;
    const Vec3Of<Real> across_line = along.cross(one.normal);  // in plane `one`
    const Real steep = across_line.dot(turn);                  // = across_line . other.normal, but exact
    from = near + (other.violation(near) / steep) * across_line;
    // What the way of a long step rounded off, once more.
    from += one.violation(from) * one.normal;
    from += (other.violation(from) / steep) * across_line;
    return true;
}

}  // namespace jink::orca
