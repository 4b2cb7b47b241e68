// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "core/base/random.hpp"
#include "core/orca/velocity_filter.hpp"
#include "tests/oracle/obstacle_threats.hpp"
#include "tests/property/core/geometry/oracle.hpp"

// Random ticks of VelocityFilter: accepted settings, a vehicle's inputs at one instant, and constraints of its command.

namespace jink::orca::random_tick {

inline Vec3 in_sphere(Random& random, float radius)
{
    Vec3 out;
    do {
        out = geometry::oracle::in_cube(random, 1.0F);
    } while (out.squaredNorm() > 1.0F);
    return radius * out;
}

inline Vec3 direction(Random& random)
{
    Vec3 out;
    do {
        out = in_sphere(random, 1.0F);
    } while (out.squaredNorm() < 0.01F);
    return out.normalized();
}

inline FilterSettings random_settings(Random& random)
{
    FilterSettings s;
    do {
        s = FilterSettings{};
        s.limits.max_speed = random.uniform(0.5F, 5.0F);
        s.limits.acceleration = random.uniform(0.5F, 6.0F);
        s.limits.period = random.uniform(0.01F, 0.1F);
        if (random.below(3) == 0) {
            s.limits.climb_rate = random.uniform(0.3F, 2.0F);
            s.limits.sink_rate = random.uniform(0.3F, 2.0F);
        }
        if (random.below(4) == 0) {
            s.limits.climb_acceleration = random.uniform(0.3F, 3.0F);
            s.limits.sink_acceleration = random.uniform(0.3F, 3.0F);
        }
        s.half_width = random.uniform(0.2F, 1.0F);
        s.half_height = s.half_width * random.uniform(0.4F, 1.5F);
        s.cover = random.below(2) == 0 ? 1.0F : kCylinderCover;
        s.pair.horizon = random.uniform(2.0F, 10.0F);
        s.pair.conflict = random.below(2) == 0 ? Conflict::present : Conflict::at_rest;
        s.pair.brake = random.uniform(0.2F, 3.0F);
        s.pair.recovery_time = 2.0F;
        s.pair.ramp_speed = random.uniform(0.0F, 0.3F);
        s.delay = random.uniform(0.0F, 0.3F);
        s.obstacles.horizontal = random.uniform(0.3F, 1.5F);
        s.obstacles.vertical = s.obstacles.horizontal * random.uniform(0.4F, 1.5F);
        s.obstacles.horizon = random.uniform(1.0F, 4.0F);
        s.own_id = 500;
    } while (VelocityFilter().configure(s) != Unsafe::none);
    return s;
}

/// A box of the world's axes.
struct Box {
    Vec3 centre;
    Vec3 half;
};

/// All data of one tick; `input` refers to the other members after seen().
struct Seen {
    FilterSettings settings;
    FilterInput input;
    std::vector<Neighbour> neighbours;
    std::vector<Box> boxes;
    std::vector<Bound> bounds;
    std::vector<world::Obstacle> obstacles;
    std::vector<world::Threat> threats;

