// SPDX-License-Identifier: BSD-3-Clause
#include "core/orca/program.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/finite.hpp"
#include "core/orca/search.hpp"

namespace jink::orca {

namespace {

/// Units of a program before its first turn.
constexpr std::uint32_t kSolveUnits = 6;

constexpr float kUnitLength = 1e-3F;  // by which a normal's length may be off

/// Reads the problem into rows. @return the largest speed that occurs, or NaN where something is no number or no
/// half-space, or the levels are not in order
float read(const Problem& problem, ScratchView scratch) noexcept
{
    const std::size_t n = problem.planes.size();
    constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
    if (n > scratch.rows.size() || problem.spheres.empty() || problem.spheres.size() > 2) {
        return kNan;
    }
    float scale = 0.0F;
    float sum = 0.0F;  // NaN or infinite where anything in it is
    for (const Sphere& sphere : problem.spheres) {
        scale = std::max(scale, sphere.centre.norm() + sphere.radius);
        sum += sphere.centre.squaredNorm() + (sphere.radius >= 0.0F ? sphere.radius : kNan);
    }
    sum += problem.preferred.squaredNorm() + problem.reference.squaredNorm();
    bool sound = true;
    Level level = Level::limits;
    for (std::size_t i = 0; i < n; ++i) {
        const HalfSpace& plane = problem.planes[i];
        scratch.rows[i] = {plane.normal, plane.offset};
        scratch.yields[i] = plane.yield;
        sum += std::fabs(plane.offset);
        sound = sound && std::fabs(plane.normal.squaredNorm() - 1.0F) <= kUnitLength && plane.yield > 0.0F &&
                plane.level >= level;
        level = plane.level;
    }
    return sound && std::isfinite(sum) ? scale : kNan;
}

/// The reference, within the spheres where these are sound.
Vec3 last_command(const Problem& problem) noexcept
{
    const auto is_sound = [](const Sphere& sphere) {
        return is_finite(sphere.centre) && is_not_negative(sphere.radius);
    };
    if (!problem.spheres.empty() && std::all_of(problem.spheres.begin(), problem.spheres.end(), is_sound)) {
        return into_spheres(problem.spheres, problem.reference);
    }
    return is_finite(problem.reference) ? problem.reference : Vec3(Vec3::Zero());
}

/// The end of the levels up to and with `level`.
std::size_t level_end(std::span<const HalfSpace> planes, std::size_t level) noexcept
{
    std::size_t end = 0;
    while (end < planes.size() && static_cast<std::size_t>(planes[end].level) <= level) {
        ++end;
    }
    return end;
}

/// How far each level is broken by `x`.
std::array<float, kLevels> broken_by(std::span<const HalfSpace> planes, const Vec3& x) noexcept
{
    std::array<float, kLevels> out{};
    for (const HalfSpace& plane : planes) {
        float& most = out[static_cast<std::size_t>(plane.level)];
        const float by = plane.violation(x);
        if (by > most * plane.yield) {
            most = by / plane.yield;
        }
    }
    return out;
}

constexpr std::array<std::uint32_t, kLevels> kRelaxed{kInfeasibleDynamics, kRelaxedObstacle, kRelaxedConflict,
                                                      kRelaxedWarning};

/// Last check of each velocity, however it was found: reports the levels that it breaks. Accurate to twice the shift
/// where a level gives way, to rounding where it does not.
void report(std::span<const HalfSpace> planes, float scale, Solution& out) noexcept
{
    const float unsaid = 4.0F * Tolerance<float>(scale).outside;
    const std::array<float, kLevels> exact = broken_by(planes, out.velocity);
    for (std::size_t level = 0; level < kLevels; ++level) {
        if (exact[level] > out.broken[level] + (out.broken[level] > 0.0F ? 2.0F * kShifted : unsaid)) {
            out.broken[level] = exact[level];
            out.status |= kRelaxed[level];
            out.level = std::min(out.level, static_cast<Level>(level));
        }
    }
}

/// All the acceleration there is along the half-space of `level` that the reference breaks most.
Vec3 away_from(const Problem& problem, Level level) noexcept
{
    const Sphere& reachable = problem.spheres.back();
    Vec3 out = problem.reference;
    float most = -std::numeric_limits<float>::infinity();
    for (const HalfSpace& plane : problem.planes) {
        const float by = plane.violation(problem.reference);
        if (plane.level == level && by > most) {
            most = by;
            out = reachable.centre + reachable.radius * plane.normal;
        }
    }
    return out;
}

/// The best of a few velocities, where there is no time to find a better one. What it breaks is said, not what was
/// given way to until then.
void choose(const Problem& problem, const Vec3& so_far, float scale, Solution& out) noexcept
{
    const Sphere& reachable = problem.spheres.back();
    const float speed = reachable.centre.norm();
    const Vec3 braking =
        speed <= reachable.radius ? Vec3(Vec3::Zero()) : Vec3(reachable.centre * (1.0F - reachable.radius / speed));
    const std::array<Vec3, 5> candidates{so_far, problem.reference, braking, away_from(problem, Level::obstacles),
                                         away_from(problem, Level::conflict)};
    bool first = true;
    for (const Vec3& candidate : candidates) {
        const Vec3 x = into_spheres(problem.spheres, candidate);
        const std::array<float, kLevels> broken = broken_by(problem.planes, x);
        if (first || broken < out.broken) {
            out.velocity = x;
            out.broken = broken;
            first = false;
        }
    }
    out.status = kWorkLimit;
    out.level = Level::warning;
    for (std::size_t level = kLevels; level-- > 0;) {
        if (out.broken[level] > 4.0F * Tolerance<float>(scale).outside) {
            out.status |= kRelaxed[level];
            out.level = static_cast<Level>(level);
        }
    }
}

/// Level by level: each gives way for those before it.
template <class Real>
Found order(const Problem& problem, Search<Real>& search, Solution& out, Vec3& best) noexcept
{
    std::size_t before = 0;
    for (std::size_t level = 0; level < kLevels; ++level) {
        const std::size_t end = level_end(problem.planes, level);
        if (end == before && level > 0) {
            continue;
        }
        Found found = search.nearest(end);
        if (found == Found::nothing && level == 0) {
            out.status |= kInfeasibleDynamics;
            out.level = Level::limits;
            return Found::nothing;
        }
        if (found == Found::nothing) {
            if (out.status == 0) {
                out.level = static_cast<Level>(level);
            }
            out.status |= kRelaxed[level];
            found = search.nearest(before);
            best = search.x();
            if (found == Found::optimum) {
                found = search.relax(before, end, out.broken[level]);
            }
            if (found == Found::optimum) {
                best = search.x();
                found = search.nearest_relaxed(before, end);
            }
        }
        if (found == Found::exhausted) {
            return found;
        }
        if (found == Found::optimum) {
            best = search.x();
        }
        before = end;
    }
    return Found::optimum;
}

/// Solves it with numbers of one kind. `is_blunt`: rounding may have left the answer open.
template <class Real>
Found attempt(const Problem& problem, ScratchView scratch, float scale, WorkBudget& budget, Solution& out, Vec3& best,
              bool& is_blunt) noexcept
{
    Search<Real> search(problem.spheres, problem.preferred, scratch, scale, budget);
    Found found = search.nearest(problem.planes.size());
    best = search.x();
    is_blunt = false;
    if (found == Found::optimum) {
        search.judge(problem.planes.size());
    } else if (found == Found::nothing) {
        // The last level alone, in most cases.
        const std::size_t last = problem.planes.empty() ? 0 : static_cast<std::size_t>(problem.planes.back().level);
        if (last > 0 &&
            search.relax_at_corner(level_end(problem.planes, last - 1), problem.planes.size(), out.broken[last])) {
            out.status = kRelaxed[last];
            out.level = problem.planes.back().level;
            best = search.x();
            found = budget.exhausted() ? Found::exhausted : Found::optimum;
        } else {
            best = problem.reference;
            out.broken = {};
            found = order(problem, search, out, best);
            is_blunt = out.status == 0;  // it is not sure what it found first
        }
    }
    is_blunt = is_blunt || search.is_blunt();
    out.actives = search.basis().size;
    out.active = search.basis().rows;
    return found;
}

/// Once more, in twice the precision. What was found stays where that does not end: its few rows do not do.
[[gnu::noinline]] Found refine(const Problem& problem, ScratchView scratch, float scale, WorkBudget& budget,
                               Solution& out, Vec3& best) noexcept
{
    read(problem, scratch);  // rows that have given way
    Solution finer;
    Vec3 finer_best;
    bool unused = false;
    const Found found = attempt<DoubleFloat>(problem, scratch, scale, budget, finer, finer_best, unused);
    if (budget.exhausted()) {
        return Found::exhausted;
    }
    if (found == Found::exhausted) {
        return Found::optimum;
    }
    out = finer;
    best = finer_best;
    return found;
}

}  // namespace

Vec3 into_spheres(Spheres spheres, const Vec3& point) noexcept
{
    constexpr float kUlps = 3e-7F;
    Vec3 out = is_finite(point) ? point : spheres.back().centre;
    const auto in = [&](const Sphere& sphere) {
        return (out - sphere.centre).squaredNorm() <= sphere.radius * sphere.radius;
    };
    if (std::all_of(spheres.begin(), spheres.end(), in)) {
        return out;
    }
    if (!optimum_in_spheres<float>(spheres, {out, false}, Tolerance<float>(0.0F), out)) {
        out = spheres.front().centre;
    }
    for (const Sphere& sphere : spheres) {
        const Vec3 away = out - sphere.centre;
        const float length = away.norm();
        if (length > sphere.radius) {
            out = sphere.centre + away * (sphere.radius / length * (1.0F - kUlps));
        }
    }
    return out;
}

Solution solve(const Problem& problem, ScratchView scratch, WorkBudget& budget) noexcept
{
    Solution out;
    const float scale = read(problem, scratch);
    if (!std::isfinite(scale)) {
        out.status = kBadInput;
        out.level = Level::limits;
        out.velocity = last_command(problem);
        return out;
    }
    Vec3 best = problem.reference;
    bool is_blunt = false;
    // Reading and looking at all of them once more is work too.
    const auto looks = static_cast<std::uint32_t>(problem.planes.size()) / 2;
    Found found = budget.spend(kSolveUnits + looks)
                      ? attempt<float>(problem, scratch, scale, budget, out, best, is_blunt)
                      : Found::exhausted;
    if (is_blunt && found != Found::exhausted) {
        found = refine(problem, scratch, scale, budget, out, best);
    }
    if (found == Found::exhausted) {
        choose(problem, best, scale, out);
        return out;
    }
    if ((out.status & kInfeasibleDynamics) != 0) {
        out.velocity = into_spheres(problem.spheres, problem.reference);
        out.broken = broken_by(problem.planes, out.velocity);
        return out;
    }
    out.velocity = into_spheres(problem.spheres, best);
    report(problem.planes, scale, out);
    return out;
}

}  // namespace jink::orca
