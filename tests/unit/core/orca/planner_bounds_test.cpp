// SPDX-License-Identifier: BSD-3-Clause
// Of many cylinders the nearest ones, tracks that fly off, time between plans, and long horizons of the ORCA planner.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "tests/unit/core/orca/orca_input.hpp"

namespace jink::orca {
namespace {

using test::OrcaInput;
using world::PlanStatus;

/// Seven cylinders about it at gaps from 1.0 m to 1.6 m, and capacity for five beside the airspace's own bounds: the
/// nearest five are kept, in any order.
TEST_F(OrcaInput, TheNearestCylindersAreKeptInWhicheverOrderTheyCome)
{
    scene.airspace.has_floor = scene.airspace.has_ceiling = scene.airspace.has_keep_in = true;
    scene.airspace.floor = -500.0F;
    scene.airspace.ceiling = 500.0F;
    scene.airspace.home = Vec3(1, 0, 0);
    scene.airspace.keep_in_radius = 5000.0F;
    const auto direction = [](int k) {
        const float angle = 2.0F * kPi * static_cast<float>(k) / 7.0F;
        return Vec3(std::cos(angle), std::sin(angle), 0.0F);
    };
    const auto gap = [](int k) { return 1.0F + 0.1F * static_cast<float>(k); };
    const std::vector<std::vector<int>> orders{{0, 1, 2, 3, 4, 5, 6}, {6, 5, 4, 3, 2, 1, 0}, {3, 6, 0, 5, 1, 4, 2},
                                               {5, 6, 4, 3, 0, 2, 1}, {2, 4, 1, 5, 0, 6, 3}, {0, 6, 1, 5, 2, 4, 3}};
    for (const std::vector<int>& order : orders) {
        scene.cylinders.clear();
        for (const int k : order) {
            const Vec3 centre = (10.0F + kHalfWidth + gap(k)) * direction(k);
            scene.cylinder(world::Vec2(centre.x(), centre.y()), 10.0F).top = 60.0F;
        }
        for (int k = 0; k < 7; ++k) {
            towards(direction(k));
            const float along = command().dot(direction(k));
            if (k < 5) {
                EXPECT_NEAR(along, gap(k), 2e-3F) << k;
            } else {
                EXPECT_GT(along, gap(k) + 0.05F) << k << " is left to the final check";
            }
        }
    }
}

/// A receding track is nearest now: its uncertainty has grown since the measurement, and does not shrink.
TEST_F(OrcaInput, OneThatFliesOffIsAsUncertainAsItIsNow)
{
    scene.own.velocity = Vec3(5, 0, 0);
    world::Track& track = scene.track(Vec3(30, 0, 30), Vec3(8, 0, 0));
    track.stamp = scene.now - 2.0F;
    track.sigma_velocity = 0.2F;
    track.max_acceleration = 0.1F;
    // Position and velocity are the present ones; the measurement is 2.1 s old when the command acts.
    const float radius = 1.0F + 3.0F * 0.2F * 2.1F + 0.05F * 2.1F * 2.1F;
    const float distance = 30.0F + 0.8F - 0.5F;
    EXPECT_NEAR(nearest(), distance / (1.41421356F * (kHalfWidth + radius)), 2e-3F);
}

/// Plans at the same instant are timed by next to nothing, also where the commands are known and nothing is forgotten.
TEST_F(OrcaInput, PlansAtTheSameInstantDoNotBlock)
{
    scene.airspace.has_keep_in = true;  // no path ahead
    scene.airspace.home = Vec3(-100, 0, 0);
    scene.airspace.keep_in_radius = 100.0F + kHalfWidth;
    world::Commanded sent{Vec3::Zero(), scene.now};
    scene.commanded = &sent;
    for (int i = 0; i < 300; ++i) {
        ASSERT_EQ(plan(), PlanStatus::found) << i;
        ASSERT_EQ(planner.last().status & kBlocked, 0U) << i;
    }
}

/// The flight is predicted to the end of any horizon, in pieces of 0.2 s as far as the capacity permits.
TEST_F(OrcaInput, ThePathReachesTheEndOfTheHorizon)
{
    scene.own.velocity = Vec3(5, 0, 0);
    for (const float horizon : {8.0F, 20.0F, 60.0F}) {
        scene.rules.lookahead = horizon;
        static_cast<void>(command());
        EXPECT_NEAR(out.path.duration(), horizon, 1e-3F);
        EXPECT_NEAR(out.path.points.back().position.x(), 5.0F * horizon, 1e-2F);
    }
    scene.rules.lookahead = 8.0F;
    static_cast<void>(command());
    EXPECT_LE(out.path.points.size(), 44U) << "40 pieces, and the first few periods";
}

/// A wing's reference ends, but it flies on at its speed; a multirotor ends there.
TEST_F(OrcaInput, OnlyWhatCanStopSlowsDownBeforeTheEnd)
{
    scene.own.velocity = Vec3(5, 0, 0);
    scene.leg(Vec3(-100, 0, 30), Vec3(3, 0, 30), 5.0F);
    EXPECT_NEAR(command().x(), 3.0F, 1e-3F);
    scene.limits.kind = vehicle::VehicleKind::fixed_wing;
    EXPECT_NEAR(command().x(), 5.0F, 1e-3F);
}

/// Shared tracks are left half of the reaction only while they are fresh, at the instant of the plan and not of the
/// command.
TEST_F(OrcaInput, OfOldTracksNothingIsExpected)
{
    settings.stale = 0.5F;
    scene.rules.latency = 1.0F;
    scene.own.velocity = Vec3(5, 0, 0);
    world::Track& track = scene.track(Vec3(60, 0.5F, 30), Vec3(-5, 0, 0));
    const float alone = command().y();
    track.cooperative = true;
    track.stamp = scene.now - 0.5F;
    const float shared = command().y();
    EXPECT_GT(shared, alone + 0.05F) << "half a second old, as it may be";
    track.stamp = scene.now - 0.51F;
    EXPECT_LT(command().y(), alone - 0.05F) << "all of the reaction, and what it may have turned since";
}

/// Each plan is of its own situation: tracks, cylinders and obstacles of the one before are gone.
TEST_F(OrcaInput, NothingOfTheSituationBeforeIsLeft)
{
    ASSERT_EQ(plan(), PlanStatus::found);
    const Vec3 free = out.command;
    scene.track(Vec3(4, 0, 30), Vec3::Zero());
    scene.cylinder(world::Vec2(0, 14), 10.0F).top = 60.0F;
    scene.obstacle(geometry::make_box(Vec3(5, -3, 30), Vec3(1, 1, 9)));
    scene.airspace.has_floor = true;
    scene.airspace.floor = 29.5F;
    ASSERT_EQ(plan(), PlanStatus::found);
    EXPECT_GT((out.command - free).norm(), 0.5F);
    EXPECT_TRUE(std::isfinite(planner.last().nearest) && std::isfinite(planner.last().margin));
    scene.tracks.clear();
    scene.cylinders.clear();
    scene.obstacles.clear();
    scene.airspace = {};
    planner.reset();
    ASSERT_EQ(plan(), PlanStatus::found);
    EXPECT_EQ(out.command, free);
    EXPECT_TRUE(std::isinf(planner.last().nearest) && std::isinf(planner.last().margin));
    EXPECT_EQ(planner.last().status, planner.last().status & kDelayClipped);
}

/// The answer is fully written over any old contents; without an answer nothing is written.
TEST_F(OrcaInput, TheAnswerReplacesWhatWasInItsPlace)
{
    const auto planned = [&](world::Manoeuvre& place, std::uint32_t units) {
        planner = Planner(settings);
        WorkBudget budget(units);
        return planner.plan(scene.situation(), budget, place);
    };
    world::Manoeuvre clean;
    ASSERT_EQ(planned(clean, world::test::kPlenty), PlanStatus::found);
    world::Manoeuvre used;
    used.kind = world::ManoeuvreKind::brake;
    used.side = Vec3(1, 2, 3);
    used.cost = 7.0F;
    used.command = Vec3(9, 9, 9);
    used.path = world::test::flight({Vec3(1, 1, 1), Vec3(2, 2, 2), Vec3(3, 3, 3)}, 1.0F);
    world::Manoeuvre kept = used;
    ASSERT_EQ(planned(kept, 30), PlanStatus::budget_spent);
    EXPECT_EQ(kept.kind, used.kind);
    EXPECT_EQ(kept.command, used.command);
    EXPECT_EQ(kept.path.points.size(), 3U);
    ASSERT_EQ(planned(used, world::test::kPlenty), PlanStatus::found);
    EXPECT_EQ(used.kind, world::ManoeuvreKind::velocity);
    EXPECT_EQ(used.side, Vec3::Zero());
    EXPECT_EQ(used.cost, 0.0F);
    EXPECT_EQ(used.command, clean.command);
    ASSERT_EQ(used.path.points.size(), clean.path.points.size());
    EXPECT_EQ(used.path.points.front().position, clean.path.points.front().position);
    EXPECT_EQ(used.path.points.back().position, clean.path.points.back().position);
}

/// One neighbour too many caps the speed, but not below what the vehicle can fly next: a wing's least speed, the climb
/// that it cannot leave at once.
TEST_F(OrcaInput, ACapOfTheSpeedLeavesWhatCanBeFlown)
{
    const auto ring = [&](int n, float radius) {
        scene.tracks.clear();
        for (int i = 0; i < n; ++i) {
            const float angle = 2.0F * kPi * static_cast<float>(i) / static_cast<float>(n);
            const Vec3 at = scene.own.position + radius * Vec3(std::cos(angle), std::sin(angle), 0.0F);
            world::Track& track = scene.track(at, scene.own.velocity);
            track.id = static_cast<world::TrackId>(100 + i);
            track.cooperative = true;
        }
    };
    scene.own.velocity = Vec3(0, 0, 3);
    towards(Vec3(0, 0, 1), 3.0F);
    for (const int n : {16, 17, 24}) {
        for (const float radius : {5.0F, 6.0F, 10.0F}) {
            ring(n, radius);
            EXPECT_GT(command().z(), 0.0F) << n << " " << radius;
        }
    }
    scene.limits.kind = vehicle::VehicleKind::fixed_wing;
    scene.limits.cruise_speed = 15.0F;
    scene.limits.max_acceleration = 5.0F;
    scene.own.velocity = Vec3(15, 0, 0);
    towards(Vec3(1, 0, 0), 15.0F);
    for (const int n : {16, 17, 24}) {
        for (const float radius : {80.0F, 100.0F, 120.0F}) {
            ring(n, radius);
            EXPECT_GE(command().norm(), 0.9F * 15.0F - 1e-3F) << n << " " << radius;
        }
    }
}

/// Down at a floor with weak vertical acceleration: braking takes longer than level.
TEST_F(OrcaInput, AFloorIsBrakedForWithTheVerticalAcceleration)
{
    constexpr Seconds kTick = 0.02F;
    for (const float acceleration : {3.0F, 1.0F, 0.5F}) {
        scene.limits.max_vertical_acceleration = acceleration;
        scene.airspace.has_floor = true;
        scene.airspace.floor = 4.5F;
        scene.own.position = Vec3(0, 0, 40);
        scene.own.velocity = Vec3(0, 0, -3);
        scene.leg(Vec3(0, 0, 60), Vec3(0, 0, -100), 5.0F);
        planner = Planner(settings);
        float lowest = 1e9F;
        for (int k = 0; k < 2000; ++k) {
            static_cast<void>(plan());
            vehicle::advance(scene.own, out.command, scene.limits, kTick);
            step(kTick);
            lowest = std::min(lowest, scene.own.position.z() - scene.limits.half_extents.z());
        }
        EXPECT_GE(lowest, scene.airspace.floor - 0.02F) << acceleration;
        EXPECT_LT(lowest, scene.airspace.floor + 3.0F) << acceleration << ": it does come down";
    }
}

}  // namespace
}  // namespace jink::orca
