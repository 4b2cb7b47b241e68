// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include "core/base/work_units.hpp"
#include "core/world/map_obstacles.hpp"
#include "firmware/app/parameters.hpp"
#include "firmware/link/global_position.hpp"

namespace jink::app {

/// A map of known surroundings, where there is one: placed in the autopilot's local frame, its pieces near the vehicle
/// made obstacles in each step.
///
/// A map that knows its origin on the globe lies where the local frame's origin puts it, moved but not turned. Its
/// pieces are uncertain by what that leaves out: ConstraintTable::kMapError of the distance from the local origin
/// (1.5 m in 1 km), the angle between the norths of both origins (0.27 m at 1 km from the map's origin, where the
/// origins are 1 km apart at 60 degrees of latitude), the Earth's curvature (0.08 m there). A map without an origin on
/// the globe is taken to be in the autopilot's local frame as it is.
class KnownMap {
public:
    /// Nodes of the map that are opened in a step, at most.
    static constexpr std::uint32_t kMaxOpened = 16 * static_cast<std::uint32_t>(kMaxMapObstacles);
    /// What that takes [work units]: of no plan, and of no check.
    static constexpr std::uint32_t kUnits = units::kMeshNode * kMaxOpened;
    /// Obstacles count as far as the vehicle gets in so many times the look-ahead of conflict prediction: the farthest
    /// that a method plans.
    static constexpr float kLookaheads = 2.0F;
    /// At so many times the cruise speed, or faster where it is faster: the fastest leg of a plan.
    static constexpr float kFastest = 1.6F;

    /// From now on; good (geometry::check), outlives this. `table` keeps places for it and knows no obstacle yet.
    void use(const geometry::MeshMap& map, world::ObstacleTable& table) noexcept;

    /// Appends the obstacles about the vehicle to `table`, none where the map has no place.
    /// @param origin  of the local frame, where it is known
    /// O(kMaxOpened * log kMaxMapObstacles).
    void append_to(world::ObstacleTable& table, const std::optional<link::GlobalPosition>& origin,
                   const vehicle::VehicleState& own, const Configuration& c) noexcept;
    /// Nothing is known of the surroundings in this step: no own state, or no autopilot whose frame it is.
    void leave_out() noexcept
    {
        selection_ = {};
        lacks_place_ = is_unresolved_ = is_coarse_ = false;
    }

    /// The map is known by its place on the globe, and the local frame's origin is not, or lies too far away.
    [[nodiscard]] bool lacks_place() const noexcept { return lacks_place_; }
    /// A box that holds several pieces may touch the own box: what is about the vehicle is not known well enough.
    [[nodiscard]] bool is_unresolved() const noexcept { return is_unresolved_; }
    /// Boxes stand for pieces nearer than the vehicle can stop: it may be kept from where there is nothing.
    [[nodiscard]] bool is_coarse() const noexcept { return is_coarse_; }
    [[nodiscard]] const world::MapSelection& selection() const noexcept { return selection_; }

private:
    [[nodiscard]] std::optional<world::MapPlace> place(const std::optional<link::GlobalPosition>& origin,
                                                       const Vec3& own, float reach) const noexcept;

    const geometry::MeshMap* map_ = nullptr;
    world::MapSelection selection_;
    bool lacks_place_ = false;
    bool is_unresolved_ = false;
    bool is_coarse_ = false;
};

}  // namespace jink::app
