// SPDX-License-Identifier: BSD-3-Clause
#include "core/orca/search.hpp"

#include <algorithm>
#include <cmath>
#include <type_traits>

#include <Eigen/Geometry>

#include "core/base/work_units.hpp"
#include "core/orca/exchange.hpp"

namespace jink::orca {

using std::sqrt;

namespace {

constexpr int kMaxShifts = 2;   // times that a level gives way ten times as far, before what was found is taken
constexpr float kFirm = 1e-3F;  // least share of a corner that is a point and no edge

// From when on single precision is not enough for 1e-4 of the speed: sine of an angle, and sum of a corner's shares.
constexpr float kBluntAngle = 0.1F;
constexpr float kMaxShares = 20.0F;

/// By how much a square of a distance has to grow to be said to.
template <class Real>
constexpr float kProgress = std::is_same_v<Real, float> ? 1e-6F : 1e-12F;

}  // namespace

template <class Real>
auto Search<Real>::worst(std::size_t from, std::size_t to, Real least) const noexcept -> Worst
{
    Worst out;
    out.by = least;
    if constexpr (std::is_same_v<Real, float>) {
        const Vec3 at = x_;
        const float rounding = rounding_;
        for (std::size_t i = from; i < to; ++i) {
            const float by = scratch_.rows[i].violation(at);
            out.near += by > -rounding ? 1U : 0U;
            if (by > out.by) {
                out.row = static_cast<std::uint32_t>(i);
                out.by = by;
            }
        }
    } else {
        // In single precision first, which leaves a few rows.
        const Vec3 rounded = x();
        for (std::size_t i = from; i < to; ++i) {
            if (scratch_.rows[i].violation(rounded) + rounding_ <= static_cast<float>(out.by)) {
                continue;
            }
            const Real by = violation<Real>(scratch_.rows[i], x_);
            if (by > out.by) {
                out.row = static_cast<std::uint32_t>(i);
                out.by = by;
            }
        }
    }
    return out;
}

template <class Real>
auto Search<Real>::worst_yielding(std::size_t from, std::size_t to, Real least) const noexcept -> Worst
{
    Worst out;
    out.by = least;
    for (std::size_t i = from; i < to; ++i) {
        const Real by = violation<Real>(scratch_.rows[i], x_);
        if (by > out.by * scratch_.yields[i]) {
            out.row = static_cast<std::uint32_t>(i);
            out.by = by / scratch_.yields[i];
        }
    }
    return out;
}

template <class Real>
RowOf<Real> Search<Real>::row(std::size_t i) const noexcept
{
    RowOf<Real> out{scratch_.rows[i].normal.template cast<Real>(), scratch_.rows[i].offset};
    if constexpr (!std::is_same_v<Real, float>) {
        // The length of a normal is 1 but for its rounding, and that would be a way off the plane.
        const Real by = Real(1.0F) / out.normal.norm();
        out.normal *= by;
        out.offset *= by;
    }
    return out;
}

template <class Real>
Found Search<Real>::whole(std::size_t count) noexcept
{
    if constexpr (std::is_same_v<Real, float>) {
        blunt_ = true;
        const Optimum<Real> all = optimum<Real>(scratch_.rows.first(count), spheres_, goal_, tolerance_, budget_);
        x_ = all.x;
        basis_ = all.basis;
        // It does not look back at rows that it has passed; near corners that hardly are any, rounding may have left
        // them.
        const bool holds = worst(0, count, 4.0F * tolerance_.outside).row == kNobody;
        return all.found == Found::optimum && !holds ? Found::nothing : all.found;
    } else {
        return Found::exhausted;
    }
}

template <class Real>
void Search<Real>::judge(std::size_t count) noexcept
{
    blunt_ = blunt_ || (near_ + spheres_.size() > 1 && is_held_bluntly(count));
}

template <class Real>
bool Search<Real>::is_held_bluntly(std::size_t count) const noexcept
{
    // Unit normals of all that is near: rows that hold x or nearly do, and spheres.
    std::array<Vec3, 3> normals;
    std::size_t near = 0;
    const Vec3 at = x();
    for (std::size_t i = 0; i < count; ++i) {
        if (scratch_.rows[i].violation(at) > -rounding_) {
            if (near == normals.size()) {
                return true;
            }
            normals[near++] = scratch_.rows[i].normal;
        }
    }
    for (const Sphere& sphere : spheres_) {
        const Vec3 away = at - sphere.centre;
        const float from = sphere.radius - rounding_;
        if (from <= 0.0F || away.squaredNorm() > from * from) {
            if (near == normals.size()) {
                return true;
            }
            normals[near++] = -away / std::max(away.norm(), rounding_);
        }
    }
    for (std::size_t i = 1; i < near; ++i) {
        for (std::size_t k = 0; k < i; ++k) {
            const float cosine = normals[i].dot(normals[k]);
            if (cosine * cosine > 1.0F - kBluntAngle * kBluntAngle) {
                return true;
            }
        }
    }
    return near == 3 && std::fabs(normals[0].dot(normals[1].cross(normals[2]))) < kBluntAngle;
}

template <class Real>
Found Search<Real>::nearest(std::size_t count) noexcept
{
    basis_ = Basis{};
    if (!optimum_in_spheres(spheres_, goal_, tolerance_, x_)) {
        return Found::nothing;
    }
    std::array<RowOf<Real>, kMaxHeld> held;
    std::array<std::uint16_t, kMaxHeld>& ids = ids_;
    std::size_t& size = size_;
    size = 0;
    Real distance2 = (x_ - goal_.point).squaredNorm();
    while (budget_.spend(cost<Real>(units::kOrcaTurn) + units::orca_rows(count))) {
        const Worst next = worst(0, count, tolerance_.outside);
        if (next.row == kNobody) {
            near_ = next.near;
            return Found::optimum;
        }
        const bool again = std::find(ids.begin(), ids.begin() + size, next.row) != ids.begin() + size;
        if (size == kMaxHeld || again) {
            return whole(count);
        }
        held[size] = row(next.row);
        ids[size] = static_cast<std::uint16_t>(next.row);
        ++size;
        Basis local;
        const Found found = optimum_on_plane<Real>(std::span<const RowOf<Real>>(held.data(), size), size - 1, size - 1,
                                                   spheres_, goal_, tolerance_, budget_, x_, local);
        if (found != Found::optimum) {
            return found;
        }
        basis_.size = local.size;
        for (std::size_t k = 0; k < local.size; ++k) {
            basis_.rows[k] = ids[local.rows[k]];
        }
        const Real farther2 = (x_ - goal_.point).squaredNorm();
        if (farther2 > distance2 * (1.0F + kProgress<Real>)) {
            // It can not come back to the rows that are let go: they alone leave a point that is nearer.
            distance2 = farther2;
            size = local.size;
            for (std::size_t k = 0; k < size; ++k) {
                ids[k] = basis_.rows[k];
                held[k] = row(ids[k]);
            }
        }
    }
    return Found::exhausted;
}

template <class Real>
bool Search<Real>::relax_at_corner(std::size_t from, std::size_t count, float& d) noexcept
{
    if (size_ != 4) {
        return false;
    }
    Corner<Real> corner;
    std::copy_n(ids_.begin(), 4, corner.rows.begin());
    const bool blunt_before = blunt_;
    if (!exchange(scratch_.rows.first(count), scratch_.yields.first(count), from, spheres_, tolerance_, budget_,
                  corner)) {
        return false;
    }
    d = static_cast<float>(corner.d);
    // No shares so large that rounding of what they share is more than what is wanted.
    const float held = static_cast<float>(corner.shares[0] + corner.shares[1] + corner.shares[2] + corner.shares[3]);
    blunt_ = blunt_before || !corner.is_alone || held > kMaxShares || d < held * rounding_;
    if (*std::min_element(corner.shares.begin(), corner.shares.end()) > kFirm) {
        x_ = corner.x;
        basis_ = {{corner.rows[0], corner.rows[1], corner.rows[2]}, 3};
        return true;
    }
    // Not the only point that breaks no more: the nearest of them.
    shift(from, count, d);
    x_ = corner.x;
    const Vec3Of<Real> least = corner.x;
    if (nearest_relaxed(from, count) != Found::optimum) {
        x_ = least;
    }
    return true;
}

template <class Real>
void Search<Real>::shift(std::size_t from, std::size_t to, float d) const noexcept
{
    for (std::size_t i = from; i < to; ++i) {
        scratch_.rows[i].offset -= (d + kShifted) * scratch_.yields[i];
    }
}

template <class Real>
Found Search<Real>::nearest_relaxed(std::size_t from, std::size_t count) noexcept
{
    Found found = nearest(count);
    float further = kShifted;
    for (int turn = 0; turn < kMaxShifts && found == Found::nothing; ++turn) {
        further *= 10.0F;
        shift(from, count, further);
        found = nearest(count);
    }
    return found;
}

/// Moves x to where `soft` is broken least while none of the softs before it is broken more: they stand in `held`
/// after the hards.
template <class Real>
Found Search<Real>::push_out(std::size_t soft, std::size_t hards, std::size_t softs, Real& d) noexcept
{
    if (!budget_.spend(cost<Real>(units::kOrcaTurn + units::orca_rows(hards + softs)))) {
        return Found::exhausted;
    }
    // NOLINTNEXTLINE(cppcoreguidelines-pro-type-member-init): written before it is read, and kilobytes
    std::array<RowOf<Real>, std::is_same_v<Real, float> ? 0 : kMaxDerived> own;
    std::span<RowOf<Real>> derived(own);
    if constexpr (std::is_same_v<Real, float>) {
        derived = scratch_.derived;
    }
    if (hards + softs > derived.size()) {
        return Found::exhausted;
    }
    const RowOf<Real> most = row(soft);
    const Real by = Real(1.0F) / scratch_.yields[soft];
    std::size_t size = 0;
    for (std::size_t k = 0; k < hards; ++k) {
        derived[size++] = row(scratch_.held[k]);
    }
    for (std::size_t k = hards; k < hards + softs; ++k) {
        const std::size_t j = scratch_.held[k];
        const RowOf<Real> other = row(j);
        const Real other_by = Real(1.0F) / scratch_.yields[j];
        // Broken by no more than `soft`: offset_j / yield_j - normal_j / yield_j . x <= the same of `soft`.
        const Vec3Of<Real> normal = other.normal * other_by - most.normal * by;
        const Real length2 = normal.squaredNorm();
        if (length2 <= 1e-12F) {
            continue;  // the same direction: the one that is broken more stays so
        }
        const Real shrink = Real(1.0F) / sqrt(length2);
        derived[size++] = {normal * shrink, (other.offset * other_by - most.offset * by) * shrink};
    }
    const Optimum<Real> best =
        optimum<Real>(derived.first(size), spheres_, GoalOf<Real>{most.normal, true}, tolerance_, budget_);
    if (best.found == Found::exhausted) {
        return Found::exhausted;
    }
    if (best.found == Found::optimum) {
        x_ = best.x;
    }
    d = std::max(d, most.violation(x_) * by);
    return best.found;
}

template <class Real>
Found Search<Real>::relax(std::size_t from, std::size_t to, float& broken) noexcept
{
    const Vec3Of<Real> start = x_;
    Real d = 0.0F;
    std::size_t hards = basis_.size;
    std::copy_n(basis_.rows.begin(), hards, scratch_.held.begin());
    std::size_t softs = 0;
    const float enough = 4.0F * tolerance_.outside;
    while (true) {
        if (!budget_.spend(cost<Real>(units::kOrcaTurn + units::orca_rows(to)))) {
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
            if (violation<Real>(scratch_.rows[i], x_) > (d + enough) * scratch_.yields[i] &&
                push_out(i, hards, k, d) == Found::exhausted) {
                return Found::exhausted;
            }
        }
    }
    d = std::max(d, worst_yielding(from, to, d).by);
    broken = static_cast<float>(d);
    if constexpr (std::is_same_v<Real, float>) {
        blunt_ = blunt_ || is_held_bluntly(from);
    }
    shift(from, to, broken);
    return Found::optimum;
}

template class Search<float>;
template class Search<DoubleFloat>;

}  // namespace jink::orca
