// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/avoid/guidance.hpp"
#include "core/avoid/settings.hpp"
#include "core/base/work_budget.hpp"
#include "core/world/method.hpp"

namespace jink::avoid {

/// The two situations that a method may be asked in.
struct Situations {
    const world::Situation& inflated;  ///< for a vehicle larger by FlightRules::clearance to every side
    const world::Situation& plain;     ///< for the vehicle as it is
};

/// How an answer was chosen.
struct Choice {
    float margin = 0.0F;       ///< of the answer; least predicted one, as it was asked for [m]
    Seconds cost = 0.0F;       ///< ManoeuvreCost::total
    std::uint8_t answers = 0;  ///< checked ones that it is the best of
};

/// The methods as the state machine sees them: one function that plans, and gives checked answers only.
struct Planning {
    void* self = nullptr;
    MethodOrder all;       ///< the methods that are there
    MethodOrder planners;  ///< those of them that answer with more than a velocity, which is good for one update
    world::PlanStatus (*plan)(void* self, const Situations&, const Settings&, WorkBudget&, Diagnostics&,
                              world::Manoeuvre&, Choice&) noexcept = nullptr;
};

/// The same situation for a vehicle with `extra` [m] more to every side.
struct Inflated {
    vehicle::VehicleLimits limits;
    world::Situation situation;

    Inflated(const world::Situation& s, float extra) noexcept
        : limits(vehicle::widened(s.limits, extra)), situation(world::with_limits(s, limits))
    {
    }
    Inflated(const Inflated&) = delete;
    Inflated& operator=(const Inflated&) = delete;
};

}  // namespace jink::avoid
