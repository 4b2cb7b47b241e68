// SPDX-License-Identifier: BSD-3-Clause
// Numbers that are not finite never give a clearance.
#include <functional>

#include <gtest/gtest.h>

#include "core/world/conflict.hpp"
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
    detail::consider(best, -kInfinity, 5.0F, {ThreatKind::cylinder, 1});
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

/// One threat of each kind 30 m beside the path, a box of 1 m, and a non-finite value.
struct OneBadNumber {
    ThreatKind kind;
    std::function<void(Scene&)> spoil;
};

const OneBadNumber kBadNumbers[] = {
    {ThreatKind::track, [](Scene& s) { s.tracks[0].position.y() = kNan; }},
    {ThreatKind::track, [](Scene& s) { s.tracks[0].velocity.x() = kNan; }},
    {ThreatKind::track, [](Scene& s) { s.tracks[0].velocity.x() = -kInfinity; }},
    {ThreatKind::track, [](Scene& s) { s.tracks[0].radius = kNan; }},
    {ThreatKind::track, [](Scene& s) { s.tracks[0].radius = kInfinity; }},
    {ThreatKind::track, [](Scene& s) { s.tracks[0].sigma_position = kNan; }},
    {ThreatKind::track, [](Scene& s) { s.tracks[0].sigma_velocity = kInfinity; }},
    {ThreatKind::track, [](Scene& s) { s.tracks[0].max_acceleration = kNan; }},
    {ThreatKind::track, [](Scene& s) { s.own.sigma_position = kNan; }},
    {ThreatKind::track, [](Scene& s) { s.rules.k_sigma = kInfinity; }},
    {ThreatKind::obstacle, [](Scene& s) { s.obstacles[0].shape.centre.x() = kNan; }},
    {ThreatKind::obstacle, [](Scene& s) { s.obstacles[0].shape.radius = kNan; }},
    {ThreatKind::obstacle, [](Scene& s) { s.own.sigma_position = kNan; }},
    {ThreatKind::obstacle, [](Scene& s) { s.own.sigma_position = kInfinity; }},
    {ThreatKind::obstacle, [](Scene& s) { s.rules.k_sigma = kNan; }},
    {ThreatKind::cylinder, [](Scene& s) { s.cylinders[0].circle.centre.y() = kNan; }},
    {ThreatKind::cylinder, [](Scene& s) { s.cylinders[0].circle.radius = kNan; }},
    {ThreatKind::cylinder, [](Scene& s) { s.cylinders[0].velocity.x() = kNan; }},
    {ThreatKind::cylinder, [](Scene& s) { s.cylinders[0].velocity.y() = kInfinity; }},
    {ThreatKind::cylinder, [](Scene& s) { s.cylinders[0].bottom = kNan; }},
    {ThreatKind::cylinder, [](Scene& s) { s.cylinders[0].top = kNan; }},
    {ThreatKind::cylinder, [](Scene& s) { s.limits.half_extents.x() = kNan; }},
    {ThreatKind::cylinder, [](Scene& s) { s.own.sigma_position = kNan; }},
    {ThreatKind::cylinder, [](Scene& s) { s.rules.k_sigma = kNan; }},
};

struct BesideTheWay : testing::TestWithParam<OneBadNumber> {
    BesideTheWay()
    {
        scene.leg(Vec3::Zero(), Vec3(100, 0, 0), 5.0F);
        switch (GetParam().kind) {
        case ThreatKind::track: scene.track(Vec3(20, 31, 0), Vec3::Zero(), 1.0F); break;
        case ThreatKind::cylinder: scene.cylinder(Vec2(20, 31), 1.0F); break;
        default: scene.obstacle(geometry::make_sphere(Vec3(20, 31, 0), 1.0F)); break;
        }
    }
    [[nodiscard]] Separation now() const
    {
        WorkBudget budget(kPlenty);
        return separation_at(scene.situation(), Vec3::Zero(), 0.0F, budget);
    }
    [[nodiscard]] bool meets(Conflict& out) const
    {
        WorkBudget budget(kPlenty);
        return main_conflict(scene.situation(), way_of(scene.situation()), 10.0F, budget, out);
    }
    Scene scene;
    const path::TimedPath path = flight({Vec3::Zero(), Vec3(20, 0, 0), Vec3(40, 0, 0)}, 4.0F);
};

TEST_P(BesideTheWay, ABadNumberIsContactAndAConflictNow)
{
    Conflict conflict;
    ASSERT_GT(now().margin, 20.0F);
    ASSERT_GT(separation(scene, path).margin, 20.0F);
    ASSERT_FALSE(meets(conflict));
    GetParam().spoil(scene);
    EXPECT_LT(now().margin, 0.0F);
    EXPECT_EQ(now().against, (ThreatRef{GetParam().kind, 0}));
    EXPECT_LT(separation(scene, path).margin, 0.0F);
    EXPECT_EQ(separation(scene, path).against, (ThreatRef{GetParam().kind, 0}));
    ASSERT_TRUE(meets(conflict));
    EXPECT_EQ(conflict.threat, (ThreatRef{GetParam().kind, 0}));
    EXPECT_FALSE(conflict.margin >= 0.0F);
}

INSTANTIATE_TEST_SUITE_P(BadNumbers, BesideTheWay, testing::ValuesIn(kBadNumbers));

/// The own place, and each place and velocity of a flight before its end.
TEST(BadFlights, AreContactWithWhateverThereIs)
{
    for (const ThreatKind kind : {ThreatKind::track, ThreatKind::obstacle, ThreatKind::cylinder}) {
        Scene scene;
        if (kind == ThreatKind::track) {
            scene.track(Vec3(20, 31, 0), Vec3::Zero(), 1.0F);
        } else if (kind == ThreatKind::cylinder) {
            scene.cylinder(Vec2(20, 31), 1.0F);
        } else {
            scene.obstacle(geometry::make_sphere(Vec3(20, 31, 0), 1.0F));
        }
        for (int axis = 0; axis < 3; ++axis) {
            Vec3 own = Vec3::Zero();
            own[axis] = kNan;
            WorkBudget budget(kPlenty);
            EXPECT_LT(separation_at(scene.situation(), own, 0.0F, budget).margin, 0.0F) << axis;
            for (std::size_t point = 0; point < 2; ++point) {
                path::TimedPath place = flight({Vec3::Zero(), Vec3(5, 0, 0), Vec3(10, 0, 0)}, 1.0F);
                path::TimedPath velocity = place;
                place.points[point].position[axis] = kNan;
                velocity.points[point].velocity[axis] = kNan;
                EXPECT_LT(separation(scene, place).margin, 0.0F) << static_cast<int>(kind) << axis << point;
                EXPECT_LT(separation(scene, velocity).margin, 0.0F) << static_cast<int>(kind) << axis << point;
            }
        }
    }
}

}  // namespace
}  // namespace jink::world
