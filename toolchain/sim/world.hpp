// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "toolchain/sim/scenario.hpp"

namespace jink::sim {

/// The vehicle's closest approach to any threat.
struct Closest {
    double surface = 1e9;  ///< vehicle's centre to the threat's surface [m]
    double box = 1e9;      ///< 1 m box around the centre to the surface, separate minimum [m]
    double time = 0.0;     ///< of `surface` [s]
    Vec own = Vec::Zero();
    Vec threat_centre = Vec::Zero();
    std::size_t threat = 0;
};

/// The true state: positions and closest approaches. Threats follow their plan, the vehicle follows its commands.
class World {
public:
    /// @param scenario  outlives the world
    explicit World(const Scenario& scenario);

    /// Advances by one kStep under a velocity command. O(threats).
    void step(const Vec& command);
    /// Sets a plane's airspeed; the initial value is the scenario's cruise speed [m/s].
    void set_airspeed(double speed) noexcept { limits_.cruise = speed; }

    [[nodiscard]] Micros now() const noexcept { return now_; }
    [[nodiscard]] double seconds() const noexcept { return to_seconds(now_); }
    [[nodiscard]] const Truth& own() const noexcept { return own_; }
    [[nodiscard]] const Scenario& scenario() const noexcept { return scenario_; }
    [[nodiscard]] const Vec& threat_position(std::size_t i) const { return positions_[i]; }
    [[nodiscard]] bool visible(std::size_t i) const { return appeared_[i] >= 0; }
    /// Time since which the threat is detectable [us]; -1: not yet.
    [[nodiscard]] Micros appeared(std::size_t i) const { return appeared_[i]; }
    [[nodiscard]] const Closest& closest() const noexcept { return closest_; }
    /// Least signed distance of the centre to a closed area's body [m], negative inside; 1e9 without areas.
    [[nodiscard]] double closest_area() const noexcept { return closest_area_; }
    /// Present least distance from the centre to a surface [m]; sets `nearest` to that threat. 1e9 without threats.
    [[nodiscard]] double separation(std::size_t& nearest) const;
    /// Lowest height of the centre so far [m].
    [[nodiscard]] double lowest() const noexcept { return lowest_; }
    /// True when the vehicle recedes from every threat and closed area, and all threats have appeared.
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
