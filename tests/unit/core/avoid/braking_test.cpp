// SPDX-License-Identifier: BSD-3-Clause
#include "core/avoid/supervisor.hpp"

#include <gtest/gtest.h>

#include "tests/unit/core/avoid/fakes.hpp"

namespace jink::avoid {
namespace {

using namespace test;
using world::ManoeuvreKind;

TEST(Braking, StopsWhenThatIsClear)
{
    Flight f;
    FakeMethod method = never();
    Supervisor supervisor(quick(), method);
    f.scene.track(Vec3(9, 0, 30), Vec3::Zero(), 1.0F);
    const Guidance g = f.update(supervisor, true);
    EXPECT_EQ(g.state, State::braking);
    EXPECT_EQ(g.kind, ManoeuvreKind::brake);
    EXPECT_EQ(g.velocity, Vec3(0, 0, 0));
    EXPECT_GE(g.margin, 0.0F);
    EXPECT_TRUE(g.wants_control);
    EXPECT_EQ(supervisor.diagnostics().brakes, 1U);
    EXPECT_EQ(supervisor.diagnostics().escapes, 0U);
}

TEST(Braking, GetsOutOfTheWayWhenStandingIsNotClear)
{
    Flight f;
    FakeMethod method = never();
    Supervisor supervisor(quick(), method);
    head_on(f, 14.0F);
    Guidance g = f.update(supervisor, true);
    EXPECT_EQ(g.state, State::braking);
    EXPECT_EQ(g.kind, ManoeuvreKind::velocity);
    EXPECT_EQ(supervisor.diagnostics().escapes, 1U);
    float least = 1e9F;
    const Vec3 command = g.velocity;
    for (int i = 0; i < 60; ++i) {
        f.pass(g.velocity, 0.05F);
        g = f.update(supervisor, true);
        WorkBudget budget(world::test::kPlenty);
        least = std::min(least, world::separation_at(f.scene.situation(), f.scene.own.position, 0.0F, budget).margin);
        if (i < 10) {
            EXPECT_EQ(g.velocity, command) << "no dithering";
        }
    }
    EXPECT_GT(least, 0.0F);
    EXPECT_EQ(supervisor.diagnostics().escapes, 1U);
}

TEST(Braking, APlanEndsIt)
{
    Flight f;
    bool finds = false;
    FakeMethod method{[&](const Situation& s, WorkBudget&, Manoeuvre& out) {
        out = detour(s, kLeft, 6.0F, 60.0F);
        return finds ? PlanStatus::found : PlanStatus::none_available;
    }};
    Supervisor supervisor(quick(), method);
    f.scene.own.velocity = Vec3::Zero();
    f.scene.track(Vec3(11, -2.5F, 30), Vec3::Zero(), 2.0F);
    f.scene.own.velocity = Vec3(5, 0, 0);
    f.scene.tracks[0].position.x() = 10.0F;
    ASSERT_EQ(f.update(supervisor, true).state, State::braking);
    f.scene.own.velocity = Vec3::Zero();
    f.scene.tracks[0].position.x() = 30.0F;
    finds = true;
    const Guidance g = f.update(supervisor, true);
    EXPECT_EQ(g.state, State::avoiding);
    EXPECT_TRUE(g.new_manoeuvre);
}

TEST(Braking, AClearWayEndsIt)
{
    Flight f;
    FakeMethod method = never();
    Supervisor supervisor(quick(), method);
    f.scene.track(Vec3(9, 0, 30), Vec3::Zero(), 1.0F);
    ASSERT_EQ(f.update(supervisor, true).state, State::braking);
    f.scene.tracks.clear();
    EXPECT_EQ(f.update(supervisor, true).state, State::braking) << "not yet trusted";
    f.scene.now = f.scene.now + 0.6F;
    EXPECT_NE(f.update(supervisor, true).state, State::braking);
}

TEST(Braking, GivesGroundToWhatStandsInTheWayButNotForEver)
{
    Flight f;
    FakeMethod method = never();
    Settings settings = quick();
    settings.back_off_limit = 3.0F;
    Supervisor supervisor(settings, method);
    f.scene.track(Vec3(10, 0, 30), Vec3::Zero(), 1.0F);
    Seconds backwards = 0.0F;
    Seconds first = -1.0F;
    for (int i = 0; i < 400; ++i) {
        const Guidance g = f.update(supervisor, true);
        ASSERT_EQ(g.state, State::braking);
        if (g.velocity.x() < -0.5F) {
            backwards += 0.05F;
            first = first < 0.0F ? 0.05F * static_cast<float>(i) : first;
            EXPECT_NEAR(g.velocity.norm(), settings.back_off_speed, 1e-4F);
            EXPECT_EQ(g.kind, ManoeuvreKind::velocity);
        }
        f.pass(g.velocity, 0.05F);
    }
    EXPECT_NEAR(backwards, 3.0F, 0.1F);
    EXPECT_GT(first, settings.blocked_patience) << "patient at first";
    EXPECT_LT(f.scene.own.velocity.norm(), 0.05F);
}

TEST(Braking, DoesNotBackIntoWhatIsBehind)
{
    Flight f;
    FakeMethod method = never();
    Supervisor supervisor(quick(), method);
    f.scene.track(Vec3(9, 0, 30), Vec3::Zero(), 1.0F);
    f.scene.track(Vec3(-1.5F, 0, 30), Vec3::Zero(), 1.0F);
    for (int i = 0; i < 200; ++i) {
        const Guidance g = f.update(supervisor, true);
        f.pass(g.velocity, 0.05F);
        WorkBudget budget(world::test::kPlenty);
        ASSERT_GE(world::separation_at(f.scene.situation(), f.scene.own.position, 0.0F, budget).margin, -0.51F);
    }
}

// Regression: on its path back it turned through traffic beside the path, and reported no conflict.
TEST(Rejoining, AFixedWingKeepsItsCourseWhileTheTurnBackIsNotClear)
{
    for (const bool blocked : {false, true}) {
        Flight f;
        f.scene.limits.kind = vehicle::VehicleKind::fixed_wing;
        f.scene.limits.cruise_speed = 18.0F;
        f.scene.limits.max_acceleration = 4.0F;
        f.scene.limits.velocity_lag = 1.2F;
        f.scene.leg(Vec3(0, 0, 30), Vec3(900, 0, 30), 18.0F);
        f.scene.own.position = Vec3(100, 80, 30);
        f.scene.own.velocity = Vec3(0, 18, 0);
        if (blocked) {
            // On the turn back; the straight path to the leg passes it at 60 m.
            f.scene.track(Vec3(135, 150, 30), Vec3::Zero(), 10.0F);
        }
        FakeMethod method = never();
        Supervisor supervisor(quick(), method);
        const Guidance g = f.update(supervisor, true);
        EXPECT_FALSE(g.conflict.has_value());
        EXPECT_TRUE(g.wants_control);
        if (blocked) {
            EXPECT_NEAR(g.velocity.x(), 0.0F, 1e-3F);
            EXPECT_NEAR(g.velocity.y(), 18.0F, 1e-3F) << "on";
        } else {
            EXPECT_LT(g.velocity.y(), -5.0F) << "back to the leg";
        }
    }
}

TEST(Braking, OfAFixedWingIsATurnThatStays)
{
    Flight f;
    f.scene.limits.kind = vehicle::VehicleKind::fixed_wing;
    f.scene.limits.cruise_speed = 15.0F;
    f.scene.own.velocity = Vec3(15, 0, 0);
    f.scene.leg(Vec3(0, 0, 30), Vec3(900, 0, 30), 15.0F);
    f.scene.track(Vec3(60, -2, 30), Vec3::Zero(), 3.0F);
    FakeMethod method = never();
    Supervisor supervisor(quick(), method);
    Guidance g = f.update(supervisor, true);
    for (int i = 0; i < 200 && g.state != State::braking; ++i) {
        f.pass(g.wants_control ? g.velocity : Vec3(15, 0, 0), 0.05F);
        g = f.update(supervisor, true);
    }
    ASSERT_EQ(g.state, State::braking);
    EXPECT_EQ(g.kind, ManoeuvreKind::hold_turn);
    EXPECT_GT(g.velocity.y(), 1.0F) << "away from it";
    EXPECT_NEAR(g.velocity.norm(), 15.0F, 0.1F) << "no standing in the air";
    const bool left = g.velocity.y() > 0;
    for (int i = 0; i < 20 && g.state == State::braking; ++i) {
        const Vec3 before = f.scene.own.velocity;
        f.pass(g.velocity, 0.05F);
        g = f.update(supervisor, true);
        const float turn = before.x() * f.scene.own.velocity.y() - before.y() * f.scene.own.velocity.x();
        EXPECT_EQ(turn > 0, left) << "step " << i;
    }
}

}  // namespace
}  // namespace jink::avoid
