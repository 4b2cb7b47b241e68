// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>

#include "core/base/time.hpp"
#include "core/base/vec3.hpp"

namespace jink::link::mavlink {

/// Converts velocity commands to the guided points that ArduPlane flies to: DO_REPOSITION in GUIDED.
///
/// Course: ArduPlane heads straight for a guided point while the point is well outside of the loiter circle about it
/// (AP_L1_Control::update_loiter, capture). The point lies kAhead seconds of flight ahead on the commanded course,
/// kMinAhead at least, and is renewed long before it is reached.
/// Height: own height plus kClimbTime of the commanded climb, kMaxClimb at most. ArduPlane flies to a height that near
/// as fast as its energy control allows, in both directions. A larger descent would be stretched over the whole
/// distance (ALT_SLOPE_MIN, 15 m). If jink falls silent the plane levels off there. Speed is left to the autopilot,
/// which keeps its own airspeed limits.
///
/// A point is due when the command has changed by kTurned or kClimbChanged, kPeriod after the last point; without a
/// change kRefresh after the last point, since a frame may be lost. A refused point (geofence) is followed by a point
/// at half the distance, kNearest at least.
///
/// Pure, O(1).
class PlaneSteering {
public:
    /// @param command   velocity [m/s, ENU], finite; without a course (slower than kNoCourse) no point is due
    /// @param position  own position [m, ENU]
    /// @return the point to send now, or nothing; a returned point counts as sent
    [[nodiscard]] std::optional<Vec3> next(const Vec3& command, const Vec3& position, TimePoint now) noexcept;

    /// The last point was not sent: the next one is due at once.
    void forget_last() noexcept { has_sent_ = false; }
    /// The autopilot refused the last point.
    void note_refusal() noexcept;
    /// Control has ended.
    void reset() noexcept { *this = {}; }

    static constexpr Seconds kPeriod = 0.5F;
    static constexpr Seconds kRefresh = 1.0F;
    static constexpr Seconds kAhead = 25.0F;
    static constexpr float kMinAhead = 400.0F;  ///< [m]
    static constexpr float kNearest = 150.0F;   ///< after refusals [m]
    static constexpr Seconds kClimbTime = 4.0F;
    static constexpr float kMaxClimb = 14.0F;      ///< [m]
    static constexpr float kTurned = 0.035F;       ///< course [rad]
    static constexpr float kClimbChanged = 0.25F;  ///< [m/s]
    static constexpr float kNoCourse = 1.0F;       ///< [m/s]

private:
    bool has_sent_ = false;
    TimePoint sent_;
    Vec3 course_ = Vec3::Zero();  ///< of the last point: unit vector, level
    float climb_ = 0.0F;          ///< [m/s]
    float share_ = 1.0F;          ///< of the full distance
};

}  // namespace jink::link::mavlink
