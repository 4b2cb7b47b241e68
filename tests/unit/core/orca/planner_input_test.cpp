// SPDX-License-Identifier: BSD-3-Clause
// What the ORCA planner makes of a situation: bounds, obstacles and tracks where they are when the command acts, each
// with all that is not known of it; and what its answer holds.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "core/orca/planner.hpp"
#include "tests/oracle/map_of_hulls.hpp"
#include "tests/unit/core/world/scene.hpp"

namespace jink::orca {
namespace {

using world::PlanStatus;
using world::test::Scene;

/// A vehicle that stands at (0, 0, 30) and means to fly to the east at 5 m/s. Its box is 2 m wide: its cylinder has a
/// half width of 1.414 m and a half height of 1 m.
class OrcaInput : public ::testing::Test {
protected:
    static constexpr float kHalfWidth = 1.41421356F;
    static constexpr float kNotANumber = std::numeric_limits<float>::quiet_NaN();

    OrcaInput()
    {
        scene.own.position = Vec3(0, 0, 30);
        scene.own.stamp = scene.now;
        towards(Vec3(1, 0, 0));
    }
    void towards(const Vec3& direction, float speed = 5.0F)
    {
        scene.leg(scene.own.position, scene.own.position + 300.0F * direction, speed);
    }
    PlanStatus plan(std::uint32_t units = world::test::kPlenty)
    {
        WorkBudget budget(units);
        out = {};
        const PlanStatus status = planner.plan(scene.situation(), budget, out);
        spent = budget.spent();
        return status;
    }
    /// The first command of a vehicle that has not been planned for.
    Vec3 command()
    {
        planner = Planner(settings);
        EXPECT_EQ(plan(), PlanStatus::found);
        return out.command;
    }
    /// Least distance of a pair, over what is kept in its conflict region: sqrt(2) of both half widths.
    float nearest()
    {
        static_cast<void>(command());
        return planner.last().nearest;
    }
    void step(Seconds dt)
    {
        scene.now = scene.now + dt;
        scene.own.stamp = scene.now;
    }

