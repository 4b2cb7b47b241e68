// SPDX-License-Identifier: BSD-3-Clause
// The filter's header, sentence by sentence: effects of settings, refusals, and that no unfinished check counts as
// safe.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "core/orca/velocity_filter.hpp"
#include "tests/unit/core/orca/flown.hpp"

namespace jink::orca {
namespace {

using namespace flown;

/// A non-finite bound is refused before any timing, without other status.
TEST(VelocityFilterContract, EveryNumberOfABoundIsLookedAt)
{
    for (const float bad : {kNan, kInfinity, -kInfinity}) {
        for (int field = 0; field < 5; ++field) {
            for (const std::size_t place : {std::size_t{0}, std::size_t{2}}) {
                Flown flown({}, {1, 0, 0});
                flown.add_sphere({2.1F, 0, 0}, 1.0F);
                flown.bounds.assign(3, {Vec3::UnitZ(), 30.0F, 0.0F});
                flown.ticks(40);
                const Seconds stalled = flown.filter.stalled();
                ASSERT_GT(stalled, 0.1F);
                Bound& bound = flown.bounds[place];
                float* const places[] = {&bound.gap, &bound.speed, &bound.outward.x(), &bound.outward.y(),
                                         &bound.outward.z()};
                *places[field] = bad;
                EXPECT_EQ(flown.tick().status, kBadInput) << field << " " << bad;
                EXPECT_EQ(flown.filter.stalled(), stalled) << field << " " << bad;
            }
        }
    }
}

TEST(VelocityFilterContract, NewSettingsAreUsedAtOnce)
{
    Flown flown({}, {1, 0, 0});
    flown.neighbours = {other({3, 0, 0}, {1, 0, 0})};  // ahead, at the same speed
    EXPECT_NEAR(flown.tick().command.y(), -0.05F, 2e-3F) << "0.05 of the speed to the right";
    FilterSettings s;
    s.bias.sideways = 0.0F;
    ASSERT_EQ(flown.filter.configure(s), Unsafe::none);
    flown.tick();
    EXPECT_NEAR(flown.tick().command.y(), 0.0F, 2e-3F);
    EXPECT_EQ(flown.filter.settings().bias.sideways, 0.0F);
    // Sizes and the id are those of the new settings too.
    flown.neighbours = {other({0, 0, 0}, {1, 0, 0}, 5)};
    s.own_id = 9;
    ASSERT_EQ(flown.filter.configure(s), Unsafe::none);
    EXPECT_LT(flown.tick().command.z(), -0.01F);
    s.half_width = 1.2F;
    s.half_height = 0.6F;
    ASSERT_EQ(flown.filter.configure(s), Unsafe::none);
    flown.neighbours = {other({3, 0, 0}, {1, 0, 0}, 5)};
    EXPECT_NEAR(flown.tick().nearest, 3.0F / (0.7F * 1.8F), 1e-4F);
}

/// A mean of another length begins anew.
TEST(VelocityFilterContract, AnotherLengthOfTheMeanBeginsItAnew)
{
    FilterSettings s;
    s.smoothing = 4;
    Flown flown(s, {1, 0, 0});
    flown.ticks(10);
    s.smoothing = 3;
    ASSERT_EQ(flown.filter.configure(s), Unsafe::none);
    flown.input.preferred = Vec3::Zero();
    EXPECT_NEAR(flown.tick().command.x(), 0.95F, 1e-4F) << "its first command is the mean";
}

/// The solutions go on from each other, not from their mean: both would lag each other.
TEST(VelocityFilterContract, TheSolutionsAreNotDelayedByTheirMean)
{
    FilterSettings s;
    s.smoothing = 10;
    s.delay = 0.4F;
    Flown flown(s);
    flown.input.preferred = {1.4F, 0, 0};
    EXPECT_NEAR(flown.ticks(20).command.x(), 1.0F - 0.05F * 9.0F / 3.0F, 1e-4F) << "the ramp, three periods late";
}

/// Where nothing is smoothed nothing is not smoothed.
TEST(VelocityFilterContract, WithoutAMeanItIsNeverSaidToBeBroken)
{
    Flown flown({}, {1.5F, 0, 0});
    flown.add_sphere({2.6F, 0, 0}, 1.0F);
    const Decision decision = flown.tick();
    EXPECT_NE(decision.status & kRelaxedObstacle, 0U);
    EXPECT_EQ(decision.status & kNotSmoothed, 0U);
}

TEST(VelocityFilterContract, OfTwoPairsAsNearTheFirstIsSaid)
{
    for (const bool swapped : {false, true}) {
        Flown flown;
        flown.neighbours = {other({5, 0, 0}, Vec3::Zero(), swapped ? 8 : 7),
                            other({-5, 0, 0}, Vec3::Zero(), swapped ? 7 : 8)};
        EXPECT_EQ(flown.tick().nearest_id, 7U) << "ties go by id";
    }
}

/// Vehicles, spheres, a bound and a map: for every budget, an unfinished answer is reported, and a command is within
/// the limits (Flown checks each).
TEST(VelocityFilterContract, WhatIsNotFinishedIsSaid)
{
    for (const std::size_t smoothing : {std::size_t{1}, std::size_t{4}}) {
        const auto decided = [&](std::uint32_t units) {
            FilterSettings s;
            s.smoothing = smoothing;
            Flown flown(s, {1, 0, 0});
            flown.neighbours = {other({6, 3, 0}, {-0.5F, 0, 0}), other({0, -6, 0}, Vec3::Zero(), 8)};
            flown.obstacles.push_back({0, geometry::make_capsule({5, -1, -1}, {5, 1, 1}, 0.5F)});
            flown.obstacles.push_back({1, geometry::make_box({0, 0, 5}, {3, 3, 1})});
            flown.bounds = {{-Vec3::UnitZ(), 2.0F, 0.0F}};
            return flown.tick(units);
        };
        const Decision whole = decided(kPlenty);
        constexpr std::uint32_t kUnfinished = std::uint32_t{kWorkLimit} | kObstacleAhead | kNotSmoothed;
        ASSERT_EQ(whole.status & kUnfinished, 0U);
        for (std::uint32_t units = 0; units < whole.work; ++units) {
            const Decision some = decided(units);
            EXPECT_NE(some.status & kUnfinished, 0U) << units << " of " << whole.work;
            EXPECT_LE(some.work, units);
            EXPECT_LE(some.clear_until, whole.clear_until);
        }
        EXPECT_EQ(decided(whole.work).status, whole.status);
        EXPECT_EQ(decided(whole.work).command, whole.command);
    }
}

}  // namespace
}  // namespace jink::orca
