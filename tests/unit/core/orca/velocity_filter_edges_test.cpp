// SPDX-License-Identifier: BSD-3-Clause
// The filter's settings at their limits, its memory and resets, and the meaning of each status of a decision.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "core/orca/velocity_filter.hpp"
#include "tests/unit/core/orca/flown.hpp"

namespace jink::orca {
namespace {

using namespace flown;

TEST(VelocityFilterEdges, SettingsAtTheirEndsAreTaken)
{
    const auto takes = [](auto change) {
        FilterSettings s;
        change(s);
        VelocityFilter filter;
        return filter.configure(s) == Unsafe::none;
    };
    EXPECT_TRUE(takes([](FilterSettings& s) { s.cover = 1.0F; }));
    EXPECT_TRUE(takes([](FilterSettings& s) { s.cover = kLargestCover; }));
    EXPECT_FALSE(takes([](FilterSettings& s) { s.cover = 0.999F; }));
    EXPECT_FALSE(takes([](FilterSettings& s) { s.cover = 3.001F; }));
    EXPECT_TRUE(takes([](FilterSettings& s) { s.smoothing = CommandFilter::kMax; }));
    EXPECT_TRUE(takes([](FilterSettings& s) { s.tick = 0.0F; }));
    EXPECT_FALSE(takes([](FilterSettings& s) { s.tick = -0.1F; }));
    EXPECT_FALSE(takes([](FilterSettings& s) { s.tick = kNan; }));
    EXPECT_TRUE(takes([](FilterSettings& s) { s.stale = 0.0F; }));
    for (float FilterSettings::*member : {&FilterSettings::half_width, &FilterSettings::half_height,
                                          &FilterSettings::most_apart, &FilterSettings::own_stale}) {
        EXPECT_FALSE(takes([&](FilterSettings& s) { s.*member = 0.0F; }));
    }
    EXPECT_TRUE(takes([](FilterSettings& s) { s.loop = {0.0F, 0.0F}; }));
    for (float BiasSettings::*member :
         {&BiasSettings::sideways, &BiasSettings::vertical, &BiasSettings::stalled_below, &BiasSettings::stall}) {
        EXPECT_TRUE(takes([&](FilterSettings& s) { s.bias.*member = 0.0F; }));
    }
    EXPECT_FALSE(takes([](FilterSettings& s) { s.bias.near = 0.0F; }));
    EXPECT_FALSE(takes([](FilterSettings& s) { s.bias.blocked = 0.0F; }));
}

/// The check is for a pair of two equal vehicles, with the cover: twice both halves.
TEST(VelocityFilterEdges, TheCheckIsOfAPairLikeItself)
{
    VelocityFilter filter;
    FilterSettings s;
    s.half_height = 0.14F;  // more than four times as wide as high
    EXPECT_EQ(filter.configure(s), Unsafe::stretch);
    s = {};
    s.obstacles.horizon = 0.7F;
    EXPECT_EQ(filter.configure(s), Unsafe::obstacle_horizon_brakes);
    s = {};
    s.delay = 1.0F;  // e of it are more than the 2.4 s of obstacles
    EXPECT_EQ(filter.configure(s), Unsafe::obstacle_horizon_delay);
    s.delay = 0.52F;
    EXPECT_NE(filter.configure(s), Unsafe::none) << "e of it are more than the recovery time";
    s = {};
    s.half_width = 0.55F;  // the ramp would grow too fast within 0.3 of 1.1 m
    s.half_height = 0.3F;
    EXPECT_EQ(filter.configure(s), Unsafe::ramp_gain);
    s.cover = 1.1F;
    EXPECT_EQ(filter.configure(s), Unsafe::none);
    // Studies may choose any value except non-finite ones.
    s.cover = 1.0F;
    s.accepts_unsafe = true;
    EXPECT_EQ(filter.configure(s), Unsafe::none);
    s.limits.max_speed = -1.0F;
    EXPECT_EQ(filter.configure(s), Unsafe::not_positive);
}

/// A change of settings keeps timing and smoothing state; a change of the mean's length restarts the mean.
TEST(VelocityFilterEdges, SettingsThatChangeKeepWhatIsRemembered)
{
    FilterSettings s;
    s.smoothing = 4;
    Flown flown(s, {1, 0, 0});
    flown.ticks(10);
    flown.input.preferred = Vec3::Zero();
    const Vec3 one = flown.tick().command;
    EXPECT_NEAR(one.x(), 1.0F - 0.4F * 0.05F, 1e-4F) << "4 of 10 parts are the newest, 0.05 m/s slower";
    ASSERT_EQ(flown.filter.configure(s), Unsafe::none);
    EXPECT_NEAR(flown.tick().command.x(), 1.0F - 0.4F * 0.1F - 0.3F * 0.05F, 1e-4F) << "the mean goes on";
}

TEST(VelocityFilterEdges, AResetForgetsEverything)
{
    for (const std::size_t smoothing : {std::size_t{1}, std::size_t{4}}) {
        FilterSettings s;
        s.smoothing = smoothing;
        Flown flown(s, {1, 0, 0});
        flown.ticks(10);
        flown.filter.reset();
        flown.input.own.velocity = flown.last = flown.input.preferred = {0.2F, 0.4F, 0};
        const Decision first = flown.tick();
        EXPECT_EQ(first.status, 0U) << "no command that is not flown";
        expect_near(first.command, {0.2F, 0.4F, 0}, 1e-5F);
        // The sent command is forgotten as well: the measured velocity is used.
        flown.filter.reset();
        vehicle::VehicleState measured;
        measured.stamp = flown.now - 0.1F;
        measured.velocity = {0.5F, 0, 0};
        EXPECT_TRUE(flown.filter.predicted(measured, flown.now).clipped);
    }
    // It slowed down for a neighbour that is not there any more.
    Flown slow({}, {0.2F, 0, 0});
    slow.neighbours = {other({0, 0.3F, 0}, Vec3::Zero())};
    slow.ticks(60);
    slow.neighbours.clear();
    slow.filter.reset();
    slow.input.own.velocity = slow.last = slow.input.preferred;
    expect_near(slow.tick().command, slow.input.preferred, 1e-5F);
}

TEST(VelocityFilterEdges, APredictionIsOfWhenTheCommandBeginsToAct)
{
    FilterSettings s;
    s.loop = {0.4F, 0.0F};
    VelocityFilter filter(s);
    ASSERT_TRUE(filter.issued({1'000'000}, {1, 0, 0}));
    ASSERT_TRUE(filter.issued({1'500'000}, {0, 2, 0}));
    vehicle::VehicleState measured;
    measured.stamp = {1'600'000};
    // At 2 s: the first acts from 1.4 s to 1.9 s, the second from then on.
    const Predicted there = filter.predicted(measured, {1'600'000});
    expect_near(there.position, {0.3F, 0.2F, 0}, 1e-5F);
    expect_near(there.velocity, {0, 2, 0}, 1e-6F);
    EXPECT_FALSE(there.clipped);
}

/// Braking starts from the sent command, without one from the present velocity, and ends at rest.
TEST(VelocityFilterEdges, BrakingTakesWhatOnePeriodAllows)
{
    Flown flown({}, {0.6F, 0.8F, 0});
    flown.input.own_age = 1.0F;
    expect_near(flown.tick().command, 0.95F * Vec3(0.6F, 0.8F, 0), 1e-6F);
    expect_near(flown.tick().command, 0.90F * Vec3(0.6F, 0.8F, 0), 1e-6F);
    Flown nearly({}, {0.05F, 0, 0});
    nearly.input.own_age = 1.0F;
    EXPECT_EQ(nearly.tick().command, Vec3::Zero()) << "just what it can";
    // A command of another sender meanwhile: braking starts from it.
    VelocityFilter filter;
    FilterInput input;
    input.own.velocity = input.preferred = {1, 0, 0};
    WorkBudget budget(kPlenty);
    static_cast<void>(filter.decide(input, budget));
    ASSERT_TRUE(filter.issued({5}, {0, 0.5F, 0}));
    input.own_age = 1.0F;
    expect_near(filter.decide(input, budget).command, {0, 0.45F, 0}, 1e-6F);
    // Faster than it may be: within its limits at once.
    VelocityFilter hurried;
    FilterInput fast;
    fast.own.velocity = {5, 0, 0};
    fast.own_age = 1.0F;
    expect_near(hurried.decide(fast, budget).command, {1.5F, 0, 0}, 1e-5F);
}

TEST(VelocityFilterEdges, EveryBoundIsSaidByItsPlace)
{
    Flown flown({}, {0, 0.2F, 0});
    flown.input.preferred = {0, 1, 0};
    flown.bounds = {{Vec3::UnitZ(), 30.0F, 0.0F}, {Vec3::UnitX(), 30.0F, 0.0F}, {Vec3::UnitY(), 0.48F, 0.0F}};
    const Decision decision = flown.tick();
    ASSERT_EQ(decision.bindings.size(), 1U);
    EXPECT_EQ(decision.bindings[0].source, kBoundSource + 2);
    EXPECT_EQ(decision.bindings[0].level, Level::obstacles);
    EXPECT_NEAR(decision.command.y(), 0.2F, 1e-5F);
    EXPECT_EQ(decision.status & kBoundsOverlap, 0U);
    flown.bounds[2].gap = 0.0F;
    EXPECT_EQ(flown.tick().status & kBoundsOverlap, 0U) << "at the bound";
    flown.bounds[2].gap = -0.15F;
    const Decision beyond_it = flown.ticks(30);
    EXPECT_NE(beyond_it.status & kBoundsOverlap, 0U);
    EXPECT_NEAR(beyond_it.command.y(), -0.15F, 1e-4F) << "in a second, where that is slower than the recovery";
}

/// A moving bound: the closing velocity is relative to the bound's own motion.
TEST(VelocityFilterEdges, ABoundThatGoesAwayIsFollowed)
{
    Flown flown({}, {0.5F, 0, 0});
    flown.input.preferred = {1, 0, 0};
    flown.bounds = {{Vec3::UnitX(), 0.24F, 0.6F}};
    EXPECT_NEAR(flown.ticks(20).command.x(), 0.1F + 0.6F, 1e-4F);
}

TEST(VelocityFilterEdges, TheNearestPairAndObstacleAreSaid)
{
    Flown flown;
    flown.neighbours = {other({5, 0, 0}, Vec3::Zero(), 1), other({0, 3, 0}, Vec3::Zero(), 2),
                        other({0, 0, 4}, Vec3::Zero(), 3)};
    flown.add_sphere({0, -2.25F, 0}, 1.0F);
    flown.add_sphere({-2.2F, 0, 0}, 1.0F);
    const Decision decision = flown.tick();
    EXPECT_EQ(decision.nearest_id, 2U);
    EXPECT_NEAR(decision.nearest, 3.0F / (0.7F * 1.2F), 1e-4F);
    EXPECT_EQ(decision.nearest_obstacle, 1);
    EXPECT_NEAR(decision.margin, 1.2F - 1.1F, 1e-3F);
    EXPECT_EQ(decision.status & (kConflictOverlap | kObstaclePenetration), 0U);
}

/// Obstacles that no command within this period's acceleration could approach are not checked.
TEST(VelocityFilterEdges, ObstaclesAreLookedAtAsFarAsTheSpeedAllows)
{
    const auto seen = [](float speed, float surface) {
        Flown flown({}, {0, speed, 0});
        flown.add_sphere({surface + 1.0F, 0, 0}, 1.0F);
        return std::isfinite(flown.tick().margin);
    };
    // 1.1 m, and 2.4 s at 0.05 m/s, heights stretched by 1.375.
    EXPECT_TRUE(seen(0.0F, 1.2F));
    EXPECT_FALSE(seen(0.0F, 1.3F));
    EXPECT_TRUE(seen(1.5F, 6.0F)) << "1.5 m/s";
    EXPECT_FALSE(seen(1.5F, 6.1F)) << "and no faster than that";
}

/// The conflict region of those that are left out, within the time of braking, where vehicles rest.
TEST(VelocityFilterEdges, AtRestTheCapIsThatOfTheConflictRegion)
{
    FilterSettings s;
    s.pair.conflict = Conflict::at_rest;
    s.pair.brake = 1.5F;
    Flown flown(s);
    flown.input.preferred = {0, 0, 1.4F};
    for (std::uint32_t i = 0; i < kMaxOrcaNeighbours + 1; ++i) {
        const float angle = 6.2831853F * static_cast<float>(i) / static_cast<float>(kMaxOrcaNeighbours + 1);
        flown.neighbours.push_back(other({8 * std::cos(angle), 8 * std::sin(angle), 0}, Vec3::Zero(), i + 1));
    }
    // 8 m less 0.7 of 1.2 m in 1.5 s, heights twice as steep, less its own 1.5 m/s.
    EXPECT_NEAR(flown.ticks(60).command.norm(), (8.0F - 0.84F) / (1.5F * 2.0F) - 1.5F, 2e-3F);
}

TEST(VelocityFilterEdges, AtTheRimOfTheConflictRegionNothingOverlaps)
{
    FilterSettings s;
    s.pair.conflict_ratio = 0.5F;
    Flown flown(s);
    flown.neighbours = {other({0.6F, 0, 0}, Vec3::Zero())};
    const Decision decision = flown.tick();
    EXPECT_EQ(decision.nearest, 1.0F);
    EXPECT_EQ(decision.status & kConflictOverlap, 0U);
}

TEST(VelocityFilterEdges, LookingAlongIsLeftOutWhereItIsNotAskedFor)
{
    FilterSettings s;
    s.looks_along = false;
    Flown flown(s, {1.5F, 0, 0});
    flown.add_sphere({2.6F, 0, 0}, 1.0F);
    const Decision decision = flown.tick();
    EXPECT_EQ(decision.status & kObstacleAhead, 0U);
    EXPECT_EQ(decision.clear_until, 0.0F);
}

/// Unusable input changes no timing, and gives its own status.
TEST(VelocityFilterEdges, WhatIsNotANumberIsNotTimed)
{
    Flown flown;
    flown.input.preferred = {1, 0, 0};
    flown.add_sphere({2.1F, 0, 0}, 1.0F);
    flown.ticks(40);
    const Seconds stalled = flown.filter.stalled();
    ASSERT_GT(stalled, 0.5F);
    const FilterInput good = flown.input;
    for (int field = 0; field < 4; ++field) {
        flown.input = good;
        float* const places[] = {&flown.input.preferred.y(), &flown.input.own.velocity.x(),
                                 &flown.input.own.position.z(), &flown.input.own_age};
        *places[field] = kNan;
        EXPECT_EQ(flown.tick().status, kBadInput) << field;
        EXPECT_EQ(flown.filter.stalled(), stalled) << field;
    }
    Flown never;
    never.input.own.velocity = {kInfinity, 0, 0};
    EXPECT_EQ(never.tick().command, Vec3::Zero());
}

/// After commands that were not flown the mean restarts.
TEST(VelocityFilterEdges, TheMeanBeginsAnewWhereTheCommandsWereNotFlown)
{
    FilterSettings s;
    s.smoothing = 10;
    s.delay = 0.4F;
    Flown flown(s, {1, 0, 0});
    flown.ticks(20);
    flown.input.own.velocity = flown.last = {-0.5F, 0, 0};
    ASSERT_EQ(flown.tick().status, kResynchronised);
    EXPECT_NEAR(flown.tick().command.x(), (-0.45F - 2.0F * 0.40F) / 3.0F, 1e-4F);
}

/// Without a sent command, braking continues from the last solution.
TEST(VelocityFilterEdges, BrakingGoesOnFromTheSolutionWhereNothingWasSent)
{
    VelocityFilter filter;
    FilterInput input;
    input.own.velocity = input.preferred = {1, 0, 0};
    WorkBudget budget(kPlenty);
    expect_near(filter.decide(input, budget).command, {1, 0, 0}, 1e-6F);
    input.own_age = 1.0F;
    expect_near(filter.decide(input, budget).command, {0.95F, 0, 0}, 1e-6F);
}

/// Timed by the tick where one is given, not by the period of the acceleration.
TEST(VelocityFilterEdges, StallsAreTimedByTheTick)
{
    FilterSettings s;
    s.tick = 0.1F;
    Flown flown(s);
    flown.input.preferred = {1, 0, 0};
    flown.add_sphere({2.1F, 0, 0}, 1.0F);
    flown.ticks(20);
    EXPECT_NEAR(flown.filter.stalled(), 2.0F, 0.11F);
}

TEST(VelocityFilterEdges, TheWorkIsWhatThisDecisionTook)
{
    Flown flown({}, {1, 0, 0});
    flown.neighbours = {other({6, 0.1F, 0}, {-1, 0, 0}, 9)};
    flown.input.neighbours = flown.neighbours;
    WorkBudget budget(kPlenty);
    ASSERT_TRUE(budget.spend(1000));
    const Decision decision = flown.filter.decide(flown.input, budget);
    EXPECT_EQ(decision.work, budget.spent() - 1000U);
    EXPECT_LT(decision.work, 1000U);
}

}  // namespace
}  // namespace jink::orca