    Settings settings;
    Planner planner;
    Scene scene;
    world::Manoeuvre out;
    std::uint32_t spent = 0;
};

// --- the answer ---

TEST_F(OrcaInput, TheAnswerIsTheCommandAndTheFlightUnderIt)
{
    scene.own.velocity = Vec3(2, 0, 0);
    const Vec3 sent = command();
    EXPECT_EQ(out.kind, world::ManoeuvreKind::velocity);
    EXPECT_EQ(out.by, world::MethodId::orca);
    EXPECT_EQ(out.start, scene.now);
    EXPECT_NEAR(out.valid_until - scene.now, 8.0F, 1e-5F);
    EXPECT_EQ(out.side, Vec3::Zero());
    EXPECT_EQ(out.cost, 0.0F);
    EXPECT_NEAR(out.path.duration(), 8.0F, 1e-4F);
    vehicle::VehicleState flown = scene.own;
    for (const path::PathPoint& point : out.path.points) {
        vehicle::VehicleState at = scene.own;
        if (point.time > 0.0F) {
            vehicle::advance(at, sent, scene.limits, point.time);
        }
        EXPECT_LT((point.position - at.position).norm(), 1e-3F) << point.time;
        EXPECT_LE(point.time - (flown.stamp - scene.now), 0.2F + 8.0F / static_cast<float>(kMaxPathPoints - 2));
        flown.stamp = scene.now + point.time;
    }
}

/// Horizons are as long as braking and the delay need at least.
TEST_F(OrcaInput, HorizonsAreAsLongAsBrakingAndTheDelayNeed)
{
    const auto horizon = [&] {
        static_cast<void>(command());
        EXPECT_NEAR(planner.last().horizon, out.valid_until - out.start, 1e-4F);
        return planner.last().horizon;
    };
    settings.horizon = 20.0F;
    EXPECT_FLOAT_EQ(horizon(), 20.0F);
    settings.horizon = 1.0F;
    EXPECT_FLOAT_EQ(horizon(), 2.0F) << "5 m/s at 5 m/s2, twice";
    scene.limits.max_acceleration = 1.0F;
    EXPECT_FLOAT_EQ(horizon(), 10.0F);
    scene.reference.leg.speed = 8.0F;
    EXPECT_FLOAT_EQ(horizon(), 16.0F) << "a leg that is faster than the cruise";
    scene.limits.max_acceleration = 50.0F;
    settings.latency = 1.0F;
    EXPECT_FLOAT_EQ(horizon(), 2.72F * 1.25F) << "latency and lag";
    settings.smoothing = 11;
    EXPECT_NEAR(horizon(), 2.72F * (1.25F + 10.0F / 3.0F * 0.02F), 1e-4F) << "and the mean of commands 20 ms apart";
}

TEST_F(OrcaInput, EveryEndOfTheSettingsIsTakenAndNothingBeyond)
{
    const auto takes = [&](auto Settings::*member, auto value) {
        Settings changed;
        changed.*member = value;
        return is_valid(changed);
    };
    const auto ends = [&](float Settings::*member, float low, float high) {
        EXPECT_TRUE(takes(member, low) && takes(member, high)) << low;
        EXPECT_FALSE(takes(member, std::nextafter(low, -1.0F)) || takes(member, std::nextafter(high, 100.0F))) << low;
        EXPECT_FALSE(takes(member, kNotANumber)) << low;
    };
    ends(&Settings::horizon, 1.0F, 60.0F);
    ends(&Settings::conflict_ratio, 0.5F, 0.95F);
    ends(&Settings::latency, 0.0F, 1.0F);
    ends(&Settings::reach, 0.1F, 5.0F);
    ends(&Settings::stale, 0.01F, 60.0F);
    using Length = std::uint16_t;
    EXPECT_TRUE(takes(&Settings::smoothing, Length{1}) && takes(&Settings::smoothing, Length{CommandFilter::kMost}));
    EXPECT_FALSE(takes(&Settings::smoothing, Length{0}));
    EXPECT_FALSE(takes(&Settings::smoothing, Length{CommandFilter::kMost + 1}));
    Settings good;
    good.horizon = 11.0F;
    EXPECT_TRUE(planner.configure(good));
    good.reach = 0.0F;
    good.horizon = 12.0F;
    EXPECT_FALSE(planner.configure(good));
    EXPECT_EQ(planner.settings().horizon, 11.0F);
}

// --- no answer ---

TEST_F(OrcaInput, WhatIsNotANumberIsNoAnswer)
{
    for (const float bad : {kNotANumber, std::numeric_limits<float>::infinity()}) {
        for (int field = 0; field < 5; ++field) {
            const Scene good = scene;
            float* const places[] = {&scene.own.position.x(), &scene.own.position.z(), &scene.own.velocity.y(),
                                     &scene.reference.leg.speed, &scene.limits.max_acceleration};
            *places[field] = bad;
            planner = Planner(settings);
            EXPECT_NE(plan(), PlanStatus::found) << "field " << field << ", " << bad;
            EXPECT_EQ(out.by, world::MethodId::none);
            scene = good;
        }
    }
    EXPECT_EQ(plan(), PlanStatus::found);
    scene.limits.max_acceleration = 0.0F;
    EXPECT_EQ(plan(), PlanStatus::bad_input) << "a vehicle that can not be stopped";
}

TEST_F(OrcaInput, AnOwnStateOfHalfASecondIsUsedAndNoOlderOne)
{
    scene.own.stamp = scene.now - 0.5F;
    EXPECT_EQ(plan(), PlanStatus::found);
    scene.own.stamp = scene.now - 0.51F;
    EXPECT_EQ(plan(), PlanStatus::none_available);
    EXPECT_NE(planner.last().status & kOwnStale, 0U);
    EXPECT_EQ(out.by, world::MethodId::none);
}

TEST_F(OrcaInput, ABudgetThatRunsOutIsNoAnswer)
{
    scene.track(Vec3(40, 0.5F, 30), Vec3(-5, 0, 0));
    scene.barrel(world::Vec2(60, 0), 5.0F);
    ASSERT_EQ(plan(), PlanStatus::found);
    const std::uint32_t needed = spent;
    for (std::uint32_t units = 0; units < needed; ++units) {
        planner = Planner(settings);
        ASSERT_EQ(plan(units), PlanStatus::budget_spent) << units;
        ASSERT_EQ(out.by, world::MethodId::none) << units;
    }
    planner = Planner(settings);
    EXPECT_EQ(plan(needed), PlanStatus::found);
    // Each track and barrel is paid for before it is looked at.
    planner = Planner(settings);
    ASSERT_EQ(plan(45), PlanStatus::budget_spent);
    EXPECT_EQ(planner.last().status, 0U) << "no decision was made";
    EXPECT_EQ(spent, 45U);
}

// --- what was flown before ---

TEST_F(OrcaInput, WhatWasSentSinceTheLastPlanIsFlownFirst)
{
    world::Commanded sent;
    scene.commanded = &sent;
    const auto is_known = [&] {
        EXPECT_EQ(plan(), PlanStatus::found);
        return (planner.last().status & kDelayClipped) == 0;
    };
    sent = {Vec3::Zero(), scene.now - 0.2F};
    EXPECT_FALSE(is_known()) << "before there was a plan it says nothing";
    step(0.1F);
    sent.at = scene.now - 0.2F;
    EXPECT_TRUE(is_known());
    step(0.5F);
    sent.at = scene.now - 0.2F;
    EXPECT_TRUE(is_known()) << "half a second is no pause";
    step(0.51F);
    sent.at = scene.now - 0.2F;
    EXPECT_FALSE(is_known()) << "after a pause nothing is known";
    step(0.1F);
    sent.at = scene.now - 0.2F;
    EXPECT_TRUE(is_known());
    step(0.1F);
    scene.commanded = nullptr;
    EXPECT_FALSE(is_known()) << "somebody else flies";
    step(0.1F);
    scene.commanded = &sent;
    sent.at = scene.now - 0.2F;
    EXPECT_TRUE(is_known());
    planner.reset();
    step(0.1F);
    sent.at = scene.now - 0.2F;
    EXPECT_FALSE(is_known());
}

/// Where the own vehicle will be is what the commands make of it, not what was measured.
TEST_F(OrcaInput, CommandsOnTheirWayMoveTheVehicle)
{
    scene.limits.velocity_lag = 0.0F;
    settings.latency = 0.4F;
    planner = Planner(settings);
    scene.track(Vec3(0, 60, 30), Vec3::Zero());
    world::Commanded sent{Vec3(0, 4, 0), scene.now - 0.3F};
    scene.commanded = &sent;
    ASSERT_EQ(plan(), PlanStatus::found);
    const float before = planner.last().nearest;
    step(0.1F);
    ASSERT_EQ(plan(), PlanStatus::found);
    // It was sent 0.4 s ago and acts from now on: 0.4 s at 4 m/s by the time that a new one does.
    EXPECT_NEAR(before - planner.last().nearest, 1.6F / (kHalfWidth * (kHalfWidth + 1.0F)), 1e-3F);
}

/// Plans at the same instant are no time in which the vehicle is blocked.
TEST_F(OrcaInput, PlansAtTheSameInstantTakeNoTime)
{
    for (int i = 0; i < 300; ++i) {
        ASSERT_EQ(plan(), PlanStatus::found) << i;
        ASSERT_EQ(planner.last().status & kBlocked, 0U);
    }
}

/// A command that is not flown is not gone on from.
TEST_F(OrcaInput, WhoDoesNotFlyWhatWasPlannedIsPlannedForAnew)
{
    world::Commanded sent;
    scene.commanded = &sent;
    scene.own.velocity = Vec3(5, 0, 0);
    const auto resynchronised = [&](float speed) {
        scene.own.velocity = Vec3(5, 0, 0);
        planner = Planner(settings);
        EXPECT_EQ(plan(), PlanStatus::found);
        step(0.1F);
        sent = {out.command, scene.now};
        scene.own.velocity = Vec3(speed, 0, 0);
        EXPECT_EQ(plan(), PlanStatus::found);
        return (planner.last().status & kResynchronised) != 0;
    };
    EXPECT_FALSE(resynchronised(2.1F)) << "5 m/s was sent; half of the top speed and 0.5 m/s are let pass";
    EXPECT_TRUE(resynchronised(1.9F));
}

// --- limits ---

TEST_F(OrcaInput, CommandsKeepToWhatTheVehicleCanDo)
{
    EXPECT_NEAR(command().x(), 2.5F, 1e-3F) << "5 m/s2 for half a second";
    settings.reach = 0.2F;
    EXPECT_NEAR(command().x(), 1.0F, 1e-3F);
    settings.reach = 0.5F;
    scene.own.velocity = Vec3(5, 0, 0);
    EXPECT_NEAR(command().x(), 5.0F, 1e-3F);
    towards(Vec3(1, 0, 0), 7.0F);
    EXPECT_NEAR(command().x(), 7.0F, 1e-3F) << "a leg may be faster than the cruise";
    scene.own.velocity = Vec3::Zero();
    scene.limits.max_vertical_acceleration = 1.0F;
    towards(Vec3(0, 0, 1));
    EXPECT_NEAR(command().z(), 0.5F, 1e-3F);
    towards(Vec3(0, 0, -1));
    EXPECT_NEAR(command().z(), -0.5F, 1e-3F);
}

TEST_F(OrcaInput, RatesOfClimbAndDescentAreNeverExceeded)
{
    // In the margin of both bounds in turn: it returns at 0.3 m/s where it may.
    scene.airspace.has_floor = true;
    scene.airspace.floor = 31.0F;
    EXPECT_NEAR(command().z(), 0.3F, 1e-3F);
    scene.limits.max_climb = 0.2F;
    EXPECT_NEAR(command().z(), 0.2F, 1e-3F);
    scene.airspace.has_floor = false;
    scene.airspace.has_ceiling = true;
    scene.airspace.ceiling = 29.0F;
    EXPECT_NEAR(command().z(), -0.3F, 1e-3F);
    scene.limits.max_descent = 0.1F;
    EXPECT_NEAR(command().z(), -0.1F, 1e-3F);
}

TEST_F(OrcaInput, AWingKeepsItsSpeedAndItsTurn)
{
    scene.limits.kind = vehicle::VehicleKind::fixed_wing;
    scene.own.velocity = Vec3(4.5F, 0, 0);
    towards(Vec3(0, 1, 0));
    const Vec3 turned = command();
    // Its circle has a radius of 5 m: in half a second it turns by 2.25 m of that.
    EXPECT_NEAR(std::atan2(turned.y(), turned.x()), 0.45F, 5e-3F);
    EXPECT_GE(turned.norm(), 4.49F);
    scene.own.velocity = Vec3(5, 0, 0);
    // Its end is no place to stop.
    scene.leg(Vec3(-100, 0, 30), Vec3(1, 0, 30), 5.0F);
    EXPECT_NEAR((command() - Vec3(5, 0, 0)).norm(), 0.0F, 1e-3F);
    // A wall ahead: no slower than 0.9 of the cruise.
    scene.obstacle(geometry::make_box(Vec3(8, 0, 30), Vec3(1, 50, 50)));
    EXPECT_GE(command().norm(), 4.49F);
    scene.limits.kind = vehicle::VehicleKind::multirotor;
    EXPECT_LT(command().norm(), 4.4F);
}

// --- bounds ---

TEST_F(OrcaInput, TheFloorIsKeptFromTheBottomOfTheCylinder)
{
    scene.airspace.has_floor = true;
    towards(Vec3(0, 0, -1), 2.0F);
    scene.airspace.floor = 30.0F - 1.0F - 0.4F;
    EXPECT_NEAR(command().z(), -0.4F, 1e-3F) << "met in a second";
    scene.own.sigma_position = 0.1F;
    EXPECT_NEAR(command().z(), -0.1F, 1e-3F) << "three standard deviations of the own place";
    scene.k_sigma = 2.0F;
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

TEST_F(OrcaInput, ABarrelIsKeptFromItsNearestSide)
{
    scene.barrel(world::Vec2(10.0F + kHalfWidth + 1.2F, 0), 10.0F).top = 60.0F;
    EXPECT_NEAR(command().x(), 1.2F, 1e-3F);
    scene.own.sigma_position = 0.1F;
    EXPECT_NEAR(command().x(), 0.9F, 1e-3F);
    scene.own.sigma_position = 0.0F;
    scene.barrels[0].velocity = world::Vec2(-0.5F, 0);
    EXPECT_NEAR(command().x(), 1.2F - 0.05F - 0.5F, 1e-3F) << "it comes nearer, and has when the command acts";
    scene.barrels[0].velocity = world::Vec2(0.5F, 3.0F);
    EXPECT_GT(command().x(), 1.2F + 0.04F) << "it goes away";
    // Above it: down to its top.
    scene.barrels[0] = {{world::Vec2(3, 0), 10.0F}, world::Vec2(0, 0), 0.0F, 30.0F - 1.0F - 0.5F, 0.0F};
    towards(Vec3(0, 0, -1), 2.0F);
    EXPECT_NEAR(command().z(), -0.5F, 1e-3F);
    // Below it: up to its bottom.
    scene.barrels[0] = {{world::Vec2(3, 0), 10.0F}, world::Vec2(0, 0), 30.0F + 1.0F + 0.6F, 100.0F, 0.0F};
    towards(Vec3(0, 0, 1), 2.0F);
    EXPECT_NEAR(command().z(), 0.6F, 1e-3F);
    // The side that is farther off counts: beside it by 2 m and above it by 0.5 m.
    scene.barrels[0] = {{world::Vec2(10.0F + kHalfWidth + 2.0F, 0), 10.0F}, world::Vec2(0, 0), 0.0F, 28.5F, 0.0F};
    towards(Vec3(0.6F, 0, -0.8F), 2.0F);
    EXPECT_NEAR(command().z(), -1.5F, 2e-3F) << "down is free but for its acceleration";
    EXPECT_LE(command().x(), 2.0F);
    // In its axis it is left to any side.
    scene.barrels[0] = {{world::Vec2(0, 0), 10.0F}, world::Vec2(0, 0), 0.0F, 60.0F, 0.0F};
    towards(Vec3(1, 0, 0));
    EXPECT_NEAR(command().x(), -0.3F, 1e-3F);
    EXPECT_NE(planner.last().status & kBoundsOverlap, 0U);
}

/// Bounds come before barrels; of these the nearest are taken, whatever their order.
TEST_F(OrcaInput, OfManyBarrelsTheNearestAreTaken)
{
    scene.airspace.has_floor = scene.airspace.has_ceiling = scene.airspace.has_keep_in = true;
    scene.airspace.floor = -500.0F;
    scene.airspace.ceiling = 500.0F;
    scene.airspace.home = Vec3(1, 0, 0);
    scene.airspace.keep_in_radius = 5000.0F;
    for (int near = 0; near < 8; ++near) {
        scene.barrels.clear();
        for (int i = 0; i < 8; ++i) {
            const float x = i == near ? 10.0F + kHalfWidth + 1.0F : 300.0F + 30.0F * static_cast<float>((5 * i) % 8);
            scene.barrel(world::Vec2(x, 0), 10.0F).top = 60.0F;
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

TEST_F(OrcaInput, AMapOfPiecesIsAnObstacleToo)
{
    std::vector<Vec3> corners;
    for (int i = 0; i < 8; ++i) {
        corners.emplace_back((i & 1) != 0 ? 6.0F : 4.0F, (i & 2) != 0 ? 50.0F : -50.0F, (i & 4) != 0 ? 80.0F : 0.0F);
    }
    const oracle::MapOfHulls map({corners});
    planner.use_map(&map.map());
    ASSERT_EQ(plan(), PlanStatus::found);
    EXPECT_NEAR(planner.last().margin, 4.0F - 1.41421356F * kHalfWidth, 1e-3F);
    planner.use_map(nullptr);
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
    settings.latency = 0.5F;
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
    EXPECT_NEAR(kept(30.0F), 1.0F + 3.0F * (0.2F + 0.3F + 0.1F * 6.1F), 1e-2F);
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
    track.stamp = scene.now - 1.0F;
    EXPECT_NEAR(command().y(), shared, 1e-3F) << "seen a second ago";
    track.stamp = scene.now - 1.001F;
    EXPECT_NEAR(command().y(), alone, 1e-2F);
    settings.stale = 2.0F;
    EXPECT_NEAR(command().y(), shared, 1e-3F);
    settings.stale = 1.0F;
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
