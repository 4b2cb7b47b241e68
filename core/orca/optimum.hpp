// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "core/base/vec3.hpp"
#include "core/base/work_budget.hpp"
#include "core/orca/half_space.hpp"

// The best velocity within balls and half-spaces: the incremental programs of van den Berg et al., one dimension at a
// time, with one or two balls in each (Alejo 7.16 and 7.17 hold together). Points are velocities [m/s]; what is said of
// "within" holds but for Tolerance::outside.

namespace jink::orca {

/// A half-space as the programs read it: normal . x >= offset. 16 bytes, so that four numbers are read at once.
struct Row {  // NOLINT(cppcoreguidelines-pro-type-member-init): left open, scratch is made of it
    Vec3 normal;
    float offset;

    [[nodiscard]] float violation(const Vec3& x) const noexcept { return offset - normal.dot(x); }
};

/// What is wanted: the point nearest to `point`, or the one farthest along the unit vector `point`.
struct Goal {
    Vec3 point = Vec3::Zero();
    bool farthest = false;
};

/// Rows that hold the optimum in place: it is the optimum of these and the balls alone, but for degenerate corners.
struct Basis {
    std::array<std::uint16_t, 3> rows{};
    std::uint8_t size = 0;
};

/// How exact single precision can be [m/s]: from the speeds that are computed with.
struct Tolerance {
    float outside;  ///< a point is within a half-space or a ball by this much: twice the rounding of n . x

    /// @param scale  the largest speed that occurs [m/s]
    explicit constexpr Tolerance(float scale) noexcept : outside((scale > 1.0F ? scale : 1.0F) * 5e-7F) {}
};

/// Balls of one program: one or two.
using Balls = std::span<const Ball>;

/// Whether `x` is within the ball, but for a tolerance [m/s].
[[nodiscard]] inline bool within(const Ball& ball, const Vec3& x, float tolerance) noexcept
{
    const float reach = ball.radius + tolerance;
    return (x - ball.centre).squaredNorm() <= reach * reach;
}

/// How a search ended.
enum class Found : std::uint8_t {
    optimum,
    nothing,    ///< the constraints contradict each other
    exhausted,  ///< the budget is spent
};

/// Within the balls alone. False where they do not meet. O(1).
[[nodiscard]] bool optimum_in_balls(Balls balls, const Goal& goal, Tolerance tolerance, Vec3& x) noexcept;

/// On the plane of rows[on], within rows[0 .. before) and the balls. False, with `x` as it was, where there is no such
/// point. O(before^2), of which one look at each row and one line for each row that turns out to be violated.
[[nodiscard]] Found optimum_on_plane(std::span<const Row> rows, std::size_t on, std::size_t before, Balls balls,
                                     const Goal& goal, Tolerance tolerance, WorkBudget& budget, Vec3& x,
                                     Basis& basis) noexcept;

/// Within rows and balls, row by row; the rows' order is the order of priority. `x` is the optimum, or where there is
/// none (nothing) the optimum of the first `satisfied` rows. O(n^3), expected O(n) in a good order.
struct Optimum {
    Found found = Found::nothing;
    std::size_t satisfied = 0;  ///< rows; all of them where found
    Vec3 x = Vec3::Zero();
    Basis basis;
};
[[nodiscard]] Optimum optimum(std::span<const Row> rows, Balls balls, const Goal& goal, Tolerance tolerance,
                              WorkBudget& budget) noexcept;

}  // namespace jink::orca
