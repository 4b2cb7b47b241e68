// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/base/static_vector.hpp"
#include "core/geometry/sweep.hpp"
#include "core/world/conflict.hpp"

// The nominal path cut into straight pieces. Private to this module.

namespace jink::world::detail {

/// On an arc, chords of this angle, longer where more than kWayChords were needed [rad].
inline constexpr float kChordAngle = 0.4F;
inline constexpr std::size_t kWayChords = 10;
/// Straight beginning, segments, chords of arcs, and hovering at the end.
inline constexpr std::size_t kWayPieces = kMaxRouteSegments + kWayChords + 2;
static_assert(kWayPieces < kMaxPathPoints, "a path along a route has to fit");
/// What a chord flown evenly is off the arc more than its middle, and rounding [m].
inline constexpr float kChordSlack = 2e-3F;

/// Flown straight, or hovering.
struct WayPiece {
    geometry::Motion own;  ///< position at `start`
    Seconds start = 0.0F;
    Seconds end = 0.0F;
    float way = 0.0F;      ///< along the way until `start` [m]
    Seconds whole = 0.0F;  ///< it would take so long without the look-ahead's end

    [[nodiscard]] Seconds span() const noexcept { return end - start; }
    [[nodiscard]] Vec3 last() const noexcept { return own.position + own.velocity * span(); }
    [[nodiscard]] bool hovers() const noexcept { return own.velocity == Vec3::Zero(); }
};

/// A way for `lookahead` seconds. On a leg, two pieces: the rest of the leg, and hovering at its end. 40 bytes per
/// piece.
class RoutePieces {
public:
    static constexpr std::size_t kMax = kWayPieces;

    RoutePieces(const Situation& situation, const Way& way, Seconds lookahead) noexcept;

    [[nodiscard]] std::size_t size() const noexcept { return pieces_.size(); }
    [[nodiscard]] const WayPiece& operator[](std::size_t i) const noexcept { return pieces_[i]; }
    [[nodiscard]] auto begin() const noexcept { return pieces_.begin(); }
    [[nodiscard]] auto end() const noexcept { return pieces_.end(); }
    /// Distance of the pieces from the way, at most [m].
    [[nodiscard]] float off() const noexcept { return off_; }
    /// Of the way, `t` seconds ahead: on it, not on a piece.
    [[nodiscard]] float way_at(Seconds t) const noexcept;

private:
    void add(const Vec3& from, const Vec3& to, float length) noexcept;
    void add_segment(const path::RouteSegment& segment, float from, float to) noexcept;

    const Way& way_;
    const vehicle::VehicleLimits& limits_;
    const float speed_;
    const Seconds lookahead_;
    float chord_angle_ = kChordAngle;
    float off_ = 0.0F;
    Seconds now_ = 0.0F;
    float flown_ = 0.0F;
    StaticVector<WayPiece, kWayPieces> pieces_;
};

}  // namespace jink::world::detail
