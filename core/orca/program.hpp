// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "core/base/vec3.hpp"
#include "core/base/work_budget.hpp"
#include "core/orca/half_space.hpp"
#include "core/orca/optimum.hpp"
#include "core/orca/search.hpp"

// The velocity that keeps to all half-spaces and is nearest to the preferred one; where none keeps to all, the one that
// breaks the weakest level least (Alejo 7.1, van den Berg et al.; what Alejo leaves open is said here).

namespace jink::orca {

/// What a solution says of itself; or-ed.
enum StatusBit : std::uint32_t {
    kRelaxedWarning = 1U << 0U,      ///< half-spaces of the warning level are broken
    kRelaxedConflict = 1U << 1U,     ///< of the conflict level
    kRelaxedObstacle = 1U << 2U,     ///< of the obstacle level
    kInfeasibleDynamics = 1U << 3U,  ///< the limits contradict each other: the reference, within the spheres
    kWorkLimit = 1U << 4U,           ///< the budget is spent: the best of a few candidates
    kBadInput = 1U << 5U,            ///< something is not finite or no half-space: the reference, within the spheres
};

/// Most levels there are.
inline constexpr std::size_t kLevels = 4;

struct Problem {
    std::span<const HalfSpace> planes;  ///< by level, the strongest first; within a level in any order
    Spheres spheres;                    ///< one or two: what the vehicle can fly; the last one is what it can reach
    Vec3 preferred = Vec3::Zero();      ///< [m/s]
    Vec3 reference = Vec3::Zero();      ///< the last command [m/s]: what is flown where nothing can be said
};

struct Solution {
    Vec3 velocity = Vec3::Zero();         ///< [m/s], always finite and within the spheres
    Level level = Level::warning;         ///< the strongest level that is broken; meaningless where `status` is 0
    std::array<float, kLevels> broken{};  ///< by level: how far its half-spaces are broken at most, over their yield
    std::array<std::uint16_t, 3>
        active{};              ///< half-spaces that hold the velocity where it is: their places in `planes`
    std::uint8_t actives = 0;  ///< how many of them
    std::uint32_t status = 0;  ///< StatusBit
};

/// Solves `problem`.
///
/// The answer is the same whatever the order of the half-spaces within a level, but for rounding: the nearest point is
/// unique, and where a level gives way the least common violation d (each half-space by d * yield) is found first and
/// the nearest point for it after (van den Berg's 4-D program keeps what its order leaves; this does not). Levels give
/// way from the last: no level is broken for the sake of a weaker one. Limits never give way.
///
/// Instead of looking at all half-spaces in an order that has to be random to be fast, the most violated one joins the
/// few that hold the optimum so far, and the programs run on these: the distance to the preferred velocity grows with
/// each turn, so it ends; should rounding make it go round, the whole program is run once in the given order.
///
/// With planes.size() > the scratch's size (a caller's mistake) or a yield <= 0: kBadInput. Where the budget runs out:
/// of the best point so far, the reference, all braking that the last sphere allows, and all acceleration along the
/// most violated obstacle and conflict half-spaces, the one that breaks obstacles, conflict and warning least, in this
/// order; what it breaks is said as for any other. Five checks of each half-space beyond the budget.
///
/// In single precision first. Where what holds the answer meets in angles below 0.1, or in more half-spaces than three,
/// or half-spaces that may not give way hold those that do by more than twenty times their part, rounding may leave it
/// open: then once more in numbers of twice the precision (wide.hpp), on the few half-spaces that decide. That takes
/// many times as long, and is seldom asked for. Should its few places not do, what single precision has found stands.
///
/// Rounding: where a level is not said to be broken, none of it is by more than 2e-6 of the largest speed, and where it
/// is, by no more than is said and 2e-4 m/s: each velocity is checked once more before it is returned. The optimum
/// and the least violation are exact to 1e-4 m/s for speeds up to some m/s, also among half-spaces within 1e-4 of each
/// other's direction or of its opposite; whether a level has to give way at all is open within 1e-5 m/s. O(n) per turn,
/// usually 2 - 6 turns; each turn is counted, those in twice the precision sixteen times (units::kOrcaDoubleFloat), and
/// n^3 bounds them all. Four more checks of each half-space are not counted. Allocates nothing.
[[nodiscard]] Solution solve(const Problem& problem, ScratchView scratch, WorkBudget& budget) noexcept;

/// The point nearest to `point` that is within all spheres, as near as rounding lets it be. Finite where the spheres
/// are, whatever the point is.
[[nodiscard]] Vec3 into_spheres(Spheres spheres, const Vec3& point) noexcept;

}  // namespace jink::orca
