// SPDX-License-Identifier: BSD-3-Clause
#include "core/avoid/supervisor.hpp"

#include <cstring>

#include <gtest/gtest.h>

#include "tests/unit/core/avoid/fakes.hpp"

namespace jink::avoid {
namespace {

using namespace test;
using world::ManoeuvreKind;

const Vec3 kLeft(0, 1, 0);
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

Settings quick()
{
    Settings s;
    s.settle = 0.5F;
    return s;
}

/// A threat that comes head on and is `ahead` metres away.
void head_on(Flight& f, float ahead = 40.0F)
{
    f.scene.track(f.scene.own.position + Vec3(ahead, 0, 0), Vec3(-5, 0, 0), 1.0F);
}

// --- watching
// ------------------------------------------------------------------------------------------------------------------

TEST(Watching, NothingToDoWithoutAConflict)
{
    Flight f;
    FakeMethod method = always(kLeft);
    Supervisor supervisor(quick(), method);
    const Guidance g = f.update(supervisor, false);
    EXPECT_EQ(g.state, State::watching);
    EXPECT_FALSE(g.wants_control);
    EXPECT_FALSE(g.has_conflict);
    EXPECT_EQ(g.plan_status, PlanStatus::no_conflict);
    EXPECT_EQ(method.asked, 0);
    EXPECT_EQ(supervisor.diagnostics().updates, 1U);
    EXPECT_EQ(supervisor.flying(), nullptr);
}

TEST(Watching, AConflictFarAheadIsToldButNotPlannedFor)
{
    Flight f;
    head_on(f, 72.0F);  // loss in 7 s
    FakeMethod method = always(kLeft);
    Supervisor supervisor(quick(), method);
    const Guidance g = f.update(supervisor, false);
    EXPECT_TRUE(g.has_conflict);
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
    EXPECT_NEAR(g.conflict.time_to_loss, vehicle::stopping_time(5.0F, f.scene.limits) + 0.75F, 0.06F);
    EXPECT_NE(g.kind, ManoeuvreKind::follow_path);
}

TEST(Watching, GrantedWithoutAReasonItKeepsToTheLegAndLetsGo)
{
    Flight f;
    FakeMethod method = always(kLeft);
    Supervisor supervisor(quick(), method);
    const Guidance g = f.update(supervisor, true);
    EXPECT_EQ(g.state, State::watching);
    EXPECT_FALSE(g.wants_control);
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

// --- avoiding
// --------------------------------------------------------------------------------------------------------------------

/// Brings a supervisor to `avoiding` around a head-on threat.
template <class S>
Guidance avoid_head_on(Flight& f, S& supervisor)
{
    head_on(f);
    static_cast<void>(f.update(supervisor, false));
    return f.update(supervisor, true);
}

TEST(Avoiding, BeginsWithControl)
{
    Flight f;
    FakeMethod method = always(kLeft);
    Supervisor supervisor(quick(), method);
    const Guidance g = avoid_head_on(f, supervisor);
    EXPECT_EQ(g.state, State::avoiding);
    EXPECT_TRUE(g.new_manoeuvre);
    EXPECT_EQ(supervisor.diagnostics().manoeuvres, 1U);
    EXPECT_EQ(supervisor.diagnostics().replans, 0U);
}

TEST(Avoiding, KeepsWhatItFliesWhileThatIsSafe)
{
    Flight f;
    FakeMethod method = always(kLeft);
    Supervisor supervisor(quick(), method);
    Guidance g = avoid_head_on(f, supervisor);
    const TimePoint begun = supervisor.flying()->start;
    const int asked = method.asked;
    for (int i = 0; i < 30; ++i) {
        f.pass(g.velocity, 0.1F);
        g = f.update(supervisor, true);
        ASSERT_EQ(g.state, State::avoiding) << "step " << i;
        ASSERT_FALSE(g.new_manoeuvre);
        ASSERT_GE(g.margin, 0.0F);
    }
    EXPECT_EQ(supervisor.flying()->start, begun);
    EXPECT_EQ(method.asked, asked);
}

/// A method that changes its mind each time is not asked while the picture stays.
TEST(Avoiding, DoesNotFlipWhileThePictureStays)
{
    Flight f;
    float sign = 1.0F;
    FakeMethod method{[&](const Situation& s, WorkBudget&, Manoeuvre& out) {
        sign = -sign;
        out = detour(s, sign * kLeft, 6.0F, 60.0F);
        return PlanStatus::found;
    }};
    Supervisor supervisor(quick(), method);
    Guidance g = avoid_head_on(f, supervisor);
    const Vec3 side = supervisor.flying()->side;
    for (int i = 0; i < 60 && g.state == State::avoiding; ++i) {
        f.pass(g.velocity, 0.1F);
        g = f.update(supervisor, true);
        if (supervisor.flying() != nullptr) {
            ASSERT_EQ(supervisor.flying()->side, side) << "step " << i;
        }
    }
    EXPECT_EQ(supervisor.diagnostics().flips, 0U);
}

TEST(Avoiding, ReplansWhenThePictureChangesAndCountsTheFlip)
{
    Flight f;
    Vec3 side = kLeft;
    FakeMethod method{[&](const Situation& s, WorkBudget&, Manoeuvre& out) {
        out = detour(s, side, 6.0F, 60.0F);
        return PlanStatus::found;
    }};
    Supervisor supervisor(quick(), method);
    Guidance g = avoid_head_on(f, supervisor);
    f.pass(g.velocity, 0.1F);
    f.scene.track(Vec3(22, 6, 30), Vec3::Zero(), 2.0F);  // in the way of the detour
    side = -kLeft;
    g = f.update(supervisor, true);
    EXPECT_EQ(g.state, State::avoiding);
    EXPECT_TRUE(g.new_manoeuvre);
    EXPECT_EQ(supervisor.flying()->side, -kLeft);
    EXPECT_EQ(supervisor.diagnostics().replans, 1U);
    EXPECT_EQ(supervisor.diagnostics().flips, 1U);
    EXPECT_EQ(supervisor.diagnostics().manoeuvres, 1U);
}

TEST(Avoiding, AReplanOnTheSameSideIsNoFlip)
{
    Flight f;
    float width = 6.0F;
    FakeMethod method{[&](const Situation& s, WorkBudget&, Manoeuvre& out) {
        out = detour(s, kLeft, width, 60.0F);
        return PlanStatus::found;
    }};
    Supervisor supervisor(quick(), method);
    Guidance g = avoid_head_on(f, supervisor);
    f.pass(g.velocity, 0.1F);
    f.scene.track(Vec3(30, 6, 30), Vec3::Zero(), 1.0F);
    width = 11.0F;
    g = f.update(supervisor, true);
    EXPECT_TRUE(g.new_manoeuvre);
    EXPECT_EQ(supervisor.diagnostics().replans, 1U);
    EXPECT_EQ(supervisor.diagnostics().flips, 0U);
}

TEST(Avoiding, UnsafeWithoutAnotherPlanItFliesOnUntilItMustBrake)
{
    Flight f;
    bool finds = true;
    FakeMethod method{[&](const Situation& s, WorkBudget&, Manoeuvre& out) {
        out = detour(s, kLeft, 6.0F, 60.0F);
        return finds ? PlanStatus::found : PlanStatus::none_available;
    }};
    Supervisor supervisor(quick(), method);
    Guidance g = avoid_head_on(f, supervisor);
    finds = false;
    f.pass(g.velocity, 0.1F);
    f.scene.track(Vec3(30, 6, 30), Vec3::Zero(), 2.0F);  // met in 6 s
    g = f.update(supervisor, true);
    EXPECT_EQ(g.state, State::avoiding);
    EXPECT_LT(g.margin, 0.0F) << "and says so";
    while (g.state == State::avoiding) {
        f.pass(g.velocity, 0.05F);
        g = f.update(supervisor, true);
        WorkBudget budget(world::test::kPlenty);
        ASSERT_GE(world::separation_at(f.scene.situation(), f.scene.own.position, 0.0F, budget).margin, 0.0F);
    }
    EXPECT_EQ(g.state, State::braking);
    EXPECT_EQ(supervisor.diagnostics().brakes, 1U);
}

/// What counts is when the margin is entered, not when it is at its worst: behind the surface of a large threat that is
/// late.
TEST(Avoiding, BrakesBeforeTheSurfaceOfALargeThreatNotBeforeItsMiddle)
{
    Flight f;
    bool finds = true;
    FakeMethod method{[&](const Situation& s, WorkBudget&, Manoeuvre& out) {
        out = detour(s, kLeft, 6.0F, 60.0F);
        return finds ? PlanStatus::found : PlanStatus::none_available;
    }};
    Supervisor supervisor(quick(), method);
    Guidance g = avoid_head_on(f, supervisor);
    finds = false;
    f.pass(g.velocity, 0.1F);
    f.scene.tracks.clear();
    f.scene.track(Vec3(45, 5, 30), Vec3::Zero(), 15.0F);
    for (int i = 0; i < 400; ++i) {
        g = f.update(supervisor, true);
        WorkBudget budget(world::test::kPlenty);
        ASSERT_GE(world::separation_at(f.scene.situation(), f.scene.own.position, 0.0F, budget).margin, 0.0F)
            << "step " << i;
        f.pass(g.velocity, 0.05F);
    }
    EXPECT_GE(supervisor.diagnostics().brakes, 1U);
}

TEST(Avoiding, EndsWithThePath)
{
    Flight f;
    FakeMethod method = always(kLeft);
    Supervisor supervisor(quick(), method);
    Guidance g = avoid_head_on(f, supervisor);
    f.scene.tracks[0].position = Vec3(400, 0, 30);
    f.scene.now = f.scene.now + 100.0F;
    g = f.update(supervisor, true);
    EXPECT_EQ(g.state, State::rejoining);
}

TEST(Avoiding, EndsEarlyWhenTheWayHasBeenClearForAWhile)
{
    Flight f;
    FakeMethod method = always(kLeft);
    Supervisor supervisor(quick(), method);
    Guidance g = avoid_head_on(f, supervisor);
    f.scene.tracks.clear();
    for (int i = 0; i < 4; ++i) {
        f.pass(g.velocity, 0.1F);
        g = f.update(supervisor, true);
        EXPECT_EQ(g.state, State::avoiding) << "not yet trusted";
    }
    f.pass(g.velocity, 0.3F);
    g = f.update(supervisor, true);
    EXPECT_NE(g.state, State::avoiding);
}

// --- rejoining
// ---------------------------------------------------------------------------------------------------------------------

TEST(Rejoining, GetsBackToTheLegAndReleases)
{
    Flight f;
    FakeMethod method = always(kLeft);
    Supervisor supervisor(quick(), method);
    f.scene.own.position = Vec3(20, 8, 32);
    Guidance g = f.update(supervisor, true);
    ASSERT_EQ(g.state, State::rejoining);
    int steps = 0;
    for (; g.wants_control && steps < 400; ++steps) {
        f.pass(g.velocity, 0.05F);
        g = f.update(supervisor, true);
    }
    EXPECT_LT(steps, 400);
    EXPECT_EQ(g.state, State::watching);
    EXPECT_EQ(supervisor.diagnostics().rejoined, 1U);
    EXPECT_LE(std::hypot(f.scene.own.position.y(), f.scene.own.position.z() - 30.0F), 1.0F);
    EXPECT_EQ(supervisor.flying(), nullptr);
    EXPECT_GT(g.velocity.x(), 4.0F) << "still valid: the autopilot needs a moment to take over";
}

TEST(Rejoining, ANewConflictIsAvoided)
{
    Flight f;
    FakeMethod method = always(kLeft, 12.0F);
    Supervisor supervisor(quick(), method);
    f.scene.own.position = Vec3(20, 8, 30);
    ASSERT_EQ(f.update(supervisor, true).state, State::rejoining);
    f.scene.track(Vec3(36, -3, 30), Vec3::Zero(), 2.0F);
    EXPECT_EQ(f.update(supervisor, true).state, State::avoiding);
    EXPECT_EQ(supervisor.diagnostics().manoeuvres, 1U);
}

TEST(Rejoining, ANewConflictWithoutAPlanIsBrakedFor)
{
    Flight f;
    FakeMethod method = never();
    Supervisor supervisor(quick(), method);
    f.scene.own.position = Vec3(20, 8, 30);
    ASSERT_EQ(f.update(supervisor, true).state, State::rejoining);
    f.scene.own.velocity = Vec3(4, -3, 0);
    f.scene.track(f.scene.own.position + Vec3(5, -4, 0), Vec3::Zero(), 1.0F);
    EXPECT_EQ(f.update(supervisor, true).state, State::braking);
}

// --- braking
// -----------------------------------------------------------------------------------------------------------------------

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
    settings.give_ground_limit = 3.0F;
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
            EXPECT_NEAR(g.velocity.norm(), settings.give_ground_speed, 1e-4F);
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

// --- answers that cannot be trusted
// --------------------------------------------------------------------------------------------------

/// Each of these says "found".
struct BadAnswer {
    const char* name;
    void (*make)(const Situation&, Manoeuvre&);
    friend void PrintTo(const BadAnswer& b, std::ostream* out) { *out << b.name; }
};

const BadAnswer kBadAnswers[] = {
    {"straight_on", [](const Situation& s, Manoeuvre& m) { m = detour(s, kLeft, 0.0F, 60.0F); }},
    {"ends_before_the_threat",
     [](const Situation& s, Manoeuvre& m) {
         m = along(s, {s.own.position, s.own.position + Vec3(18, 0, 0)}, kLeft);
     }},
    {"empty", [](const Situation& s, Manoeuvre& m) { m = detour(s, kLeft, 6.0F, 60.0F), m.path.points.clear(); }},
    {"nan_position",
     [](const Situation& s, Manoeuvre& m) { m = detour(s, kLeft, 6.0F, 60.0F), m.path.points[5].position.y() = kNan; }},
    {"nan_velocity",
     [](const Situation& s, Manoeuvre& m) { m = detour(s, kLeft, 6.0F, 60.0F), m.path.points[5].velocity.y() = kNan; }},
    {"nan_time",
     [](const Situation& s, Manoeuvre& m) { m = detour(s, kLeft, 6.0F, 60.0F), m.path.points[5].time = kNan; }},
    {"infinite_end",
     [](const Situation& s, Manoeuvre& m) {
         m = detour(s, kLeft, 6.0F, 60.0F), m.path.points.back().position.x() = std::numeric_limits<float>::infinity();
     }},
    {"times_run_back",
     [](const Situation& s, Manoeuvre& m) {
         m = detour(s, kLeft, 6.0F, 60.0F), std::swap(m.path.points[3].time, m.path.points[4].time);
     }},
    {"time_stands",
     [](const Situation& s, Manoeuvre& m) {
         m = detour(s, kLeft, 6.0F, 60.0F), m.path.points[4].time = m.path.points[3].time;
     }},
    {"starts_in_the_future",
     [](const Situation& s, Manoeuvre& m) { m = detour(s, kLeft, 6.0F, 60.0F), m.start = m.start + 5.0F; }},
    {"underground", [](const Situation& s, Manoeuvre& m) { m = detour(s, Vec3(0, 0, -1), 29.5F, 60.0F); }},
};

struct BadAnswers : testing::TestWithParam<BadAnswer> {};

TEST_P(BadAnswers, AreRejectedAndCounted)
{
    Flight f;
    f.scene.airspace.has_floor = true;
    f.scene.airspace.floor = 2.0F;
    head_on(f);
    FakeMethod method{[&](const Situation& s, WorkBudget&, Manoeuvre& out) {
        GetParam().make(s, out);
        return PlanStatus::found;
    }};
    Supervisor supervisor(quick(), method);
    const Guidance g = f.update(supervisor, true);
    EXPECT_NE(g.state, State::avoiding);
    EXPECT_EQ(g.plan_status, PlanStatus::none_available);
    EXPECT_GE(supervisor.diagnostics().answers_rejected, 1U);
    EXPECT_EQ(supervisor.diagnostics().plans_found, 0U);
    EXPECT_TRUE(is_finite(g.velocity));
}

TEST_P(BadAnswers, TheNextRungIsAsked)
{
    Flight f;
    f.scene.airspace.has_floor = true;
    f.scene.airspace.floor = 2.0F;
    head_on(f);
    FakeMethod bad{[&](const Situation& s, WorkBudget&, Manoeuvre& out) {
        GetParam().make(s, out);
        return PlanStatus::found;
    }};
    FakeMethod good = always(kLeft);
    Supervisor supervisor(quick(), bad, good);
    const Guidance g = f.update(supervisor, true);
    EXPECT_EQ(g.state, State::avoiding);
    EXPECT_EQ(g.plan_status, PlanStatus::found);
    EXPECT_EQ(good.asked, 1);
}

INSTANTIATE_TEST_SUITE_P(Of, BadAnswers, testing::ValuesIn(kBadAnswers),
                         [](const auto& info) { return std::string(info.param.name); });

TEST(Ladder, TheFirstGoodAnswerWinsAndEachStatusIsTold)
{
    for (const PlanStatus status : {PlanStatus::no_conflict, PlanStatus::too_close, PlanStatus::none_available,
                                    PlanStatus::budget_spent, PlanStatus::bad_input}) {
        Flight f;
        head_on(f);
        FakeMethod first = never(status);
        FakeMethod second = never(status);
        Supervisor supervisor(quick(), first, second);
        EXPECT_EQ(f.update(supervisor, false).plan_status, status);
        EXPECT_EQ(first.asked, second.asked);
        EXPECT_EQ(supervisor.diagnostics().answers_rejected, 0U);
    }
    Flight f;
    head_on(f);
    FakeMethod first = always(kLeft);
    FakeMethod second = always(-kLeft);
    Supervisor supervisor(quick(), first, second);
    static_cast<void>(f.update(supervisor, true));
    EXPECT_EQ(second.asked, 0);
    EXPECT_EQ(supervisor.flying()->side, kLeft);
}

TEST(Ladder, AMethodThatSpendsTheBudgetLeavesNothingToTrust)
{
    Flight f;
    head_on(f);
    FakeMethod method{[&](const Situation& s, WorkBudget& budget, Manoeuvre& out) {
        while (budget.spend(1000)) {
        }
        out = detour(s, kLeft, 6.0F, 60.0F);
        return PlanStatus::found;
    }};
    Supervisor supervisor(quick(), method);
    const Guidance g = f.update(supervisor, true);
    EXPECT_NE(g.state, State::avoiding) << "what could not be checked is not flown";
    EXPECT_EQ(supervisor.diagnostics().budget_spent, 1U);
    EXPECT_GE(supervisor.diagnostics().most_work, quick().plan_budget);
    EXPECT_LT(supervisor.diagnostics().most_work, quick().budget) << "checks and fallbacks must have theirs";
}

TEST(Supervisors, TheWorkOfEachUpdateIsTold)
{
    Flight f;
    FakeMethod method{[&](const Situation& s, WorkBudget& budget, Manoeuvre& out) {
        static_cast<void>(budget.spend(5000));
        out = detour(s, kLeft, 6.0F, 60.0F);
        return PlanStatus::found;
    }};
    Supervisor supervisor(quick(), method);
    head_on(f);
    const Guidance busy = f.update(supervisor, false);
    EXPECT_GE(busy.work, 5000U);
    EXPECT_EQ(supervisor.diagnostics().most_work, busy.work);
    f.scene.tracks.clear();
    EXPECT_LT(f.update(supervisor, false).work, 100U);
    EXPECT_EQ(supervisor.diagnostics().most_work, busy.work);
}

TEST(Supervisors, LosingControlForgetsWhatIsFlown)
{
    Flight f;
    FakeMethod method = always(kLeft);
    Supervisor supervisor(quick(), method);
    ASSERT_EQ(avoid_head_on(f, supervisor).state, State::avoiding);
    const Guidance g = f.update(supervisor, false);
    EXPECT_EQ(g.state, State::watching);
    EXPECT_EQ(supervisor.diagnostics().control_lost, 1U);
    EXPECT_TRUE(g.wants_control) << "the conflict is still there";
    static_cast<void>(f.update(supervisor, false));
    EXPECT_EQ(supervisor.diagnostics().control_lost, 1U);
}

TEST(Supervisors, ResetForgetsWhatIsFlownAndKeepsTheCounts)
{
    Flight f;
    FakeMethod method = always(kLeft);
    Supervisor supervisor(quick(), method);
    ASSERT_EQ(avoid_head_on(f, supervisor).state, State::avoiding);
    supervisor.reset();
    EXPECT_EQ(supervisor.state(), State::watching);
    EXPECT_EQ(supervisor.flying(), nullptr);
    EXPECT_EQ(supervisor.diagnostics().manoeuvres, 1U);
}

TEST(Supervisors, SettingsOutOfRangeAreRefused)
{
    FakeMethod method = always(kLeft);
    Supervisor supervisor(Settings{}, method);
    const auto refused = [&](auto change) {
        Settings s;
        change(s);
        EXPECT_EQ(supervisor.configure(s), is_valid(s));
        return !is_valid(s);
    };
    EXPECT_FALSE(refused([](Settings&) {}));
    for (const float bad : {kNan, -0.1F, 1e9F}) {
        EXPECT_TRUE(refused([&](Settings& s) { s.lookahead = bad; }));
        EXPECT_TRUE(refused([&](Settings& s) { s.commit = bad; }));
        EXPECT_TRUE(refused([&](Settings& s) { s.room = bad; }));
        EXPECT_TRUE(refused([&](Settings& s) { s.prediction_step = bad; }));
        EXPECT_TRUE(refused([&](Settings& s) { s.fallback_horizon = bad; }));
        EXPECT_TRUE(refused([&](Settings& s) { s.reserve = bad; }));
        EXPECT_TRUE(refused([&](Settings& s) { s.settle = bad; }));
        EXPECT_TRUE(refused([&](Settings& s) { s.clear_extra = bad; }));
        EXPECT_TRUE(refused([&](Settings& s) { s.on_leg = bad; }));
        EXPECT_TRUE(refused([&](Settings& s) { s.blocked_patience = bad; }));
        EXPECT_TRUE(refused([&](Settings& s) { s.give_ground_speed = bad; }));
        EXPECT_TRUE(refused([&](Settings& s) { s.give_ground_limit = bad; }));
        EXPECT_TRUE(refused([&](Settings& s) { s.gains.position_gain = bad; }));
        EXPECT_TRUE(refused([&](Settings& s) { s.gains.max_correction = bad; }));
        EXPECT_TRUE(refused([&](Settings& s) { s.escape.slack = bad; }));
        EXPECT_TRUE(refused([&](Settings& s) { s.escape.speed = bad; }));
    }
    EXPECT_TRUE(refused([](Settings& s) { s.budget = 999; }));
    EXPECT_TRUE(refused([](Settings& s) { s.plan_budget = 99; }));
    EXPECT_TRUE(refused([](Settings& s) { s.plan_budget = s.budget + 1; }));
    EXPECT_FALSE(refused([](Settings& s) { s.lookahead = 12.0F; }));
    EXPECT_EQ(supervisor.settings().lookahead, 12.0F);
}

}  // namespace
}  // namespace jink::avoid
