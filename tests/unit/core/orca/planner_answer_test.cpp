// SPDX-License-Identifier: BSD-3-Clause
// The answers of the ORCA planner: its horizons, refusals, budget, limits, and previous commands.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/unit/core/orca/orca_input.hpp"

namespace jink::orca {
namespace {

using test::OrcaInput;
using world::PlanStatus;
using world::test::Scene;

// --- the answer ---

TEST_F(OrcaInput, TheAnswerIsTheCommandAndTheFlightUnderIt)
{
    scene.own.velocity = Vec3(2, 0, 0);
    const Vec3 sent = command();
    EXPECT_EQ(out.kind, world::ManoeuvreKind::velocity);
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
    scene.rules.lookahead = 20.0F;
    EXPECT_FLOAT_EQ(horizon(), 20.0F);
    scene.rules.lookahead = 1.0F;
    EXPECT_FLOAT_EQ(horizon(), 2.0F) << "5 m/s at 5 m/s2, twice";
    scene.limits.max_acceleration = 1.0F;
    EXPECT_FLOAT_EQ(horizon(), 10.0F);
    scene.reference.speed = 8.0F;
    EXPECT_FLOAT_EQ(horizon(), 16.0F) << "a leg that is faster than the cruise";
    scene.limits.max_acceleration = 50.0F;
    scene.rules.latency = 1.0F;
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
    ends(&Settings::conflict_ratio, 0.5F, 0.95F);
    ends(&Settings::reach, 0.1F, 5.0F);
    ends(&Settings::stale, 0.01F, 60.0F);
    using Length = std::uint16_t;
    EXPECT_TRUE(takes(&Settings::smoothing, Length{1}) && takes(&Settings::smoothing, Length{CommandFilter::kMax}));
    EXPECT_FALSE(takes(&Settings::smoothing, Length{0}));
    EXPECT_FALSE(takes(&Settings::smoothing, Length{CommandFilter::kMax + 1}));
    Settings good;
    good.stale = 11.0F;
    EXPECT_TRUE(planner.configure(good));
    good.reach = 0.0F;
    good.stale = 12.0F;
    EXPECT_FALSE(planner.configure(good));
    EXPECT_EQ(planner.settings().stale, 11.0F);
}

// --- no answer ---

TEST_F(OrcaInput, WhatIsNotANumberIsNoAnswer)
{
    for (const float bad : {kNotANumber, std::numeric_limits<float>::infinity()}) {
        for (int field = 0; field < 5; ++field) {
            const Scene good = scene;
            float* const places[] = {&scene.own.position.x(), &scene.own.position.z(), &scene.own.velocity.y(),
                                     &scene.reference.speed, &scene.limits.max_acceleration};
            *places[field] = bad;
            planner = Planner(settings);
            EXPECT_NE(plan(), PlanStatus::found) << "field " << field << ", " << bad;
            EXPECT_TRUE(out.path.points.empty());
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
    EXPECT_TRUE(out.path.points.empty());
}

TEST_F(OrcaInput, ABudgetThatRunsOutIsNoAnswer)
{
    scene.track(Vec3(40, 0.5F, 30), Vec3(-5, 0, 0));
    scene.cylinder(world::Vec2(60, 0), 5.0F);
    ASSERT_EQ(plan(), PlanStatus::found);
    const std::uint32_t needed = spent;
    for (std::uint32_t units = 0; units < needed; ++units) {
        planner = Planner(settings);
        ASSERT_EQ(plan(units), PlanStatus::budget_spent) << units;
        ASSERT_TRUE(out.path.points.empty()) << units;
    }
    planner = Planner(settings);
    EXPECT_EQ(plan(needed), PlanStatus::found);
    // Each track and cylinder costs work units before its check.
    planner = Planner(settings);
    ASSERT_EQ(plan(45), PlanStatus::budget_spent);
    EXPECT_EQ(planner.last().status, 0U) << "no decision was made";
    EXPECT_EQ(spent, 45U);
}

// --- previous commands ---

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

/// The own vehicle's predicted position follows from the commands, not from the measurement alone.
TEST_F(OrcaInput, CommandsOnTheirWayMoveTheVehicle)
{
    scene.limits.velocity_lag = 0.0F;
    scene.rules.latency = 0.4F;
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

}  // namespace
}  // namespace jink::orca
