// SPDX-License-Identifier: BSD-3-Clause
#include "core/orca/program.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/finite.hpp"
#include "core/base/work_units.hpp"
#include "core/orca/exchange.hpp"

namespace jink::orca {

namespace {

constexpr std::size_t kMaxHeld = 8;   // rows of one turn: the three of a basis, and those that brought nothing
constexpr float kShifted = 1e-4F;     // [m/s] that a relaxed level gives way beyond what it has to, against rounding
constexpr int kMostShifts = 2;        // times that it gives way ten times as far, before what was found is taken
constexpr float kFirm = 1e-3F;        // least share of a corner that is a point and no edge
constexpr float kUnitLength = 1e-3F;  // by which a normal's length may be off
constexpr std::size_t kNobody = ~std::size_t{0};

/// The search for one problem's solution.
class Solver {
public:
    Solver(const Problem& problem, ScratchView scratch, Tolerance tolerance, WorkBudget& budget) noexcept
        : balls_(problem.balls), goal_{problem.preferred, false}, scratch_(scratch), tolerance_(tolerance),
          budget_(budget)
    {
    }

    /// The point nearest to the goal within the first `count` rows.
    Found nearest(std::size_t count) noexcept;
    /// The least d by which rows [from, to) have to give way, each by d * yield, for the rows before `from` to hold.
    /// Starts from the nearest point within those, which nearest(from) has left. Shifts the rows by it.
    Found relax(std::size_t from, std::size_t to, float& d) noexcept;
    /// After nearest(count) found nothing: the same for rows [from, count), where four rows decide. And the nearest
    /// point then. False: nothing is known.
    bool relax_at_corner(std::size_t from, std::size_t count, float& d) noexcept;

    /// The nearest point once rows [from, count) have given way. Where rounding leaves none, because rows before them
    /// are nearly opposite, they give way further.
    Found nearest_relaxed(std::size_t from, std::size_t count) noexcept;

    [[nodiscard]] const Vec3& x() const noexcept { return x_; }
    [[nodiscard]] const Basis& basis() const noexcept { return basis_; }

private:
    struct Worst {
        std::size_t row = kNobody;
        float by = 0.0F;
    };
    [[nodiscard]] Worst worst(std::size_t from, std::size_t to, float least) const noexcept;
    [[nodiscard]] Worst worst_yielding(std::size_t from, std::size_t to, float least) const noexcept;
    void shift(std::size_t from, std::size_t to, float d) noexcept;
    Found whole(std::size_t count) noexcept;
    Found push_out(std::size_t soft, std::size_t hards, std::size_t softs, float& d) noexcept;

