// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/avoid/settings.hpp"
#include "core/world/conflict.hpp"

namespace jink::avoid {

/// What is flown where no method has a safe answer. Never fails.
struct Fallback {
    /// brake, hold_turn, or velocity: the max-clearance escape, where braking or turning does not stay clear.
    world::ManoeuvreKind kind = world::ManoeuvreKind::brake;
    Vec3 command = Vec3::Zero();  ///< [m/s]; of hold_turn the sense of the turn in z
    /// Least predicted over the horizon [m]; >= 0: clear of all that is possible. Below 0: not clear, and how far tells
    /// little (of what is likely alone, to the box with rounded corners, or cut off).
    float margin = 0.0F;
};

/// Of a fixed wing: the better one of a level turn to either side. Where neither is clear, the one with the greatest
/// least margin of both and of 15 commands: on, and 0.5 and 1 rad to either side, level, climbing and descending. The
/// previous fallback stays unless another is 0.1 m better. O(17 * setpoints + 17 * points * threats).
///
/// Of a multirotor: brake when that is clear, else `previous` (may be null) when that is. Else of brake and 26 commands
/// at cruise speed (8 courses level, climbing and descending; straight up and down), refined three times by steps of
/// course and of climb to all sides: the one of greatest least margin to threats within one standard deviation in place
/// of FlightRules::k_sigma. The box has rounded corners here: it is shrunk by its least half extent, and the margin is
/// measured to all that is within that distance of the rest. Where the box cannot be kept clear, a threat past a corner
/// is then as near as one past a face at the same distance. That command is taken where the whole box is clear of all
/// that is possible; else the clear one of greatest least margin; where none is clear, `previous`, unless the command
/// is 0.02 m better: `previous` is compared first, so that this holds with any budget. What is surely in contact says
/// nothing of which way is the better one: threats that are grown by all that is possible overlap. The check of a
/// command ends once it is no better than the best so far. Without `budget` it counts as the worst. O(80 * points *
/// threats). Against 721 commands in 600 random close calls: 3 mm behind on average, 0.24 m at most
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
