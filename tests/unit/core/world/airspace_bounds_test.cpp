// SPDX-License-Identifier: BSD-3-Clause
// Floor, ceiling and keep-in radius: the own box and its uncertainty, exactly at the bound and just beyond it.
#include <cmath>
#include <utility>

#include <gtest/gtest.h>

#include "tests/numbers.hpp"
#include "tests/unit/core/world/scene.hpp"

namespace jink::world {
namespace {

using namespace test;

/// A box of 3 x 4 x 2 m half extents, uncertain by 0.5 m (two deviations of 0.25 m), between 10 and 30 m, within 100 m
/// of (10, -20). The corner of the box is 5 m from its centre.
struct AirspaceBounds : testing::Test {
    AirspaceBounds()
    {
        scene.limits.half_extents = Vec3(3, 4, 2);
        scene.own.sigma_position = 0.25F;
        scene.rules.k_sigma = 2.0F;
        scene.airspace.floor = 10.0F;
        scene.airspace.ceiling = 30.0F;
        scene.airspace.home = Vec3(10, -20, 500);
        scene.airspace.keep_in_radius = 100.0F;
    }
    [[nodiscard]] Separation to(const Vec3& end) const
    {
        return separation(scene, flight({Vec3(10, -20, 20), end}, 1.0F));
    }
    [[nodiscard]] Separation at(const Vec3& position) const
    {
        WorkBudget budget(kPlenty);
        return separation_at(scene.situation(), position, 3.0F, budget);
    }
    /// The margin at the end of a flight that begins in the middle, and at that place, is `margin`.
    void holds(ThreatKind kind, const Vec3& end, float margin) const
    {
        EXPECT_EQ(to(end).margin, margin);
        EXPECT_EQ(to(end).against, (ThreatRef{kind, 0}));
        EXPECT_EQ(to(end).when, 1.0F);
        EXPECT_EQ(at(end).margin, margin);
        EXPECT_EQ(at(end).against, (ThreatRef{kind, 0}));
        EXPECT_EQ(at(end).when, 3.0F);
    }
    Scene scene;
};

TEST_F(AirspaceBounds, TheFloorIsMetByTheUncertainBoxsLowerFace)
{
    scene.airspace.has_floor = true;
    holds(ThreatKind::floor, Vec3(10, -20, 12.5F), 0.0F);
    holds(ThreatKind::floor, Vec3(10, -20, 12.4375F), -0.0625F);
    holds(ThreatKind::floor, Vec3(10, -20, 12.5625F), 0.0625F);
    holds(ThreatKind::floor, Vec3(10, -20, 0.0F), -12.5F);
}

TEST_F(AirspaceBounds, TheCeilingIsMetByTheUncertainBoxsUpperFace)
{
    scene.airspace.has_ceiling = true;
    holds(ThreatKind::ceiling, Vec3(10, -20, 27.5F), 0.0F);
    holds(ThreatKind::ceiling, Vec3(10, -20, 27.5625F), -0.0625F);
    holds(ThreatKind::ceiling, Vec3(10, -20, 27.4375F), 0.0625F);
    holds(ThreatKind::ceiling, Vec3(10, -20, 40.0F), -12.5F);
}

/// Home's height does not count, nor does the own one.
TEST_F(AirspaceBounds, TheKeepInRadiusIsMetByTheUncertainBoxsCorner)
{
    scene.airspace.has_keep_in = true;
    for (const Vec3& way : {Vec3(1, 0, 0), Vec3(-1, 0, 0), Vec3(0, 1, 0), Vec3(0, -1, 0)}) {
        const auto out = [&](float distance) { return Vec3(Vec3(10, -20, 20) + distance * way); };
        holds(ThreatKind::keep_in, out(94.5F), 0.0F);
        holds(ThreatKind::keep_in, out(94.5625F), -0.0625F);
        holds(ThreatKind::keep_in, out(94.4375F), 0.0625F);
    }
    EXPECT_NEAR(to(Vec3(10.0F + 0.6F * 94.0F, -20.0F - 0.8F * 94.0F, 20)).margin, 0.5F, 1e-4F);
    EXPECT_NEAR(at(Vec3(10.0F + 0.6F * 95.0F, -20.0F - 0.8F * 95.0F, -700)).margin, -0.5F, 1e-4F);
}

/// Of bounds that are not set the numbers do not count.
TEST_F(AirspaceBounds, OneThatIsNotSetIsNoBound)
{
    const Vec3 outside(10, 400, -300);
    EXPECT_EQ(to(outside).margin, kSeparationCap);
    EXPECT_EQ(at(outside).margin, kSeparationCap);
    scene.airspace.has_ceiling = true;
    EXPECT_EQ(to(outside).margin, 30.0F - 22.5F) << "at the start";
    EXPECT_EQ(at(outside).margin, kSeparationCap);
}

/// The margin is that of the worst bound, wherever on the flight it is.
TEST_F(AirspaceBounds, OfSeveralTheNearestCounts)
{
    scene.airspace.has_floor = scene.airspace.has_ceiling = scene.airspace.has_keep_in = true;
    const path::TimedPath path =
        flight({Vec3(10, -20, 20), Vec3(10, -20, 13), Vec3(40, -20, 27.25F), Vec3(104.25F, -20, 20)}, 2.0F);
    const auto nearest = [&](float floor, float ceiling, float radius) {
        scene.airspace.floor = floor;
        scene.airspace.ceiling = ceiling;
        scene.airspace.keep_in_radius = radius;
        return separation(scene, path);
    };
    EXPECT_EQ(nearest(10.0F, 30.0F, 100.0F).against.kind, ThreatKind::ceiling);
    EXPECT_EQ(nearest(10.0F, 30.0F, 100.0F).margin, 0.25F);
    EXPECT_EQ(nearest(10.0F, 30.0F, 100.0F).when, 4.0F);
    EXPECT_EQ(nearest(10.375F, 30.0F, 100.0F).against.kind, ThreatKind::floor);
    EXPECT_EQ(nearest(10.375F, 30.0F, 100.0F).margin, 0.125F);
    EXPECT_EQ(nearest(10.375F, 30.0F, 100.0F).when, 2.0F);
    EXPECT_EQ(nearest(10.375F, 30.0F, 99.8125F).against.kind, ThreatKind::keep_in);
    EXPECT_EQ(nearest(10.375F, 30.0F, 99.8125F).margin, 0.0625F);
    EXPECT_EQ(nearest(10.375F, 30.0F, 99.8125F).when, 6.0F);
}

/// Up to the horizon: the later flight does not count, the position at the horizon does.
TEST_F(AirspaceBounds, TheHorizonEndsTheFlight)
{
    scene.airspace.has_floor = true;
    const path::TimedPath down = flight({Vec3(10, -20, 20), Vec3(10, -20, 4)}, 8.0F);  // 2 m/s
    EXPECT_EQ(separation(scene, down, 3.75F).margin, 0.0F);
    EXPECT_EQ(separation(scene, down, 3.75F).when, 3.75F);
    EXPECT_EQ(separation(scene, down, 4.0F).margin, -0.5F);
    EXPECT_EQ(separation(scene, down, 100.0F).margin, -8.5F);
    EXPECT_EQ(separation(scene, down, 0.0F).margin, 7.5F);
}

using Change = void (*)(Scene&, Vec3&);

/// Each number that a bound rests on.
const std::pair<ThreatKind, Change> kSpoiltBounds[] = {
    {ThreatKind::floor, [](Scene& s, Vec3&) { s.airspace.floor = kNan; }},
    {ThreatKind::floor, [](Scene& s, Vec3&) { s.limits.half_extents.z() = kNan; }},
    {ThreatKind::floor, [](Scene& s, Vec3&) { s.own.sigma_position = kNan; }},
    {ThreatKind::floor, [](Scene& s, Vec3&) { s.rules.k_sigma = kNan; }},
    {ThreatKind::floor, [](Scene&, Vec3& p) { p.z() = kNan; }},
    {ThreatKind::floor, [](Scene& s, Vec3&) { s.airspace.floor = kInfinity; }},
    {ThreatKind::floor, [](Scene& s, Vec3&) { s.own.sigma_position = kInfinity; }},
    {ThreatKind::ceiling, [](Scene& s, Vec3&) { s.airspace.ceiling = kNan; }},
    {ThreatKind::ceiling, [](Scene& s, Vec3&) { s.limits.half_extents.z() = kNan; }},
    {ThreatKind::ceiling, [](Scene& s, Vec3&) { s.own.sigma_position = kNan; }},
    {ThreatKind::ceiling, [](Scene& s, Vec3&) { s.rules.k_sigma = kNan; }},
    {ThreatKind::ceiling, [](Scene&, Vec3& p) { p.z() = kNan; }},
    {ThreatKind::ceiling, [](Scene& s, Vec3&) { s.airspace.ceiling = -kInfinity; }},
    {ThreatKind::keep_in, [](Scene& s, Vec3&) { s.airspace.keep_in_radius = kNan; }},
    {ThreatKind::keep_in, [](Scene& s, Vec3&) { s.airspace.home.x() = kNan; }},
    {ThreatKind::keep_in, [](Scene& s, Vec3&) { s.airspace.home.y() = kInfinity; }},
    {ThreatKind::keep_in, [](Scene& s, Vec3&) { s.limits.half_extents.x() = kNan; }},
    {ThreatKind::keep_in, [](Scene& s, Vec3&) { s.limits.half_extents.y() = kNan; }},
    {ThreatKind::keep_in, [](Scene& s, Vec3&) { s.own.sigma_position = kNan; }},
    {ThreatKind::keep_in, [](Scene& s, Vec3&) { s.rules.k_sigma = kNan; }},
    {ThreatKind::keep_in, [](Scene&, Vec3& p) { p.x() = kNan; }},
    {ThreatKind::keep_in, [](Scene&, Vec3& p) { p.y() = -kInfinity; }},
};

TEST_F(AirspaceBounds, NonFiniteNumbersAreContactOfTheWorstKind)
{
    int number = 0;
    for (const auto& [kind, spoil] : kSpoiltBounds) {
        Scene s = scene;
        s.airspace.has_floor = kind == ThreatKind::floor;
        s.airspace.has_ceiling = kind == ThreatKind::ceiling;
        s.airspace.has_keep_in = kind == ThreatKind::keep_in;
        Vec3 position(10, -20, 20);
        spoil(s, position);
        WorkBudget budget(kPlenty);
        const Separation there = separation_at(s.situation(), position, 0.0F, budget);
        EXPECT_EQ(there.margin, -kSeparationCap) << number;
        EXPECT_EQ(there.against.kind, kind) << number;
        const Separation flown = separation(s, flight({position, position}, 1.0F));
        EXPECT_EQ(flown.against.kind, kind) << number;
        EXPECT_LT(flown.margin, 0.0F) << number;
        ++number;
    }
}

}  // namespace
}  // namespace jink::world
