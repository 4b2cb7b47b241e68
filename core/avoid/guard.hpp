// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <limits>

#include "core/avoid/guidance.hpp"

namespace jink::avoid {

/// What the vehicle needs to stop, and Settings::reserve [s].
[[nodiscard]] Seconds time_to_stop(const world::Situation& situation, const Settings& settings) noexcept;

/// Least separation of a manoeuvre as it will really be flown from now on, within `horizon`: the vehicle model follows
/// the rest of it, with a set-point every path::kSetpointPeriod, or holds its command where it is a `velocity`. At the
/// end it brakes to a stand (a fixed wing flies on), so that a way that ends in a trap is not clear. A `velocity` is
/// chosen anew every tick, and what tracks that share the reaction do meanwhile depends on it: they are checked as far
/// ahead as the vehicle needs to stop (time_to_stop). A manoeuvre that is empty, non-finite, not increasing in time or
/// starting in the future counts as contact. If the budget is spent, the verdict is contact.
///
/// Accuracy: within 100 m of the origin the margin is never above that of the flight so defined by more than 2 mm
/// (tracks, spheres, cylinders, bounds and solids alike). It is below that by two sagittas of a chord at most
/// (path::Sagitta: 25 mm for 0.2 s at 5 m/s2), and by what least_separation says. A start within 0.1 mm of a surface
/// may count as inside, and solids that the flight starts inside are judged as least_separation says. Checked against
/// dense flight in double precision (tests/property/core/avoid/final_check_test.cpp; JINK_CASES=1150000 there: 10^6
/// manoeuvres). Other periods of set-points, wind and an autopilot unlike the model are not part of this: the safety
/// box has to hold them. O(rest / kSetpointPeriod + points * threats).
[[nodiscard]] world::Separation check_manoeuvre(const world::Situation& situation, const world::Manoeuvre& manoeuvre,
                                                const Settings& settings, WorkBudget& budget,
                                                Seconds horizon = std::numeric_limits<Seconds>::infinity(),
                                                const world::Cutoff& cutoff = {}) noexcept;

/// The last rung: always an answer.
struct Fallback {
    world::ManoeuvreKind kind =
        world::ManoeuvreKind::brake;  ///< brake, hold_turn, or velocity where standing still does more harm
    Vec3 command = Vec3::Zero();      ///< [m/s]
    float margin = 0.0F;              ///< least predicted over the horizon [m]
};

/// Of a fixed wing: the better one of a level turn to either side; where neither is clear, the one with the greatest
/// least margin of both and of 15 commands: on, and 0.5 and 1 rad to either side, level, climbing and descending. What
/// was flown before stays unless another is 0.1 m better. O(17 * setpoints + 17 * points * threats).
///
/// Of a multirotor: brake when that is clear; else the one with the greatest least margin of brake and 26 ways
/// at cruise speed (8 courses level, climbing and descending; straight up and down), refined three times by steps of
/// course and of climb to all sides; what was flown before (`previous`, may be null) stays while it is clear, and where
/// nothing is clear unless another is 0.1 m better. A way is looked at only until it is no better than the best so far,
/// and counts as the worst when `budget` runs out. O(40 * points * threats). Against 721 ways in 600 random close
/// calls, 419 of which it is asked in: 2 mm behind on average, 0.31 m at most
/// (tests/property/core/avoid/fallback_test.cpp).
[[nodiscard]] Fallback choose_fallback(const world::Situation& situation, const world::Way& way,
                                       const Fallback* previous, const Settings& settings, WorkBudget& budget) noexcept;

/// Least separation when `command` is held for `horizon` [s] > 0; without one, for the fallback horizon. A fixed wing
/// turns to the command's course at its lateral limit. As accurate as check_manoeuvre. O(points * threats).
[[nodiscard]] float command_margin(const world::Situation& situation, const Vec3& command, Seconds horizon,
                                   const Settings& settings, WorkBudget& budget) noexcept;
[[nodiscard]] float command_margin(const world::Situation& situation, const Vec3& command, const Settings& settings,
                                   WorkBudget& budget) noexcept;

/// Turning left or right at the lateral acceleration limit: the command for this tick [m/s].
[[nodiscard]] Vec3 turn_command(const vehicle::VehicleState& own, const vehicle::VehicleLimits& limits,
                                float direction) noexcept;

}  // namespace jink::avoid
