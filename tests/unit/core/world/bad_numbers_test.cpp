// SPDX-License-Identifier: BSD-3-Clause
// Numbers that are not finite never give a clearance.
#include <functional>

#include <gtest/gtest.h>

#include "core/world/separation.hpp"
#include "core/world/separation_parts.hpp"
#include "tests/numbers.hpp"
#include "tests/unit/core/world/scene.hpp"

namespace jink::world {
namespace {

using namespace test;

TEST(Consider, AMarginThatIsNotANumberIsContactOfTheWorstKind)
{
    for (const float so_far : {kSeparationCap, 0.0F, -3.0F}) {
        Separation best{so_far, 1.0F, {}};
        detail::consider(best, kNan, 2.0F, {ThreatKind::track, 4});
        EXPECT_EQ(best.margin, -kSeparationCap);
        EXPECT_EQ(best.when, 2.0F);
        EXPECT_EQ(best.against, (ThreatRef{ThreatKind::track, 4}));
        detail::consider(best, 10.0F, 3.0F, {});
        EXPECT_EQ(best.margin, -kSeparationCap) << "nothing afterwards makes it better";
    }
}

TEST(Consider, KeepsTheLeastAndIsBoundedBelow)
{
    Separation best;
    detail::consider(best, 3.0F, 1.0F, {ThreatKind::floor, 0});
    detail::consider(best, 4.0F, 2.0F, {ThreatKind::ceiling, 0});
    EXPECT_EQ(best.margin, 3.0F);
    EXPECT_EQ(best.against.kind, ThreatKind::floor);
    detail::consider(best, -kInfinity, 5.0F, {ThreatKind::barrel, 1});
    EXPECT_EQ(best.margin, -kSeparationCap);
    EXPECT_EQ(best.when, 5.0F);
}

TEST(Consider, OfEqualMarginsTheFirstIsKept)
{
    Separation best;
    detail::consider(best, 3.0F, 1.0F, {ThreatKind::floor, 0});
    detail::consider(best, 3.0F, 2.0F, {ThreatKind::ceiling, 0});
    EXPECT_EQ(best.against.kind, ThreatKind::floor);
    EXPECT_EQ(best.when, 1.0F);
}

TEST(Paid, WithoutTheUnitsItIsContactThere)
{
    WorkBudget budget(10);
    Separation best;
    EXPECT_TRUE(detail::paid(budget, 10, best, 1.0F, {ThreatKind::track, 2}));
    EXPECT_EQ(best.margin, kSeparationCap);
    EXPECT_FALSE(detail::paid(budget, 1, best, 2.0F, {ThreatKind::track, 3}));
    EXPECT_EQ(best.margin, -kSeparationCap);
    EXPECT_EQ(best.when, 2.0F);
    EXPECT_EQ(best.against, (ThreatRef{ThreatKind::track, 3}));
}

TEST(ShrinkAt, IsWhatIsLeftOfIt)
{
    EXPECT_EQ(detail::shrink_at(0.0F, {0.05F, 0.5F}, 0.0F), 0.0F);
    EXPECT_EQ(detail::shrink_at(2.0F, {0.05F, 0.5F}, 0.0F), 2.0F);
    EXPECT_EQ(detail::shrink_at(2.0F, {0.05F, 0.5F}, 3.0F), 0.5F);
    EXPECT_EQ(detail::shrink_at(2.0F, {0.05F, 0.5F}, 9.0F), 0.0F);
}

TEST(LeastSeparationOfBadNumbers, IsContact)
{
    using Spoil = std::function<void(Scene&, path::TimedPath&)>;
    const Spoil spoils[] = {
        [](Scene& s, path::TimedPath&) { s.tracks[0].position.x() = kNan; },
        [](Scene& s, path::TimedPath&) { s.tracks[0].velocity.y() = kNan; },
        [](Scene& s, path::TimedPath&) { s.tracks[0].radius = kNan; },
        [](Scene& s, path::TimedPath&) { s.tracks[0].sigma_position = kNan; },
        [](Scene& s, path::TimedPath&) { s.tracks[0].sigma_velocity = kNan; },
        [](Scene& s, path::TimedPath&) { s.tracks[0].max_acceleration = kNan; },
        [](Scene& s, path::TimedPath&) { s.own.sigma_position = kNan; },
        [](Scene& s, path::TimedPath&) { s.airspace.floor = kNan; },
        [](Scene& s, path::TimedPath&) { s.airspace.keep_in_radius = kNan; },
        [](Scene& s, path::TimedPath&) { s.airspace.home.x() = kNan; },
        [](Scene&, path::TimedPath& p) { p.points[1].position.z() = kNan; },
        [](Scene&, path::TimedPath& p) { p.points[1].velocity = Vec3(kNan, kNan, kNan); },
    };
    int number = 0;
    for (const Spoil& spoil : spoils) {
        Scene scene;
        scene.track(Vec3(5, 20, 0), Vec3::Zero());
        scene.tracks[0].stamp = scene.now - 0.5F;
        scene.airspace.has_floor = scene.airspace.has_keep_in = true;
        scene.airspace.floor = -30.0F;
        scene.airspace.keep_in_radius = 60.0F;
        path::TimedPath path = flight({Vec3::Zero(), Vec3(5, 0, 0), Vec3(10, 0, 0)}, 1.0F);
        ASSERT_GT(separation(scene, path).margin, 10.0F);
        spoil(scene, path);
        EXPECT_LT(separation(scene, path).margin, 0.0F) << number;
        ++number;
    }
}

}  // namespace
}  // namespace jink::world
