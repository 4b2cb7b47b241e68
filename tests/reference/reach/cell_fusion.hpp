// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <span>

#include "core/reach/cell_source.hpp"
#include "tests/reference/reach/map_obstacle.hpp"
#include "tests/reference/reach/meeting.hpp"

// Gomola's way to rate a placed set: by cells, each of them by all that may be in it while any trajectory is there
// (6.6, 6.7). The planner rates nodes; this class is for comparison (Planner::rate_cells_by).

namespace jink::reach {

struct FusionRule {
    Models models{false, true, false, true};  ///< of every intruder: body, in time
    float horizontal = 0.0F;                  ///< spread of every intruder, where the models ask for it [rad]
    float vertical = 0.0F;
    Seconds clock = 0.0F;  ///< one decision frame of the intruders, by which their times may be off
    float room = 0.4F;     ///< about obstacles: soft [m]
};

/// Memory: 8 bytes a cell, for the times of the set that was rated last.
class CellFusion final : public CellSource {  // NOLINT(cppcoreguidelines-virtual-class-destructor): final
public:
    explicit CellFusion(const FusionRule& rule) noexcept : rule_(rule) {}

    [[nodiscard]] const FusionRule& rule() const noexcept { return rule_; }

    /// Lowers the levels of cells: obstacles where an obstacle may be, intruders where a track may be at a time at
    /// which some trajectory is in the cell, hard constraints where a bound of the airspace is passed, soft ones within
    /// the room about obstacles. Tracks are as large as they get by the time of the longest trajectory; all that is
    /// near is enlarged by a ball about the own box.
    ///
    /// Never less than the truth but for what `meeting.hpp` says of stays. Says more than by nodes: the hull of all
    /// trajectories' times, cells as balls and boxes. When the set is not the one that was rated last its times are
    /// found anew, samples of each node in turn, which is no matter for a microcontroller's tick.
    /// O(cells * (tracks + obstacles)), and nodes * samples for another set.
    [[nodiscard]] RateStatus rate(const world::Situation& situation, const Placed& placed, const CellBalls& balls,
                                  Seconds lead, std::span<Level> blocks, WorkBudget& budget) noexcept override;

private:
    [[nodiscard]] bool find_times(const Placed& placed, WorkBudget& budget) noexcept;
    void rate_track(const world::Situation& situation, const world::Threat& track, const Placed& placed,
                    const CellBalls& balls, Seconds lead, std::span<Level> blocks) const noexcept;
    void rate_obstacle(const world::Situation& situation, const world::Threat& obstacle, const Placed& placed,
                       std::span<Level> blocks) const noexcept;
    static void rate_airspace(const world::Situation& situation, const Placed& placed, const CellBalls& balls,
                              std::span<Level> blocks) noexcept;

    FusionRule rule_;
    const ReachSet* times_of_ = nullptr;
    Seconds period_ = 0.0F;
    std::array<Stay, kMaxReachCells> times_{};
};

/// A solid at rest as a placed set sees it: the box or the ball about it, enlarged by `about` [m]. O(1), O(vertices)
/// for a hull.
[[nodiscard]] MapBody body_of(const world::Threat& obstacle, const Placed& placed, float about, float margin) noexcept;

}  // namespace jink::reach
