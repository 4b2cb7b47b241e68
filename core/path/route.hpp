// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>

#include "core/base/static_vector.hpp"
#include "core/base/vec3.hpp"
#include "core/capacity.hpp"

namespace jink::path {

/// Result of adding a segment.
enum class RouteStatus : std::uint8_t {
    ok,
    full,        ///< the route has kMaxRouteSegments already
    not_finite,  ///< a value is not finite, or a coordinate lies beyond kFarthest
    too_short,   ///< shorter than kShortest
    bad_arc,     ///< radius or angle out of range, no axis, or the start is not in the plane of the circle
    gap,         ///< does not begin where the previous segment ends
};

/// A straight leg or a circular arc.
struct RouteSegment {
    Vec3 start = Vec3::Zero();    ///< [m]
    Vec3 along = Vec3::UnitX();   ///< unit tangent at the start
    Vec3 towards = Vec3::Zero();  ///< arc: unit vector from the start to the centre
    float radius = 0.0F;          ///< arc: [m]; 0: straight
    float length = 0.0F;          ///< [m]

    [[nodiscard]] bool is_arc() const noexcept { return radius > 0.0F; }
};

struct RoutePoint {
    Vec3 position = Vec3::Zero();  ///< [m]
    Vec3 along = Vec3::UnitX();    ///< unit tangent
};

/// The point of a route abeam of a vehicle.
struct Abeam {
    std::size_t segment = 0;
    float arc_length = 0.0F;  ///< from the start of the route [m]
    float off = 0.0F;         ///< distance of the vehicle from the point [m]
    float left = 0.0F;        ///< arc length from the point to the end of the segment [m]
    RoutePoint point;
};

/// Where a segment is `arc_length` [m] from its start; outside of it straight on. O(1).
[[nodiscard]] RoutePoint point_of(const RouteSegment& segment, float arc_length) noexcept;

/// The straight segment from `start` to `end` [m]; within 1 mm of each other they are a point: `end`, of length 0, with
/// the tangent +x. O(1).
[[nodiscard]] RouteSegment straight_segment(const Vec3& start, const Vec3& end) noexcept;

/// The segments of a route, each beginning where the one before ends. They outlive the view. O(1) to copy.
class RouteView {
public:
    constexpr RouteView() noexcept = default;
    explicit constexpr RouteView(std::span<const RouteSegment> segments) noexcept : segments_(segments) {}

    [[nodiscard]] constexpr std::span<const RouteSegment> segments() const noexcept { return segments_; }
    [[nodiscard]] constexpr bool empty() const noexcept { return segments_.empty(); }
    /// [m]. O(segments).
    [[nodiscard]] float length() const noexcept;
    /// Where the route is at an arc length [m]; before its start and past its end straight on. At a corner the tangent
    /// of what follows. Not empty. O(segments).
    [[nodiscard]] RoutePoint at(float arc_length) const noexcept;
    /// From segment `from` on (the last one where there are fewer), the first one whose nearest point is nearer than
    /// that of the one after it: a later leg that passes close by is not mistaken for the one being flown. Not empty.
    /// O(segments).
    [[nodiscard]] Abeam abeam_of(const Vec3& position, std::size_t from = 0) const noexcept;

private:
    std::span<const RouteSegment> segments_;
};

/// Straight legs and circular arcs, each beginning where the one before ends; where they do not meet tangentially the
/// route has a corner. World frame.
///
/// Memory: 44 bytes per segment and a counter. Accuracy: positions within 1e-3 m of exact ones for coordinates up to
/// 1 km (tests/property/core/path).
class Route {
public:
    static constexpr float kShortest = 0.01F;       ///< segment [m]
    static constexpr float kFarthest = 100'000.0F;  ///< coordinate [m]
    static constexpr float kMinRadius = 0.5F;       ///< of an arc [m]
    static constexpr float kLargestRadius = 10'000.0F;
    /// A segment may begin this far from the end of the previous segment, and an arc this far from the plane of its
    /// circle; the segment is moved to the exact start [m].
    static constexpr float kJoin = 0.01F;

    /// Adds a segment only if the result is ok. O(1).
    [[nodiscard]] RouteStatus add_leg(const Vec3& start, const Vec3& end) noexcept;
    /// Circle about `centre` in the plane perpendicular to `axis` (any length > 0), `angle` [rad], at most a full turn
    /// either way: positive is counter-clockwise as seen from the tip of `axis`, negative clockwise. O(1).
    [[nodiscard]] RouteStatus add_arc(const Vec3& start, const Vec3& centre, const Vec3& axis, float angle) noexcept;

    void clear() noexcept { segments_.clear(); }

    [[nodiscard]] std::span<const RouteSegment> segments() const noexcept
    {
        return {segments_.data(), segments_.size()};
    }
    [[nodiscard]] bool empty() const noexcept { return segments_.empty(); }
    /// Valid until the route is changed.
    operator RouteView() const& noexcept { return RouteView(segments()); }  // NOLINT(google-explicit-constructor)
    operator RouteView() const&& = delete;
    [[nodiscard]] float length() const noexcept { return RouteView(segments()).length(); }
    [[nodiscard]] RoutePoint at(float arc_length) const noexcept { return RouteView(segments()).at(arc_length); }
    [[nodiscard]] Abeam abeam_of(const Vec3& position, std::size_t from = 0) const noexcept
    {
        return RouteView(segments()).abeam_of(position, from);
    }

private:
    [[nodiscard]] RouteStatus add(const RouteSegment& segment) noexcept;
    [[nodiscard]] bool meets_end(const Vec3& start) const noexcept;

    StaticVector<RouteSegment, kMaxRouteSegments> segments_;
};

/// What a vehicle has ahead: straight for a while, then a route.
struct RouteAhead {
    RouteView route;         ///< empty: straight for ever
    float straight = 0.0F;   ///< until the route is reached [m]
    float joined_at = 0.0F;  ///< arc length of the route where it is reached [m]
};
/// Point of the nominal path at arc length `way` [m] from `origin`, in `direction` (unit vector) at first. O(segments).
[[nodiscard]] RoutePoint point_of(const RouteAhead& ahead, const Vec3& origin, const Vec3& direction,
                                  float way) noexcept;

/// Rotates `side`, perpendicular to `from`, by the least rotation that maps unit vector `from` to `to`. Carried from
/// tangent to tangent, the side does not twist about the path. For opposite directions `side` is unchanged. O(1).
[[nodiscard]] Vec3 carried(const Vec3& side, const Vec3& from, const Vec3& to) noexcept;

}  // namespace jink::path