    const FilterInput& seen()
    {
        obstacles.clear();
        for (const Box& box : boxes) {
            obstacles.push_back(
                {static_cast<world::ObstacleId>(obstacles.size()), geometry::make_box(box.centre, box.half)});
        }
        input.neighbours = neighbours;
        threats = jink::oracle::threats_of(obstacles);
        input.obstacles = threats;
        input.bounds = bounds;
        return input;
    }
};

/// Velocities that the vehicle can fly; `crowd` others at most, boxes and bounds beside them.
inline Seen random_seen(Random& random, std::size_t crowd)
{
    Seen out;
    out.settings = random_settings(random);
    const MotionLimits& limits = out.settings.limits;
    out.input.own.position = geometry::oracle::in_cube(random, 5.0F);
    out.input.own.velocity = clamped(limits, in_sphere(random, limits.max_speed));
    out.input.preferred = in_sphere(random, 1.2F * limits.max_speed);
    const float room = random.uniform(2.0F, 20.0F);
    for (std::size_t i = random.below(crowd + 1); i > 0; --i) {
        Neighbour n;
        n.position = in_sphere(random, room);
        n.max_speed = random.uniform(0.5F, 5.0F);
        n.velocity = in_sphere(random, n.max_speed);
        n.half_width = random.uniform(0.2F, 1.0F);
        // The pair's region within the accepted stretch.
        n.half_height = n.half_width * random.uniform(0.4F, 1.5F);
        n.id = static_cast<std::uint32_t>(out.neighbours.size() * 37 + 300);
        n.cooperative = random.below(5) != 0;
        n.age = random.below(3) == 0 ? random.uniform(0.0F, 2.0F) : 0.0F;
        out.neighbours.push_back(n);
    }
    const float near = random.uniform(2.0F, 10.0F);
    for (std::size_t i = random.below(crowd / 2 + 1); i > 0; --i) {
        const Vec3 half(random.uniform(0.1F, 1.0F), random.uniform(0.1F, 1.0F), random.uniform(0.1F, 1.0F));
        out.boxes.push_back({out.input.own.position + in_sphere(random, near), half});
    }
    for (std::size_t i = random.below(4) == 0 ? random.below(kMaxBounds + 1) : 0; i > 0; --i) {
        out.bounds.push_back({direction(random), random.uniform(-0.5F, 8.0F), random.uniform(-0.2F, 0.2F)});
    }
    return out;
}

inline Decision decide(VelocityFilter& filter, Seen& tick, std::uint32_t units = 1'000'000)
{
    WorkBudget budget(units);
    return filter.decide(tick.seen(), budget);
}

inline Decision decide(Seen& tick, std::uint32_t units = 1'000'000)
{
    VelocityFilter filter(tick.settings);
    return decide(filter, tick, units);
}

/// Status bits of a broken level.
inline constexpr std::array<std::uint32_t, kLevels> kSaid{kInfeasibleDynamics, kRelaxedObstacle, kRelaxedConflict,
                                                          kRelaxedWarning};

/// The largest speed of a tick's program, which its rounding is measured by.
inline float scale_of(const Seen& tick)
{
    const MotionLimits& limits = tick.settings.limits;
    return std::max(1.0F, limits.max_speed + limits.acceleration * limits.period);
}

/// Finite, and within speed and acceleration from `before`.
inline ::testing::AssertionResult is_flyable(const Decision& decision, const MotionLimits& limits, const Vec3& before)
{
    const Eigen::Vector3d command = decision.command.cast<double>();
    const double speed = command.norm();
    const double change = (command - before.cast<double>()).norm();
    if (is_finite(decision.command) && speed <= double(limits.max_speed) * (1.0 + 1e-6) &&
        change <= double(limits.acceleration) * double(limits.period) + 1e-6 * (1.0 + double(limits.max_speed))) {
        return ::testing::AssertionSuccess();
    }
    return ::testing::AssertionFailure() << "command of " << speed << " m/s, changed by " << change;
}

/// Half-spaces of the vehicles chosen by select(), and of bounds, recomputed.
inline std::vector<HalfSpace> planes_of(Seen& tick)
{
    const FilterInput& input = tick.seen();
    const FilterSettings& s = tick.settings;
    std::vector<HalfSpace> out;
    NeighbourSettings own;
    own.half_width = s.half_width;
    own.half_height = s.half_height;
    own.max_speed = s.limits.max_speed;
    own.horizon = s.pair.horizon;
    own.cover = s.cover;
    own.stale = s.stale;
    own.own_id = s.own_id;
    WorkBudget budget(1'000'000);
    for (const std::uint16_t index : select(own, input.neighbours, budget).chosen) {
        const PairPlanes pair = pair_planes(pair_of(own, input.own.velocity, input.neighbours[index], index), s.pair);
        out.push_back(pair.conflict);
        out.push_back(pair.warning);
    }
    for (const Bound& bound : tick.bounds) {
        const float towards = bound.gap >= 0.0F
                                  ? bound.gap / s.obstacles.horizon
                                  : -std::min(s.obstacles.recovery_speed, -bound.gap / s.obstacles.recovery_time);
        out.push_back({-bound.outward, -(towards + bound.speed), Level::obstacles});
    }
    return out;
}

}  // namespace jink::orca::random_tick
