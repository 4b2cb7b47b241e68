// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>
#include <vector>

#include "toolchain/sim/area_sender.hpp"
#include "toolchain/sim/record.hpp"

namespace jink::sim {

/// Everything at the autopilot's end of the cable for one flight: world, autopilot, and recording.
///
/// The owner moves the bytes: `deliver` bytes of the co-processor, `step`, then send the bytes of `collect`. The same
/// plant flies in process and against the real program.
class Plant {
public:
    /// @param scenario  outlives the plant
    explicit Plant(const Scenario& scenario);
    Plant(const Plant&) = delete;
    Plant& operator=(const Plant&) = delete;

    void deliver(std::span<const std::byte> bytes);
    /// Advances by one kStep.
    void step();
    /// Frames of other systems, from the radio.
    void relay(std::span<const std::byte> frames) { autopilot_.relay(frames); }
    /// The co-processor chose a manoeuvre of this side in this step.
    void note_choice(const Vec& side);
    [[nodiscard]] std::vector<std::byte> collect();

    /// The duration has elapsed, or all threats are past and the vehicle is settled.
    [[nodiscard]] bool finished() const;
    [[nodiscard]] Micros now() const noexcept { return world_.now(); }
    [[nodiscard]] const Autopilot& autopilot() const noexcept { return autopilot_; }
    [[nodiscard]] const World& world() const noexcept { return world_; }

    /// Finishes the recording. The caller adds `inside` and further faults before `conclude`.
    /// @param scanned  time at which a LiDAR first reported each threat [s], negative: never; empty: no LiDAR
    [[nodiscard]] Record record(const std::vector<double>& scanned = {}) const;

private:
    [[nodiscard]] bool cable_pulled() const noexcept;
    [[nodiscard]] bool faults_over() const;
    void take_notes();
    [[nodiscard]] bool is_below_floor() const;

    const Scenario& scenario_;
    World world_;
    Autopilot autopilot_;
    AreaSender areas_;
    FlipCounter flips_;
    SideLog sides_;
    std::vector<Sample> samples_;
    Micros held_ = 0;
    Micros longest_hold_ = 0;
    bool below_floor_ = false;
    Micros goal_at_ = -1;
};

/// Decides the outcome and lists the broken rules.
void conclude(const Scenario& scenario, Record& record);

}  // namespace jink::sim
