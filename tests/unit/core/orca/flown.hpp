// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include <gtest/gtest.h>

#include "core/orca/velocity_filter.hpp"
#include "tests/numbers.hpp"
#include "tests/oracle/obstacle_threats.hpp"

// A filter flown tick by tick, for its tests.

namespace jink::orca::flown {

inline constexpr std::uint32_t kPlenty = 1'000'000;

/// A perfectly followed filter; checks that each command is finite, and within both spheres of the limits.
class Flown {
public:
    explicit Flown(const FilterSettings& settings = {}, const Vec3& velocity = Vec3::Zero())
        : filter(settings), last(velocity)
    {
        input.own.velocity = velocity;
        input.preferred = velocity;
    }

    Decision tick(std::uint32_t units = kPlenty)
    {
        input.neighbours = neighbours;
        threats = oracle::threats_of(obstacles);
        input.obstacles = threats;
        input.bounds = bounds;
        WorkBudget budget(units);
        const Decision decision = filter.decide(input, budget);
        const MotionLimits& limits = filter.settings().limits;
        EXPECT_TRUE(is_finite(decision.command));
        EXPECT_LE(decision.command.norm(), limits.max_speed * 1.000001F);
        EXPECT_LE((decision.command - last).norm(), limits.acceleration * limits.period * 1.00001F + 1e-6F);
        now.us += 25'000;
        EXPECT_TRUE(filter.issued(now, decision.command));
        last = decision.command;
        input.own.velocity = decision.command;
        return decision;
    }
    Decision ticks(int count)
    {
        Decision out;
        for (int i = 0; i < count; ++i) {
            out = tick();
        }
        return out;
    }
    void add_sphere(const Vec3& centre, float radius)
    {
        obstacles.push_back({static_cast<world::ObstacleId>(obstacles.size()), geometry::make_sphere(centre, radius)});
    }

    VelocityFilter filter;
    FilterInput input;
    std::vector<Neighbour> neighbours;
    std::vector<world::Obstacle> obstacles;
    std::vector<world::Threat> threats;  ///< of the newest tick
    std::vector<Bound> bounds;
    Vec3 last;
    TimePoint now{1'000'000};
};

inline Neighbour other(const Vec3& position, const Vec3& velocity, std::uint32_t id = 7)
{
    Neighbour n;
    n.position = position;
    n.velocity = velocity;
    n.half_width = 0.6F;
    n.half_height = 0.3F;
    n.max_speed = 1.5F;
    n.id = id;
    return n;
}

inline void expect_near(const Vec3& got, const Vec3& want, float tolerance)
{
    EXPECT_LE((got - want).norm(), tolerance) << got.x() << " " << got.y() << " " << got.z();
}

}  // namespace jink::orca::flown
