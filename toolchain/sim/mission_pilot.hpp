// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include "toolchain/sim/scenario.hpp"

namespace jink::sim {

/// Flies a mission as an autopilot does: towards a point of the leg some way ahead, at cruise speed, waypoint by
/// waypoint, and hovers at the last one.
class MissionPilot {
public:
    /// @param scenario  outlives the pilot; its mission has at least two waypoints
    explicit MissionPilot(const Scenario& scenario) : scenario_(scenario) {}

    /// Velocity command at a place; moves on to the next waypoint when the present one is reached.
    [[nodiscard]] Vec command(const Vec& position);

    /// ArduPilot: the mission mode is entered, and the present waypoint is flown to from here.
    void resume(const Vec& position) { from_ = position; }

    /// Index of the waypoint that is flown to, >= 1.
    [[nodiscard]] std::size_t target() const noexcept { return target_; }
    /// Distance from the present leg [m].
    [[nodiscard]] double cross_track(const Vec& position) const;
    /// Of the present leg as it is flown, where it is nearest [m].
    [[nodiscard]] double height_abeam(const Vec& position) const
    {
        return abeam(from_.value_or(scenario_.mission[target_ - 1]), position, 0.0).z();
    }

private:
    [[nodiscard]] Vec abeam(const Vec& position, double ahead) const;
    [[nodiscard]] Vec abeam(const Vec& from, const Vec& position, double ahead) const;

    const Scenario& scenario_;
    std::size_t target_ = 1;
    std::optional<Vec> from_;  ///< where the present leg is flown from, if that is not the waypoint before
};

}  // namespace jink::sim
