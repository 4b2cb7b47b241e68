// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>

#include "core/reach/cell_source.hpp"
#include "core/reach/near.hpp"
#include "core/reach/vehicle_sets.hpp"
#include "core/world/method.hpp"

namespace jink::reach {

struct Settings {
    const VehicleSets* sets = nullptr;  ///< of the vehicle, checked by the caller; outlives the planner
    /// Cells at the grid's sides nearer than this many layers are no exits.
    std::uint8_t least_outer_layer = 2;
    /// Trajectories whose end is checked before the planner gives up, 1..64.
    std::uint8_t tries = 12;
};

/// Result of a plan and its cause.
struct Report {
    PathStatus path = PathStatus::no_path;
    AvoidanceRun run = AvoidanceRun::soft_constraints;
    bool emergency = false;        ///< the navigation set had no trajectory
    std::uint8_t headings = 0;     ///< courses that were tried
    std::uint8_t tries = 0;        ///< trajectories whose end was checked
    std::uint16_t near = 0;        ///< threats within reach
    std::uint16_t free_nodes = 0;  ///< of the set that was evaluated last, in the run of the answer
    NodeIndex node = kNoNode;
};

/// The method: satisfies world's AvoidanceMethod. Places the vehicle's reach set in the world along the vehicle's
/// course and finds the trajectories that keep clear of every threat, in time. Of these the cheapest that ends nearest
/// to the goal is chosen (Gomola 6.7). The goal is the point of the reference as far ahead as the grid reaches.
///
/// The navigation set is tried first, then the emergency set. A multirotor that hardly moves may begin in any
/// direction: along the nominal path, then to either side, then backwards to either side. A trajectory at whose end the
/// vehicle could not stop (a fixed wing flies on) is discarded, and the next best is taken.
///
/// Plans even without a conflict ahead. Unlike Gomola's planner, this one never accepts a conflict with an
/// intruder or with closed airspace (a cylinder's body): such a trajectory would not pass the final check. A cylinder's
/// margin is entered only where no other trajectory is left.
///
/// Memory: sizeof(Planner), about 32 KiB with the default capacities: a byte a node, 22 a cell, 88 a threat. O(nodes *
/// near threats + cells * threats) for each course and set.
class Planner {
public:
    static constexpr std::size_t kHeadings = 5;
    /// Ways that keep FlightRules::clearance come first.
    static constexpr world::MethodTraits kTraits{
        .id = 2, .reactive = false, .keeps_clearance = true, .needs_sets = true};

    explicit Planner(const Settings& settings) noexcept { static_cast<void>(configure(settings)); }

    [[nodiscard]] world::PlanStatus plan(const world::Situation& situation, WorkBudget& budget,
                                         world::Manoeuvre& out) noexcept;

    [[nodiscard]] const Settings& settings() const noexcept { return settings_; }
    /// Refused (false, nothing changed) when settings are out of range or a set exceeds the capacities of nodes or
    /// cells. Without sets from the start every plan is bad_input.
    [[nodiscard]] bool configure(const Settings& settings) noexcept;
    [[nodiscard]] const Report& last() const noexcept { return report_; }
    /// From now on `picture`, a scanning sensor's (ScanPicture), rates the cells before nodes are checked; null: no
    /// such sensor. It outlives this.
    void look_at(CellSource* picture) noexcept { picture_ = picture; }
    /// From now on `fusion` rates the cells by all known threats, as Gomola does, in place of the node checks; null:
    /// node checks. For comparison (tests/reference/reach/cell_fusion.hpp). It outlives this.
    void rate_cells_by(CellSource* fusion) noexcept { fusion_ = fusion; }

private:
    struct Start;

    [[nodiscard]] world::PlanStatus look(const world::Situation& situation, const Placed& placed, const Start& start,
                                         WorkBudget& budget) noexcept;
    [[nodiscard]] world::PlanStatus try_set(const world::Situation& situation, const Placed& placed, const Start& start,
                                            WorkBudget& budget, world::Manoeuvre& out) noexcept;
    static void make_path(const world::Situation& situation, const Placed& placed, NodeIndex node, const Start& start,
                          path::TimedPath& path) noexcept;
    [[nodiscard]] bool can_stop(const world::Situation& situation, const path::TimedPath& path, const Start& start,
                                WorkBudget& budget) const noexcept;

    Settings settings_;
    Report report_;
    CellSource* picture_ = nullptr;
    CellSource* fusion_ = nullptr;
    bool looked_ = false;  ///< `blocks_` are valid for the current course and for the cells of `spheres_`
    CellSpheres spheres_;
    detail::NearThreats near_;
    std::array<Level, kMaxReachNodes> nodes_{};
    std::array<Level, kMaxReachCells> blocks_{};
    std::array<Level, kMaxReachCells> cells_{};
};

[[nodiscard]] bool is_valid(const Settings& settings) noexcept;
/// Whether a vehicle of these limits can fly the sets, and cruises no faster than their top speed. O(1).
[[nodiscard]] bool suits(const VehicleSets& sets, const vehicle::VehicleLimits& limits) noexcept;

}  // namespace jink::reach
