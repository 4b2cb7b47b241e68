// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "toolchain/sim/scenario.hpp"

namespace jink::sim {

/// The closest that the vehicle came to any threat.
struct Closest {
    double surface = 1e9;  ///< vehicle's centre to the threat's surface [m]
    double box = 1e9;      ///< 1 m box around the centre to the surface, its own minimum [m]
    double time = 0.0;     ///< of `surface` [s]
    Vec own = Vec::Zero();
    Vec threat_centre = Vec::Zero();
    std::size_t threat = 0;
};

/// What is true: where everything is, and how close it came. Threats fly their plan, the vehicle what it is told.
class World {
public:
    /// @param scenario  outlives the world
    explicit World(const Scenario& scenario);

    /// One kStep of time under a velocity command. O(threats).
    void step(const Vec& command);
    /// A plane holds this speed from now on; the scenario's cruise speed at first [m/s].
    void set_airspeed(double speed) noexcept { limits_.cruise = speed; }

    [[nodiscard]] Micros now() const noexcept { return now_; }
    [[nodiscard]] double seconds() const noexcept { return to_seconds(now_); }
    [[nodiscard]] const Truth& own() const noexcept { return own_; }
    [[nodiscard]] const Scenario& scenario() const noexcept { return scenario_; }
    [[nodiscard]] const Vec& threat_position(std::size_t i) const { return positions_[i]; }
    [[nodiscard]] bool visible(std::size_t i) const { return appeared_[i] >= 0; }
    /// Since when it is seen [us]; -1: not yet.
    [[nodiscard]] Micros appeared(std::size_t i) const { return appeared_[i]; }
    [[nodiscard]] const Closest& closest() const noexcept { return closest_; }
    /// The closest that the centre came to a closed area's body [m], below 0: into it; 1e9 without any.
    [[nodiscard]] double closest_area() const noexcept { return closest_area_; }
    /// Least distance now from the centre to a surface [m], and whose; 1e9 without threats.
    [[nodiscard]] double separation(std::size_t& nearest) const;
    /// Lowest height of the centre so far [m].
    [[nodiscard]] double lowest() const noexcept { return lowest_; }
    /// True when the vehicle draws away from every threat and closed area, and none is yet to appear.
    [[nodiscard]] bool all_past() const;

private:
    void look();
    void measure(const Vec& own_before, const std::vector<Vec>& before);

    const Scenario& scenario_;
    TruthLimits limits_;
    Micros now_ = 0;
    Truth own_;
    Gusts gusts_;
    std::vector<Vec> positions_;
    std::vector<Vec> before_;
    std::vector<Micros> appeared_;
    Closest closest_;
    double closest_area_ = 1e9;
    double lowest_;
};

}  // namespace jink::sim
