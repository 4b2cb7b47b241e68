// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <span>

#include "core/reach/cell_source.hpp"
#include "tests/reference/reach/map_obstacle.hpp"
#include "tests/reference/reach/meeting.hpp"

// Gomola's rating of a placed set: by cells, each by everything that may be in the cell while any trajectory is there
// (6.6, 6.7). The planner rates nodes; this class is for comparison (Planner::rate_cells_by).

namespace jink::reach {

struct FusionRule {
    Models models{false, true, false, true};  ///< of every intruder: body, in time
    float horizontal = 0.0F;                  ///< spread of every intruder, if the models use it [rad]
    float vertical = 0.0F;
    Seconds clock = 0.0F;  ///< one decision frame of the intruders: possible error of their times
    float room = 0.4F;     ///< soft clearance buffer about obstacles [m]
};

/// Memory: 8 bytes a cell, for the times of the set that was rated last.
class CellFusion final : public CellSource {  // NOLINT(cppcoreguidelines-virtual-class-destructor): final
public:
    explicit CellFusion(const FusionRule& rule) noexcept : rule_(rule) {}

    [[nodiscard]] const FusionRule& rule() const noexcept { return rule_; }

    /// Lowers the levels of cells: obstacles where an obstacle may be, intruders where a track may be at a time at
    /// which some trajectory is in the cell, hard constraints where a bound of the airspace is passed, soft constraints
    /// within the buffer about obstacles. Tracks have their size at the time of the longest trajectory; all bodies are
    /// enlarged by a sphere about the own box.
    ///
    /// Conservative, except for the stays as described in `meeting.hpp`. Rates more cells than the rating of nodes:
    /// uses the hull of all trajectories' times, and cells as spheres and boxes. If the set differs from the set rated
    /// last, its times are recomputed from samples of each node, too expensive for a microcontroller's tick. O(cells *
    /// (tracks + obstacles)), and nodes * samples for another set.
    [[nodiscard]] RateStatus rate(const world::Situation& situation, const Placed& placed, const CellSpheres& spheres,
                                  Seconds lead, std::span<Level> blocks, WorkBudget& budget) noexcept override;

private:
    [[nodiscard]] bool find_times(const Placed& placed, WorkBudget& budget) noexcept;
    void rate_track(const world::Situation& situation, const world::Threat& track, const Placed& placed,
                    const CellSpheres& spheres, Seconds lead, std::span<Level> blocks) const noexcept;
    void rate_obstacle(const world::Situation& situation, const world::Threat& obstacle, const Placed& placed,
                       std::span<Level> blocks) const noexcept;
    static void rate_airspace(const world::Situation& situation, const Placed& placed, const CellSpheres& spheres,
                              std::span<Level> blocks) noexcept;

    FusionRule rule_;
    const ReachSet* times_of_ = nullptr;
    Seconds period_ = 0.0F;
    std::array<Stay, kMaxReachCells> times_{};
};

/// A solid at rest as a placed set sees it: the box or the sphere about it, enlarged by `about` [m]. O(1), O(vertices)
/// for a hull.
[[nodiscard]] MapBody body_of(const world::Threat& obstacle, const Placed& placed, float about, float margin) noexcept;

}  // namespace jink::reach
