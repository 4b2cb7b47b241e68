// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdio>

#include <gtest/gtest.h>

#include "tests/property/core/orca/closed_loop.hpp"

// Scenes flown by tests: prints the outcomes and expects the general properties.

namespace jink::orca::closed_loop {

inline double longest_wait(const Outcome& o)
{
    return o.waits.empty() ? 0.0 : *std::max_element(o.waits.begin(), o.waits.end());
}

inline void print(const char* name, const Outcome& o)
{
    std::printf(
        "[ measured ] %s: %.1f s, least %.3f m (across %.3f), ellipsoid %.3f, cylinder %.3f, obstacles %.3f, climb "
        "%.3f m/s, command rate %.3f m/s2, turns %llu, relaxed W %llu C %llu O %llu other %llu of %llu, longest "
        "stall %.1f s\n",
        name, o.time, o.least, o.least_across, o.ellipsoid, o.cylinder, o.obstacle, o.climb, o.command_rate,
        static_cast<unsigned long long>(o.turns), static_cast<unsigned long long>(o.warning),
        static_cast<unsigned long long>(o.conflict), static_cast<unsigned long long>(o.obstacle_relaxed),
        static_cast<unsigned long long>(o.other), static_cast<unsigned long long>(o.solves), longest_wait(o));
}

inline Outcome fly(const char* name, const Scene& scene)
{
    World world(scene);
    EXPECT_TRUE(world.configured()) << name;
    const Outcome outcome = world.fly();
    print(name, outcome);
    EXPECT_EQ(outcome.outside, 0U) << name;
    EXPECT_EQ(outcome.other, 0U) << name;
    return outcome;
}

/// Two vehicles that exchange places, exactly head-on.
inline std::vector<Agent> head_on(const Vec3d& half_way, const Vec3d& middle)
{
    return {{middle - half_way, middle + half_way}, {middle + half_way, middle - half_way}};
}

/// Two walls beside the path along x with a gap of 2.6 m (S2).
inline std::vector<Body> corridor()
{
    return {{Vec3d(0, 1.65, 2), Vec3d(2, 0.35, 2)}, {Vec3d(0, -1.65, 2), Vec3d(2, 0.35, 2)}};
}

}  // namespace jink::orca::closed_loop
