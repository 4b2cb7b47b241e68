// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "firmware/link/mavlink/messages.hpp"
#include "toolchain/sim/truth_vehicle.hpp"

namespace jink::sim {

/// What ArduPlane makes of a guided point, and its LOITER: GCS_MAVLINK_Plane::handle_command_int_do_reposition,
/// Plane::set_guided_WP, Plane::setup_alt_slope, AP_L1_Control::update_loiter. Default parameters: NAVL1_PERIOD 17,
/// NAVL1_DAMPING 0.75, WP_LOITER_RAD 60 (clockwise), ALT_SLOPE_MIN 15, TECS_TIME_CONST 5. No wind, no fence.
class PlaneGuidance {
public:
    /// @param limits  outlive the guidance
    explicit PlaneGuidance(const TruthLimits& limits) : limits_(limits) {}

    /// A mode was entered here: the point is the place of the aircraft.
    void hold(const Vec& here) { from_ = point_ = here; }
    /// @return MAV_RESULT: DO_REPOSITION in GUIDED alone; one that would change the mode counts as denied
    [[nodiscard]] std::uint8_t hear(const link::mavlink::CommandInt& command, bool guided, const Vec& here);
    /// Velocity command for move_plane().
    [[nodiscard]] Vec command(const Truth& own) const;
    [[nodiscard]] const Vec& point() const noexcept { return point_; }

private:
    const TruthLimits& limits_;
    Vec from_ = Vec::Zero();
    Vec point_ = Vec::Zero();
};

/// One step of a plane: the lateral acceleration of the L1 law towards the command's course, bounded by
/// max_acceleration (bank) and reached with the lag of the roll loop; cruise speed, never below min_speed; the climb
/// asked for, with a lag of its own.
void move_plane(Truth& truth, const Vec& command, const TruthLimits& limits, double dt) noexcept;

}  // namespace jink::sim
