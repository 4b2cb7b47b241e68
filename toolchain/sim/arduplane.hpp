// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "firmware/link/mavlink/messages.hpp"
#include "toolchain/sim/truth_vehicle.hpp"

namespace jink::sim {

/// ArduPlane's WP_LOITER_RAD, clockwise [m].
inline constexpr double kPlaneLoiterRadius = 60.0;
/// ArduPlane's ALT_SLOPE_MIN: smaller changes of height are flown at once [m].
inline constexpr double kPlaneSlopeMin = 15.0;

/// Guidance to and along a clockwise circle about a point: AP_L1_Control::update_loiter.
struct PlaneCircle {
    Vec course = Vec::Zero();  ///< level velocity command for move_plane(), of the present speed [m/s]
    bool reached = false;      ///< on the circle, approach finished: reached_loiter_target()
};
[[nodiscard]] PlaneCircle circle_course(const Truth& own, const Vec& centre, double radius) noexcept;
/// Level velocity command that follows the line from `from` to `to`, as AP_L1_Control::update_waypoint does.
[[nodiscard]] Vec line_course(const Truth& own, const Vec& from, const Vec& to) noexcept;
/// Distance before a waypoint at which ArduPlane turns to the next waypoint [m]: turn_distance() with WP_RADIUS 90.
/// `angle`: course change at the waypoint, >= 0 [rad].
[[nodiscard]] double turn_distance(double speed, double angle) noexcept;
/// Commanded height between `from` and `to`: Plane::setup_alt_slope. Climbs below 20 m above home are flown at once;
/// with `climbs_at_once`, all climbs are.
[[nodiscard]] double height_on_the_way(const Vec& from, const Vec& to, const Vec& here, bool climbs_at_once) noexcept;
/// Climb rate towards a height, TECS_TIME_CONST 5 [m/s].
[[nodiscard]] double climb_to(double height, const Truth& own, const TruthLimits& limits) noexcept;

/// ArduPlane's guidance to a guided point, and its LOITER: GCS_MAVLINK_Plane::handle_command_int_do_reposition,
/// Plane::set_guided_WP, Plane::setup_alt_slope, AP_L1_Control::update_loiter. Default parameters: NAVL1_PERIOD 17,
/// NAVL1_DAMPING 0.75, WP_LOITER_RAD 60 (clockwise), ALT_SLOPE_MIN 15, TECS_TIME_CONST 5. No wind, no fence.
class PlaneGuidance {
public:
    /// @param limits  outlive the guidance
    explicit PlaneGuidance(const TruthLimits& limits) : limits_(limits) {}

    /// A mode was entered at `here`: the point is the aircraft's position.
    void hold(const Vec& here) { from_ = point_ = here; }
    /// GUIDED to a point of another sender, RTL to home: flies from `here` to the point, then circles it.
    void go_to(const Vec& point, const Vec& here)
    {
        from_ = here;
        point_ = point;
    }
    /// @return MAV_RESULT. DO_REPOSITION is accepted in GUIDED only; a request that would change the mode is denied.
    [[nodiscard]] std::uint8_t hear(const link::mavlink::CommandInt& command, bool guided, const Vec& here);
    /// Velocity command for move_plane().
    [[nodiscard]] Vec command(const Truth& own) const;
    [[nodiscard]] const Vec& point() const noexcept { return point_; }

private:
    const TruthLimits& limits_;
    Vec from_ = Vec::Zero();
    Vec point_ = Vec::Zero();
};

/// One step of a plane. Lateral acceleration: L1 law towards the command's course, bounded by max_acceleration (bank),
/// with the lag of the roll loop. Speed: cruise speed, never below min_speed. Climb: as commanded, with its own lag.
void move_plane(Truth& truth, const Vec& command, const TruthLimits& limits, double dt) noexcept;

}  // namespace jink::sim
