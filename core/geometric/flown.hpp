// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "core/geometric/clearance.hpp"
#include "core/vehicle/motion.hpp"

// A candidate as the vehicle would fly it. Private to this module.

namespace jink::geometric::detail {

/// Flies a candidate, with braking to a stand at its end, and says what the flight touches.
///
/// Once the vehicle has had kSettled to find the path, the flight is predicted in parts of kSettledPart: on the path
/// the command hardly changes from one part to the next. What is chosen is checked in the finer parts of predict_flight
/// before it is flown (avoid/final_check.hpp); how far both lie apart is measured in tests/property/core/geometric
/// (CoarseFlight).
///
/// Memory: a curve and a Clearance, 2.1 KiB with the default capacities.
class Flown {
public:
    static constexpr Seconds kSettled = 3.0F;
    static constexpr Seconds kSettledPart = 0.25F;

    /// All outlive this.
    Flown(const Problem& problem, const Settings& settings, const vehicle::VehicleLimits& limits) noexcept;

    /// Moving threats, by index, that `judge` leaves out and `judge_deferred` takes in.
    void defer(const Selection& threats) noexcept { clearance_.defer(threats); }

    /// What the flight along `path`, about the start, touches; volumes that threats sweep end at `swept_until` or with
    /// the flight. not_evaluated, with the budget spent, where it does not allow for flying it to its end.
    /// O(points * (threats + obstacles)).
    [[nodiscard]] Verdict judge(const path::TimedPath& path, Seconds swept_until, WorkBudget& budget) noexcept;

    /// What the flight judged last touches of those that were left out then.
    [[nodiscard]] Verdict judge_deferred(WorkBudget& budget) const noexcept
    {
        return clearance_.check(flight_, budget, Clearance::Part::deferred);
    }

private:
    [[nodiscard]] bool fly(const path::TimedPath& path, WorkBudget& budget) noexcept;
    void brake(WorkBudget& budget) noexcept;

    const vehicle::VehicleLimits& limits_;
    const path::FollowerGains& gains_;
    Clearance clearance_;
    const Vec3 start_velocity_;
    float fastest_;  ///< of any flight [m/s]
    vehicle::detail::Fading fading_;
    Curve flight_;
};

}  // namespace jink::geometric::detail
