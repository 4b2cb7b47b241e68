// SPDX-License-Identifier: BSD-3-Clause
// Half-spaces of a pair: the check vectors of the G-ORCA specification, section 17, and its degenerate cases.
#include "core/orca/agent_plane.hpp"

#include <array>
#include <cmath>

#include <gtest/gtest.h>

namespace jink::orca {
namespace {

constexpr float kExact = 2e-6F;  // of figures that are given with six digits

void expect_near(const Vec3& a, const Vec3& b, float tolerance = kExact)
{
    EXPECT_NEAR(a.x(), b.x(), tolerance);
    EXPECT_NEAR(a.y(), b.y(), tolerance);
    EXPECT_NEAR(a.z(), b.z(), tolerance);
}

struct Check {
    Vec3 p, v;
    float radius, horizon;
    Vec3 normal, change;
};

TEST(OrcaCheckVectors, AgentPlanes)
{
    const std::array<Check, 9> checks{{
        {{10, 0, 0}, {0.5F, 0, 0}, 1, 10, {-1, 0, 0}, {0.4F, 0, 0}},
        {{10, 0, 0}, {2, 0, 0}, 1, 10, {-0.1F, -0.994987F, 0}, {-0.02F, -0.198997F, 0}},
        {{10, 0, 0}, {2, 0.1F, 0}, 1, 10, {-0.1F, 0.994987F, 0}, {-0.010050F, 0.099997F, 0}},
        {{10, 0, 0}, {2, 0, -0.1F}, 1, 10, {-0.1F, 0, -0.994987F}, {-0.010050F, 0, -0.099997F}},
        {{3, 4, 0}, {1, 0, 0}, 1.2F, 5, {0.447214F, -0.894427F, 0}, {-0.292669F, 0.585337F, 0}},
        {{3, 4, 1},
         {0.6F, 0.9F, 0.1F},
         1.2F,
         5,
         {-0.400068F, 0.222329F, -0.889109F},
         {-0.051551F, 0.028648F, -0.114567F}},
        {{0, 0, 5}, {0, 0, 2}, 1, 10, {0, 0.979796F, -0.2F}, {0, 0.391918F, -0.08F}},
        {{10, 0, 0}, {-1, 0, 0}, 1, 10, {-1, 0, 0}, {1.9F, 0, 0}},
        {{2, 0, 0}, {0.5F, 0.3F, 0}, 1.2F, 10, {-0.6F, 0.8F, 0}, {-0.036F, 0.048F, 0}},
    }};
    for (std::size_t i = 0; i < checks.size(); ++i) {
        SCOPED_TRACE(i);
        const Check& c = checks[i];
        const Exit exit = nearest_exit(c.p, c.v, c.radius, c.horizon);
        expect_near(exit.normal, c.normal);
        expect_near(exit.depth * exit.normal, c.change);
    }
}

TEST(OrcaCheckVectors, EllipsoidPair)
{
    Pair pair;
    pair.position = {4, 0.5F, 0.3F};
    pair.own_velocity = {0.6F, 0.05F, 0};
    pair.other_velocity = pair.own_velocity - Vec3(1.2F, 0.1F, -0.05F);
    pair.across = 1.0F;
    pair.upright = 0.64F;
    PairSettings settings;
    settings.horizon = 5.0F;
    const HalfSpace plane = pair_plane(pair, settings);
    expect_near(plane.normal, {-0.070329F, -0.151146F, -0.986006F});
    EXPECT_NEAR(plane.offset, -0.024650F, kExact);
    EXPECT_NEAR(plane.normal.dot(Vec3(0.595855F, 0.041093F, -0.0238F)), plane.offset, kExact);  // q
    // The stretched space itself.
    const float alpha = 1.0F / 0.64F;
    const Exit exit = nearest_exit({4, 0.5F, 0.3F * alpha}, {1.2F, 0.1F, -0.05F * alpha}, 1.0F, 5.0F);
    expect_near(exit.normal, {-0.107753F, -0.231573F, -0.966832F});
    expect_near(exit.depth * exit.normal, {-0.008289F, -0.017814F, -0.074375F});
}

PairSettings ramp_settings()
{
    PairSettings settings;
    settings.horizon = 5.0F;
    settings.conflict_ratio = 0.7F;
    settings.ramp_speed = 0.3F;
    return settings;
}

TEST(OrcaCheckVectors, WarningRamp)
{
    Pair pair;
    pair.position = {0.8F, 0.3F, 0};
    pair.own_velocity = {0.1F, 0, 0.05F};
    pair.other_velocity = pair.own_velocity - Vec3(0.2F, 0, 0.1F);
    const PairPlanes planes = pair_planes(pair, ramp_settings());
    EXPECT_NEAR(planes.distance, 0.854400F, kExact);
    expect_near(planes.warning.normal, {-0.936329F, -0.351123F, 0});
    EXPECT_NEAR(planes.warning.offset, 0.072800F, kExact);
    const Exit exit = separating(pair.position, planes.distance, {0.2F, 0, 0.1F}, 0.145600F, false);
    expect_near(exit.depth * exit.normal, {-0.311672F, -0.116877F, 0});
}

TEST(AgentPlane, RampGrowsFromTheRimAndStaysAtItsMost)
{
    Pair pair;
    const PairSettings settings = ramp_settings();
    const auto offset_at = [&](float distance) {
        pair.position = {distance, 0, 0};
        return pair_planes(pair, settings).warning.offset;
    };
    EXPECT_NEAR(offset_at(1.0F), 0.0F, kExact);
    EXPECT_NEAR(offset_at(0.85F), 0.5F * 0.15F, kExact);  // the own half of half of 0.3 m/s
    EXPECT_NEAR(offset_at(0.7F), 0.5F * 0.3F, kExact);
    EXPECT_NEAR(offset_at(0.1F), 0.5F * 0.3F, kExact);
    // Just outside: the original half-space is the same, since neither moves.
    EXPECT_NEAR(offset_at(1.00001F), 0.0F, 1e-5F);
}

TEST(AgentPlane, ConflictRegionIsLeftWithinTheRecoveryTime)
{
    Pair pair;
    PairSettings settings = ramp_settings();
    settings.recovery_speed = 0.3F;
    settings.recovery_time = 2.0F;
    pair.position = {0, -0.5F, 0};
    HalfSpace plane = pair_planes(pair, settings).conflict;
    expect_near(plane.normal, {0, 1, 0});
    EXPECT_NEAR(plane.offset, 0.5F * 0.2F / 2.0F, kExact);
    EXPECT_EQ(plane.level, Level::conflict);
    settings.recovery_time = 0.5F;
    EXPECT_NEAR(pair_planes(pair, settings).conflict.offset, 0.5F * 0.3F, kExact);
    // A share of 1 for non-cooperative neighbours.
    pair.weights = kAlone;
    EXPECT_NEAR(pair_planes(pair, settings).conflict.offset, 0.3F, kExact);
}

TEST(AgentPlane, WithinTheRadiusTheOriginalLeavesInOnePeriod)
{
    // R / period - |v - p / period| along v - p / period (Alejo 7.34, 7.35): at rest, 0.2 m are made up in 0.05 s.
    const Exit exit = original_exit({0.8F, 0, 0}, Vec3::Zero(), 1.0F, 0.05F);
    expect_near(exit.normal, {-1, 0, 0});
    EXPECT_NEAR(exit.depth, 0.2F / 0.05F, 1e-4F);
}

TEST(AgentPlane, InterpolatedRampMeetsBothEnds)
{
    Pair pair;
    PairSettings settings = ramp_settings();
    settings.ramp = Ramp::interpolated;
    settings.period = 0.05F;
    pair.position = {1.0F, 0, 0};
    EXPECT_NEAR(pair_planes(pair, settings).warning.offset, 0.0F, kExact);
    pair.position = {0.7F, 0, 0};
    EXPECT_NEAR(pair_planes(pair, settings).warning.offset, 0.5F * 0.3F / 0.05F, 1e-4F);
    pair.position = {0.85F, 0, 0};
    EXPECT_NEAR(pair_planes(pair, settings).warning.offset, 0.5F * 0.5F * 0.15F / 0.05F, 1e-4F);
    pair.position = Vec3::Zero();
    EXPECT_TRUE(std::isfinite(pair_planes(pair, settings).warning.offset));
}

TEST(AgentPlane, CoincidentCentresPartByTheirIds)
{
    Pair pair;
    pair.position = Vec3::Zero();
    pair.above = true;
    const PairPlanes up = pair_planes(pair, PairSettings{});
    pair.above = false;
    const PairPlanes down = pair_planes(pair, PairSettings{});
    expect_near(up.warning.normal, {0, 0, 1});
    expect_near(up.conflict.normal, {0, 0, 1});
    expect_near(down.warning.normal, {0, 0, -1});
    EXPECT_GT(up.warning.offset, 0.0F);
    EXPECT_GT(up.conflict.offset, 0.0F);
    EXPECT_EQ(up.warning.offset, down.warning.offset);
}

TEST(AgentPlane, OnTheAxisBothPassToTheirRight)
{
    expect_near(side({10, 0, 0}), {0, -1, 0});
    expect_near(side({0, 7, 0}), {1, 0, 0});
    expect_near(side({0, 0, 5}), {0, 1, 0});
    expect_near(side({1e-4F, 0, -5}), {0, -1, 0});
    for (const Vec3& p : {Vec3(1, 2, 3), Vec3(0, 0, 4), Vec3(1e-4F, 2e-4F, -3), Vec3(-5, 0, 0.1F)}) {
        EXPECT_EQ(side(-p), Vec3(-side(p)));
        EXPECT_NEAR(side(p).norm(), 1.0F, kExact);
        EXPECT_NEAR(side(p).dot(p), 0.0F, kExact * p.norm());
    }
}

TEST(AgentPlane, WhoDoesNotGiveWayIsPassedAlone)
{
    Pair pair;
    pair.position = {10, 0, 0};
    pair.own_velocity = {1, 0, 0};
    pair.other_velocity = {-1, 0.1F, 0};
    PairSettings settings;
    const HalfSpace shared = pair_plane(pair, settings);
    pair.weights = kAlone;
    const HalfSpace alone = pair_plane(pair, settings);
    const float unmoved = shared.normal.dot(pair.own_velocity);
    EXPECT_GT(shared.offset, unmoved);
    EXPECT_NEAR(alone.offset - unmoved, 2.0F * (shared.offset - unmoved), 1e-6F);
    // The part outside the obstacle is still shared.
    pair.other_velocity = {1, 0, 0};
    const HalfSpace slack = pair_plane(pair, settings);
    pair.weights = kShared;
    EXPECT_EQ(slack.offset, pair_plane(pair, settings).offset);
}

TEST(AgentPlane, AtRestHalfOfTheGapIsLeftInEachBrakeTime)
{
    Pair pair;
    pair.position = {0, 2.0F, 0};
    pair.own_velocity = {3, 1, 0};
    pair.other_velocity = {-1, -1, 2};
    PairSettings settings;
    settings.conflict = Conflict::at_rest;
    settings.conflict_ratio = 0.7F;
    settings.brake = 0.5F;
    const HalfSpace plane = pair_planes(pair, settings).conflict;
    expect_near(plane.normal, {0, -1, 0});
    EXPECT_NEAR(plane.offset, -0.5F * (2.0F - 0.7F) / 0.5F, kExact);
    // The other's velocity counts if it is not cooperative: 1 m/s towards us.
    pair.weights = kAlone;
    EXPECT_NEAR(pair_planes(pair, settings).conflict.offset, -1.3F / 0.5F + 1.0F, kExact);
}

TEST(AgentPlane, ReachAndWhatARangeLeavesOfTheHorizon)
{
    EXPECT_EQ(reach(1.0F, 5.0F, 2.0F, 3.0F, 0.5F), 26.0F);
    EXPECT_EQ(reach(1.0F, 5.0F, 2.0F, 3.0F, 2.0F), 51.0F);
    // Alejo's values: 4 m of range, 1.2 m apart, 1.5 m/s each.
    EXPECT_NEAR(effective_horizon(4.0F, 1.2F, 10.0F, 1.5F, 1.5F, 1.0F), 2.8F / 3.0F, 1e-6F);
    EXPECT_EQ(effective_horizon(40.0F, 1.2F, 10.0F, 1.5F, 1.5F, 1.0F), 10.0F);
    EXPECT_EQ(effective_horizon(1.0F, 1.2F, 10.0F, 1.5F, 1.5F, 1.0F), 0.0F);
    EXPECT_EQ(effective_horizon(4.0F, 1.2F, 10.0F, 0.0F, 0.0F, 1.0F), 10.0F);
}

}  // namespace
}  // namespace jink::orca
