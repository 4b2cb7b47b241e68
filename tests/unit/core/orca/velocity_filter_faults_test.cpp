// SPDX-License-Identifier: BSD-3-Clause
// Faults: one status per cause, and always a command within the limits (G-ORCA specification, T7).
#include <gtest/gtest.h>

#include "core/orca/velocity_filter.hpp"

#include <array>
#include <cmath>
#include <vector>

#include "tests/unit/core/orca/flown.hpp"

namespace jink::orca {
namespace {

using namespace flown;

TEST(VelocityFilterFaults, MoreBoundsThanThereIsRoomForAreRefused)
{
    Flown flown({}, {1, 0, 0});
    flown.bounds.assign(kMaxBounds, {Vec3::UnitZ(), 30.0F, 0.0F});
    EXPECT_EQ(flown.tick().status, 0U);
    flown.bounds.emplace_back();
    const Decision decision = flown.tick();
    EXPECT_EQ(decision.status, kBadInput);
    expect_near(decision.command, {0.95F, 0, 0}, 1e-6F);
}

TEST(VelocityFilterFaults, ABoundWithoutADirectionIsRefusedAndBrakes)
{
    for (const Vec3& outward : {Vec3(0, 0, 0), Vec3(0, 0, 2), Vec3(1e-20F, 0, 0)}) {
        Flown flown({}, {1, 0, 0});
        flown.bounds = {{outward, 30.0F, 0.0F}};
        const Decision decision = flown.ticks(25);
        EXPECT_NE(decision.status & kBadInput, 0U);
        expect_near(decision.command, Vec3::Zero(), 1e-6F);
    }
}

TEST(VelocityFilterFaults, WhatIsNotFiniteBrakes)
{
    for (const float bad : {kNan, kInfinity, -kInfinity}) {
        for (int field = 0; field < 6; ++field) {
            Flown flown({}, {1, 0, 0});
            flown.tick();
            flown.bounds = {{Vec3::UnitZ(), 30.0F, 0.0F}};
            float* const places[] = {&flown.input.own.position.y(), &flown.input.own.velocity.z(),
                                     &flown.input.preferred.x(),    &flown.input.own_age,
                                     &flown.bounds[0].gap,          &flown.bounds[0].speed};
            *places[field] = bad;
            const Decision decision = flown.tick();
            EXPECT_NE(decision.status & kBadInput, 0U) << field;
            expect_near(decision.command, {0.95F, 0, 0}, 1e-6F);
        }
    }
    // Nothing was ever known.
    Flown flown;
    flown.input.own.velocity = {kNan, 0, 0};
    const Decision decision = flown.tick();
    EXPECT_EQ(decision.status, kBadInput);
    EXPECT_EQ(decision.command, Vec3::Zero());
}

/// Values whose squares or sums overflow: undecidable, so the filter brakes.
TEST(VelocityFilterFaults, AbsurdSizesBrake)
{
    for (int what = 0; what < 2; ++what) {
        Flown flown({}, {1, 0, 0});
        flown.tick();
        if (what == 0) {
            flown.input.preferred = {1e30F, 0, 0};
        } else {
            flown.bounds = {{Vec3::UnitZ(), 3e38F, 3e38F}};
        }
        const Decision decision = flown.tick();
        EXPECT_NE(decision.status & kBadInput, 0U) << what;
        expect_near(decision.command, {0.95F, 0, 0}, 1e-6F);
    }
}

TEST(VelocityFilterFaults, AnOwnStateThatIsTooOldBrakes)
{
    Flown flown({}, {1, 0, 0});
    flown.input.own_age = 0.2F;
    EXPECT_EQ(flown.tick().status, 0U);
    flown.input.own_age = 0.21F;
    const Decision decision = flown.ticks(10);
    EXPECT_EQ(decision.status, kOwnStale);
    expect_near(decision.command, {0.5F, 0, 0}, 1e-5F);
    expect_near(flown.ticks(20).command, Vec3::Zero(), 0.0F);
    flown.input.own_age = 0.0F;
    EXPECT_EQ(flown.tick().status, 0U);
}

/// Braking starts from the sent command, not from the unsmoothed command.
TEST(VelocityFilterFaults, BrakesFromWhatWasSentWhereItSmooths)
{
    FilterSettings settings;
    settings.smoothing = 10;
    settings.delay = 0.4F;
    Flown flown(settings);
    flown.input.preferred = {1, 0, 0};
    flown.ticks(12);
    flown.input.own_age = 1.0F;
    const Vec3 before = flown.last;
    const Decision decision = flown.tick();  // its slew is checked there
    expect_near(decision.command, before - Vec3(0.05F, 0, 0), 1e-5F);
}

TEST(VelocityFilterFaults, SettingsThatAreRefusedLeaveThoseBefore)
{
    VelocityFilter filter;
    FilterSettings bad;
    bad.pair.horizon = 0.5F;
    EXPECT_EQ(filter.configure(bad), Unsafe::horizon_brakes);
    EXPECT_EQ(filter.settings().pair.horizon, 10.0F);
    bad.accepts_unsafe = true;
    EXPECT_EQ(filter.configure(bad), Unsafe::none);
    EXPECT_EQ(filter.settings().pair.horizon, 0.5F);
}

TEST(VelocityFilterFaults, WithoutSettingsItBrakes)
{
    FilterSettings bad;
    bad.delay = 5.0F;
    Flown flown(bad, {1, 0, 0});
    const Decision decision = flown.ticks(5);
    EXPECT_EQ(decision.status, kConfigUnsafe);
    expect_near(decision.command, {0.75F, 0, 0}, 1e-5F);
    EXPECT_EQ(flown.filter.configure({}), Unsafe::none);
    EXPECT_EQ(flown.tick().status, 0U);
}

/// No number, nowhere, not even for studies.
TEST(VelocityFilterFaults, NumbersThatAreNoneAreRefused)
{
    for (const float bad : {kNan, kInfinity, -1.0F}) {
        for (int field = 0; field < 19; ++field) {
            FilterSettings s;
            s.accepts_unsafe = true;
            float* const places[] = {&s.half_width,
                                     &s.half_height,
                                     &s.cover,
                                     &s.stale,
                                     &s.loop.act,
                                     &s.loop.lag,
                                     &s.delay,
                                     &s.most_apart,
                                     &s.own_stale,
                                     &s.bias.near,
                                     &s.bias.sideways,
                                     &s.bias.vertical,
                                     &s.bias.stalled_below,
                                     &s.bias.stall,
                                     &s.bias.blocked,
                                     &s.pair.conflict_ratio,
                                     &s.pair.horizon,
                                     &s.obstacles.horizontal,
                                     &s.limits.max_speed};
            *places[field] = bad;
            VelocityFilter filter;
            EXPECT_EQ(filter.configure(s), Unsafe::not_positive) << "field " << field << ", " << bad;
        }
    }
    for (const std::size_t length : {std::size_t{0}, CommandFilter::kMax + 1}) {
        FilterSettings s;
        s.smoothing = length;
        VelocityFilter filter;
        EXPECT_EQ(filter.configure(s), Unsafe::not_positive) << length;
    }
}

TEST(VelocityFilterFaults, ANeighbourThatIsNotFiniteIsLeftOutAndSaid)
{
    Flown flown({}, {1, 0, 0});
    flown.neighbours = {other({kNan, 0, 0}, {0, 0, 0}), other({6, 0, 0}, {-1, 0, 0})};
    const Decision decision = flown.tick();
    EXPECT_NE(decision.status & kNeighbourRefused, 0U);
    ASSERT_FALSE(decision.bindings.empty());  // the other one counts
    EXPECT_EQ(decision.bindings[0].source, 1);
}

TEST(VelocityFilterFaults, OfAStaleNeighbourNothingIsExpected)
{
    const auto commanded = [](float age) {
        FilterSettings settings;
        settings.limits.acceleration = 20.0F;  // no bound within a tick
        Flown flown(settings, {1, 0, 0});
        flown.neighbours = {other({4, 0.5F, 0}, {0, 0, 0})};
        flown.neighbours[0].age = age;
        Decision decision = flown.tick();
        EXPECT_EQ((decision.status & kNeighbourStale) != 0, age > 1.0F);
        return (decision.command - flown.input.preferred).norm();
    };
    EXPECT_GT(commanded(1.01F), 1.5F * commanded(0.0F));
}

TEST(VelocityFilterFaults, CoincidentVehiclesPartUpAndDown)
{
    for (const std::uint32_t own : {1U, 9U}) {
        for (const Vec3& offset : {Vec3(0, 0, 0), Vec3(0, 0, 1e-20F), Vec3(0, 1e-25F, 0), Vec3(1e-15F, 0, 0)}) {
            FilterSettings settings;
            settings.own_id = own;
            Flown flown(settings);
            flown.input.preferred = {0.5F, 0.5F, 0.5F};
            flown.neighbours = {other(offset, {0, 0, 0}, 5)};
            const Decision decision = flown.ticks(40);
            EXPECT_NE(decision.status & kConflictOverlap, 0U);
            EXPECT_EQ(decision.status & kBadInput, 0U) << own << " " << offset.z();
            EXPECT_LT(decision.nearest, 1e-6F);
            EXPECT_GT(decision.command.z() * (own < 5 ? 1.0F : -1.0F), 0.1F) << own;
        }
    }
}

TEST(VelocityFilterFaults, WithinAnObstacleItLeavesByTheShortestWay)
{
    Flown flown;
    flown.add_sphere({0.3F, 0, 0}, 1.0F);
    const Decision decision = flown.ticks(40);
    EXPECT_NE(decision.status & kObstaclePenetration, 0U);
    EXPECT_NEAR(decision.margin, -0.7F - 1.1F, 0.3F);  // stretched
    EXPECT_LT(decision.command.x(), -0.25F);
    // A box from its middle, exactly.
    Flown boxed;
    boxed.obstacles.push_back({0, geometry::make_box(Vec3::Zero(), Vec3(2, 1, 3))});
    EXPECT_GT(std::fabs(boxed.ticks(40).command.y()), 0.25F);
}

TEST(VelocityFilterFaults, TheSeventeenthNeighbourCapsTheSpeed)
{
    Flown flown({}, {0, 0, 0});
    flown.input.preferred = {0, 0, 1};
    const auto ring = [](std::size_t count) {
        std::vector<Neighbour> out;
        for (std::size_t i = 0; i < count; ++i) {
            const float angle = 6.2831853F * static_cast<float>(i) / static_cast<float>(count);
            out.push_back(other({8 * std::cos(angle), 8 * std::sin(angle), 0}, {0, 0, 0}, 10 + std::uint32_t(i)));
        }
        return out;
    };
    flown.neighbours = ring(kMaxOrcaNeighbours);
    EXPECT_EQ(flown.ticks(40).status, 0U);
    flown.neighbours = ring(kMaxOrcaNeighbours + 1);
    const Decision first = flown.tick();  // it can not brake at once
    EXPECT_EQ(first.status, kNeighboursTruncated | kCapBroken);
    const Decision decision = flown.ticks(40);
    EXPECT_EQ(decision.status, kNeighboursTruncated);
    // 6.8 m of gap, heights twice as steep, each of the two half of it.
    EXPECT_NEAR(decision.command.norm(), 6.8F / (2.0F * 2.0F * 10.0F), 1e-3F);
}

TEST(VelocityFilterFaults, TheSeventeenthObstacleCapsTheSpeed)
{
    Flown flown;
    flown.input.preferred = {0, 0, 1};
    const auto ring = [&](std::size_t count) {
        flown.obstacles.clear();
        for (std::size_t i = 0; i < count; ++i) {
            const float angle = 6.2831853F * static_cast<float>(i) / static_cast<float>(count);
            flown.add_sphere({2 * std::cos(angle), 2 * std::sin(angle), 0}, 0.1F);
        }
    };
    ring(kMaxObstaclePlanes);
    EXPECT_EQ(flown.ticks(40).status & kObstaclesTruncated, 0U);
    ring(kMaxObstaclePlanes + 1);
    EXPECT_NE(flown.tick().status & kCapBroken, 0U);
    const Decision decision = flown.ticks(40);
    EXPECT_NE(decision.status & kObstaclesTruncated, 0U);
    EXPECT_LE(decision.command.norm(), (1.9F - 1.1F) / 2.4F);
}

/// T7's work limit of 10, and every other: the limit and the command's violations are reported.
TEST(VelocityFilterFaults, WorkThatIsNotDoneIsSaid)
{
    for (std::uint32_t units = 0; units < 400; ++units) {
        Flown flown({}, {1, 0, 0});
        flown.neighbours = {other({2, 0.1F, 0}, {-1, 0, 0}), other({0, 2, 0}, {1, -1, 0}, 8),
                            other({0, -2, 0.5F}, {1, 0.3F, 0}, 11)};
        flown.add_sphere({4, 0, 0}, 1.0F);
        flown.add_sphere({0, 0, 2.5F}, 1.0F);
        flown.bounds = {{-Vec3::UnitZ(), 2.0F, 0.0F}};
        const Decision decision = flown.tick(units);
        EXPECT_LE(decision.work, units);
        if (units <= 10) {
            EXPECT_NE(decision.status & kWorkLimit, 0U) << units;
        }
        const std::array<std::uint32_t, kLevels> said{kInfeasibleDynamics, kRelaxedObstacle, kRelaxedConflict,
                                                      kRelaxedWarning};
        for (std::size_t level = 0; level < kLevels; ++level) {
            EXPECT_EQ(decision.broken[level] > 1e-5F, (decision.status & said[level]) != 0) << units << " " << level;
            if (level < static_cast<std::size_t>(decision.level)) {
                EXPECT_LE(decision.broken[level], 1e-5F) << units;
            }
        }
    }
}

TEST(VelocityFilterFaults, ADelayThatIsNotCoveredIsSaid)
{
    Flown flown({}, {1, 0, 0});
    flown.input.own.clipped = true;
    EXPECT_EQ(flown.tick().status, kDelayClipped);
}

TEST(VelocityFilterFaults, CommandsThatWereSentTwiceOrAreNoNumbersAreNotRemembered)
{
    VelocityFilter filter;
    EXPECT_TRUE(filter.issued({10}, {1, 0, 0}));
    EXPECT_FALSE(filter.issued({10}, {1, 0, 0}));
    EXPECT_FALSE(filter.issued({5}, {1, 0, 0}));
    EXPECT_FALSE(filter.issued({20}, {kNan, 0, 0}));
    EXPECT_TRUE(filter.issued({20}, {1, 0, 0}));
}

}  // namespace
}  // namespace jink::orca
