// SPDX-License-Identifier: BSD-3-Clause
#include "core/orca/search.hpp"

#include <algorithm>
#include <cmath>

#include "core/base/work_units.hpp"
#include "core/orca/exchange.hpp"

namespace jink::orca {

namespace {

constexpr int kMostShifts = 2;  // times that a level gives way ten times as far, before what was found is taken
constexpr float kFirm = 1e-3F;  // least share of a corner that is a point and no edge

}  // namespace

Search::Worst Search::worst(std::size_t from, std::size_t to, float least) const noexcept
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

Search::Worst Search::worst_yielding(std::size_t from, std::size_t to, float least) const noexcept
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

Found Search::whole(std::size_t count) noexcept
{
    const Optimum all = optimum(scratch_.rows.first(count), balls_, goal_, tolerance_, budget_);
    x_ = all.x;
    basis_ = all.basis;
    // It does not look back at rows that it has passed; near corners that hardly are any, rounding may have left them.
    const bool holds = worst(0, count, 4.0F * tolerance_.outside).row == kNobody;
    return all.found == Found::optimum && !holds ? Found::nothing : all.found;
}

Found Search::nearest(std::size_t count) noexcept
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

bool Search::relax_at_corner(std::size_t from, std::size_t count, float& d) noexcept
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

void Search::shift(std::size_t from, std::size_t to, float d) const noexcept
{
    for (std::size_t i = from; i < to; ++i) {
        scratch_.rows[i].offset -= (d + kShifted) * scratch_.yields[i];
    }
}

Found Search::nearest_relaxed(std::size_t from, std::size_t count) noexcept
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
Found Search::push_out(std::size_t soft, std::size_t hards, std::size_t softs, float& d) noexcept
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

Found Search::relax(std::size_t from, std::size_t to, float& d) noexcept
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

}  // namespace jink::orca
