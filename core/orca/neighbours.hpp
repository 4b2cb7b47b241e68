// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>

#include "core/base/static_vector.hpp"
#include "core/base/vec3.hpp"
#include "core/base/work_budget.hpp"
#include "core/capacity.hpp"
#include "core/orca/agent_plane.hpp"

// Which other vehicles get half-spaces, and what is left for those that do not.

namespace jink::orca {

/// Another vehicle at the planning instant, relative to the own one, in the world frame. The Planner makes one of each
/// track's world::Threat and keeps them for one plan. Not a Threat itself: swarms and the exchange make them of what
/// the others broadcast (age, top speed, share of the reaction), and its size is that at the closest approach.
struct Neighbour {
    Vec3 position = Vec3::Zero();  ///< of its centre, less the own one's [m]
    Vec3 velocity = Vec3::Zero();  ///< [m/s]
    float half_width = 0.5F;       ///< [m]
    float half_height = 0.5F;      ///< [m]
    float max_speed = 2.0F;        ///< [m/s]
    float acceleration = 2.0F;     ///< [m/s2] at most
    float age = 0.0F;              ///< [s] since it was seen or heard of, before prediction
    std::uint32_t id = 0;          ///< the same for every vehicle, and not the own one's
    bool cooperative = true;       ///< it gives way by the same rules
};

/// The own vehicle and rules for neighbours.
struct NeighbourSettings {
    float half_width = 0.5F;   ///< own, [m]
    float half_height = 0.5F;  ///< own, [m]
    float max_speed = 2.0F;    ///< own, [m/s]
    float horizon = 10.0F;     ///< [s]
    float cover = 1.0F;        ///< kCylinderCover to keep the cylinder of the same widths
    /// [m] in the stretched space beyond which no vehicle is checked (Alejo's neighbour distance, 7.3.2); infinite:
    /// everybody who can be met within the horizon.
    float range = std::numeric_limits<float>::infinity();
    /// [s] that a neighbour which is left out must not be met within: the horizon, or PairSettings::brake with
    /// Conflict::at_rest.
    float cap_horizon = 10.0F;
    /// Of the distance to be kept: what the cap keeps clear. PairSettings::conflict_ratio with Conflict::at_rest.
    float cap_ratio = 1.0F;
    float stale = 1.0F;  ///< [s] of age after which nothing is expected of it
    std::uint32_t own_id = 0;
};

/// The pair of the own vehicle and `other`: a share of 1 where it does not give way or is stale. What its age adds to
/// the distance is part of its widths (world::threat_radius).
[[nodiscard]] Pair pair_of(const NeighbourSettings& settings, const Vec3& own_velocity, const Neighbour& other,
                           std::uint16_t source) noexcept;

/// Which neighbours are used.
struct Selection {
    StaticVector<std::uint16_t, kMaxOrcaNeighbours> chosen;  ///< places in the input, the most urgent first
    /// [m/s] for the own speed: those left out can not be met within the cap horizon. Infinite where nobody is.
    float speed_cap = std::numeric_limits<float>::infinity();
    float horizon = 0.0F;         ///< [s] that is left where `range` leaves somebody out
    std::uint16_t truncated = 0;  ///< within reach, but beyond capacity
    std::uint16_t stale = 0;      ///< among the chosen
    std::uint16_t refused = 0;    ///< not finite, or sizes and speeds that are none
    bool exhausted = false;       ///< the budget ran out before all were checked: speed_cap is 0
};

/// Chooses among `all`, tracked ones in any order; the same set whatever the order, ties by id.
///
/// Whoever can not be met within the horizon is left out, and nothing is lost. Of the others the kMaxOrcaNeighbours
/// with the least (distance - radius) / horizon are kept, those that do not give way counted as nearer by their speed.
/// For each one that is left out the own speed is capped at gap / cap_horizon less its own top speed; where that is
/// nothing, at half of the gap, which holds if it caps its own the same way (those that do not give way do not: then
/// 0). O(n kMaxOrcaNeighbours).
[[nodiscard]] Selection select(const NeighbourSettings& settings, std::span<const Neighbour> all,
                               WorkBudget& budget) noexcept;

}  // namespace jink::orca
