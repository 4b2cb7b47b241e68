// SPDX-License-Identifier: BSD-3-Clause
// Giving up in front of static obstacles, and giving control back.
#include <cmath>

#include <gtest/gtest.h>

#include "tests/unit/core/avoid/waiting.hpp"

namespace jink::avoid {
namespace {

using namespace test;
using world::ManoeuvreKind;

// --- giving up ---

/// Blocked since the first update; nothing backs off.
Settings giving_up(Seconds patience = 20.0F)
{
    Settings settings = quick();
    settings.back_off_speed = 0.0F;
    settings.patience = patience;
    return settings;
}

TEST(GivingUp, ExactlyAfterThePatience)
{
    AtAWall w(giving_up());
    static_cast<void>(w.update(false));
    const Guidance before = w.wait(19.5F, 0.5F);
    EXPECT_FALSE(before.blocked);
    const Guidance g = w.after(0.5F);
    EXPECT_EQ(g.work, before.work) << "without traffic nothing more is looked at";
    EXPECT_TRUE(g.blocked);
    EXPECT_FALSE(g.wants_control);
    EXPECT_EQ(g.kind, ManoeuvreKind::brake);
    EXPECT_EQ(g.state, State::watching);
    EXPECT_EQ(w.supervisor.flying(), nullptr);
    const Guidance later = w.wait(10.0F, 0.5F);
    EXPECT_TRUE(later.blocked) << "it stays given up";
    EXPECT_EQ(later.kind, ManoeuvreKind::brake);
    EXPECT_EQ(later.velocity, Vec3(0, 0, 0));
    EXPECT_EQ(w.supervisor.diagnostics().blocked, 1U);
    EXPECT_FALSE(w.after(0.1F, false).blocked) << "once control is gone";
    EXPECT_EQ(w.supervisor.diagnostics().control_lost, 0U);
}

/// Too near to the wall as well: it stands, for backing away begins as near. Traffic far away has no part in it.
TEST(GivingUp, InsideAMarginAllTheSame)
{
    AtAWall w(giving_up());
    w.stand(Vec3(58.2F, 0, 30));
    w.f.scene.track(Vec3(2000, 0, 30), Vec3::Zero(), 1.0F);
    static_cast<void>(w.update(false));
    const Guidance before = w.wait(19.5F, 0.5F);
    EXPECT_FALSE(before.blocked);
    const Guidance g = w.after(0.5F);
    EXPECT_TRUE(g.blocked);
    EXPECT_EQ(g.kind, ManoeuvreKind::brake);
    EXPECT_EQ(g.velocity, Vec3(0, 0, 0));
}

/// The earlier manoeuvre is forgotten with it.
TEST(GivingUp, ForgetsWhatWasFlown)
{
    AtAWall w(giving_up());
    bool finds = true;
    w.method = {[&](const Situation& s, WorkBudget&, Manoeuvre& out) {
        out = along(s, {s.own.position, s.own.position - Vec3(20, 0, 0)}, Vec3(0, 0, 0));
        return finds ? PlanStatus::found : PlanStatus::none_available;
    }};
    static_cast<void>(w.update(false));
    ASSERT_EQ(w.update().state, State::avoiding);
    finds = false;
    w.f.scene.obstacle(geometry::make_box(Vec3(53, 0, 30), Vec3(0.8F, 200, 200)));
    ASSERT_EQ(w.update().state, State::braking);
    ASSERT_NE(w.supervisor.flying(), nullptr);
    EXPECT_TRUE(w.wait(20.0F, 0.5F).blocked);
    EXPECT_EQ(w.supervisor.flying(), nullptr);
}

/// More traffic than there is capacity for: no threats are collected, and whether traffic comes is not known.
TEST(GivingUp, NotWhereThreatsWereNeverCollected)
{
    AtAWall w(giving_up(1.0F));
    for (std::size_t i = 0; i <= kMaxTracks; ++i) {
        w.f.scene.track(Vec3(2000, 0, 30), Vec3::Zero(), 1.0F);
    }
    static_cast<void>(w.update(false));
    const Guidance g = w.wait(5.0F, 0.5F);
    EXPECT_EQ(g.state, State::braking);
    EXPECT_FALSE(g.blocked);
    EXPECT_EQ(w.supervisor.diagnostics().blocked, 0U);
}

/// The wall is gone; traffic from the side is still avoided.
TEST(GivingUp, IsOverWhenTrafficComesThoughTheWayIsClear)
{
    AtAWall w(giving_up());
    static_cast<void>(w.update(false));
    ASSERT_TRUE(w.wait(20.0F, 0.5F).blocked);
    w.f.scene.obstacles.clear();
    ASSERT_TRUE(w.after(0.5F).blocked);
    w.f.scene.track(Vec3(55, 14, 30), Vec3(0, -4, 0), 1.0F);  // here in 3 s, when the path has moved on
    const Guidance g = w.after(0.1F);
    EXPECT_FALSE(g.blocked);
    EXPECT_TRUE(g.wants_control);
    w.f.scene.tracks.clear();
    EXPECT_TRUE(w.wait(4.8F).wants_control) << "for the least time";
}

TEST(GivingUp, CountsFromTheTakeOver)
{
    AtAWall w(giving_up());
    static_cast<void>(w.wait(60.0F, 0.5F, false));
    EXPECT_FALSE(w.wait(19.5F, 0.5F).blocked);
    EXPECT_TRUE(w.wait(0.5F, 0.5F).blocked);
}

/// A path along a block that is flown in parts, with stops between them, may take longer than the patience.
TEST(GivingUp, CountsAQuarterOfTheTimeOfManoeuvres)
{
    AtAWall w(giving_up());
    bool finds = false;
    w.method = {[&](const Situation& s, WorkBudget&, Manoeuvre& out) {
        out = along(s, {s.own.position, s.own.position - Vec3(100, 0, 0)}, Vec3(0, 0, 0));
        return finds ? PlanStatus::found : PlanStatus::none_available;
    }};
    static_cast<void>(w.update(false));
    ASSERT_EQ(w.wait(12.0F, 0.5F).state, State::braking);
    finds = true;
    ASSERT_EQ(w.wait(10.0F, 0.5F).state, State::avoiding);
    finds = false;
    w.f.scene.obstacle(geometry::make_box(Vec3(53, 0, 30), Vec3(0.8F, 200, 200)));
    // 12 s, a quarter of 10 s, and 5.5 s.
    const Guidance before = w.wait(5.0F, 0.5F);
    EXPECT_EQ(before.state, State::braking);
    EXPECT_FALSE(before.blocked);
    EXPECT_TRUE(w.wait(0.5F, 0.5F).blocked);
}

/// To and fro within 15 m, with an instant of braking after each 2 s: it gives up after 4 times the patience.
TEST(GivingUp, ComesInTheEndWhereManoeuvresLeadNowhere)
{
    AtAWall w(giving_up());
    w.method = {[&](const Situation& s, WorkBudget&, Manoeuvre& out) {
        out = along(s, {s.own.position, s.own.position - Vec3(100, 0, 0)}, Vec3(0, 0, 0));
        return w.f.scene.obstacles.size() == 1 ? PlanStatus::found : PlanStatus::none_available;
    }};
    static_cast<void>(w.update(false));
    Seconds braked = 0.0F;
    Seconds flown = 0.0F;
    Guidance g;
    for (float at = 55.0F; !g.blocked && flown < 200.0F; at = 110.0F - 7.0F - at) {
        w.stand(Vec3(at, 0, 30));
        ASSERT_EQ(w.wait(2.0F, 0.5F).state, State::avoiding) << flown;
        flown += 2.0F;
        w.f.scene.obstacle(geometry::make_box(Vec3(at - 2.0F, 0, 30), Vec3(0.8F, 200, 200)));
        g = w.after(0.1F);
        braked += 0.1F;
        ASSERT_EQ(g.state, g.blocked ? State::watching : State::braking) << flown;
        w.f.scene.obstacles.pop_back();
    }
    EXPECT_TRUE(g.blocked);
    EXPECT_NEAR(flown / 4.0F + braked, 20.0F, 0.7F);
    EXPECT_EQ(w.supervisor.diagnostics().blocked, 1U);
}

TEST(GivingUp, CountsAnewAfterTraffic)
{
    AtAWall w(giving_up());
    static_cast<void>(w.wait(15.0F, 0.5F));
    w.f.scene.track(Vec3(58, 0, 30), Vec3::Zero(), 1.0F);  // nearer than the wall
    ASSERT_EQ(w.after(0.5F).conflict->threat.kind, world::ThreatKind::track);
    w.f.scene.tracks.clear();
    EXPECT_FALSE(w.wait(19.5F, 0.5F).blocked);
    EXPECT_TRUE(w.wait(0.5F, 0.5F).blocked);
}

TEST(GivingUp, NeverBeforeTrafficThatStands)
{
    Waiting w(giving_up());
    w.stand(Vec3(55, 0, 30));
    w.f.scene.track(Vec3(58.2F, 0, 30), Vec3::Zero(), 1.0F);
    EXPECT_FALSE(w.wait(60.0F, 0.5F).blocked);
    EXPECT_EQ(w.supervisor.diagnostics().blocked, 0U);
}

/// 15 m are nowhere, more is somewhere.
TEST(GivingUp, CountsAnewWhereTheVehicleGetsSomewhere)
{
    AtAWall near(giving_up());
    static_cast<void>(near.wait(15.0F, 0.5F));
    near.f.scene.leg(Vec3(0, 15, 30), Vec3(300, 15, 30));
    near.stand(Vec3(55, 15, 30));
    EXPECT_TRUE(near.wait(5.5F, 0.5F).blocked);
    AtAWall far(giving_up());
    static_cast<void>(far.wait(15.0F, 0.5F));
    far.f.scene.leg(Vec3(0, 15.1F, 30), Vec3(300, 15.1F, 30));
    far.stand(Vec3(55, 15.1F, 30));
    EXPECT_FALSE(far.wait(19.5F, 0.5F).blocked);
    EXPECT_TRUE(far.wait(1.0F, 0.5F).blocked);
}

TEST(GivingUp, OnlyAtRest)
{
    AtAWall w(giving_up());
    static_cast<void>(w.wait(15.0F, 0.5F));
    w.f.scene.own.velocity = Vec3(-0.3F, 0, 0);
    EXPECT_FALSE(w.wait(10.0F, 0.5F).blocked);
    w.f.scene.own.velocity = Vec3(-0.29F, 0, 0);
    EXPECT_TRUE(w.after(0.5F).blocked);
}

TEST(GivingUp, NeverOfAFixedWing)
{
    AtAWall w(giving_up());
    w.f.scene.limits.kind = vehicle::VehicleKind::fixed_wing;
    EXPECT_EQ(w.wait(30.0F, 0.5F).state, State::braking);
    EXPECT_EQ(w.supervisor.diagnostics().blocked, 0U);
}

TEST(GivingUp, NotWhereTheWayHasJustBecomeClear)
{
    AtAWall w(giving_up());
    static_cast<void>(w.update(false));
    EXPECT_FALSE(w.wait(19.5F, 0.5F).blocked);
    w.f.scene.obstacles.clear();
    EXPECT_FALSE(w.after(0.6F).blocked);
    EXPECT_NE(w.after(0.6F).state, State::braking);
    EXPECT_EQ(w.supervisor.diagnostics().blocked, 0U);
}

TEST(GivingUp, NotWhileAManoeuvreIsFlown)
{
    Waiting w(giving_up());
    w.method = {[](const Situation& s, WorkBudget&, Manoeuvre& out) {
        out = detour(s, kLeft, 8.0F, 80.0F);
        return PlanStatus::found;
    }};
    w.f.scene.obstacle(geometry::make_sphere(Vec3(30, 0, 30), 2.0F));
    w.stand(Vec3(20, 0, 30));
    for (int i = 0; i < 60; ++i) {
        const Guidance g = w.after(0.5F);
        ASSERT_TRUE(g.conflict.has_value());
        ASSERT_NE(g.state, State::braking);
        ASSERT_FALSE(g.blocked) << i;
    }
}

/// The wall is the first and main conflict; traffic from the side still counts.
TEST(GivingUp, NotWhileTrafficComes)
{
    const auto blocked = [](float distance, float height) {
        AtAWall w(giving_up());
        static_cast<void>(w.update(false));
        EXPECT_FALSE(w.wait(19.5F, 0.5F).blocked);
        w.f.scene.track(Vec3(55, distance, 30.0F + height), Vec3(0, -4, 0), 1.0F);
        const Guidance g = w.after(0.5F);
        EXPECT_EQ(w.supervisor.diagnostics().blocked, g.blocked ? 1U : 0U);
        EXPECT_EQ(g.state, g.blocked ? State::watching : State::braking);
        return g.blocked;
    };
    EXPECT_FALSE(blocked(16.0F, 0.0F)) << "here in 3.5 s";
    EXPECT_TRUE(blocked(20.0F, 0.0F)) << "in 4.5 s";
    EXPECT_TRUE(blocked(10.0F, 4.0F)) << "and above it";
    EXPECT_TRUE(blocked(10.0F, 2.0F)) << "touching is not coming too near";
    EXPECT_FALSE(blocked(10.0F, 1.99F));
    EXPECT_TRUE(blocked(1000.0F, 0.0F));
}

// --- reasons to keep control ---

/// In control, clear path: control is returned after the least time, and once.
struct GivenBack : Waiting {
    GivenBack() : Waiting(quick())
    {
        EXPECT_TRUE(update().wants_control);
        EXPECT_FALSE(wait(6.0F).wants_control);
    }
};

TEST(GivenBackControl, IsNotTakenBackWhileNothingHappens)
{
    GivenBack w;
    for (int i = 0; i < 30; ++i) {
        const Guidance g = w.after(0.1F);
        ASSERT_FALSE(g.wants_control);
        ASSERT_EQ(g.state, State::watching);
        ASSERT_EQ(g.velocity, Vec3(5, 0, 0)) << "the way's velocity stays valid";
    }
    EXPECT_EQ(w.supervisor.diagnostics().rejoined, 1U);
    EXPECT_EQ(w.supervisor.diagnostics().conflicts, 0U) << "there was none";
    EXPECT_FALSE(w.after(0.1F, false).wants_control);
    EXPECT_EQ(w.supervisor.diagnostics().control_lost, 0U) << "it was not wanted any more";
}

/// Each take-over has its own least time, independent of the previous one.
TEST(GivenBackControl, IsKeptForTheLeastTimeWhenItIsTakenAnew)
{
    GivenBack w;
    static_cast<void>(w.wait(2.0F, 0.1F, false));
    EXPECT_TRUE(w.after(0.1F).wants_control);
    EXPECT_TRUE(w.wait(4.9F).wants_control);
    EXPECT_FALSE(w.after(0.1F).wants_control);
}

TEST(GivenBackControl, IsKeptAfterAllForAConflictToCome)
{
    GivenBack w;
    head_on(w.f, 72.0F);  // loss in 7 s: nothing to plan for yet
    const Guidance g = w.after(0.02F);
    EXPECT_EQ(g.state, State::rejoining);
    EXPECT_TRUE(g.wants_control);
    EXPECT_EQ(w.method.asked, 0) << "and nothing is planned";
    w.f.scene.tracks.clear();
    EXPECT_TRUE(w.wait(4.8F).wants_control) << "for the least time once more";
    EXPECT_FALSE(w.wait(0.5F).wants_control);
    EXPECT_EQ(w.supervisor.diagnostics().rejoined, 2U);
}

TEST(GivenBackControl, IsKeptAfterAllWhereTheVehicleIsFarOffItsLeg)
{
    GivenBack w;
    w.f.scene.own.position.y() = 2.0F;  // twice the tolerance of being on the leg
    EXPECT_FALSE(w.after(0.1F).wants_control);
    w.f.scene.own.position.y() = 2.01F;
    const Guidance g = w.after(0.1F);
    EXPECT_TRUE(g.wants_control);
    EXPECT_EQ(g.state, State::rejoining);
    w.f.scene.own.position.y() = 0.0F;
    EXPECT_TRUE(w.wait(4.9F).wants_control) << "for the least time once more";
    EXPECT_FALSE(w.after(0.1F).wants_control);
}

/// Definition of being back on the leg.
TEST(GivingBack, WithinTheLegsWidth)
{
    const auto given_back = [](float off) {
        Settings settings = quick();
        settings.settle = settings.least_control = 0.0F;
        Waiting w(settings);
        w.f.scene.own.position.z() += off;
        return !w.update().wants_control;
    };
    EXPECT_TRUE(given_back(1.0F));
    EXPECT_FALSE(given_back(std::nextafter(1.0F, 2.0F) + 4e-6F));
}

TEST(GivingBack, WhenTheWayHasBeenClearForTheSettlingTime)
{
    Settings settings = quick();
    settings.least_control = 0.0F;
    Waiting w(settings);
    EXPECT_TRUE(w.update().wants_control);
    EXPECT_TRUE(w.wait(0.4F).wants_control);
    EXPECT_FALSE(w.after(0.1F).wants_control);
}

TEST(GivingBack, AfterTheLeastTimeOfControl)
{
    Settings settings = quick();
    settings.least_control = 3.0F;
    Waiting w(settings);
    static_cast<void>(w.wait(10.0F, 0.1F, false));
    EXPECT_TRUE(w.after(0.1F).wants_control);
    EXPECT_TRUE(w.wait(2.9F).wants_control) << "from the take-over on, not from before";
    EXPECT_FALSE(w.after(0.1F).wants_control);
}

}  // namespace
}  // namespace jink::avoid
