// SPDX-License-Identifier: BSD-3-Clause
#include "core/avoid/supervisor.hpp"

#include <gtest/gtest.h>

#include "tests/unit/core/avoid/fakes.hpp"

namespace jink::avoid {
namespace {

using namespace test;
using world::ManoeuvreKind;

TEST(Watching, NothingToDoWithoutAConflict)
{
    Flight f;
    FakeMethod method = always(kLeft);
    Supervisor supervisor(quick(), method);
    const Guidance g = f.update(supervisor, false);
    EXPECT_EQ(g.state, State::watching);
    EXPECT_FALSE(g.wants_control);
    EXPECT_FALSE(g.conflict.has_value());
    EXPECT_EQ(g.plan_status, PlanStatus::no_conflict);
    EXPECT_EQ(method.asked, 0);
    EXPECT_EQ(supervisor.diagnostics().updates, 1U);
    EXPECT_EQ(supervisor.flying(), nullptr);
}

TEST(Watching, AConflictFarAheadIsReportedButNotPlannedFor)
{
    Flight f;
    head_on(f, 72.0F);  // loss in 7 s
    FakeMethod method = always(kLeft);
    Supervisor supervisor(quick(), method);
    const Guidance g = f.update(supervisor, false);
    EXPECT_TRUE(g.conflict.has_value());
    EXPECT_FALSE(g.wants_control);
    EXPECT_EQ(method.asked, 0);
    EXPECT_EQ(supervisor.diagnostics().conflicts, 1U);
    static_cast<void>(f.update(supervisor, false));
    EXPECT_EQ(supervisor.diagnostics().conflicts, 1U) << "the same one";
}

TEST(Watching, OffersAManoeuvreAndWantsControl)
{
    Flight f;
    head_on(f);
    FakeMethod method = always(kLeft);
    Supervisor supervisor(quick(), method);
    const Guidance g = f.update(supervisor, false);
    EXPECT_EQ(g.state, State::watching) << "nobody follows us yet";
    EXPECT_TRUE(g.wants_control);
    EXPECT_FALSE(g.new_manoeuvre);
    EXPECT_EQ(g.kind, ManoeuvreKind::follow_path);
    EXPECT_EQ(g.plan_status, PlanStatus::found);
    EXPECT_GE(g.margin, 0.0F);
    ASSERT_NE(supervisor.flying(), nullptr);
    EXPECT_EQ(supervisor.flying()->side, kLeft);
    EXPECT_EQ(supervisor.diagnostics().plans, 1U);
    EXPECT_EQ(supervisor.diagnostics().plans_found, 1U);
    EXPECT_EQ(supervisor.diagnostics().manoeuvres, 0U);
}

TEST(Watching, MakesTheOfferAnewFromThePresentState)
{
    Flight f;
    head_on(f);
    FakeMethod method = always(kLeft);
    Supervisor supervisor(quick(), method);
    for (int i = 0; i < 5; ++i) {
        const Guidance g = f.update(supervisor, false);
        ASSERT_TRUE(g.wants_control);
        EXPECT_EQ(supervisor.flying()->start, f.scene.now);
        f.pass(Vec3(5, 0, 0), 0.1F);
    }
}

TEST(Watching, ForgetsTheOfferWhenTheWayHasBeenClearForAWhile)
{
    Flight f;
    head_on(f);
    FakeMethod method = always(kLeft);
    Supervisor supervisor(quick(), method);
    static_cast<void>(f.update(supervisor, false));
    f.scene.tracks.clear();
    static_cast<void>(f.update(supervisor, false));
    EXPECT_NE(supervisor.flying(), nullptr);
    f.pass(Vec3(5, 0, 0), 0.6F);
    static_cast<void>(f.update(supervisor, false));
    EXPECT_EQ(supervisor.flying(), nullptr);
}

TEST(Watching, WithoutAPlanItWaitsUntilTheLastMoment)
{
    Flight f;
    head_on(f, 50.0F);
    FakeMethod method = never();
    Supervisor supervisor(quick(), method);
    Guidance g;
    Seconds waited = 0.0F;
    while (!(g = f.update(supervisor, false)).wants_control && waited < 10.0F) {
        f.pass(Vec3(5, 0, 0), 0.05F);
        waited += 0.05F;
    }
    EXPECT_NEAR(g.conflict->time_to_loss, vehicle::stopping_time(5.0F, f.scene.limits) + 0.75F, 0.06F);
    EXPECT_NE(g.kind, ManoeuvreKind::follow_path);
}

TEST(Watching, GrantedAfterTheConflictIsOverItKeepsToTheLegForAWhileAndLetsGo)
{
    Flight f;
    FakeMethod method = always(kLeft);
    Settings settings = quick();
    settings.least_control = 2.0F;
    Supervisor supervisor(settings, method);
    Guidance g = f.update(supervisor, true);
    Seconds kept = 0.0F;
    while (g.wants_control && kept < 10.0F) {
        EXPECT_NEAR((g.velocity - Vec3(5, 0, 0)).norm(), 0.0F, 1e-3F);
        f.pass(g.velocity, 0.05F);
        kept += 0.05F;
        g = f.update(supervisor, true);
    }
    EXPECT_NEAR(kept, 2.0F, 0.06F) << "a conflict that comes and goes makes one take-over";
    EXPECT_EQ(g.state, State::watching);
    EXPECT_NEAR((g.velocity - Vec3(5, 0, 0)).norm(), 0.0F, 1e-3F) << "valid all the same: it may be flown for a while";
    f.scene.own.position = Vec3(20, 8, 30);
    const Guidance off = f.update(supervisor, true);
    EXPECT_EQ(off.state, State::rejoining);
    EXPECT_TRUE(off.wants_control);
    EXPECT_LT(off.velocity.y(), -1.0F);
}

TEST(Watching, InControlWithAConflictToComeItFollowsTheWay)
{
    Flight f;
    head_on(f, 72.0F);
    FakeMethod method = never();
    Supervisor supervisor(quick(), method);
    const Guidance g = f.update(supervisor, true);
    EXPECT_EQ(g.state, State::rejoining);
    EXPECT_NEAR((g.velocity - Vec3(5, 0, 0)).norm(), 0.0F, 1e-3F);
}

}  // namespace
}  // namespace jink::avoid
