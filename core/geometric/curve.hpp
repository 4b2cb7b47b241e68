// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>

#include "core/capacity.hpp"
#include "core/geometric/candidate.hpp"
#include "core/path/timed_path.hpp"

// One candidate as numbers: waypoints with times, coordinate by coordinate, about the start of the manoeuvre (so that
// far from the world's origin nothing is lost). Private to this module.

namespace jink::geometric::detail {

/// A path frame may be that far from unitary (Problem's validity), and times are rounded.
inline constexpr float kUnitTolerance = 1.01F;

using Coordinates = std::array<float, kMaxPathPoints>;

/// A family's curve for D = 1, w = 1: made once per plan.
// NOLINTNEXTLINE(cppcoreguidelines-pro-type-member-init): entries past `points` are not read, zeroing them costs
struct UnitCurve {
    std::size_t points = 0;
    float step = 0.0F;  ///< of u, which begins with 0
    Coordinates f;
};
/// `length`: of it, over D.
[[nodiscard]] UnitCurve make_unit_curve(Family family, std::uint16_t waypoints, float length) noexcept;
[[nodiscard]] inline UnitCurve make_unit_curve(Family family, std::uint16_t waypoints) noexcept
{
    return make_unit_curve(family, waypoints, curve_length_x(family, 1.0F));
}

/// Timed waypoints relative to the start. Entries past `points` hold nothing.
// NOLINTNEXTLINE(cppcoreguidelines-pro-type-member-init): as above
struct Curve {
    std::size_t points = 0;
    Coordinates x, y, z;
    Coordinates t;
    float fastest = 0.0F;  ///< no coordinate changes faster than this [m/s]

    [[nodiscard]] Vec3 position(std::size_t i) const noexcept { return {x[i], y[i], z[i]}; }
    [[nodiscard]] Seconds duration() const noexcept { return t[points - 1]; }
    /// Of the segment from point i to the next one.
    [[nodiscard]] Vec3 velocity(std::size_t i) const noexcept
    {
        return Vec3(x[i + 1] - x[i], y[i + 1] - y[i], z[i + 1] - z[i]) / (t[i + 1] - t[i]);
    }
};

/// Unit vector, across the leg, in which positive offsets of a plane lie.
[[nodiscard]] Vec3 plane_direction(const PathFrame& frame, float plane) noexcept;

/// `side`: plane_direction of the candidate. Segment times by the rule of make_timed_path: as long as the cruise speed,
/// the climb or the descent limit takes, whichever is longest. O(waypoints).
void make_curve(const UnitCurve& unit, const Vec3& along, const Vec3& side, float distance, float offset, float speed,
                const vehicle::VehicleLimits& limits, Curve& out) noexcept;

/// A candidate of the family wait along a leg of `length` [m]: from `start_speed` [m/s] to `share` of `speed` until
/// `until` [s], then on at `speed` to its end, speeding up and slowing down at `acceleration` [m/s2] > 0. O(waypoints).
struct Wait {
    float length = 0.0F;
    float start_speed = 0.0F;
    float speed = 0.0F;
    float share = 0.0F;
    Seconds until = 0.0F;
    float acceleration = 1.0F;
};
void make_waiting_curve(const Wait& wait, const Vec3& along, std::size_t waypoints, Curve& out) noexcept;

/// As a timed path about `origin`. O(points).
void to_timed_path(const Curve& curve, const Vec3& origin, path::TimedPath& out) noexcept;

/// Within the acceleration limits all along, from flying at `velocity_before` on, and back on the leg, whose direction
/// is `rejoin` there, without a turn that would carry the vehicle more than kRejoinOvershoot past it. See
/// Settings::check_acceleration. O(points).
[[nodiscard]] bool is_flyable(const Curve& curve, const Vec3& velocity_before, const Vec3& rejoin,
                              const vehicle::VehicleLimits& limits) noexcept;

}  // namespace jink::geometric::detail