    Balls balls_;
    Goal goal_;
    ScratchView scratch_;
    Tolerance tolerance_;
    WorkBudget& budget_;
    Vec3 x_ = Vec3::Zero();
    Basis basis_;
    std::array<std::uint16_t, kMaxHeld> ids_{};  // rows that the last search held, the last one the most violated
    std::size_t size_ = 0;
};

Solver::Worst Solver::worst(std::size_t from, std::size_t to, float least) const noexcept
{
    Worst out{kNobody, least};
    for (std::size_t i = from; i < to; ++i) {
        const float by = scratch_.rows[i].violation(x_);
        if (by > out.by) {
            out = {i, by};
        }
    }
    return out;
}

Solver::Worst Solver::worst_yielding(std::size_t from, std::size_t to, float least) const noexcept
{
    Worst out{kNobody, least};
    for (std::size_t i = from; i < to; ++i) {
        const float by = scratch_.rows[i].violation(x_);
        if (by > out.by * scratch_.yields[i]) {
            out = {i, by / scratch_.yields[i]};
        }
    }
    return out;
}

Found Solver::whole(std::size_t count) noexcept
{
    const Optimum all = optimum(scratch_.rows.first(count), balls_, goal_, tolerance_, budget_);
    x_ = all.x;
    basis_ = all.basis;
    return all.found;
}

Found Solver::nearest(std::size_t count) noexcept
{
    basis_ = Basis{};
    if (!optimum_in_balls(balls_, goal_, tolerance_, x_)) {
        return Found::nothing;
    }
    std::array<Row, kMaxHeld> held;
    std::array<std::uint16_t, kMaxHeld>& ids = ids_;
    std::size_t& size = size_;
    size = 0;
    float distance2 = (x_ - goal_.point).squaredNorm();
    while (budget_.spend(units::kOrcaTurn + units::orca_rows(count))) {
        const Worst next = worst(0, count, tolerance_.outside);
        if (next.row == kNobody) {
            return Found::optimum;
        }
        const bool again = std::find(ids.begin(), ids.begin() + size, next.row) != ids.begin() + size;
        if (size == kMaxHeld || again) {
            return whole(count);
        }
        held[size] = scratch_.rows[next.row];
        ids[size] = static_cast<std::uint16_t>(next.row);
        ++size;
        Basis local;
        const Found found = optimum_on_plane(std::span<const Row>(held.data(), size), size - 1, size - 1, balls_, goal_,
                                             tolerance_, budget_, x_, local);
        if (found != Found::optimum) {
            return found;
        }
        basis_.size = local.size;
        for (std::size_t k = 0; k < local.size; ++k) {
            basis_.rows[k] = ids[local.rows[k]];
        }
        const float farther2 = (x_ - goal_.point).squaredNorm();
        if (farther2 > distance2 * (1.0F + 1e-6F)) {
            // It can not come back to the rows that are let go: they alone leave a point that is nearer.
            distance2 = farther2;
            size = local.size;
            for (std::size_t k = 0; k < size; ++k) {
                ids[k] = basis_.rows[k];
                held[k] = scratch_.rows[ids[k]];
            }
        }
    }
    return Found::exhausted;
}

bool Solver::relax_at_corner(std::size_t from, std::size_t count, float& d) noexcept
{
    if (size_ != 4) {
        return false;
    }
    Corner corner;
    std::copy_n(ids_.begin(), 4, corner.rows.begin());
    if (!exchange(scratch_.rows.first(count), scratch_.yields.first(count), from, balls_, tolerance_, budget_,
                  corner)) {
        return false;
    }
    d = corner.d;
    if (*std::min_element(corner.shares.begin(), corner.shares.end()) > kFirm) {
        x_ = corner.x;
        basis_ = {{corner.rows[0], corner.rows[1], corner.rows[2]}, 3};
        return true;
    }
    // Not the only point that breaks no more: the nearest of them.
    shift(from, count, d);
    x_ = corner.x;
    const Vec3 least = corner.x;
    if (nearest_relaxed(from, count) != Found::optimum) {
        x_ = least;
    }
    return true;
}

void Solver::shift(std::size_t from, std::size_t to, float d) noexcept
{
    for (std::size_t i = from; i < to; ++i) {
        scratch_.rows[i].offset -= (d + kShifted) * scratch_.yields[i];
    }
}

Found Solver::nearest_relaxed(std::size_t from, std::size_t count) noexcept
{
    Found found = nearest(count);
    float further = kShifted;
    for (int turn = 0; turn < kMostShifts && found == Found::nothing; ++turn) {
        further *= 10.0F;
        shift(from, count, further);
        found = nearest(count);
    }
    return found;
}

/// Moves x to where `soft` is broken least while none of the softs before it is broken more: they stand in `held`
/// after the hards.
Found Solver::push_out(std::size_t soft, std::size_t hards, std::size_t softs, float& d) noexcept
{
    if (!budget_.spend(units::kOrcaTurn + units::orca_rows(hards + softs))) {
        return Found::exhausted;
    }
    const Row& most = scratch_.rows[soft];
    const float by = 1.0F / scratch_.yields[soft];
    std::size_t size = 0;
    for (std::size_t k = 0; k < hards; ++k) {
        scratch_.derived[size++] = scratch_.rows[scratch_.held[k]];
    }
    for (std::size_t k = hards; k < hards + softs; ++k) {
        const std::size_t j = scratch_.held[k];
        const float other_by = 1.0F / scratch_.yields[j];
        // Broken by no more than `soft`: offset_j / yield_j - normal_j / yield_j . x <= the same of `soft`.
        const Vec3 normal = scratch_.rows[j].normal * other_by - most.normal * by;
        const float length2 = normal.squaredNorm();
        if (length2 <= 1e-12F) {
            continue;  // the same direction: the one that is broken more stays so
        }
        const float shrink = 1.0F / std::sqrt(length2);
        scratch_.derived[size++] = {normal * shrink, (scratch_.rows[j].offset * other_by - most.offset * by) * shrink};
    }
    const Optimum best = optimum(scratch_.derived.first(size), balls_, {most.normal, true}, tolerance_, budget_);
    if (best.found == Found::exhausted) {
        return Found::exhausted;
    }
    if (best.found == Found::optimum) {
        x_ = best.x;
    }
    d = std::max(d, most.violation(x_) * by);
    return best.found;
}

Found Solver::relax(std::size_t from, std::size_t to, float& d) noexcept
{
    const Vec3 start = x_;
    std::size_t hards = basis_.size;
    std::copy_n(basis_.rows.begin(), hards, scratch_.held.begin());
    std::size_t softs = 0;
    d = 0.0F;
    const float enough = 4.0F * tolerance_.outside;
    while (true) {
        if (!budget_.spend(units::kOrcaTurn + units::orca_rows(to))) {
            return Found::exhausted;
        }
        const Worst soft = worst_yielding(from, to, d + enough);
        const Worst hard = worst(0, from, enough);
        const auto end = scratch_.held.begin() + static_cast<std::ptrdiff_t>(hards + softs);
        const auto is_held = [&](const Worst& w) { return std::find(scratch_.held.begin(), end, w.row) != end; };
        if (soft.row != kNobody && soft.by - d > hard.by) {
            if (is_held(soft)) {
                break;
            }
            if (push_out(soft.row, hards, softs, d) == Found::exhausted) {
                return Found::exhausted;
            }
            scratch_.held[hards + softs++] = static_cast<std::uint16_t>(soft.row);
            continue;
        }
        if (hard.row == kNobody || is_held(hard)) {
            break;
        }
        // A hard one more, before the soft ones: what these gave way has to be found anew.
        std::copy_backward(scratch_.held.begin() + static_cast<std::ptrdiff_t>(hards), end, end + 1);
        scratch_.held[hards++] = static_cast<std::uint16_t>(hard.row);
        x_ = start;
        d = 0.0F;
        for (std::size_t k = 0; k < softs; ++k) {
            const std::size_t i = scratch_.held[hards + k];
            if (scratch_.rows[i].violation(x_) > (d + enough) * scratch_.yields[i] &&
                push_out(i, hards, k, d) == Found::exhausted) {
                return Found::exhausted;
            }
        }
    }
    d = std::max(d, worst_yielding(from, to, d).by);
    shift(from, to, d);
    return Found::optimum;
}

/// Reads the problem into rows. @return the largest speed that occurs, or NaN where something is no number or no
/// half-space, or the levels are not in order
float read(const Problem& problem, ScratchView scratch) noexcept
{
    const std::size_t n = problem.planes.size();
    constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
    if (n > scratch.rows.size() || problem.balls.empty() || problem.balls.size() > 2) {
        return kNan;
    }
    float scale = 0.0F;
    float sum = 0.0F;  // NaN or infinite where anything in it is
    for (const Ball& ball : problem.balls) {
        scale = std::max(scale, ball.centre.norm() + ball.radius);
        sum += ball.centre.squaredNorm() + (ball.radius >= 0.0F ? ball.radius : kNan);
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

/// The reference, within the balls where these are sound.
Vec3 last_command(const Problem& problem) noexcept
{
    const auto is_sound = [](const Ball& ball) { return is_finite(ball.centre) && is_not_negative(ball.radius); };
    if (!problem.balls.empty() && std::all_of(problem.balls.begin(), problem.balls.end(), is_sound)) {
        return into_balls(problem.balls, problem.reference);
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
        most = std::max(most, plane.violation(x) / plane.yield);
    }
    return out;
}

constexpr std::array<std::uint32_t, kLevels> kRelaxed{kInfeasibleDynamics, kRelaxedObstacle, kRelaxedConflict,
                                                      kRelaxedWarning};

constexpr float kUnsaid = 1e-5F;  // [m/s] by which a level may be broken that is not said to be

/// What is said to be broken is what is, to twice the shift: corners of nearly opposite half-spaces may be off by more.
void report(std::span<const HalfSpace> planes, Solution& out) noexcept
{
    const std::array<float, kLevels> exact = broken_by(planes, out.velocity);
    for (std::size_t level = 0; level < kLevels; ++level) {
        if (exact[level] > out.broken[level] + (out.broken[level] > 0.0F ? 2.0F * kShifted : kUnsaid)) {
            out.broken[level] = exact[level];
            out.status |= kRelaxed[level];
            out.level = std::min(out.level, static_cast<Level>(level));
        }
    }
}

/// All the acceleration there is along the half-space of `level` that the reference breaks most.
Vec3 away_from(const Problem& problem, Level level) noexcept
{
    const Ball& reachable = problem.balls.back();
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

/// The best of a few velocities, where there is no time to find a better one.
void choose(const Problem& problem, const Vec3& so_far, Solution& out) noexcept
{
    const Ball& reachable = problem.balls.back();
    const float speed = reachable.centre.norm();
    const Vec3 braking =
        speed <= reachable.radius ? Vec3(Vec3::Zero()) : Vec3(reachable.centre * (1.0F - reachable.radius / speed));
    const std::array<Vec3, 5> candidates{so_far, problem.reference, braking, away_from(problem, Level::obstacles),
                                         away_from(problem, Level::conflict)};
    bool first = true;
    for (const Vec3& candidate : candidates) {
        const Vec3 x = into_balls(problem.balls, candidate);
        const std::array<float, kLevels> broken = broken_by(problem.planes, x);
        if (first || broken < out.broken) {
            out.velocity = x;
            out.broken = broken;
            first = false;
        }
    }
}

/// Level by level: each gives way for those before it.
Found ladder(const Problem& problem, Solver& solver, Solution& out, Vec3& best) noexcept
{
    std::size_t before = 0;
    for (std::size_t level = 0; level < kLevels; ++level) {
        const std::size_t end = level_end(problem.planes, level);
        if (end == before && level > 0) {
            continue;
        }
        Found found = solver.nearest(end);
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
            found = solver.nearest(before);
            best = solver.x();
            if (found == Found::optimum) {
                found = solver.relax(before, end, out.broken[level]);
            }
            if (found == Found::optimum) {
                best = solver.x();
                found = solver.nearest_relaxed(before, end);
            }
        }
        if (found == Found::exhausted) {
            return found;
        }
        if (found == Found::optimum) {
            best = solver.x();
        }
        before = end;
    }
    return Found::optimum;
}

}  // namespace

Vec3 into_balls(Balls balls, const Vec3& point) noexcept
{
    constexpr float kUlps = 3e-7F;
    Vec3 out = is_finite(point) ? point : balls.back().centre;
    const auto in = [&](const Ball& ball) { return (out - ball.centre).squaredNorm() <= ball.radius * ball.radius; };
    if (std::all_of(balls.begin(), balls.end(), in)) {
        return out;
    }
    if (!optimum_in_balls(balls, {out, false}, Tolerance(0.0F), out)) {
        out = balls.front().centre;
    }
    for (const Ball& ball : balls) {
        const Vec3 away = out - ball.centre;
        const float length = away.norm();
        if (length > ball.radius) {
            out = ball.centre + away * (ball.radius / length * (1.0F - kUlps));
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
    Solver solver(problem, scratch, Tolerance(scale), budget);
    Found found = solver.nearest(problem.planes.size());
    Vec3 best = solver.x();
    if (found == Found::nothing) {
        // The last level alone, in most cases.
        const std::size_t last = problem.planes.empty() ? 0 : static_cast<std::size_t>(problem.planes.back().level);
        if (last > 0 &&
            solver.relax_at_corner(level_end(problem.planes, last - 1), problem.planes.size(), out.broken[last])) {
            out.status = kRelaxed[last];
            out.level = problem.planes.back().level;
            best = solver.x();
            found = Found::optimum;
        } else {
            best = problem.reference;
            out.broken = {};
            found = ladder(problem, solver, out, best);
        }
    }
    if (found == Found::exhausted) {
        out.status |= kWorkLimit;
        choose(problem, best, out);
        return out;
    }
    if ((out.status & kInfeasibleDynamics) != 0) {
        out.velocity = into_balls(problem.balls, problem.reference);
        out.broken = broken_by(problem.planes, out.velocity);
        return out;
    }
    out.velocity = into_balls(problem.balls, best);
    if (out.status != 0) {
        report(problem.planes, out);
    }
    out.actives = solver.basis().size;
    out.active = solver.basis().rows;
    return out;
}

}  // namespace jink::orca
