// SPDX-License-Identifier: BSD-3-Clause
// Two nominal paths, how long control is kept, and permanent static obstacles on the path.
#include <gtest/gtest.h>

#include "tests/unit/core/avoid/fakes.hpp"

namespace jink::avoid {
namespace {

using namespace test;

/// A leg to the east, but the vehicle actually flies north.
class TwoNominalPaths : public ::testing::Test {
protected:
    TwoNominalPaths()
    {
        f.scene.own.velocity = Vec3(0, 5, 0);
        north = world::Reference({f.scene.own.position, f.scene.own.position + Vec3(0, 300, 0), 5.0F});
    }
    Guidance update(bool in_control) { return supervisor.update(f.scene.situation(), in_control, &north); }

    Flight f;
    world::Reference north;
    FakeMethod method = always(Vec3(1, 0, 0));
    Supervisor<FakeMethod> supervisor{quick(), method};
};

TEST_F(TwoNominalPaths, AConflictOnTheOtherOneAloneCounts)
{
    f.scene.track(f.scene.own.position + Vec3(0, 40, 0), Vec3(0, -5, 0));
    EXPECT_FALSE(f.update(supervisor, false).conflict.has_value()) << "the leg is clear";
    const Guidance g = update(false);
    EXPECT_TRUE(g.conflict.has_value());
    EXPECT_TRUE(g.on_other);
    EXPECT_TRUE(g.wants_control);
    EXPECT_NEAR(g.conflict->time_to_loss, 3.8F, 0.1F);
    EXPECT_EQ(supervisor.diagnostics().on_other, 1U);
}

TEST_F(TwoNominalPaths, TheEarlierConflictCounts)
{
    f.scene.track(f.scene.own.position + Vec3(0, 40, 0), Vec3(0, -5, 0));
    f.scene.track(f.scene.own.position + Vec3(25, 0, 0), Vec3(-5, 0, 0));
    const Guidance g = update(false);
    EXPECT_FALSE(g.on_other);
    EXPECT_EQ(g.conflict->threat.index, 1U);
    f.scene.tracks[1].position.x() += 40.0F;
    const Guidance later = update(false);
    EXPECT_TRUE(later.on_other);
    EXPECT_EQ(later.conflict->threat.index, 0U);
}

TEST_F(TwoNominalPaths, AnObstacleOnTheOtherOneCountsWhenItIsTimeToStop)
{
    f.scene.obstacle(geometry::make_sphere(f.scene.own.position + Vec3(0, 20, 0), 1.0F));
    EXPECT_FALSE(update(false).conflict.has_value()) << "it may turn where its leg ends";
    f.pass(Vec3(0, 5, 0), 2.0F);
    EXPECT_TRUE(update(false).on_other);
}

TEST_F(TwoNominalPaths, InControlTheFirstAloneIsFlown)
{
    f.scene.track(f.scene.own.position + Vec3(0, 40, 0), Vec3(0, -5, 0));
    const Guidance g = update(true);
    EXPECT_FALSE(g.conflict.has_value());
    EXPECT_FALSE(g.on_other);
}

TEST_F(TwoNominalPaths, ControlIsNotGivenBackIntoAConflictOfTheOtherOne)
{
    Settings settings = quick();
    settings.least_control = 0.0F;
    ASSERT_TRUE(supervisor.configure(settings));
    f.scene.own.velocity = Vec3(5, 0, 0);
    f.scene.track(f.scene.own.position + Vec3(0, 30, 0), Vec3(0, -0.5F, 0));
    Guidance g;
    for (int i = 0; i < 100; ++i) {
        north = world::Reference({f.scene.own.position, f.scene.tracks[0].position, 5.0F});
        g = update(true);
        EXPECT_TRUE(g.wants_control);
        f.pass(g.velocity, 0.05F);
    }
    EXPECT_TRUE(g.other_conflict);
    EXPECT_GT(supervisor.diagnostics().kept_control, 50U);
    f.scene.tracks.clear();
    EXPECT_FALSE(update(true).wants_control) << "both are clear";
}

TEST_F(TwoNominalPaths, StandingInTheWayItGetsGoingInTime)
{
    method = never();
    f.scene.own.velocity = Vec3::Zero();
    f.scene.leg(f.scene.own.position, f.scene.own.position, 5.0F);
    north = world::Reference({f.scene.own.position, f.scene.own.position, 5.0F});
    f.scene.track(f.scene.own.position + Vec3(40, 0, 0), Vec3(-10, 0, 0), 1.5F);
    Guidance g;
    while (!(g = update(false)).wants_control && f.scene.tracks[0].position.x() > 0.0F) {
        f.pass(Vec3::Zero(), 0.05F);
    }
    EXPECT_NEAR(g.conflict->time_to_loss, 3.0F, 0.1F) << "stopping mends nothing";
    EXPECT_EQ(g.kind, world::ManoeuvreKind::velocity);
    EXPECT_GE(g.margin, 0.0F);
}

/// In front of a wall that nothing leads around.
class BlockedWay : public ::testing::Test {
protected:
    BlockedWay()
    {
        const float far = 200.0F;
        f.scene.obstacle(geometry::make_box(Vec3(60, 0, 30), Vec3(1, far, far)));
    }
    void pass(Seconds span)
    {
        for (Seconds t = 0.0F; t < span; t += 0.05F) {
            g = f.update(supervisor, true);
            given_up += g.blocked && !was ? 1 : 0;
            was = g.blocked;
            f.pass(g.velocity, 0.05F);
        }
    }

    Flight f;
    FakeMethod method = never();
    Supervisor<FakeMethod> supervisor{quick(), method};
    Guidance g;
    int given_up = 0;
    bool was = false;
};

TEST_F(BlockedWay, IsGivenUpAfterThePatience)
{
    pass(25.0F);
    EXPECT_EQ(given_up, 0) << "it came here and has waited for less than the patience";
    EXPECT_TRUE(g.wants_control);
    pass(60.0F);
    EXPECT_EQ(given_up, 1);
    EXPECT_TRUE(g.blocked);
    EXPECT_FALSE(g.wants_control);
    EXPECT_EQ(g.velocity, Vec3(Vec3::Zero()));
    EXPECT_EQ(supervisor.diagnostics().blocked, 1U);
}

TEST_F(BlockedWay, NeverWithoutPatience)
{
    Settings settings = quick();
    settings.patience = 0.0F;
    ASSERT_TRUE(supervisor.configure(settings));
    pass(120.0F);
    EXPECT_EQ(given_up, 0);
    EXPECT_TRUE(g.wants_control);
}

TEST_F(BlockedWay, TrafficIsAvoidedAllTheSame)
{
    pass(85.0F);
    ASSERT_TRUE(g.blocked);
    f.scene.track(f.scene.own.position + Vec3(0, 25, 0), Vec3(0, -10, 0));
    pass(0.1F);
    EXPECT_FALSE(g.blocked);
    EXPECT_TRUE(g.wants_control);
}

}  // namespace
}  // namespace jink::avoid
