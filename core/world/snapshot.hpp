// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include "core/world/threat_set.hpp"

namespace jink::world {

/// A situation with everything that it views, as it was when it was taken: for work that goes on while the tables
/// change. Vertices of hulls are not copied: their owner outlives this.
///
/// Memory: threats, tracks, shapes and cylinders at capacity, a route, a manoeuvre.
class Snapshot {
public:
    Snapshot() noexcept = default;
    Snapshot(const Snapshot&) = delete;
    Snapshot& operator=(const Snapshot&) = delete;

    /// Threats of a ThreatSet, all or some of them. O(threats + route).
    void take(const Situation& situation) noexcept;
    /// The situation that was taken; valid until the next one is. Without one, nothing is complete in it.
    [[nodiscard]] Situation situation() const noexcept;

private:
    TimePoint now_;
    vehicle::VehicleState own_;
    vehicle::VehicleLimits limits_;
    vehicle::Airframe airframe_;
    Reference reference_;
    path::Route route_;
    FlightRules rules_;
    StaticVector<Threat, ThreatSet::kMaxThreats> threats_;
    StaticVector<Track, kMaxTracks> tracks_;
    StaticVector<geometry::Shape, kMaxObstacles> shapes_;
    StaticVector<Cylinder, kMaxCylinders> cylinders_;
    std::optional<Manoeuvre> flying_;
    std::optional<Commanded> commanded_;
    TrackId own_id_ = 0;
    const CostToGo* cost_to_go_ = nullptr;
    Seconds shared_horizon_ = std::numeric_limits<Seconds>::infinity();
    bool collected_ = false;
};

}  // namespace jink::world
