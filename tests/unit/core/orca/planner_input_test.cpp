// SPDX-License-Identifier: BSD-3-Clause
// The ORCA planner's inputs from a situation: bounds, obstacles and tracks at the time when the command acts, each with
// its uncertainty.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "tests/oracle/hull_obstacles.hpp"
#include "tests/unit/core/orca/orca_input.hpp"

namespace jink::orca {
namespace {

using test::OrcaInput;
using world::PlanStatus;

// --- bounds ---

TEST_F(OrcaInput, TheFloorIsKeptFromTheBottomOfTheCylinder)
{
    scene.airspace.has_floor = true;
    towards(Vec3(0, 0, -1), 2.0F);
    scene.airspace.floor = 30.0F - 1.0F - 0.4F;
    EXPECT_NEAR(command().z(), -0.4F, 1e-3F) << "met in a second";
    scene.own.sigma_position = 0.1F;
    EXPECT_NEAR(command().z(), -0.1F, 1e-3F) << "three standard deviations of the own place";
    scene.rules.k_sigma = 2.0F;
    EXPECT_NEAR(command().z(), -0.2F, 1e-3F);
    scene.own.sigma_position = 0.0F;
    scene.own.velocity = Vec3(0, 0, -1);
    EXPECT_NEAR(command().z(), -0.3F, 1e-3F) << "0.1 m is lost until it acts";
    scene.own.velocity = Vec3::Zero();
    scene.limits.half_extents = Vec3(1, 1, 0.1F);
    EXPECT_NEAR(command().z(), -(0.4F + 1.0F - kHalfWidth / 3.96F), 1e-3F) << "no flatter than half-spaces can be made";
}

TEST_F(OrcaInput, TheCeilingIsKeptFromTheTopOfTheCylinder)
{
    scene.airspace.has_ceiling = true;
    towards(Vec3(0, 0, 1), 2.0F);
    scene.airspace.ceiling = 30.0F + 1.0F + 0.4F;
    EXPECT_NEAR(command().z(), 0.4F, 1e-3F);
    scene.own.sigma_position = 0.1F;
    EXPECT_NEAR(command().z(), 0.1F, 1e-3F);
    scene.own.sigma_position = 0.0F;
    scene.own.velocity = Vec3(0, 0, 1);
    EXPECT_NEAR(command().z(), 0.3F, 1e-3F);
}

TEST_F(OrcaInput, TheFenceIsKeptAboutHome)
{
    scene.airspace.has_keep_in = true;
    scene.airspace.home = Vec3(-6, -8, 500);
    scene.airspace.keep_in_radius = 10.0F + kHalfWidth + 1.5F;
    towards(Vec3(0.6F, 0.8F, 0));
    EXPECT_NEAR(command().norm(), 1.5F, 1e-3F) << "from home outwards";
    scene.own.sigma_position = 0.1F;
    EXPECT_NEAR(command().norm(), 1.2F, 1e-3F);
    scene.own.sigma_position = 0.0F;
    towards(Vec3(-0.6F, -0.8F, 0));
    EXPECT_NEAR(command().norm(), 2.5F, 1e-3F) << "inwards it is free";
    // A tall vehicle is no thinner than half-spaces can be made for.
    scene.limits.half_extents = Vec3(0.1F, 0.1F, 1.0F);
    scene.airspace.keep_in_radius = 10.0F + 0.505F + 1.5F;
    towards(Vec3(0.6F, 0.8F, 0));
    EXPECT_NEAR(command().norm(), 1.5F, 1e-3F);
    scene.airspace.home = Vec3(0, 0, 0);
    EXPECT_NEAR(command().norm(), 2.5F, 1e-3F) << "at home no direction leads out";
}

TEST_F(OrcaInput, BoundsThatAreNotThereBindNothing)
{
    scene.airspace.floor = scene.airspace.ceiling = 30.0F;
    scene.airspace.keep_in_radius = 0.1F;
    scene.airspace.home = Vec3(5, 0, 0);
    EXPECT_NEAR(command().x(), 2.5F, 1e-3F);
    EXPECT_EQ(planner.last().status & kBoundsOverlap, 0U);
}

TEST_F(OrcaInput, ACylinderIsKeptFromItsNearestSide)
{
    scene.cylinder(world::Vec2(10.0F + kHalfWidth + 1.2F, 0), 10.0F).top = 60.0F;
    EXPECT_NEAR(command().x(), 1.2F, 1e-3F);
    scene.own.sigma_position = 0.1F;
    EXPECT_NEAR(command().x(), 0.9F, 1e-3F);
    scene.own.sigma_position = 0.0F;
    scene.cylinders[0].velocity = world::Vec2(-0.5F, 0);
    EXPECT_NEAR(command().x(), 1.2F - 0.05F - 0.5F, 1e-3F) << "it comes nearer, and has when the command acts";
    scene.cylinders[0].velocity = world::Vec2(0.5F, 3.0F);
    EXPECT_GT(command().x(), 1.2F + 0.04F) << "it goes away";
    // Above it: down to its top.
    scene.cylinders[0] = {{world::Vec2(3, 0), 10.0F}, world::Vec2(0, 0), 0.0F, 30.0F - 1.0F - 0.5F, 0.0F};
    towards(Vec3(0, 0, -1), 2.0F);
    EXPECT_NEAR(command().z(), -0.5F, 1e-3F);
    // Below it: up to its bottom.
    scene.cylinders[0] = {{world::Vec2(3, 0), 10.0F}, world::Vec2(0, 0), 30.0F + 1.0F + 0.6F, 100.0F, 0.0F};
    towards(Vec3(0, 0, 1), 2.0F);
    EXPECT_NEAR(command().z(), 0.6F, 1e-3F);
    // The side that is farther off counts: beside it by 2 m and above it by 0.5 m.
    scene.cylinders[0] = {{world::Vec2(10.0F + kHalfWidth + 2.0F, 0), 10.0F}, world::Vec2(0, 0), 0.0F, 28.5F, 0.0F};
    towards(Vec3(0.6F, 0, -0.8F), 2.0F);
    EXPECT_NEAR(command().z(), -1.5F, 2e-3F) << "down is free but for its acceleration";
    EXPECT_LE(command().x(), 2.0F);
    // In its axis it is left to any side.
    scene.cylinders[0] = {{world::Vec2(0, 0), 10.0F}, world::Vec2(0, 0), 0.0F, 60.0F, 0.0F};
    towards(Vec3(1, 0, 0));
    EXPECT_NEAR(command().x(), -0.3F, 1e-3F);
    EXPECT_NE(planner.last().status & kBoundsOverlap, 0U);
}

/// Bounds come before cylinders; of cylinders the nearest are used, in any order.
TEST_F(OrcaInput, OfManyCylindersTheNearestAreTaken)
{
    scene.airspace.has_floor = scene.airspace.has_ceiling = scene.airspace.has_keep_in = true;
    scene.airspace.floor = -500.0F;
    scene.airspace.ceiling = 500.0F;
    scene.airspace.home = Vec3(1, 0, 0);
    scene.airspace.keep_in_radius = 5000.0F;
    for (int near = 0; near < 8; ++near) {
        scene.cylinders.clear();
        for (int i = 0; i < 8; ++i) {
            const float x = i == near ? 10.0F + kHalfWidth + 1.0F : 300.0F + 30.0F * static_cast<float>((5 * i) % 8);
            scene.cylinder(world::Vec2(x, 0), 10.0F).top = 60.0F;
        }
        ASSERT_NEAR(command().x(), 1.0F, 1e-3F) << near;
        ASSERT_EQ(planner.last().status & kBadInput, 0U);
    }
    // The bounds themselves stay.
    scene.airspace.keep_in_radius = 1.0F + kHalfWidth + 0.5F;
    towards(Vec3(-1, 0, 0));
    EXPECT_NEAR(command().norm(), 0.5F, 1e-3F);
}

// --- obstacles ---

TEST_F(OrcaInput, ObstaclesAreKeptByTheCylinderWithTheOwnUncertainty)
{
    scene.obstacle(geometry::make_box(Vec3(5, 0, 30), Vec3(1, 50, 50)));
    static_cast<void>(command());
    EXPECT_NEAR(planner.last().margin, 4.0F - 1.41421356F * kHalfWidth, 1e-3F);
    scene.own.sigma_position = 0.2F;
    static_cast<void>(command());
    EXPECT_NEAR(planner.last().margin, 4.0F - 1.41421356F * (kHalfWidth + 0.6F), 1e-3F);
    scene.own.sigma_position = 0.0F;
    scene.own.velocity = Vec3(1, 0, 0);
    static_cast<void>(command());
    EXPECT_NEAR(planner.last().margin, 4.0F - 0.1F - 1.41421356F * kHalfWidth, 1e-3F);
    // Overhead the height counts.
    scene.obstacles.clear();
    scene.own.velocity = Vec3::Zero();
    scene.obstacle(geometry::make_box(Vec3(0, 0, 34), Vec3(50, 50, 1)));
    static_cast<void>(command());
    EXPECT_NEAR(planner.last().margin, 3.0F * kHalfWidth - 1.41421356F * kHalfWidth, 1e-3F) << "stretched";
}

/// No faster than from which it can stop before the margin once the command acts.
TEST_F(OrcaInput, SpeedTowardsAWallLeavesRoomToStopAfterTheDelay)
{
    scene.own.velocity = Vec3(4, 0, 0);
    const float margin = 1.65F;
    scene.obstacle(geometry::make_box(Vec3(1.0F + 0.4F + margin + 1.41421356F * kHalfWidth, 0, 30), Vec3(1, 90, 90)));
    EXPECT_NEAR(command().x(), std::sqrt(2.0F * 5.0F * (margin - 4.0F * 0.35F)), 2e-3F);
}

TEST_F(OrcaInput, AHullIsAnObstacleToo)
{
    std::vector<Vec3> corners;
    for (int i = 0; i < 8; ++i) {
        corners.emplace_back((i & 1) != 0 ? 6.0F : 4.0F, (i & 2) != 0 ? 50.0F : -50.0F, (i & 4) != 0 ? 80.0F : 0.0F);
    }
    const oracle::HullObstacles hull({corners});
    scene.obstacles.push_back(hull.all()[0]);
    ASSERT_EQ(plan(), PlanStatus::found);
    EXPECT_NEAR(planner.last().margin, 4.0F - 1.41421356F * kHalfWidth, 1e-3F);
    scene.obstacles.clear();
    ASSERT_EQ(plan(), PlanStatus::found);
    EXPECT_TRUE(std::isinf(planner.last().margin));
}

// --- tracks ---

TEST_F(OrcaInput, ATrackIsMetWhereItIsWhenTheCommandActs)
{
    scene.own.velocity = Vec3(5, 0, 0);
    world::Track& track = scene.track(Vec3(40, 0, 30), Vec3::Zero());
    const float kept = 1.41421356F * (kHalfWidth + 1.0F);
    EXPECT_NEAR(nearest(), 39.5F / kept, 1e-3F);
    track.velocity = Vec3(-10, 0, 0);
    EXPECT_NEAR(nearest(), 38.5F / kept, 1e-3F);
    scene.rules.latency = 0.5F;
    EXPECT_NEAR(nearest(), 32.5F / kept, 1e-3F);
    EXPECT_EQ(planner.last().nearest_id, track.id);
}

/// Its sphere with all that is not known of it by the time that it is nearest.
TEST_F(OrcaInput, ATracksSphereGrowsUntilItIsNearest)
{
    const auto kept = [&](float x) { return x / nearest() / 1.41421356F - kHalfWidth; };
    scene.own.velocity = Vec3(5, 0, 0);
    scene.track(Vec3(30.5F, 0, 30), Vec3::Zero()).max_acceleration = 0.1F;
    EXPECT_NEAR(kept(30.0F), 1.0F + 0.05F * 6.1F * 6.1F, 1e-2F) << "6 s from when the command acts";
    scene.tracks[0].velocity = Vec3(4, 0, 0);
    EXPECT_NEAR(kept(30.4F), 1.0F + 0.05F * 8.1F * 8.1F, 1e-2F) << "no farther than the horizon";
    scene.tracks[0].velocity = Vec3(5, 0, 0);
    EXPECT_NEAR(kept(30.5F), 1.0F, 1e-2F) << "in formation";
    scene.tracks[0].velocity = Vec3(6, 0, 0);
    EXPECT_NEAR(kept(30.6F), 1.0F, 1e-2F) << "it goes away";
    scene.tracks[0].max_acceleration = 0.0F;
    scene.tracks[0].velocity = Vec3::Zero();
    scene.tracks[0].sigma_position = 0.2F;
    scene.tracks[0].sigma_velocity = 0.1F;
    scene.own.sigma_position = 0.3F;
    EXPECT_NEAR(kept(30.0F), 1.0F + 3.0F * (std::sqrt(0.13F) + 0.1F * 6.1F), 1e-2F);
}

/// The nearest point of a tall one's axis, about which its region is at most twice as high as wide.
TEST_F(OrcaInput, AnUncertainHeightMakesTheRegionTaller)
{
    world::Track& track = scene.track(Vec3(30, 0, 40), Vec3::Zero());
    const auto share = [](float level, float height, float half_height) {
        const float stretch = (kHalfWidth + 1.0F) / (1.0F + half_height);
        return std::hypot(level, stretch * height) / (1.41421356F * (kHalfWidth + 1.0F));
    };
    EXPECT_NEAR(nearest(), share(30, 10, 1.0F), 1e-3F);
    track.half_height = 0.5F;
    EXPECT_NEAR(nearest(), share(30, 9.5F, 1.5F), 1e-3F);
    track.half_height = 4.0F;
    EXPECT_NEAR(nearest(), share(30, 6, 1.0F / 0.505F), 1e-3F) << "twice as high as wide at most";
    track.half_height = 50.0F;
    EXPECT_NEAR(nearest(), share(30, 0, 1.0F / 0.505F), 1e-3F) << "at its height";
}

TEST_F(OrcaInput, OneThatStandsIsExpectedToComeAsFastAsWeDo)
{
    scene.own.velocity = Vec3(5, 0, 0);
    scene.track(Vec3(60, 0, 30), Vec3::Zero());
    EXPECT_TRUE(std::isfinite(nearest())) << "8 s at 5 m/s each are 80 m";
    scene.tracks[0].position.x() = 110.0F;
    EXPECT_FALSE(std::isfinite(nearest()));
    scene.tracks[0].velocity = Vec3(-12, 0, 0);
    EXPECT_TRUE(std::isfinite(nearest())) << "at its own speed where it is faster";
}

TEST_F(OrcaInput, HalfOfTheReactionIsLeftToFreshCooperativeTracksAlone)
{
    scene.own.velocity = Vec3(5, 0, 0);
    scene.own_id = 7;
    world::Track& track = scene.track(Vec3(40, 0.5F, 30), Vec3(-5, 0, 0));
    const float alone = command().y();
    track.cooperative = true;
    const float shared = command().y();
    ASSERT_GT(shared, 0.8F * alone);
    settings.stale = 0.25F;
    track.stamp = scene.now - 0.25F;
    const float old = command().y();
    track.stamp = scene.now - 0.251F;
    EXPECT_NEAR(command().y(), 2.0F * old, 1e-2F) << "all of the reaction";
    settings.stale = 1.0F;
    EXPECT_NEAR(command().y(), old, 1e-2F);
    track.stamp = scene.now - 1.0F;
    EXPECT_LT(command().y(), shared - 0.1F) << "seen a second ago: it may have turned since";
    track.stamp = scene.now + 1.0F;
    EXPECT_LT(command().y(), -0.01F) << "one from the future is avoided as well";
}

TEST_F(OrcaInput, ATrackThatIsNotANumberIsSaidAndTheOthersCount)
{
    scene.own.velocity = Vec3(5, 0, 0);
    scene.track(Vec3(kNotANumber, 0, 30), Vec3::Zero());
    scene.track(Vec3(40, 0.5F, 30), Vec3(-5, 0, 0));
    EXPECT_LT(command().y(), -0.1F);
    EXPECT_NE(planner.last().status & kNeighbourRefused, 0U);
    EXPECT_EQ(planner.last().nearest_id, 2U);
}

}  // namespace
}  // namespace jink::orca
