// SPDX-License-Identifier: BSD-3-Clause
#include "core/world/threat_set.hpp"

#include <gtest/gtest.h>

#include "core/geometry/shape.hpp"
#include "tests/unit/core/world/scene.hpp"

namespace jink::world {
namespace {

using namespace test;

/// One of each kind; the own position is known to 0.5 m, three deviations count.
struct OfEachKind : testing::Test {
    OfEachKind()
    {
        scene.leg(Vec3::Zero(), Vec3(100, 0, 0));
        scene.own.sigma_position = 0.5F;
        scene.airspace.has_floor = scene.airspace.has_ceiling = scene.airspace.has_keep_in = true;
        scene.airspace.floor = -30.0F;
        scene.airspace.ceiling = 40.0F;
        scene.airspace.home = Vec3(1, 2, 3);
        scene.airspace.keep_in_radius = 200.0F;
        scene.track(Vec3(50, 1, 2), Vec3(-3, 0, 1), 1.5F).half_height = 4.0F;
        scene.tracks[0].cooperative = true;
        scene.track(Vec3(60, 0, 0), Vec3::Zero(), 1.0F).sigma_velocity = 0.2F;
        scene.cylinder({30, 5}, 2.0F, {1, -1});
        scene.obstacle(geometry::make_box(Vec3(9, 9, 9), Vec3::Ones()));
        scene.obstacle(geometry::make_capsule(Vec3(20, 0, -5), Vec3(20, 0, 5), 0.5F));
    }
    Scene scene;
};

TEST_F(OfEachKind, StandsInTheStatedOrder)
{
    const Situation s = scene.situation();
    ASSERT_EQ(s.threats.size(), 8U);
    constexpr ThreatKind kKinds[] = {ThreatKind::floor,    ThreatKind::ceiling, ThreatKind::keep_in,
                                     ThreatKind::track,    ThreatKind::track,   ThreatKind::cylinder,
                                     ThreatKind::obstacle, ThreatKind::obstacle};
    constexpr std::uint16_t kIndices[] = {0, 0, 0, 0, 1, 0, 0, 1};
    for (std::size_t i = 0; i < s.threats.size(); ++i) {
        EXPECT_EQ(s.threats[i].ref, (ThreatRef{kKinds[i], kIndices[i]})) << i;
        EXPECT_EQ(s.threats[i].is_bound(), i < 3) << i;
    }
    EXPECT_EQ(of_kind(s.threats, ThreatKind::track).size(), 2U);
    EXPECT_EQ(of_kind(s.threats, ThreatKind::track).data(), &s.threats[3]);
    EXPECT_EQ(of_kind(s.threats, ThreatKind::obstacle).size(), 2U);
    EXPECT_TRUE(of_kind(s.threats, ThreatKind::none).empty());
    EXPECT_NE(of_kind(s.threats, ThreatKind::none).data(), nullptr)
        << "none of a kind is not the same as never collected";
}

TEST_F(OfEachKind, IsGrownByTheOwnUncertainty)
{
    const Situation s = scene.situation();
    for (const std::size_t i : {0U, 1U, 2U, 5U, 6U}) {
        EXPECT_EQ(s.threats[i].radius_at(7.0F), 1.5F) << i;
    }
    EXPECT_FLOAT_EQ(s.threats[3].radius_at(7.0F), 1.5F + 1.5F);
    EXPECT_FLOAT_EQ(s.threats[4].radius_at(2.0F), 1.0F + 1.5F + 3.0F * 0.2F * 2.0F);
    EXPECT_FLOAT_EQ(s.threats[7].radius_at(7.0F), 0.5F + 1.5F);
    EXPECT_TRUE(s.threats[4].grows);
    EXPECT_FALSE(s.threats[3].grows);
}

TEST_F(OfEachKind, MovesAsItsSourceDoes)
{
    const Situation s = scene.situation();
    EXPECT_EQ(s.threats[3].position_at(2.0F), Vec3(44, 1, 4));
    EXPECT_EQ(s.threats[5].position_at(2.0F), Vec3(32, 3, 0));
    EXPECT_EQ(s.threats[6].position_at(2.0F), Vec3(9, 9, 9));
    EXPECT_TRUE(s.threats[3].reciprocal);
    EXPECT_FALSE(s.threats[4].reciprocal);
}

TEST_F(OfEachKind, UprightOnesMakeTheBoxTaller)
{
    const Situation s = scene.situation();
    EXPECT_EQ(s.threats[3].box_against(Vec3(1, 2, 3)), Vec3(1, 2, 7));
    EXPECT_EQ(s.threats[7].box_against(Vec3(1, 2, 3)), Vec3(1, 2, 8));
    EXPECT_EQ(s.threats[3].nearest_in_height(0.0F, 3.0F), Vec3(50, 1, 3));
    EXPECT_EQ(s.threats[3].nearest_in_height(2.0F, 30.0F), Vec3(44, 1, 8));
    EXPECT_EQ(s.threats[3].nearest_in_height(2.0F, -30.0F), Vec3(44, 1, 0));
}

/// Never collected, or beyond the capacity: contact for every query.
TEST_F(OfEachKind, WithoutASetEverythingIsContact)
{
    Situation s = scene.situation();
    const path::TimedPath path = flight({Vec3::Zero(), Vec3(0, -50, 0)}, 10.0F);
    WorkBudget budget(kPlenty);
    ASSERT_GT(least_separation(s, path, 10.0F, budget).margin, 0.0F);
    s.threats = {};
    EXPECT_EQ(least_separation(s, path, 10.0F, budget).margin, -kSeparationCap);
    EXPECT_EQ(least_separation(s, path::TimedPath{}, 10.0F, budget).margin, -kSeparationCap);
    EXPECT_EQ(separation_at(s, Vec3::Zero(), 0.0F, budget).margin, -kSeparationCap);
    Conflict conflict;
    ASSERT_TRUE(main_conflict(s, way_of(s), 8.0F, budget, conflict));
    EXPECT_EQ(conflict.time_to_loss, 0.0F);

    ThreatSet set;
    EXPECT_EQ(set.all().data(), nullptr);
    scene.tracks.resize(kMaxTracks + 1);
    EXPECT_EQ(scene.situation().threats.data(), nullptr);
    scene.tracks.resize(kMaxTracks);
    EXPECT_EQ(scene.situation().threats.size(), kMaxTracks + 6);
    scene.cylinders.resize(kMaxCylinders + 1);
    scene.airspace.cylinders = scene.cylinders;
    EXPECT_FALSE(set.collect(scene.situation(), scene.around()));
    EXPECT_EQ(set.all().data(), nullptr);
    scene.airspace.cylinders = {};
    EXPECT_TRUE(set.collect(scene.situation(), scene.around()));
    scene.obstacles.resize(kMaxObstacles + 1);
    EXPECT_FALSE(set.collect(scene.situation(), scene.around()));
}

/// A track with a non-finite value counts as growing, so that no check treats it as a track of fixed size.
TEST_F(OfEachKind, NonFiniteGrowthIsGrowth)
{
    scene.tracks[0].sigma_velocity = std::numeric_limits<float>::quiet_NaN();
    EXPECT_TRUE(scene.situation().threats[3].grows);
    EXPECT_TRUE(std::isnan(scene.situation().threats[3].radius_at(1.0F)));
}

}  // namespace
}  // namespace jink::world
