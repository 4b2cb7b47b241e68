// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include "toolchain/sim/scenario.hpp"

namespace jink::sim {

/// Flies a mission as an autopilot does: towards a look-ahead point on the leg, at cruise speed, waypoint by waypoint.
/// Hovers at the last waypoint.
class MissionPilot {
public:
    /// @param scenario  outlives the pilot; its mission has at least two waypoints
    explicit MissionPilot(const Scenario& scenario) : scenario_(scenario) {}

    /// Velocity command at a position; advances to the next waypoint when the present waypoint is reached.
    [[nodiscard]] Vec command(const Vec& position);

    /// ArduPilot: the mission mode is entered, and the present leg starts at `position`.
    void resume(const Vec& position) { from_ = position; }

    /// Index of the present target waypoint, >= 1.
    [[nodiscard]] std::size_t target() const noexcept { return target_; }
    /// Distance from the present leg [m].
    [[nodiscard]] double cross_track(const Vec& position) const;
    /// Height of the present leg, as flown, at its point nearest to `position` [m].
    [[nodiscard]] double height_abeam(const Vec& position) const
    {
        return abeam(from_.value_or(scenario_.mission[target_ - 1]), position, 0.0).z();
    }

private:
    [[nodiscard]] Vec abeam(const Vec& position, double ahead) const;
    [[nodiscard]] Vec abeam(const Vec& from, const Vec& position, double ahead) const;

    const Scenario& scenario_;
    std::size_t target_ = 1;
    std::optional<Vec> from_;  ///< start of the present leg; empty: the waypoint before
};

}  // namespace jink::sim
