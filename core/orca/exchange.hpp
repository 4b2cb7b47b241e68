// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "core/base/vec3.hpp"
#include "core/base/work_budget.hpp"
#include "core/orca/optimum.hpp"

// The least common violation where four half-spaces contradict each other: the dual simplex method in four unknowns,
// a velocity and the violation.

namespace jink::orca {

/// Four half-spaces that leave no velocity, and the one where those that may give way are broken equally.
template <class Real>
struct Corner {
    std::array<std::uint16_t, 4> rows{};
    std::array<Real, 4> shares{};  ///< how much each of them holds it; their sum, by yield, is 1
    Vec3Of<Real> x = Vec3Of<Real>::Zero();
    Real d = 0.0F;         ///< the violation, over the yield [m/s]
    bool is_alone = true;  ///< no fifth half-space is as far broken, but for rounding
};

/// The least d for which all rows from `soft` on, each shifted by d * yield, and all rows before hold together.
///
/// @param corner  in: rows that contradict each other, any order; out: those that decide, and the answer
/// @return false where it does not end at four rows (a sphere decides too, normals lie in a plane, all four are hard)
/// or
///         the answer is not within the spheres: then nothing is known. True: `corner.x` keeps to all that has to hold,
///         and d is the least.
///
/// With all shares well above 0 that point is the only one. A turn checks each row and four corners; the search ends
/// after a few turns, each with a larger d, and gives up after kMaxTurns. There is one for float and one for Wide.
template <class Real>
[[nodiscard]] bool exchange(std::span<const Row> rows, std::span<const float> yields, std::size_t soft, Spheres spheres,
                            Tolerance<Real> tolerance, WorkBudget& budget, Corner<Real>& corner) noexcept;

}  // namespace jink::orca
