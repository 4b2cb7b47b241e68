// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/base/random.hpp"
#include "core/orca/agent_plane.hpp"
#include "core/orca/obstacle_plane.hpp"
#include "core/orca/program.hpp"
#include "core/world/map_obstacles.hpp"
#include "tests/timing/orca_nearest.hpp"

// Many vehicles in one process, each avoiding all others by core/orca: the antipodal sphere of the public ORCA-3D
// library's example. The constructor allocates all memory; a step allocates none.

namespace jink::orca {

/// Rules of a swarm; defaults are the public example's, and two regions around each vehicle.
///
/// The public library loses distance in two ways: contradicting half-spaces all yield, and of more than `most`
/// neighbours the farther ones are ignored. Here only the half-spaces of a slightly wider region yield, which keeps the
/// distance itself: the conflict region's half-spaces depend on positions alone (Conflict::at_rest) and are jointly
/// feasible, and a speed cap keeps ignored neighbours off. With a brake time of one period, the least that holds, a
/// neighbour half a metre away causes no cap, and a quarter causes no slowing.
struct SwarmSettings {
    float radius = 1.5F;     ///< of a vehicle [m]
    float max_speed = 2.0F;  ///< [m/s]
    float cruise = 1.0F;     ///< preferred speed [m/s]
    float range = 15.0F;     ///< [m] within which others are considered
    std::size_t most = 10;   ///< largest number of considered neighbours
    float step = 0.125F;     ///< [s]
    float sphere = 100.0F;   ///< radius [m]
    float warning = 3.2F;    ///< radius of the warning region [m]; the conflict region's is 2 radius
    bool regions = true;     ///< false: one yielding region of 2 radius, as in the public library
    PairSettings pair = swarm_pair();

    static PairSettings swarm_pair()
    {
        PairSettings pair;
        pair.horizon = 10.0F;
        pair.conflict = Conflict::at_rest;
        pair.brake = 0.125F;
        pair.ramp_speed = 0.75F;
        pair.recovery_time = 0.125F;
        return pair;
    }
};

/// The obstacles of a map that bind some velocity of the vehicle, into a table that keeps places for them.
world::MapSelection choose_obstacles(const geometry::MeshMap& map, const OwnMotion& own,
                                     const ObstacleSettings& settings, WorkBudget& budget, world::ObstacleTable& table);

/// Points on their way to goals.
class MovingPoints {
public:
    /// On a sphere of `radius` [m], each to the opposite point.
    MovingPoints(std::size_t count, float radius);
    /// From given positions to given goals, equal in number.
    MovingPoints(std::vector<Vec3> positions, std::vector<Vec3> goals);

    /// How many are more than `distance` [m] away from their goals.
    [[nodiscard]] std::size_t under_way(float distance) const;
    /// Least distance of two points [m] during the last period of `step` [s], in continuous time.
    [[nodiscard]] float least_distance(float step) const;
    [[nodiscard]] std::size_t size() const { return positions_.size(); }

protected:
    /// To the goal at `cruise` [m/s], slower in its last second, and a thousandth beside it against symmetry.
    [[nodiscard]] Vec3 preferred(std::size_t self, float cruise) const;
    /// All fly on at these velocities for `step` [s].
    void move(const std::vector<Vec3>& velocities, float step);

    std::vector<Vec3> positions_, velocities_, goals_;

private:
    std::uint64_t steps_ = 0;
};

class Swarm : public MovingPoints {
public:
    /// On a sphere, each to the opposite point.
    Swarm(std::size_t count, const SwarmSettings& settings);
    /// From given positions to given goals, equal in number.
    Swarm(std::vector<Vec3> positions, std::vector<Vec3> goals, const SwarmSettings& settings);

    /// Keeps clear of a map that outlives this, too.
    void set_map(const geometry::MeshMap& map, const ObstacleSettings& settings);

    /// Advances all vehicles by one period.
    void step();
    /// One vehicle's part of it; `build` first, `move` after all.
    void build();
    void decide(std::size_t self);
    void move() { MovingPoints::move(next_, settings_.step); }

    /// All within two radii of their goals.
    [[nodiscard]] bool arrived() const { return under_way() == 0; }
    [[nodiscard]] std::size_t under_way() const { return MovingPoints::under_way(2.0F * settings_.radius); }
    [[nodiscard]] float least_distance() const { return MovingPoints::least_distance(settings_.step); }

    /// Counts so far.
    struct Counts {
        std::uint64_t solved = 0, warning = 0, conflict = 0, other = 0, truncated = 0;
        std::uint64_t planes = 0, beside_obstacles = 0;  ///< half-spaces; of these of obstacles
        std::uint64_t penetrating = 0;                   ///< vehicles whose envelope overlapped an obstacle
    };
    [[nodiscard]] const Counts& counts() const { return counts_; }

private:
    std::size_t add_obstacles(std::size_t self, float& cap);

    SwarmSettings settings_;
    std::vector<Vec3> next_;
    NearestPoints nearest_;
    static constexpr std::size_t kMaxPlanes = 2 * NearestPoints::kMax + kMaxObstaclePlanes;
    Scratch<kMaxPlanes> scratch_;
    std::array<HalfSpace, kMaxPlanes> planes_;
    geometry::MeshMap map_;
    world::ObstacleTable table_;
    ObstacleSettings obstacle_settings_;
    bool is_among_obstacles_ = false;
    std::array<NearestPoints::Found, NearestPoints::kMax> found_;
    Counts counts_;
};

}  // namespace jink::orca
