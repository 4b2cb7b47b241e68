// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>

#include "core/base/static_vector.hpp"
#include "core/base/work_units.hpp"
#include "core/world/separation.hpp"

// Shared by the checks of a flight for its least separation: the flight in pieces, the best so far, what is paid.
// Private to this module.

namespace jink::world::detail {

/// Segments that share one bounding box when far threats are passed over.
inline constexpr std::size_t kChunk = 8;
inline constexpr std::size_t kMaxChunks = (kMaxPathPoints + kChunk - 1) / kChunk;

struct Piece {
    Vec3 from;
    Vec3 velocity;
    Seconds start;
    Seconds duration;
    path::Sagitta sagitta;
};

struct Bounds {
    Vec3 low;
    Vec3 high;
    Seconds start;
    Seconds end;
    std::size_t first;
    std::size_t last;      ///< one past the last piece
    float sagitta = 0.0F;  ///< greatest of the pieces [m]
};

/// A path until `horizon` as the pieces it is made of, and boxes about some of them at a time. Without sagittas the
/// pieces are straight.
class Flight {
public:
    Flight(std::span<const path::PathPoint> points, std::span<const path::Sagitta> sagittas, Seconds horizon) noexcept
        : points_(points), sagittas_(sagittas), horizon_(horizon)
    {
        while (count_ + 1 < points.size() && points[count_].time < horizon) {
            ++count_;
        }
        stands_ = count_ == 0;
        count_ = std::max<std::size_t>(count_, 1);
        for (std::size_t first = 0; first < count_; first += kChunk) {
            chunks_.unchecked_push_back(bounds(first, std::min(first + kChunk, count_)));
        }
    }

    [[nodiscard]] std::size_t size() const noexcept { return count_; }
    [[nodiscard]] Piece piece(std::size_t i) const noexcept
    {
        const path::PathPoint& from = points_[i];
        if (stands_) {
            return {from.position, Vec3::Zero(), 0.0F, 0.0F, {}};
        }
        return {from.position, from.velocity, from.time, std::min(points_[i + 1].time, horizon_) - from.time,
                i < sagittas_.size() ? sagittas_[i] : path::Sagitta{}};
    }
    [[nodiscard]] const Vec3& begin() const noexcept { return points_.front().position; }
    [[nodiscard]] const auto& chunks() const noexcept { return chunks_; }

private:
    [[nodiscard]] Bounds bounds(std::size_t first, std::size_t last) const noexcept
    {
        const Piece begin = piece(first);
        Bounds b{begin.from, begin.from, begin.start, 0.0F, first, last, 0.0F};
        for (std::size_t i = first; i < last; ++i) {
            const Piece p = piece(i);
            const Vec3 to = p.from + p.velocity * p.duration;
            b.low = b.low.cwiseMin(p.from).cwiseMin(to);
            b.high = b.high.cwiseMax(p.from).cwiseMax(to);
            b.end = p.start + p.duration;
            b.sagitta = std::max(b.sagitta, p.sagitta.any);
        }
        return b;
    }

    std::span<const path::PathPoint> points_;
    std::span<const path::Sagitta> sagittas_;
    Seconds horizon_;
    std::size_t count_ = 0;
    bool stands_ = false;
    StaticVector<Bounds, kMaxChunks + 1> chunks_;
};

/// Distance between two boxes given by their corners.
inline float boxes_apart(const Vec3& low_a, const Vec3& high_a, const Vec3& low_b, const Vec3& high_b) noexcept
{
    return (low_a - high_b).cwiseMax(low_b - high_a).cwiseMax(0.0F).norm();
}

inline float shrink_at(float initial, const EscapeRule& escape, Seconds t) noexcept
{
    return initial > 0.0F ? std::max(0.0F, initial - escape.speed * t) : 0.0F;
}

/// What is not a number is contact of the worst kind.
inline void consider(Separation& best, float margin, Seconds when, ThreatRef against) noexcept
{
    if (!(margin >= best.margin)) {
        best = {margin > -kSeparationCap ? margin : -kSeparationCap, when, against};
    }
}

/// Takes units; without them the threat counts as met, at `when`.
inline bool paid(WorkBudget& budget, std::size_t units, Separation& best, Seconds when, ThreatRef ref) noexcept
{
    if (budget.spend(static_cast<std::uint32_t>(units))) {
        return true;
    }
    consider(best, -kSeparationCap, when, ref);
    return false;
}

/// Of one cylinder with a flight of a box of half extents `half`: see least_separation. O(pieces).
void against_cylinder(const Vec3& half, const Flight& flight, const Threat& threat, const EscapeRule& escape,
                      WorkBudget& budget, Separation& best) noexcept;

}  // namespace jink::world::detail
