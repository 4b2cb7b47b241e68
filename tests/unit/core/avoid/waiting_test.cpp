// SPDX-License-Identifier: BSD-3-Clause
// Fallbacks while they last: offers and counts, reset(), and backing off.
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "tests/numbers.hpp"
#include "tests/unit/core/avoid/waiting.hpp"

namespace jink::avoid {
namespace {

using namespace test;
using world::ManoeuvreKind;

// --- offers and counts ---

TEST(Fallbacks, AreOfferedWithoutControlAndCountedWithIt)
{
    Waiting w;
    head_on(w.f, 14.0F);
    for (int i = 0; i < 3; ++i) {
        const Guidance g = w.update(false);
        EXPECT_EQ(g.state, State::watching);
        EXPECT_TRUE(g.wants_control);
        EXPECT_EQ(g.kind, ManoeuvreKind::velocity);
    }
    EXPECT_EQ(w.supervisor.diagnostics().brakes, 0U);
    EXPECT_EQ(w.supervisor.diagnostics().escapes, 0U);
    for (int i = 0; i < 3; ++i) {
        EXPECT_EQ(w.update(true).state, State::braking);
    }
    EXPECT_EQ(w.supervisor.diagnostics().brakes, 1U);
}

TEST(Fallbacks, EachBeginningOfAnEscapeIsCounted)
{
    Waiting w;
    w.f.scene.track(Vec3(9, 0, 30), Vec3::Zero(), 1.0F);
    EXPECT_EQ(w.update().kind, ManoeuvreKind::brake);
    w.stand(Vec3(0, 0, 30));
    w.f.scene.tracks[0].position.x() = 5.0F;
    EXPECT_EQ(w.update().kind, ManoeuvreKind::brake);
    EXPECT_EQ(w.supervisor.diagnostics().escapes, 0U);
    w.f.scene.tracks[0].velocity = Vec3(-4, 0, 0);
    EXPECT_EQ(w.update().kind, ManoeuvreKind::velocity);
    EXPECT_EQ(w.supervisor.diagnostics().escapes, 1U) << "from standing to moving";
    EXPECT_EQ(w.update().kind, ManoeuvreKind::velocity);
    EXPECT_EQ(w.supervisor.diagnostics().escapes, 1U);
    w.f.scene.tracks[0].velocity = Vec3::Zero();
    EXPECT_EQ(w.update().kind, ManoeuvreKind::brake);
    w.f.scene.tracks[0].velocity = Vec3(-4, 0, 0);
    EXPECT_EQ(w.update().kind, ManoeuvreKind::velocity);
    EXPECT_EQ(w.supervisor.diagnostics().escapes, 2U);
    EXPECT_EQ(w.supervisor.diagnostics().brakes, 1U) << "all of it is one fallback";
    // Over, and begun once more.
    w.f.scene.tracks.clear();
    static_cast<void>(w.after(0.1F));
    EXPECT_EQ(w.wait(0.6F).state, State::rejoining);
    w.f.scene.track(Vec3(5, 0, 30), Vec3(-4, 0, 0), 1.0F);
    EXPECT_EQ(w.update().kind, ManoeuvreKind::velocity);
    EXPECT_EQ(w.supervisor.diagnostics().escapes, 3U);
    EXPECT_EQ(w.supervisor.diagnostics().brakes, 2U);
}

/// A fallback that is over does not stay: the next one is chosen afresh.
TEST(Fallbacks, OfAFormerConflictAreForgotten)
{
    for (const bool in_control : {true, false}) {
        Waiting w;
        w.stand(Vec3(0, 0, 30));
        w.f.scene.leg(Vec3(0, 0, 30), Vec3(0, 0, 30));
        w.f.scene.track(Vec3(0.4F, 12, 30), Vec3(0, -7, 0), 1.0F);
        const Guidance first = w.update(in_control);
        ASSERT_EQ(first.kind, ManoeuvreKind::velocity);
        w.f.scene.tracks.clear();
        static_cast<void>(w.wait(1.0F, 0.1F, in_control));
        w.f.scene.track(Vec3(-0.4F, 12, 30), Vec3(0, -7, 0), 1.0F);
        WorkBudget budget(world::test::kPlenty);
        const Situation s = w.f.scene.situation();
        ASSERT_GE(command_margin(s, first.velocity, w.settings, budget), 0.0F) << "it would do";
        const Guidance g = w.update(in_control);
        const Fallback fresh = choose_fallback(s, world::way_of(s), nullptr, w.settings, budget);
        ASSERT_NE(fresh.command, first.velocity);
        EXPECT_EQ(g.velocity, fresh.command);
        EXPECT_EQ(g.margin, fresh.margin);
    }
}

/// A fallback that ended with a plan does not stay either.
TEST(Fallbacks, BeforeAManoeuvreAreForgotten)
{
    Waiting w;
    bool finds = false;
    w.method = {[&](const Situation& s, WorkBudget&, Manoeuvre& out) {
        out = along(s, {s.own.position, s.own.position + Vec3(0, 0, 12)}, Vec3(0, 0, 1));
        return finds ? PlanStatus::found : PlanStatus::none_available;
    }};
    w.stand(Vec3(0, 0, 30));
    w.f.scene.leg(Vec3(0, 0, 30), Vec3(0, 0, 30));
    w.f.scene.track(Vec3(0.4F, 12, 30), Vec3(0, -7, 0), 1.0F);
    const Guidance first = w.update();
    ASSERT_EQ(first.state, State::braking);
    ASSERT_EQ(first.kind, ManoeuvreKind::velocity);
    finds = true;
    ASSERT_EQ(w.update().state, State::avoiding);
    finds = false;
    w.f.scene.tracks[0].position = Vec3(-0.4F, 12, 31.0F);
    w.f.scene.tracks[0].radius = 3.0F;
    WorkBudget budget(world::test::kPlenty);
    const Situation s = w.f.scene.situation();
    const Fallback fresh = choose_fallback(s, world::way_of(s), nullptr, w.settings, budget);
    const Fallback before{ManoeuvreKind::velocity, first.velocity, 0.0F};
    ASSERT_NE(choose_fallback(s, world::way_of(s), &before, w.settings, budget).command, fresh.command);
    const Guidance g = w.update();
    ASSERT_EQ(g.state, State::braking);
    EXPECT_EQ(g.velocity, fresh.command);
}

/// A fixed wing turns away to either side.
TEST(Fallbacks, OfAFixedWingTurnToTheSideThatIsFree)
{
    for (const float side : {1.0F, -1.0F}) {
        Waiting w;
        w.f.scene.limits.kind = vehicle::VehicleKind::fixed_wing;
        w.f.scene.limits.cruise_speed = 15.0F;
        w.f.scene.own.velocity = Vec3(15, 0, 0);
        w.f.scene.leg(Vec3(0, 0, 30), Vec3(900, 0, 30), 15.0F);
        w.f.scene.track(Vec3(40, side * 3.0F, 30), Vec3::Zero(), 3.0F);
        const Guidance g = w.update();
        EXPECT_EQ(g.kind, ManoeuvreKind::hold_turn);
        EXPECT_LT(side * g.velocity.y(), -0.5F);
    }
}

/// Ended in one update, and begun in the next: the earlier fallback neither counts as the beginning nor stays.
TEST(Fallbacks, RightAfterAnotherAreNewOnes)
{
    Settings settings = quick();
    settings.settle = 0.0F;
    Waiting w(settings);
    w.stand(Vec3(0, 0, 30));
    w.f.scene.leg(Vec3(0, 0, 30), Vec3(0, 0, 30));
    w.f.scene.track(Vec3(0.4F, 12, 30), Vec3(0, -7, 0), 1.0F);
    const Guidance first = w.update();
    EXPECT_EQ(first.state, State::braking);
    EXPECT_EQ(first.kind, ManoeuvreKind::velocity);
    w.f.scene.tracks.clear();
    EXPECT_EQ(w.update().state, State::rejoining);
    w.f.scene.track(Vec3(-0.4F, 12, 30), Vec3(0, -7, 0), 1.0F);
    const Guidance g = w.update();
    EXPECT_EQ(g.kind, ManoeuvreKind::velocity);
    EXPECT_LT(g.velocity.x() * first.velocity.x(), 0.0F) << "to the other side";
    EXPECT_EQ(w.supervisor.diagnostics().escapes, 2U);
    EXPECT_EQ(w.supervisor.diagnostics().brakes, 2U);
}

/// After reset() the updates equal those of a new supervisor.
TEST(Reset, LeavesNothingOfFormerFlightsBehind)
{
    for (int kind = 0; kind < 5; ++kind) {
        Waiting w;
        w.method = kind == 1 ? always(kLeft) : never();
        switch (kind) {
        case 0:  // an escape
            w.stand(Vec3(0, 0, 30));
            w.f.scene.track(Vec3(5, 1.0F, 30), Vec3(-4, 0, 0), 1.0F);
            ASSERT_EQ(w.update().state, State::braking);
            break;
        case 1:  // a manoeuvre
            head_on(w.f);
            ASSERT_EQ(w.update().state, State::avoiding);
            break;
        case 2:  // parallel offset
            w.f.scene.own.position = Vec3(20, 8, 30);
            w.f.scene.track(Vec3(27, 0, 30), Vec3(2, 0, 0), 2.0F);
            ASSERT_EQ(w.update().state, State::rejoining);
            ASSERT_EQ(w.supervisor.diagnostics().holds, 1U);
            break;
        case 3:  // given back
            ASSERT_TRUE(w.update().wants_control);
            ASSERT_FALSE(w.wait(6.0F).wants_control);
            break;
        default:  // backing off
            w.stand(Vec3(0, 0, 30));
            w.f.scene.track(Vec3(4, 0, 30), Vec3::Zero(), 1.0F);
            static_cast<void>(w.wait(15.0F));
            break;
        }
        w.supervisor.reset();
        Supervisor fresh(w.settings, w.method);
        EXPECT_EQ(w.supervisor.flying(), nullptr) << kind;
        EXPECT_EQ(w.supervisor.state(), State::watching) << kind;
        w.f.scene.tracks.clear();
        w.stand(Vec3(100, 4, 30));
        w.f.scene.track(Vec3(105, 3.7F, 30), Vec3(-4, 0, 0), 1.0F);
        for (int i = 0; i < 40; ++i) {
            if (i == 10) {
                w.f.scene.tracks[0].velocity = Vec3::Zero();
                w.f.scene.tracks[0].position = w.f.scene.own.position + Vec3(5, -1.5F, 0);
            } else if (i == 30) {
                w.f.scene.tracks.clear();
            }
            const Guidance of_fresh = w.f.update(fresh, i > 1);
            const Guidance g = w.update(i > 1);
            ASSERT_EQ(g.state, of_fresh.state) << kind << ' ' << i;
            ASSERT_EQ(g.velocity, of_fresh.velocity) << kind << ' ' << i;
            ASSERT_EQ(g.kind, of_fresh.kind) << kind << ' ' << i;
            ASSERT_EQ(g.wants_control, of_fresh.wants_control) << kind << ' ' << i;
            ASSERT_EQ(g.margin, of_fresh.margin) << kind << ' ' << i;
            w.f.scene.now = w.f.scene.now + 0.1F;
            w.f.scene.own.stamp = w.f.scene.now;
            for (world::Track& t : w.f.scene.tracks) {
                t.stamp = w.f.scene.now;
            }
        }
    }
}

// --- backing off ---

TEST(BackingOff, BeginsAfterThePatience)
{
    AtAWall w;
    static_cast<void>(w.update());
    static_cast<void>(w.update());
    const Guidance before = w.wait(1.9F);
    EXPECT_EQ(before.kind, ManoeuvreKind::brake);
    EXPECT_EQ(before.velocity, Vec3(0, 0, 0));
    const Guidance g = w.after(0.1F);
    EXPECT_EQ(g.kind, ManoeuvreKind::velocity) << "2 s are enough";
    EXPECT_EQ(g.velocity, Vec3(-1, 0, 0));
}

/// A new wait after each time that the path was clear.
TEST(BackingOff, BeginsAnewAfterTheWayWasClear)
{
    Settings settings = quick();
    settings.settle = 0.0F;
    AtAWall w(settings);
    static_cast<void>(w.update());
    static_cast<void>(w.wait(1.9F));
    const std::vector<world::Obstacle> wall = w.f.scene.obstacles;
    w.f.scene.obstacles.clear();
    EXPECT_EQ(w.after(0.05F).state, State::rejoining);
    w.f.scene.obstacles = wall;
    EXPECT_EQ(w.after(0.05F).state, State::braking);
    EXPECT_EQ(w.wait(1.9F).kind, ManoeuvreKind::brake);
}

/// Slightly faster than the back-off speed the vehicle is not static, and the wait restarts.
TEST(BackingOff, ByAVehicleThatStandsAlone)
{
    Settings settings = quick();
    settings.blocked_patience = 0.0F;
    AtAWall w(settings);
    w.f.scene.own.velocity = Vec3(0.3F + 1.0F, 0, 0);
    EXPECT_EQ(w.update().kind, ManoeuvreKind::brake);
    EXPECT_EQ(w.update().kind, ManoeuvreKind::brake);
    w.f.scene.own.velocity = Vec3(std::nextafter(1.3F, 0.0F), 0, 0);
    EXPECT_EQ(w.update().kind, ManoeuvreKind::velocity);
    AtAWall patient;
    static_cast<void>(patient.update());
    static_cast<void>(patient.wait(1.5F));
    patient.f.scene.own.velocity = Vec3(-2, 0, 0);
    static_cast<void>(patient.after(0.1F));
    patient.f.scene.own.velocity = Vec3::Zero();
    EXPECT_EQ(patient.wait(1.5F).kind, ManoeuvreKind::brake) << "1.5 s since it moved";
    EXPECT_EQ(patient.wait(0.7F).kind, ManoeuvreKind::velocity);
}

TEST(BackingOff, NeverAtSpeedZeroNorBeyondTheLimit)
{
    Settings settings = quick();
    settings.back_off_speed = 0.0F;
    AtAWall none(settings);
    EXPECT_EQ(none.wait(10.0F).kind, ManoeuvreKind::brake);
    settings = quick();
    settings.back_off_limit = 0.0F;
    AtAWall limited(settings);
    for (int i = 0; i < 60; ++i) {
        ASSERT_EQ(limited.after(0.1F).velocity, Vec3(0, 0, 0)) << i;
    }
}

/// Per conflict so much, a pause between updates counting as a second at most; a new conflict has its own.
TEST(BackingOff, UntilTheLimitOfEachConflict)
{
    Settings settings = quick();
    settings.blocked_patience = 0.0F;
    settings.back_off_limit = 2.5F;
    settings.patience = 0.0F;
    AtAWall w(settings);
    const auto backs = [&](Seconds dt) { return w.after(dt).kind == ManoeuvreKind::velocity; };
    EXPECT_EQ(w.update().kind, ManoeuvreKind::brake);
    EXPECT_TRUE(backs(0.5F));
    EXPECT_TRUE(backs(0.5F));
    EXPECT_TRUE(backs(20.0F));
    EXPECT_TRUE(backs(1.0F));
    EXPECT_FALSE(backs(0.5F)) << "it has";
    w.f.scene.obstacles.clear();
    static_cast<void>(w.after(0.1F));
    w.f.scene.obstacle(geometry::make_box(Vec3(60, 0, 30), Vec3(1, 200, 200)));
    EXPECT_TRUE(backs(0.1F)) << "another conflict";
}

/// An escape from traffic follows the fallback, not backwards.
TEST(BackingOff, NotWhileEscaping)
{
    Settings settings = quick();
    settings.blocked_patience = 0.0F;
    AtAWall w(settings);
    w.f.scene.track(Vec3(55, 8, 30.4F), Vec3(0, -3, 0), 1.0F);
    for (int i = 0; i < 3; ++i) {
        const Guidance g = w.after(0.01F);
        WorkBudget budget(world::test::kPlenty);
        ASSERT_GE(command_margin(w.f.scene.situation(), Vec3(-1, 0, 0), settings, budget), 0.0F)
            << "backwards is clear";
        ASSERT_EQ(g.kind, ManoeuvreKind::velocity);
        EXPECT_GT(g.velocity.norm(), 2.0F);
    }
}

/// Exactly on the floor is clear.
TEST(BackingOff, WhereBackwardsIsExactlyClear)
{
    Settings settings = quick();
    settings.blocked_patience = 0.0F;
    AtAWall w(settings);
    w.f.scene.airspace.has_floor = true;
    w.f.scene.airspace.floor = 29.0F;
    EXPECT_EQ(w.update().kind, ManoeuvreKind::brake);
    EXPECT_EQ(w.update().velocity, Vec3(-1, 0, 0));
    w.f.scene.airspace.has_keep_in = true;
    w.f.scene.airspace.home = Vec3(76, 0, 0);
    w.f.scene.airspace.keep_in_radius = 23.0F;
    EXPECT_EQ(w.update().velocity, Vec3(0, 0, 0)) << "there is no room behind";
}

}  // namespace
}  // namespace jink::avoid
