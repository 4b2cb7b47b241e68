// SPDX-License-Identifier: BSD-3-Clause
// The filter's tick: the identity without near threats, active constraints of a command, and its status.
#include <gtest/gtest.h>

#include "core/orca/velocity_filter.hpp"

#include <array>
#include <cmath>
#include <vector>

#include "tests/unit/core/orca/flown.hpp"

namespace jink::orca {
namespace {

using namespace flown;

TEST(VelocityFilter, IsTheIdentityWhereNothingIsNear)
{
    Flown flown({}, {0.5F, -0.25F, 0.125F});
    flown.neighbours = {other({70, 0, 0}, {-1, 0, 0})};
    flown.add_sphere({0, 0, 20}, 1.0F);
    flown.bounds = {{Vec3::UnitZ(), 30.0F, 0.0F}};
    const Decision decision = flown.tick();
    EXPECT_EQ(decision.command, flown.input.preferred);
    EXPECT_EQ(decision.status, 0U);
    EXPECT_TRUE(decision.bindings.empty());
    EXPECT_TRUE(std::isinf(decision.nearest));
    EXPECT_TRUE(std::isinf(decision.margin));
    EXPECT_EQ(decision.horizon, flown.filter.settings().pair.horizon);
    EXPECT_EQ(decision.clear_until, flown.filter.settings().obstacles.horizon);
    EXPECT_GT(decision.work, 0U);
}

TEST(VelocityFilter, ReachesThePreferredVelocityAsFastAsItMay)
{
    Flown flown;
    flown.input.preferred = {1, 0, 0};
    expect_near(flown.tick().command, {0.05F, 0, 0}, 1e-6F);  // 2 m/s2 for 25 ms
    expect_near(flown.ticks(19).command, {1, 0, 0}, 1e-5F);
    EXPECT_EQ(flown.tick().status, 0U);
    // Faster than it can: its top speed.
    flown.input.preferred = {100, 0, 0};
    expect_near(flown.ticks(20).command, {1.5F, 0, 0}, 1e-5F);
}

TEST(VelocityFilter, SaysWhoHoldsTheCommand)
{
    Flown flown({}, {1, 0, 0});
    flown.neighbours = {other({60, 0, 0}, {0, 0, 0}, 3), other({6, 0.1F, 0}, {-1, 0, 0}, 9)};
    const Decision decision = flown.tick();
    ASSERT_FALSE(decision.bindings.empty());
    for (const Binding& binding : decision.bindings) {
        EXPECT_GE(binding.level, Level::conflict);
        EXPECT_EQ(binding.source, 1);
    }
    EXPECT_EQ(decision.nearest_id, 9U);
    EXPECT_NEAR(decision.nearest, std::hypot(6.0F, 0.1F) / (0.7F * 1.2F), 1e-4F);
    EXPECT_NE(decision.command, flown.input.preferred);
}

TEST(VelocityFilter, StopsBeforeABound)
{
    Flown flown({}, {0, 0, 0.5F});
    float gap = 3.0F;
    for (int i = 0; i < 2000; ++i) {
        flown.bounds = {{Vec3::UnitZ(), gap, 0.0F}};
        const Decision decision = flown.tick();
        ASSERT_EQ(decision.status & ~std::uint32_t{kBlocked}, 0U) << i;
        gap -= 0.025F * decision.command.z();
        ASSERT_GE(gap, 0.0F) << i;
    }
    EXPECT_LT(gap, 0.01F);
    // One that comes nearer pushes.
    flown.bounds = {{Vec3::UnitZ(), 0.0F, -0.3F}};
    const Decision pushed = flown.ticks(30);
    EXPECT_NEAR(pushed.command.z(), -0.3F, 1e-5F);
    ASSERT_EQ(pushed.bindings.size(), 1U);
    EXPECT_EQ(pushed.bindings[0].source, kBoundSource);
    EXPECT_EQ(pushed.bindings[0].level, Level::obstacles);
}

TEST(VelocityFilter, BeyondABoundItReturns)
{
    Flown flown;
    flown.bounds = {{Vec3::UnitX(), -1.0F, 0.0F}};
    const Decision decision = flown.ticks(40);
    EXPECT_NE(decision.status & kBoundsOverlap, 0U);
    expect_near(decision.command, {-0.3F, 0, 0}, 1e-5F);
}

TEST(VelocityFilter, TooNearToStopIsSaidAndBrakes)
{
    Flown flown({}, {1.5F, 0, 0});
    flown.add_sphere({2.6F, 0, 0}, 1.0F);  // 0.5 m of margin
    const Decision decision = flown.tick();
    EXPECT_NE(decision.status & kRelaxedObstacle, 0U);
    EXPECT_NE(decision.status & kObstacleAhead, 0U);
    EXPECT_EQ(decision.level, Level::obstacles);
    // 1.45 m/s, where 0.5 m in 2.4 s are left.
    EXPECT_NEAR(decision.broken[1], 1.45F - 0.5F / 2.4F, 1e-3F);
    EXPECT_LT(decision.clear_until, 0.5F / 1.4F);
    expect_near(decision.command, {1.45F, 0, 0}, 1e-3F);
}

TEST(VelocityFilter, WhoDoesNotFlyItsCommandsIsFollowed)
{
    Flown flown({}, {1, 0, 0});
    flown.tick();
    flown.input.own.velocity = {-0.5F, 0, 0};
    flown.last = {-0.5F, 0, 0};
    const Decision decision = flown.tick();
    EXPECT_EQ(decision.status, kResynchronised);
    expect_near(decision.command, {-0.45F, 0, 0}, 1e-5F);
    // Within the stated tolerance the commands are used.
    flown.input.own.velocity = {0.5F, 0, 0};
    EXPECT_EQ(flown.tick().status, 0U);
    // Nothing is expected after a reset.
    flown.filter.reset();
    flown.input.own.velocity = {-1.4F, 0, 0};
    flown.last = {-1.4F, 0, 0};
    EXPECT_EQ(flown.tick().status, 0U);
}

TEST(VelocityFilter, BlockedIsSaidAfterItsTime)
{
    Flown flown;
    flown.input.preferred = {1, 0, 0};
    flown.add_sphere({2.1F, 0, 0}, 1.0F);  // at its margin, straight ahead
    for (int i = 0; i < 400; ++i) {
        const Decision decision = flown.tick();
        ASSERT_EQ((decision.status & kBlocked) != 0, flown.filter.stalled() > 5.0F) << i;
    }
    EXPECT_GT(flown.filter.stalled(), 5.0F);
    flown.filter.reset();
    EXPECT_EQ(flown.filter.stalled(), 0.0F);
}

TEST(VelocityFilter, AWingThatHoversIsStalled)
{
    FilterSettings settings;
    settings.limits.max_speed = 20.0F;
    settings.limits.min_speed = 10.0F;
    settings.limits.acceleration = 10.0F;
    settings.half_width = 20.0F;
    settings.half_height = 10.0F;
    VelocityFilter filter;
    ASSERT_EQ(filter.configure(settings), Unsafe::none);
    FilterInput input;
    input.preferred = {15, 0, 0};
    WorkBudget budget(kPlenty);
    EXPECT_EQ(filter.decide(input, budget).status, kStalled);
    filter.reset();
    input.own.velocity = {15, 0, 0};
    EXPECT_EQ(filter.decide(input, budget).status, 0U);
}

/// Commands that were not flown carry no information and do not enter the mean.
TEST(VelocityFilter, WhoDoesNotFlyItsCommandsIsFollowedWhereItSmooths)
{
    FilterSettings settings;
    settings.smoothing = 10;
    settings.delay = 0.4F;
    Flown flown(settings, {1, 0, 0});
    flown.ticks(20);
    flown.input.own.velocity = flown.last = {-0.5F, 0, 0};
    const Decision decision = flown.tick();
    EXPECT_EQ(decision.status, kResynchronised);
    expect_near(decision.command, {-0.45F, 0, 0}, 1e-5F);
}

/// If the mean cannot be corrected within its slew, the newest command is sent unchanged, and this is reported.
TEST(VelocityFilter, WhereTheMeanBreaksAHalfSpaceTheNewestCommandIsSent)
{
    FilterSettings settings;
    settings.smoothing = 10;
    settings.delay = 0.4F;
    Flown flown(settings, {1, 0, 0});
    flown.ticks(20);
    flown.input.preferred = Vec3::Zero();
    const Vec3 before = flown.ticks(12).command;
    ASSERT_GT(before.x(), 0.5F);  // the newest is at 0.4 m/s
    flown.input.bounds = flown.bounds = {{Vec3::UnitX(), 0.4F * 2.4F, 0.0F}};
    WorkBudget budget(kPlenty);
    const Decision decision = flown.filter.decide(flown.input, budget);
    EXPECT_EQ(decision.status, kNotSmoothed);
    expect_near(decision.command, {0.35F, 0, 0}, 1e-3F);
}

/// A cap applies to the sent mean, not to the averaged commands.
TEST(VelocityFilter, SmoothedCommandsKeepToACap)
{
    FilterSettings settings;
    settings.smoothing = 10;
    settings.delay = 0.4F;
    Flown flown(settings, {0, 0, 1});
    flown.ticks(20);
    for (std::uint32_t i = 0; i < kMaxOrcaNeighbours + 1; ++i) {
        const float angle = 6.2831853F * static_cast<float>(i) / static_cast<float>(kMaxOrcaNeighbours + 1);
        flown.neighbours.push_back(other({8 * std::cos(angle), 8 * std::sin(angle), 0}, Vec3::Zero(), i + 1));
    }
    for (int i = 1; i <= 10; ++i) {
        EXPECT_NEAR(flown.tick().command.norm(), 1.0F - 0.0495F * static_cast<float>(i), 1e-3F) << i;
    }
}

/// Conflict regions that overlap: the preferred velocity gives time, by the share of the distance that is left.
TEST(VelocityFilter, SlowsDownWhereConflictRegionsOverlap)
{
    for (const bool slows : {true, false}) {
        FilterSettings settings;
        settings.slows_down = slows;
        Flown flown(settings);
        flown.input.preferred = {1, 0, 0};
        flown.neighbours = {other({0, 0.5F * 0.84F, 0}, Vec3::Zero())};
        const Decision decision = flown.ticks(60);
        EXPECT_NE(decision.status & kConflictOverlap, 0U);
        EXPECT_NEAR(decision.nearest, 0.5F, 1e-5F);
        EXPECT_NEAR(decision.command.x(), slows ? 0.5F : 1.0F, 1e-3F);
        EXPECT_LT(decision.command.y(), -0.1F);  // away from it, at its own speed
    }
}

/// The mean is corrected by the hard constraints; if impossible, the newest command is used.
TEST(VelocityFilter, SmoothedCommandsKeepToObstacles)
{
    FilterSettings settings;
    settings.smoothing = 10;
    settings.delay = 0.4F;
    Flown flown(settings, {1, 0, 0});
    flown.ticks(20);
    float gap = 3.0F;
    std::uint32_t said = 0;
    for (int i = 0; i < 400; ++i) {
        flown.bounds = {{Vec3::UnitX(), gap, 0.0F}};
        const Decision decision = flown.tick();
        said |= decision.status;
        ASSERT_LE(decision.command.x(), gap / 2.4F + 2e-4F) << i;
        gap -= 0.025F * decision.command.x();
    }
    EXPECT_EQ(said & ~std::uint32_t{kBlocked}, 0U);
}

}  // namespace
}  // namespace jink::orca
