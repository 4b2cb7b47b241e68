// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "core/base/vec3.hpp"
#include "core/base/work_budget.hpp"
#include "core/capacity.hpp"
#include "core/orca/optimum.hpp"

// Nearest points and least violations among many half-spaces: few of them decide, and these are what is searched for.

namespace jink::orca {

/// What a solver works in: 38 bytes for each half-space, of the caller's.
struct ScratchView {
    std::span<Row> rows;
    std::span<Row> derived;
    std::span<float> yields;
    std::span<std::uint16_t> held;
};
template <std::size_t N = kMaxOrcaPlanes>
class Scratch {  // NOLINT(cppcoreguidelines-pro-type-member-init): written before it is read, each time
public:
    [[nodiscard]] ScratchView view() noexcept { return {rows_, derived_, yields_, held_}; }

private:
    std::array<Row, N> rows_;
    std::array<Row, N> derived_;
    std::array<float, N> yields_;
    std::array<std::uint16_t, N> held_;
};

/// [m/s] that a relaxed level gives way beyond what it has to, against rounding.
inline constexpr float kShifted = 1e-4F;

/// The search for one problem's solution: what solve() is made of.
template <class Real>
class Search {
public:
    /// scratch.rows and scratch.yields are the problem's, by level.
    /// scale: the largest speed that occurs [m/s].
    Search(Spheres spheres, const Vec3& goal, ScratchView scratch, float scale, WorkBudget& budget) noexcept
        : spheres_(spheres), goal_{goal.cast<Real>(), false}, scratch_(scratch), tolerance_(scale),
          rounding_(4.0F * Tolerance<float>(scale).outside), budget_(budget)
    {
    }

    /// The point nearest to the goal within the first `count` rows.
    [[nodiscard]] Found nearest(std::size_t count) noexcept;
    /// The least d by which rows [from, to) have to give way, each by d * yield, for the rows before `from` to hold.
    /// Starts from the nearest point within those, which nearest(from) has left. Shifts the rows by it.
    [[nodiscard]] Found relax(std::size_t from, std::size_t to, float& broken) noexcept;
    /// After nearest(count) found nothing: the same for rows [from, count), where four rows decide. And the nearest
    /// point then. False: nothing is known.
    [[nodiscard]] bool relax_at_corner(std::size_t from, std::size_t count, float& d) noexcept;

    /// The nearest point once rows [from, count) have given way. Where rounding leaves none, because rows before them
    /// are nearly opposite, they give way further.
    [[nodiscard]] Found nearest_relaxed(std::size_t from, std::size_t count) noexcept;

    [[nodiscard]] Vec3 x() const noexcept { return x_.template cast<float>(); }
    [[nodiscard]] const Basis& basis() const noexcept { return basis_; }
    /// Checks what holds the nearest point that nearest(count) has found, for is_blunt(). O(count).
    void judge(std::size_t count) noexcept;
    /// Whether rounding may have left the answer open: what holds it meets in too small an angle.
    [[nodiscard]] bool is_blunt() const noexcept { return blunt_; }

private:
    /// Rows of one turn: the three of a basis, and those that brought nothing.
    static constexpr std::size_t kMaxHeld = 8;
    /// And where levels give way in twice the precision.
    static constexpr std::size_t kMaxDerived = 16;
    static constexpr std::uint32_t kNobody = ~std::uint32_t{0};
    struct Worst {
        std::uint32_t row = kNobody;
        std::uint32_t near = 0;  // rows that are broken but for rounding
        Real by = 0.0F;
    };
    [[nodiscard]] Worst worst(std::size_t from, std::size_t to, Real least) const noexcept;
    [[nodiscard]] Worst worst_yielding(std::size_t from, std::size_t to, Real least) const noexcept;
    [[nodiscard]] RowOf<Real> row(std::size_t i) const noexcept;
    void shift(std::size_t from, std::size_t to, float d) const noexcept;
    [[nodiscard]] Found whole(std::size_t count) noexcept;
    [[nodiscard]] Found push_out(std::size_t soft, std::size_t hards, std::size_t softs, Real& d) noexcept;
    [[nodiscard]] bool is_held_bluntly(std::size_t count) const noexcept;

    Spheres spheres_;
    GoalOf<Real> goal_;
    ScratchView scratch_;
    Tolerance<Real> tolerance_;
    float rounding_;  // of a violation in single precision [m/s]
    WorkBudget& budget_;
    Vec3Of<Real> x_ = Vec3Of<Real>::Zero();
    Basis basis_;
    std::array<std::uint16_t, kMaxHeld> ids_{};  // rows that the last search held, the last one the most violated
    std::size_t size_ = 0;
    std::uint32_t near_ = 0;  // rows at x, but for rounding
    bool blunt_ = false;
};

}  // namespace jink::orca
