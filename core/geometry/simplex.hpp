// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>

#include "core/base/vec3.hpp"

// Private to core/geometry: shared by the distance searches.

namespace jink::geometry::detail {

/// Up to four points, as GJK keeps them (Gilbert, Johnson & Keerthi 1988).
struct Simplex {
    std::array<Vec3, 4> points;
    std::size_t size = 0;
};

/// The point of the simplex nearest to the origin; the simplex keeps only the points that span its feature. 1 <= size
/// <= 4.
///
/// Zero exactly when the origin lies inside a tetrahedron. Vertex, edge and face regions after Ericson 2004, section
/// 5.1. A tetrahedron too flat to separate inside from outside is searched face by face. O(1).
[[nodiscard]] Vec3 reduce_to_nearest(Simplex& simplex) noexcept;

}  // namespace jink::geometry::detail
