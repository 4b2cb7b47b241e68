// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <type_traits>

#include "core/base/vec3.hpp"
#include "core/base/work_budget.hpp"
#include "core/base/work_units.hpp"
#include "core/orca/double_float.hpp"
#include "core/orca/half_space.hpp"

// The best velocity within spheres and half-spaces: the incremental programs of van den Berg et al., one dimension at a
// time, with one or two spheres in each (Alejo 7.16 and 7.17 hold together). Points are velocities [m/s]; what is said
// of "within" holds but for Tolerance::outside.

namespace jink::orca {

/// A half-space as the programs read it: normal . x >= offset. In single precision 16 bytes, so that four numbers are
/// read at once.
template <class Real>
struct RowOf {  // NOLINT(cppcoreguidelines-pro-type-member-init): left open, scratch is made of it
    Vec3Of<Real> normal;
    Real offset;

    [[nodiscard]] Real violation(const Vec3Of<Real>& x) const noexcept { return offset - normal.dot(x); }
};
using Row = RowOf<float>;

/// row.violation(x), as exact as x is.
template <class Real>
[[nodiscard]] Real violation(const Row& row, const Vec3Of<Real>& x) noexcept
{
    if constexpr (std::is_same_v<Real, float>) {
        return row.violation(x);
    } else {
        return Real(row.offset) - row.normal.cast<Real>().dot(x);
    }
}

/// What is wanted: the point nearest to `point`, or the one farthest along the unit vector `point`.
template <class Real>
struct GoalOf {
    Vec3Of<Real> point = Vec3Of<Real>::Zero();
    bool farthest = false;
};

/// Rows that hold the optimum in place: it is the optimum of these and the spheres alone, but for degenerate corners.
struct Basis {
    std::array<std::uint16_t, 3> rows{};
    std::uint8_t size = 0;
};

/// How exact the programs can be [m/s]: from the speeds that are computed with.
template <class Real>
struct Tolerance {
    float outside;  ///< a point is within a half-space or a sphere by this much: twice the rounding of n . x

    /// @param scale  the largest speed that occurs [m/s]
    explicit constexpr Tolerance(float scale) noexcept : outside((scale > 1.0F ? scale : 1.0F) * kShare) {}
    // NOLINTNEXTLINE(bugprone-dynamic-static-initializers): constexpr, hence constant
    static constexpr float kShare = std::is_same_v<Real, float> ? 5e-7F : 1e-11F;
};

/// Units of work of what takes `single` in single precision.
template <class Real>
[[nodiscard]] constexpr std::uint32_t cost(std::uint32_t single) noexcept
{
    return std::is_same_v<Real, float> ? single : units::kOrcaDoubleFloat * single;
}

/// Spheres of one program: one or two.
using Spheres = std::span<const Sphere>;

/// Whether `x` is within the sphere, but for a tolerance [m/s].
template <class Real>
[[nodiscard]] bool within(const Sphere& sphere, const Vec3Of<Real>& x, float tolerance) noexcept
{
    const Real reach = Real(sphere.radius) + Real(tolerance);
    return (x - sphere.centre.cast<Real>()).squaredNorm() <= reach * reach;
}

/// How a search ended.
enum class Found : std::uint8_t {
    optimum,
    nothing,    ///< the constraints contradict each other
    exhausted,  ///< the budget is spent
};

// All of what follows is there for float and for Wide.

/// Within the spheres alone. False where they do not meet. O(1).
template <class Real>
[[nodiscard]] bool optimum_in_spheres(Spheres spheres, const GoalOf<Real>& goal, Tolerance<Real> tolerance,
                                      Vec3Of<Real>& x) noexcept;

/// On the plane of rows[on], within rows[0 .. before) and the spheres. False, with `x` as it was, where there is no
/// such point. O(before^2), of which one check of each row and one line for each row that turns out to be violated.
template <class Real>
[[nodiscard]] Found optimum_on_plane(std::span<const RowOf<Real>> rows, std::size_t on, std::size_t before,
                                     Spheres spheres, const GoalOf<Real>& goal, Tolerance<Real> tolerance,
                                     WorkBudget& budget, Vec3Of<Real>& x, Basis& basis) noexcept;

/// Within rows and spheres, row by row; the rows' order is the order of priority. `x` is the optimum, or where there is
/// none (nothing) the optimum of the first `satisfied` rows. O(n^3), expected O(n) in a good order.
template <class Real>
struct Optimum {
    Found found = Found::nothing;
    std::size_t satisfied = 0;  ///< rows; all of them where found
    Vec3Of<Real> x = Vec3Of<Real>::Zero();
    Basis basis;
};
template <class Real>
[[nodiscard]] Optimum<Real> optimum(std::span<const RowOf<Real>> rows, Spheres spheres, const GoalOf<Real>& goal,
                                    Tolerance<Real> tolerance, WorkBudget& budget) noexcept;

}  // namespace jink::orca
