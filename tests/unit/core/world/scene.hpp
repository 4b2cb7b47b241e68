// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "core/world/conflict.hpp"
#include "core/world/threat_set.hpp"
#include "core/world/track_table.hpp"

namespace jink::world::test {

/// Owns what a Situation refers to.
struct Scene {
    TimePoint now{10'000'000};
    vehicle::VehicleState own;
    vehicle::VehicleLimits limits;
    vehicle::Airframe airframe;
    Reference reference;
    std::vector<Track> tracks;
    std::vector<Obstacle> obstacles;
    std::vector<Cylinder> cylinders;
    Airspace airspace;
    const Manoeuvre* flying = nullptr;
    FlightRules rules;
    TrackId own_id = 0;
    const Commanded* commanded = nullptr;
    Seconds shared_horizon = std::numeric_limits<Seconds>::infinity();
    const CostToGo* cost_to_go = nullptr;
    mutable ThreatSet threats;  ///< of the newest situation

    [[nodiscard]] Situation situation() const
    {
        Situation s{now, own,    limits, airframe,  reference,      rules,
                    {},  flying, own_id, commanded, shared_horizon, cost_to_go};
        static_cast<void>(threats.collect(s, around()));
        s.threats = threats.all();
        return s;
    }

    [[nodiscard]] Surroundings around() const { return {tracks, obstacles, airspace}; }

    void leg(const Vec3& start, const Vec3& end, float speed = 5.0F)
    {
        reference = world::Reference({start, end, speed});
    }
    /// A track without uncertainty, measured now.
    Track& track(const Vec3& position, const Vec3& velocity, float radius = 1.0F)
    {
        Track t;
        t.id = static_cast<TrackId>(tracks.size() + 1);
        t.stamp = now;
        t.position = position;
        t.velocity = velocity;
        t.radius = radius;
        return tracks.emplace_back(t);
    }
    /// Body alone, from 20 m below to 20 m above the origin. Do not copy the scene afterwards.
    Cylinder& cylinder(const Vec2& centre, float radius, const Vec2& velocity = Vec2::Zero())
    {
        cylinders.push_back({{centre, radius}, velocity, -20.0F, 20.0F, 0.0F});
        airspace.cylinders = cylinders;
        return cylinders.back();
    }
    void obstacle(const geometry::Shape& shape)
    {
        obstacles.push_back({static_cast<ObstacleId>(obstacles.size() + 1), shape});
    }
};

/// Conflict of one of the situation's tracks.
inline bool predict_conflict(const Situation& situation, const Way& way, std::size_t track, Seconds lookahead,
                             WorkBudget& budget, Conflict& out)
{
    return conflict_with(situation, way, of_kind(situation.threats, ThreatKind::track)[track], lookahead, budget, out);
}

/// Straight flight through `positions`, `step` seconds apart.
inline path::TimedPath flight(const std::vector<Vec3>& positions, Seconds step)
{
    path::TimedPath path;
    for (std::size_t i = 0; i < positions.size(); ++i) {
        const bool last = i + 1 == positions.size();
        const Vec3 velocity = last ? (path.points.empty() ? Vec3(Vec3::Zero()) : path.points.back().velocity)
                                   : Vec3((positions[i + 1] - positions[i]) / step);
        path.points.unchecked_push_back({positions[i], velocity, step * static_cast<float>(i)});
    }
    return path;
}

/// Position and velocity of an aircraft as a receiver measures them.
inline TrackMeasurement sighting(TrackId id, const Vec3& position, const Vec3& velocity, TimePoint stamp)
{
    TrackMeasurement m;
    m.id = id;
    m.stamp = stamp;
    m.position = position;
    m.velocity = velocity;
    m.has_velocity = true;
    m.radius = 1.0F;
    m.sigma_position = 0.5F;
    m.sigma_velocity = 0.3F;
    return m;
}

/// More work units than any test of one query uses.
inline constexpr std::uint32_t kPlenty = 10'000'000;

inline Separation separation(const Scene& scene, const path::TimedPath& path, Seconds horizon = 100.0F,
                             const EscapeRule& escape = {})
{
    WorkBudget budget(kPlenty);
    return least_separation(scene.situation(), path, horizon, budget, escape);
}

}  // namespace jink::world::test
