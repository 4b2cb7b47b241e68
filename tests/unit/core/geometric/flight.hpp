// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "core/geometric/planner.hpp"
#include "core/world/conflict.hpp"
#include "core/world/threat_set.hpp"

namespace jink::geometric {

/// On a level leg of 200 m eastwards at 5 m/s, 50 m up.
struct Flight {
    TimePoint now{1'000'000};
    vehicle::VehicleState own;
    vehicle::VehicleLimits limits;
    vehicle::Airframe airframe;
    world::Reference reference;
    std::vector<world::Track> tracks;
    std::vector<world::Obstacle> obstacles;
    world::Airspace airspace;
    world::FlightRules rules{.lookahead = 10.0F};
    const world::Manoeuvre* flying = nullptr;
    Planner planner{Settings{}};
    WorkBudget budget{1'000'000};
    world::Manoeuvre out;

    Flight()
    {
        own.stamp = now;
        own.position = Vec3(0.0F, 0.0F, 50.0F);
        own.velocity = Vec3(5.0F, 0.0F, 0.0F);
        reference = world::Reference({Vec3(0.0F, 0.0F, 50.0F), Vec3(200.0F, 0.0F, 50.0F), 5.0F});
    }

    void add(const Vec3& position, const Vec3& velocity, float radius)
    {
        world::Track track;
        track.id = static_cast<world::TrackId>(tracks.size() + 1);
        track.stamp = now;
        track.position = position;
        track.velocity = velocity;
        track.radius = radius;
        tracks.push_back(track);
    }

    [[nodiscard]] world::Situation situation() const
    {
        world::Situation s{now, own, limits, airframe, reference, rules, {}, flying};
        static_cast<void>(threats.collect(s, {tracks, obstacles, airspace}));
        s.threats = threats.all();
        return s;
    }
    mutable world::ThreatSet threats;  ///< of the newest situation

    world::PlanStatus plan() { return planner.plan(situation(), budget, out); }
};

/// The planner's problem for the vehicle's position, `distance` along the route to the collision point.
inline Problem problem_along(const Flight& flight, float distance)
{
    const world::Way way = world::way_of(flight.situation());
    Problem problem;
    problem.frame = make_path_frame(way.origin, way.direction);
    problem.ahead = way.ahead;
    problem.distance = distance;
    return problem;
}

}  // namespace jink::geometric
