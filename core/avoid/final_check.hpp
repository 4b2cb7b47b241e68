// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <limits>

#include "core/avoid/objective.hpp"
#include "core/avoid/settings.hpp"
#include "core/world/separation.hpp"

namespace jink::avoid {

/// What the vehicle needs to stop, and Settings::reserve [s].
[[nodiscard]] Seconds time_to_stop(const world::Situation& situation, const Settings& settings) noexcept;

/// Least separation of a manoeuvre as it will really be flown from now on, within `horizon`: the vehicle model follows
/// the rest of it, with a set-point every path::kSetpointPeriod, or holds its command where it is a `velocity`. At the
/// end it brakes to a stand (a fixed wing flies on), so that a path that ends in a trap is not clear. A `velocity` is
/// chosen anew every tick, and what cooperative tracks do meanwhile depends on it: they are checked as far
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

/// An answer that is compared with others.
struct Assessment {
    float margin = -world::kSeparationCap;  ///< as check_manoeuvre says
    ManoeuvreCost cost;                     ///< where the margin is not below 0
};

/// check_manoeuvre to the manoeuvre's end, and what the flight costs that it predicts. `kept`: by so much the
/// situation's vehicle is larger than the real one [m]. Complexity: both together.
[[nodiscard]] Assessment assess(const world::Situation& situation, const world::Manoeuvre& manoeuvre,
                                const Settings& settings, float kept, WorkBudget& budget) noexcept;

}  // namespace jink::avoid
