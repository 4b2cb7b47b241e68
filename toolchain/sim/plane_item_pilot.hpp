// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "toolchain/sim/item_pilot.hpp"

namespace jink::sim {

/// Flies the items of a NominalFlight as ArduPlane does (ArduPlane/commands_logic.cpp, navigation.cpp, altitude.cpp,
/// mode_auto.cpp, mode_loiter.cpp, mode.cpp; AP_L1_Control; AP_Landing::restart_landing_sequence):
///
/// * A leg starts at the waypoint before. After entering the mission mode and after a take-off the plane flies direct
///   to the waypoint. A waypoint is reached turn_distance() before it, or abeam of it.
/// * LOITER_TIME and LOITER_UNLIM circle with WP_LOITER_RAD, LOITER_TURNS with the radius of the item, all clockwise.
///   Turns and time count on the circle. The circle is left where the course leads to the next place within 10 degrees,
///   10 more for each further circle.
/// * TAKEOFF keeps the course and climbs to its height. LAND descends along the line to its place; there is no flare,
///   and the plane does not stop. Leaving the mission mode during LAND goes back to the item before it.
/// * DO_CHANGE_SPEED (airspeed) holds until the mode changes.
/// * A new mission is flown once the ground station sets its current item, here at once: along the line from the
///   previous target place.
class PlaneItemPilot final : public ItemPilot {
public:
    /// @param scenario  outlives the pilot; it has a flight with items, of the kinds that can_fly() allows a plane
    explicit PlaneItemPilot(const Scenario& scenario);

    [[nodiscard]] Vec command(const Truth& own) override;
    void resume(const Truth& own) override;
    void leave() override;
    void replace(const std::vector<Item>& items, const Truth& own) override;

private:
    void begin_item(const Vec& from, bool direct);
    void advance(const Truth& own);
    [[nodiscard]] const Item* next_item() const;
    [[nodiscard]] bool is_waypoint_done(const Truth& own) const;
    [[nodiscard]] bool is_circle_done(const Truth& own) const;
    [[nodiscard]] bool is_headed_for_next(const Truth& own) const;
    [[nodiscard]] Vec along_leg(const Truth& own) const;
    [[nodiscard]] Vec on_circle(const Truth& own);
    [[nodiscard]] double radius() const;

    bool direct_ = false;       ///< flies direct to the present place, without a line
    bool reached_ = false;      ///< the circle is reached
    double angle_ = 0.0;        ///< bearing about the place at the last step [rad]
    double turned_ = 0.0;       ///< on the circle [rad]
    double waited_ = 0.0;       ///< on the circle [s]
    double lined_up_ = -1.0;    ///< value of `turned_` when the item's own goal was reached [rad]; negative: not yet
    Vec course_ = Vec::Zero();  ///< of a take-off
};

}  // namespace jink::sim
