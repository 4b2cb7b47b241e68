// SPDX-License-Identifier: BSD-3-Clause
// Simulations of Alejo 7.3 without surrounding walls (S1, S2, S6), and the prototype's results of the G-ORCA
// specification's section 10, flown by VelocityFilter. Results that are not reproduced are marked;
// docs/evidence/reproduction_alejo.md has all.
#include <gtest/gtest.h>

#include "tests/property/core/geometry/oracle.hpp"
#include "tests/property/core/orca/closed_loop_report.hpp"

namespace jink::orca {
namespace {

using namespace closed_loop;

Scene swap_scene()
{
    Scene scene;
    scene.agents = head_on(Vec3d(4, 0, 0), Vec3d(0, 0, 1.5));
    scene.settings = testbed_settings();
    return scene;
}

/// The radii read as each vehicle's own, not a pair's (the specification's D19).
void read_per_vehicle(Scene& scene)
{
    scene.settings.half_width *= 2.0F;
    scene.settings.half_height *= 2.0F;
    scene.e_xy *= 2.0;
    scene.e_z *= 2.0;
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

TEST(PublishedScene, S1WithRadiiPerVehicle)
{
    Scene scene = swap_scene();
    read_per_vehicle(scene);
    const Outcome o = fly("S1 per vehicle", scene);
    EXPECT_NEAR(o.time, 17.2, 0.3);
    EXPECT_NEAR(o.least, 2.0, 4e-3);
    EXPECT_EQ(o.climb, 0.0);
}

/// S1's symmetry from every direction, up and down too: without a word both go to sides of their own.
TEST(PublishedScene, EveryExactHeadOnStartEnds)
{
    Random random(geometry::oracle::seed_of(11));
    const std::size_t count = 3 + geometry::oracle::case_count(40);
    double slowest = 0.0;
    double least = 1e9;
    for (std::size_t i = 0; i < count; ++i) {
        Vec3d half(random.uniform(-1.0F, 1.0F), random.uniform(-1.0F, 1.0F), random.uniform(-1.0F, 1.0F));
        half = i == 0 ? Vec3d(0, 0, 4) : i == 1 ? Vec3d(0, -4, 0) : i == 2 ? Vec3d(2, 0, 2) : 4.0 * half.normalized();
        Scene scene = swap_scene();
        scene.agents = head_on(half, Vec3d::Zero());
        World world(scene);
        const Outcome o = world.fly();
        ASSERT_GT(o.time, 0.0) << "case " << i << ", half way " << half.x() << " " << half.y() << " " << half.z();
        ASSERT_GE(o.ellipsoid, 1.0 / 0.7 - 0.01)
            << "case " << i << ", half way " << half.x() << " " << half.y() << " " << half.z();
        slowest = std::max(slowest, o.time);
        least = std::min(least, o.ellipsoid);
    }
    std::printf("[ measured ] %zu head-on starts: slowest %.1f s, least ellipsoid %.3f\n", count, slowest, least);
    EXPECT_LT(slowest, 25.0);
}

/// Section 10, S2 REFERENCE: 17.0 s by a change of altitude, obstacle margin 1.02 of the required distance; at every
/// instant apart across or in height (Alejo 7.3).
TEST(PublishedScene, S2)
{
    Scene scene = swap_scene();
    scene.bodies = corridor();
    const Outcome o = fly("S2", scene);
    EXPECT_NEAR(o.time, 17.0, 1.0);
    EXPECT_GT(o.climb, 0.1);
    EXPECT_GE(o.obstacle, 1.0);
    EXPECT_GE(o.cylinder, 1.0);
    EXPECT_EQ(o.conflict + o.obstacle_relaxed, 0U);
}

/// Section 10, S2 with the sideways bias alone: the prototype is stuck, as the walls leave no space. Not reproduced: in
/// single precision the balance does not last, and the scene ends by a later change of altitude.
TEST(PublishedScene, S2WithTheSidewaysBiasAlone)
{
    Scene scene = swap_scene();
    scene.bodies = corridor();
    scene.settings.bias.vertical = 0.0F;
    const Outcome o = fly("S2 with the sideways bias alone", scene);
    EXPECT_GT(o.time, 20.0);
    EXPECT_GT(o.climb, 0.1);
    EXPECT_GE(o.obstacle, 1.0);
    EXPECT_GE(o.cylinder, 1.0);
}

/// Section 10, 8 on a circle REFERENCE: stuck, 30.8 s with the sideways bias, 19.4 s with both.
TEST(PublishedScene, EightOnACircle)
{
    Scene scene;
    scene.settings = testbed_settings();
    scene.agents = on_a_circle(8, 4.0, 1.5);
    const Outcome both = fly("8 on a circle", scene);
    EXPECT_NEAR(both.time, 19.4, 0.5);
    EXPECT_GE(both.cylinder, 1.0);
    EXPECT_EQ(both.conflict, 0U);
    scene.settings.bias.vertical = 0.0F;
    const Outcome sideways = fly("8 on a circle with the sideways bias alone", scene);
    EXPECT_NEAR(sideways.time, 30.8, 0.5);
    EXPECT_EQ(sideways.climb, 0.0);
    EXPECT_NEAR(sideways.least, 1.0, 2e-3);
    scene.settings.bias.sideways = 0.0F;
    const Outcome none = fly("8 on a circle without a bias", scene);
    EXPECT_EQ(none.time, -1.0);
    EXPECT_NEAR(none.least, 1.0, 0.02);
}

TEST(PublishedScene, EightOnACircleWithRadiiPerVehicle)
{
    Scene scene;
    scene.settings = testbed_settings();
    scene.agents = on_a_circle(8, 4.0, 1.5);
    read_per_vehicle(scene);
    const Outcome o = fly("8 on a circle per vehicle", scene);
    EXPECT_NEAR(o.time, 28.1, 1.0);
    EXPECT_GE(o.cylinder, 1.0);
    EXPECT_EQ(o.conflict, 0U);
}

/// S6 (Alejo 7.3): pair separations 0.85 / 0.65 m and 0.7 / 0.5 m, 1 m/s.
Scene circle_of_ten_metres(std::size_t count, Conflict conflict)
{
    Scene scene;
    scene.settings = testbed_settings();
    scene.settings.half_width = 0.425F;
    scene.settings.half_height = 0.325F;
    scene.settings.pair.conflict_ratio = 0.7F / 0.85F;
    scene.settings.pair.conflict = conflict;
    scene.settings.pair.brake = 0.75F;
    scene.agents = on_a_circle(count, 10.0, 1.5);
    scene.cruise = 1.0;
    scene.e_xy = 0.7;
    scene.e_z = 0.5;
    return scene;
}

/// S6, section 10 and D12 REFERENCE: 24.3 s, ellipsoid margin 1.214, cylinder margin 0.888, no hard relaxation. Margins
/// are reproduced, the time within its 10 s: 30.9 s, because three of 19 neighbours have no half-space of their own.
TEST(PublishedScene, S6)
{
    const Outcome o = fly("S6", circle_of_ten_metres(20, Conflict::at_rest));
    EXPECT_NEAR(o.time, 24.3, 10.0);
    EXPECT_GE(o.time, 0.0);
    EXPECT_NEAR(o.ellipsoid, 1.214, 0.01);
    EXPECT_NEAR(o.cylinder, 0.888, 0.01);
    EXPECT_EQ(o.conflict, 0U);
}

/// S6 (Alejo 7.3.4): to the point across and back.
TEST(PublishedScene, S6OutAndBack)
{
    Scene scene = circle_of_ten_metres(20, Conflict::at_rest);
    scene.there_and_back = true;
    scene.until = 90.0;
    const Outcome o = fly("S6 out and back", scene);
    EXPECT_NEAR(o.time, 2.0 * 24.3, 20.0);
    EXPECT_GE(o.time, 0.0);
    EXPECT_GE(o.ellipsoid, 1.2);
    EXPECT_EQ(o.conflict, 0U);
}

/// Section 10 REFERENCE, S6 with the cylinder's cover: 23.9 s, cylinder margin 1.257.
TEST(PublishedScene, S6CoveringTheCylinder)
{
    Scene scene = circle_of_ten_metres(20, Conflict::at_rest);
    scene.settings.cover = kCylinderCover;
    const Outcome o = fly("S6 covering the cylinder", scene);
    EXPECT_NEAR(o.time, 23.9, 10.0);
    EXPECT_GE(o.time, 0.0);
    EXPECT_NEAR(o.cylinder, 1.257, 0.01);
    EXPECT_EQ(o.conflict, 0U);
}

/// D19 REFERENCE, S6 with radii per vehicle: 30.9 s, no hard relaxation.
TEST(PublishedScene, S6WithRadiiPerVehicle)
{
    Scene scene = circle_of_ten_metres(20, Conflict::at_rest);
    read_per_vehicle(scene);
    const Outcome o = fly("S6 per vehicle", scene);
    EXPECT_NEAR(o.time, 30.9, 10.0);
    EXPECT_NEAR(o.ellipsoid, 1.214, 0.01);
    EXPECT_EQ(o.conflict, 0U);
}

/// Not reproduced: with half-spaces about the present velocities the speed is capped for the three neighbours without a
/// half-space while a conflict is possible within the horizon, and all crawl. With capacity for all 19
/// (JINK_MAX_ORCA_NEIGHBOURS=32) it takes 27.5 s. No two vehicles come near each other.
TEST(PublishedScene, S6AboutPresentVelocitiesCrawls)
{
    Scene scene = circle_of_ten_metres(20, Conflict::present);
    scene.until = 35.0;
    const Outcome o = fly("S6 about present velocities", scene);
    if (kMaxOrcaNeighbours < 19) {
        EXPECT_EQ(o.time, -1.0);
    }
    EXPECT_GE(o.ellipsoid, 1.2);
    EXPECT_EQ(o.conflict, 0U);
}

/// The most that all have half-spaces for, about present velocities: S6's margin.
TEST(PublishedScene, SixteenOnTheCircleOfS6)
{
    const Outcome o = fly("16 on the circle of S6", circle_of_ten_metres(16, Conflict::present));
    EXPECT_NEAR(o.time, 24.3, 1.0);
    EXPECT_NEAR(o.ellipsoid, 1.214, 0.01);
    EXPECT_EQ(o.climb, 0.0);
    EXPECT_EQ(o.conflict, 0U);
}

}  // namespace
}  // namespace jink::orca
