// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <cstdint>
#include <vector>

#include "core/base/random.hpp"
#include "core/world/threat_set.hpp"

namespace jink::oracle {

/// A vehicle on its leg with one to five tracks that come near, and up to three pillars and houses off the leg.
struct RandomSituation {
    TimePoint now{50'000'000};
    vehicle::VehicleState own;
    vehicle::VehicleLimits limits;
    vehicle::Airframe airframe;
    world::Reference reference;
    std::vector<world::Track> tracks;
    std::vector<world::Obstacle> obstacles;
    world::Airspace airspace;
    world::FlightRules rules{.lookahead = 10.0F};

    explicit RandomSituation(std::uint64_t seed)
    {
        Random random(seed);
        own.position =
            Vec3(random.uniform(-100.0F, 100.0F), random.uniform(-100.0F, 100.0F), random.uniform(30.0F, 60.0F));
        own.sigma_position = random.uniform(0.0F, 0.2F);
        const float heading = random.uniform(-kPi, kPi);
        const Vec3 along(std::cos(heading), std::sin(heading), random.uniform(-0.3F, 0.3F));
        limits.max_acceleration = random.uniform(3.0F, 8.0F);
        reference =
            world::Reference({own.position - 20.0F * along, own.position + 150.0F * along, random.uniform(3.0F, 8.0F)});
        own.velocity = reference.speed * along.normalized();
        airspace.has_floor = true;
        airspace.floor = 2.0F;
        for (std::uint64_t i = 0, n = 1 + random.below(5); i < n; ++i) {
            world::Track track;
            track.id = static_cast<world::TrackId>(i);
            track.stamp = now - random.uniform(0.0F, 0.5F);
            track.velocity =
                Vec3(random.uniform(-8.0F, 8.0F), random.uniform(-8.0F, 8.0F), random.uniform(-1.0F, 1.0F));
            const float t = random.uniform(2.0F, 8.0F);
            const Vec3 off(random.uniform(-4.0F, 4.0F), random.uniform(-4.0F, 4.0F), random.uniform(-3.0F, 3.0F));
            track.position = own.position + own.velocity * t + off - track.velocity * t;
            track.radius = random.uniform(0.2F, 1.5F);
            track.sigma_position = random.uniform(0.0F, 0.3F);
            track.sigma_velocity = random.uniform(0.0F, 0.15F);
            track.max_acceleration = random.uniform() < 0.5F ? 0.0F : random.uniform(0.0F, 0.1F);
            tracks.push_back(track);
        }
        for (std::uint64_t i = 0, n = random.below(4); i < n; ++i) {
            const Vec3 at = own.position + own.velocity * random.uniform(3.0F, 8.0F) +
                            Vec3(random.uniform(-15.0F, 15.0F), random.uniform(-15.0F, 15.0F), 0.0F);
            obstacles.push_back(
                {static_cast<world::ObstacleId>(i),
                 random.uniform() < 0.5F
                     ? geometry::make_capsule(Vec3(at.x(), at.y(), 0.0F), Vec3(at.x(), at.y(), 80.0F), 0.5F)
                     : geometry::make_box(Vec3(at.x(), at.y(), 20.0F), Vec3(3.0F, 4.0F, 15.0F))});
        }
    }

    [[nodiscard]] world::Situation view() const
    {
        world::Situation s{now, own, limits, airframe, reference, rules};
        static_cast<void>(threats.collect(s, {tracks, obstacles, airspace}));
        s.threats = threats.all();
        return s;
    }

    mutable world::ThreatSet threats;  ///< of the latest view
};

}  // namespace jink::oracle
