// SPDX-License-Identifier: BSD-3-Clause
// The flown manoeuvre, and its replacements: other sides, faster manoeuvres, velocities.
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "tests/unit/core/avoid/scripted.hpp"

namespace jink::avoid {
namespace {

using namespace test;
using world::ManoeuvreKind;

// --- the other side ---

/// The leg is blocked, and so is the flown detour to the left: only up is free. `side`: the new answer's named side.
std::uint32_t replans_at_once(const Vec3& first_side, const Vec3& next_side)
{
    Scripted t;
    bool up = false;
    t.next = [&](const Situation& s, Manoeuvre& out) {
        out = up ? detour(s, Vec3(0, 0, 1), 12.0F, 50.0F) : detour(s, kLeft, 6.0F, 60.0F);
        out.side = up ? next_side : first_side;
        return PlanStatus::found;
    };
    Supervisor supervisor(quick(), t.method);
    EXPECT_EQ(avoid_head_on(t.f, supervisor).state, State::avoiding);
    t.f.scene.track(Vec3(33, 5, 30), Vec3::Zero(), 4.0F);  // contact in 5 s
    up = true;
    const Guidance g = t.f.update(supervisor, true);
    EXPECT_EQ(g.state, State::avoiding);
    EXPECT_EQ(g.plan_status, PlanStatus::found);
    EXPECT_EQ(g.new_manoeuvre, supervisor.diagnostics().replans == 1U);
    EXPECT_EQ(g.margin < 0.0F, !g.new_manoeuvre) << "it is said what is flown";
    EXPECT_EQ(supervisor.diagnostics().flips, 0U);
    return supervisor.diagnostics().replans;
}

TEST(OtherSide, IsMoreThanATenthOpposite)
{
    const float c = std::sqrt(0.99F);
    EXPECT_EQ(replans_at_once(kLeft, Vec3(0, 1, 0)), 1U);
    EXPECT_EQ(replans_at_once(kLeft, Vec3(0, 0, 1)), 1U) << "square to it is not the other side";
    EXPECT_EQ(replans_at_once(kLeft, Vec3(0, -0.1F, c)), 1U) << "nor is exactly a tenth";
    EXPECT_EQ(replans_at_once(kLeft, Vec3(0, -0.11F, c)), 0U);
    EXPECT_EQ(replans_at_once(kLeft, Vec3(0, -1, 0)), 0U);
}

/// The side that is flown, and the side that was chosen, each by itself.
TEST(OtherSide, OfWhatIsFlownOrOfWhatWasChosen)
{
    const auto replans = [](const Vec3& chosen, const Vec3& next, float off) {
        Scripted t;
        bool up = false;
        t.next = [&](const Situation& s, Manoeuvre& out) {
            out = up ? detour(s, Vec3(0, 0, 1), 14.0F, 50.0F) : detour(s, kLeft, 6.0F, 60.0F);
            out.side = up ? next : chosen;
            return PlanStatus::found;
        };
        t.f.scene.rules.lookahead = 6.0F;
        Supervisor supervisor(quick(), t.method);
        EXPECT_EQ(avoid_head_on(t.f, supervisor).state, State::avoiding);
        t.f.scene.own.position.y() = off;
        t.f.scene.track(Vec3(33, 5, 30), Vec3::Zero(), 4.0F);
        up = true;
        EXPECT_EQ(t.f.update(supervisor, true).state, State::avoiding);
        return supervisor.diagnostics().replans;
    };
    // Named "up", flown to the left (2 m): answers named "down" or "right" reverse the side, "forward" does not.
    EXPECT_EQ(replans(Vec3(0, 0, 1), Vec3(0, 0, -1), 2.0F), 0U);
    EXPECT_EQ(replans(Vec3(0, 0, 1), Vec3(0, -1, 0), 2.0F), 0U);
    EXPECT_EQ(replans(Vec3(0, 0, 1), Vec3(1, 0, 0), 2.0F), 1U);
    // On the leg, or no farther off than counts as on it, the called side alone is known.
    EXPECT_EQ(replans(Vec3(0, 0, 1), Vec3(0, -1, 0), 1.0F), 1U);
    EXPECT_EQ(replans(Vec3(0, 0, 1), Vec3(0, -1, 0), 1.01F), 0U);
}

TEST(OtherSide, ATurnOverIsCountedByTheSideThatIsFlown)
{
    const auto flips = [](const Vec3& next) {
        Scripted t;
        bool other = false;
        t.next = [&](const Situation& s, Manoeuvre& out) {
            out = detour(s, other ? Vec3(0, 0, 1) : kLeft, other ? 9.0F : 6.0F, other ? 40.0F : 60.0F);
            out.side = other ? next : kLeft;
            return PlanStatus::found;
        };
        Supervisor supervisor(quick(), t.method);
        EXPECT_EQ(avoid_head_on(t.f, supervisor).state, State::avoiding);
        t.f.scene.track(Vec3(14, 3, 30), Vec3::Zero(), 3.0F);  // no time is left
        other = true;
        EXPECT_TRUE(t.f.update(supervisor, true).new_manoeuvre);
        EXPECT_EQ(supervisor.diagnostics().replans, 1U);
        return supervisor.diagnostics().flips;
    };
    EXPECT_EQ(flips(Vec3(0, -1, 0)), 1U);
    EXPECT_EQ(flips(Vec3(0, -0.1F, std::sqrt(0.99F))), 0U);
    EXPECT_EQ(flips(Vec3(0, 0, 1)), 0U);
}

TEST(OtherSide, ATurnOverIsNotCountedByTheSideThatWasChosen)
{
    Scripted t;
    bool other = false;
    t.next = [&](const Situation& s, Manoeuvre& out) {
        out = detour(s, other ? Vec3(0, 0, 1) : kLeft, other ? 9.0F : 6.0F, other ? 40.0F : 60.0F);
        out.side = other ? Vec3(0, -1, 0) : Vec3(0, 0, 1);  // called up, flown to the left, then called right
        return PlanStatus::found;
    };
    Supervisor supervisor(quick(), t.method);
    EXPECT_EQ(avoid_head_on(t.f, supervisor).state, State::avoiding);
    t.f.scene.own.position.y() = 1.5F;
    t.f.scene.track(Vec3(14, 3, 30), Vec3::Zero(), 3.0F);
    other = true;
    EXPECT_TRUE(t.f.update(supervisor, true).new_manoeuvre);
    EXPECT_EQ(supervisor.diagnostics().flips, 1U);
}

// --- velocities ---

struct Renewing {
    Renewing() { head_on(f, 30.0F); }
    static Settings reacting_first()
    {
        Settings s = quick();
        s.order = MethodOrder(kReacting, kFirst);
        return s;
    }
    Flight f;
    Settings settings = reacting_first();
    bool finds = true;
    Vec3 command{4, -3, 0};
    ReactiveFake reacting{{[this](const Situation& s, WorkBudget&, Manoeuvre& out) {
        out = velocity_of(s, command);
        return finds ? PlanStatus::found : PlanStatus::none_available;
    }}};
    bool plans = false;
    FakeMethod planning{[this](const Situation& s, WorkBudget&, Manoeuvre& out) {
        out = detour(s, -kLeft, 7.0F, 50.0F);
        return plans ? PlanStatus::found : PlanStatus::none_available;
    }};
    Supervisor<FakeMethod, ReactiveFake> supervisor{settings, planning, reacting};
};

/// Without an answer the last velocity is continued while clear, and its margin is reported. Contents that the method
/// wrote with its refusal are not flown.
TEST(Velocities, WithoutAnAnswerTheLastOneIsChecked)
{
    Renewing t;
    ASSERT_EQ(t.f.update(t.supervisor, true).velocity, Vec3(4, -3, 0));
    t.finds = false;
    t.command = Vec3(5, 0, 0);
    const int asked = t.reacting.asked;
    for (int i = 1; i <= 40; ++i) {
        t.f.pass(Vec3(4, -3, 0), 0.05F);
        const Guidance g = t.f.update(t.supervisor, true);
        if (!g.conflict.has_value()) {
            break;
        }
        ASSERT_EQ(g.state, State::avoiding) << i;
        ASSERT_EQ(g.velocity, Vec3(4, -3, 0));
        ASSERT_EQ(g.plan_status, PlanStatus::none_available);
        ASSERT_FALSE(g.new_manoeuvre);
        ASSERT_LT(g.margin, 20.0F) << "of the check";
        ASSERT_GE(g.margin, 0.0F);
        ASSERT_EQ(t.reacting.asked, asked + i) << "once an update, slow as it may be";
    }
}

/// A slow velocity is not a slow manoeuvre: no faster one is searched besides the answer of each update.
TEST(Velocities, ThatAreSlowAreNotReplacedByFasterPaths)
{
    Renewing t;
    t.f.scene.tracks.clear();
    t.f.scene.own.velocity = Vec3(0, -1, 0);
    t.f.scene.track(Vec3(25, 0, 30), Vec3::Zero(), 1.0F);
    t.command = Vec3(0, -1, 0);
    ASSERT_EQ(t.f.update(t.supervisor, true).velocity, Vec3(0, -1, 0));
    t.finds = false;
    const int asked = t.reacting.asked;
    for (int i = 1; i <= 15; ++i) {
        t.f.scene.now = t.f.scene.now + 0.1F;
        t.f.scene.own.stamp = t.f.scene.tracks[0].stamp = t.f.scene.now;
        static_cast<void>(t.f.update(t.supervisor, true));
        ASSERT_EQ(t.supervisor.state(), State::avoiding);
        ASSERT_EQ(t.reacting.asked, asked + i);
    }
}

TEST(Velocities, ArePassedOnToAPathAsANewManoeuvre)
{
    Renewing t;
    ASSERT_EQ(t.f.update(t.supervisor, true).kind, ManoeuvreKind::velocity);
    t.f.pass(Vec3(4, -3, 0), 0.05F);
    t.finds = false;
    t.plans = true;
    EXPECT_EQ(t.f.update(t.supervisor, true).kind, ManoeuvreKind::velocity) << "still clear; all are asked next";
    t.f.pass(Vec3(4, -3, 0), 0.02F);
    const Guidance g = t.f.update(t.supervisor, true);
    EXPECT_EQ(g.state, State::avoiding);
    EXPECT_EQ(g.kind, ManoeuvreKind::follow_path);
    EXPECT_TRUE(g.new_manoeuvre);
    EXPECT_EQ(t.supervisor.flying()->start, t.f.scene.now);
    EXPECT_EQ(t.supervisor.diagnostics().replans, 1U);
    EXPECT_EQ(t.supervisor.diagnostics().manoeuvres, 1U);
}

// --- faster ones ---

/// Sideways at `first` m/s, past a static threat; later the answer of `faster`.
struct Slowly : Scripted {
    Slowly(float first, const Vec3& side)
    {
        f.scene.own.velocity = Vec3(0, first, 0);
        f.scene.track(Vec3(25, 0, 30), Vec3::Zero(), 1.0F);
        next = [=](const Situation& s, Manoeuvre& out) {
            out = at_speed(s, {s.own.position, s.own.position + Vec3(0, 10.0F * first, 0)}, first, side);
            return PlanStatus::found;
        };
        EXPECT_EQ(f.update(supervisor, true).state, State::avoiding);
    }
    /// `n` tenths of a second later; the vehicle stays within a metre of the leg.
    Guidance later(int n)
    {
        Guidance g;
        for (int i = 0; i < n; ++i) {
            f.scene.now = f.scene.now + 0.1F;
            f.scene.own.stamp = f.scene.tracks[0].stamp = f.scene.now;
            g = f.update(supervisor, true);
        }
        return g;
    }
    Settings settings = quick();
    Supervisor<FakeMethod> supervisor{settings, method};
};

auto sideways(float speed, const Vec3& side)
{
    return [=](const Situation& s, Manoeuvre& out) {
        out = at_speed(s, {s.own.position, s.own.position + Vec3(0, 10.0F * speed, 0)}, speed, side);
        return PlanStatus::found;
    };
}

TEST(Faster, IsLookedForOnceASecondWhereFlightIsSlow)
{
    Slowly slow(3.9F, kLeft);  // of 5 m/s
    EXPECT_EQ(slow.method.asked, 1);
    static_cast<void>(slow.later(9));
    EXPECT_EQ(slow.method.asked, 1);
    static_cast<void>(slow.later(1));
    EXPECT_EQ(slow.method.asked, 2) << "a second later";
    static_cast<void>(slow.later(9));
    EXPECT_EQ(slow.method.asked, 2);
    static_cast<void>(slow.later(1));
    EXPECT_EQ(slow.method.asked, 3);
    Slowly fair(4.0F, kLeft);
    static_cast<void>(fair.later(15));
    EXPECT_EQ(fair.method.asked, 1) << "four fifths of the way's speed is not slow";
}

TEST(Faster, IsTakenWhenItIsMoreThanThreeTenthsFaster)
{
    Slowly slow(2.0F, kLeft);
    slow.next = sideways(2.6F, kLeft);
    EXPECT_FALSE(slow.later(10).new_manoeuvre) << "exactly three tenths";
    slow.next = sideways(2.7F, kLeft);
    EXPECT_TRUE(slow.later(10).new_manoeuvre);
    EXPECT_EQ(slow.supervisor.diagnostics().replans, 1U);
}

TEST(Faster, IsTakenOnTheSameSideAlone)
{
    const auto taken = [](const Vec3& flown, const Vec3& next) {
        Slowly slow(1.5F, flown);
        slow.next = sideways(5.0F, next);
        return slow.later(10).new_manoeuvre;
    };
    EXPECT_TRUE(taken(kLeft, Vec3(0, 0.5F, std::sqrt(0.75F)))) << "60 degrees";
    EXPECT_FALSE(taken(kLeft, Vec3(0, 0.499F, std::sqrt(0.75F))));
    EXPECT_FALSE(taken(kLeft, Vec3(0, -1, 0)));
    EXPECT_TRUE(taken(Vec3(0, 0, 0), Vec3(0, -1, 0))) << "what has no side may go to any";
    EXPECT_TRUE(taken(Vec3(0, 0, 0), Vec3(0, 0, 0)));
}

TEST(Faster, IsNotTakenUncheckedNorWhereTheMethodHasNoAnswer)
{
    Slowly into(1.5F, kLeft);
    into.next = [](const Situation& s, Manoeuvre& out) {
        out = at_speed(s, {s.own.position, s.own.position + Vec3(50, 0, 0)}, 5.0F, kLeft);  // into the threat
        return PlanStatus::found;
    };
    EXPECT_FALSE(into.later(10).new_manoeuvre);
    EXPECT_GT(into.supervisor.diagnostics().answers_rejected, 0U);
    EXPECT_EQ(into.supervisor.diagnostics().replans, 0U);
    EXPECT_EQ(into.supervisor.flying()->path.duration(), 10.0F);
    Slowly none(1.5F, kLeft);
    none.next = [](const Situation& s, Manoeuvre& out) {
        static_cast<void>(sideways(5.0F, kLeft)(s, out));
        return PlanStatus::none_available;
    };
    const Guidance g = none.later(10);
    EXPECT_FALSE(g.new_manoeuvre);
    EXPECT_LT(g.margin, 30.0F) << "that of what is flown";
}

TEST(Faster, IsNotLookedForWithoutAConflict)
{
    Slowly slow(1.5F, kLeft);
    Settings patient = quick();
    patient.settle = 5.0F;
    ASSERT_TRUE(slow.supervisor.configure(patient));
    slow.f.scene.tracks[0].position.y() = 60.0F;
    static_cast<void>(slow.later(20));
    EXPECT_EQ(slow.supervisor.state(), State::avoiding);
    EXPECT_EQ(slow.method.asked, 1);
}

}  // namespace
}  // namespace jink::avoid
