// SPDX-License-Identifier: BSD-3-Clause
// The experiments of Alejo 7.3 and 8, and the prototype's results of the G-ORCA specification's section 10, flown by
// VelocityFilter.
#include <gtest/gtest.h>

#include "tests/property/core/orca/closed_loop.hpp"

namespace jink::orca {
namespace {

using namespace closed_loop;

void print(const char* name, const Outcome& o)
{
    double longest = 0.0;
    for (const double wait : o.waits) {
        longest = std::max(longest, wait);
    }
    std::printf(
        "[ measured ] %s: %.1f s, least %.3f m (across %.3f), ellipsoid %.3f, cylinder %.3f, obstacles %.3f, climb "
        "%.3f m/s, command rate %.3f m/s2, turns %llu, relaxed W %llu C %llu O %llu other %llu of %llu, longest "
        "stall %.1f s\n",
        name, o.time, o.least, o.least_across, o.ellipsoid, o.cylinder, o.obstacle, o.climb, o.command_rate,
        static_cast<unsigned long long>(o.turns), static_cast<unsigned long long>(o.warning),
        static_cast<unsigned long long>(o.conflict), static_cast<unsigned long long>(o.obstacle_relaxed),
        static_cast<unsigned long long>(o.other), static_cast<unsigned long long>(o.solves), longest);
}

Outcome fly(const char* name, const Scene& scene)
{
    World world(scene);
    EXPECT_TRUE(world.configured()) << name;
    const Outcome outcome = world.fly();
    print(name, outcome);
    EXPECT_EQ(outcome.outside, 0U) << name;
    EXPECT_EQ(outcome.other, 0U) << name;
    return outcome;
}

Scene swap_scene()
{
    Scene scene;
    scene.agents = {{Vec3d(-4, 0, 1.5), Vec3d(4, 0, 1.5)}, {Vec3d(4, 0, 1.5), Vec3d(-4, 0, 1.5)}};
    scene.settings = testbed_settings();
    return scene;
}

/// Section 10, S1: stuck at the warning distance, and blocked.
TEST(PublishedScene, S1WithoutABiasIsStuck)
{
    Scene scene = swap_scene();
    scene.settings.bias.sideways = scene.settings.bias.vertical = 0.0F;
    const Outcome o = fly("S1 without a bias", scene);
    EXPECT_EQ(o.time, -1.0);
    EXPECT_TRUE(o.blocked);
    EXPECT_NEAR(o.least, 1.0, 0.02);
}

/// Section 10, S1 REFERENCE: 15.1 s, purely horizontal, least distance 1.000 m = R_w.
TEST(PublishedScene, S1)
{
    const Outcome o = fly("S1", swap_scene());
    EXPECT_NEAR(o.time, 15.1, 0.3);
    EXPECT_NEAR(o.least, 1.0, 2e-3);
    EXPECT_EQ(o.climb, 0.0);
    EXPECT_EQ(o.warning + o.conflict, 0U);
}

/// Section 10, S2 REFERENCE: 17.0 s by a change of altitude, obstacle margin 1.02 of what is to be kept; at every
/// instant apart across or in height (Alejo 7.3).
TEST(PublishedScene, S2)
{
    Scene scene = swap_scene();
    scene.bodies = {{Vec3d(0, 1.65, 2), Vec3d(2, 0.35, 2)}, {Vec3d(0, -1.65, 2), Vec3d(2, 0.35, 2)}};
    const Outcome o = fly("S2", scene);
    EXPECT_NEAR(o.time, 17.0, 1.0);
    EXPECT_GT(o.climb, 0.1);
    EXPECT_GE(o.obstacle, 1.0);
    EXPECT_GE(o.cylinder, 1.0);
    EXPECT_EQ(o.conflict + o.obstacle_relaxed, 0U);
}

}  // namespace
}  // namespace jink::orca
