// SPDX-License-Identifier: BSD-3-Clause
// Which of two nominal paths counts, and the methods' inputs on it, the flown manoeuvre and the command.
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "tests/numbers.hpp"
#include "tests/oracle/reference_ends.hpp"
#include "tests/unit/core/avoid/fakes.hpp"

namespace jink::avoid {
namespace {

using namespace test;

/// The leg leads east, the other path north; each has a static threat the given seconds ahead.
struct TwoAhead {
    TwoAhead()
    {
        north = world::Reference({f.scene.own.position, f.scene.own.position + Vec3(0, 300, 0), 5.0F});
        f.scene.own.velocity = Vec3::Zero();
    }
    Guidance update(Seconds east, Seconds north_of, bool in_control = false)
    {
        f.scene.tracks.clear();
        place(Vec3(1, 0, 0), east);
        place(Vec3(0, 1, 0), north_of);
        return supervisor.update(f.scene.situation(), in_control, &north);
    }
    void place(const Vec3& direction, Seconds seconds)
    {
        if (seconds < 50.0F) {
            f.scene.track(f.scene.own.position + (2.0F + 5.0F * seconds) * direction, Vec3::Zero(), 1.0F);
        }
    }
    static constexpr Seconds kNever = 100.0F;
    Flight f;
    world::Reference north;
    FakeMethod method = never();
    Supervisor<FakeMethod> supervisor{quick(), method};
};

TEST(OtherPath, CountsWhenItsLossIsClearlyFirstAndThenUntilItIsClearlyLater)
{
    TwoAhead t;
    EXPECT_FALSE(t.update(6.0F, 5.6F).on_other) << "0.4 s are noise";
    EXPECT_TRUE(t.update(6.0F, 5.4F).on_other);
    EXPECT_TRUE(t.update(6.0F, 6.4F).on_other) << "it stays";
    EXPECT_NEAR(t.update(6.0F, 6.4F).conflict->time_to_loss, 6.4F, 1e-3F);
    EXPECT_FALSE(t.update(6.0F, 6.6F).on_other);
    EXPECT_NEAR(t.update(6.0F, 6.6F).conflict->time_to_loss, 6.0F, 1e-3F);
    EXPECT_FALSE(t.update(6.0F, 5.6F).on_other) << "and back again likewise";
    EXPECT_TRUE(t.update(TwoAhead::kNever, 7.5F).on_other) << "alone it counts at once";
    EXPECT_FALSE(t.update(7.5F, TwoAhead::kNever).on_other);
}

TEST(OtherPath, EachOfItsConflictsIsCountedOnce)
{
    TwoAhead t;
    const auto counted = [&] { return t.supervisor.diagnostics().on_other; };
    static_cast<void>(t.update(TwoAhead::kNever, TwoAhead::kNever));
    static_cast<void>(t.update(TwoAhead::kNever, TwoAhead::kNever));
    EXPECT_EQ(counted(), 0U);
    static_cast<void>(t.update(TwoAhead::kNever, 7.0F));
    static_cast<void>(t.update(TwoAhead::kNever, 7.0F));
    EXPECT_EQ(counted(), 1U);
    static_cast<void>(t.update(TwoAhead::kNever, TwoAhead::kNever));
    static_cast<void>(t.update(7.0F, TwoAhead::kNever));
    EXPECT_EQ(counted(), 1U) << "on the leg";
    EXPECT_EQ(t.supervisor.diagnostics().conflicts, 2U);
}

/// Taking control forgets which path counted: in control the leg alone is flown.
TEST(OtherPath, IsForgottenInControl)
{
    TwoAhead t;
    EXPECT_TRUE(t.update(6.0F, 5.0F).on_other);
    EXPECT_FALSE(t.update(6.0F, 5.0F, true).on_other);
    static_cast<void>(t.supervisor.update(t.f.scene.situation(), false, &t.north));
    t.supervisor.reset();
    EXPECT_FALSE(t.update(6.0F, 6.4F).on_other) << "no advantage is left";
}

TEST(OtherPath, IsForgottenInControlThatIsGivenBack)
{
    TwoAhead t;
    Settings settings = quick();
    settings.settle = settings.least_control = 0.0F;
    ASSERT_TRUE(t.supervisor.configure(settings));
    EXPECT_TRUE(t.update(TwoAhead::kNever, 7.0F).on_other);
    EXPECT_FALSE(t.update(TwoAhead::kNever, TwoAhead::kNever, true).wants_control);
    EXPECT_FALSE(t.update(6.0F, 6.4F).on_other) << "no advantage is left";
}

/// Static, with its leg ahead: traffic towards the vehicle counts against its static position, not against a flight.
TEST(OtherPath, ThatStandsIsLeftInTime)
{
    TwoAhead t;
    t.north = world::Reference({t.f.scene.own.position, t.f.scene.own.position, 5.0F});
    const auto acts = [&](Seconds seconds) {
        t.f.scene.tracks.clear();
        t.f.scene.track(t.f.scene.own.position + Vec3(0, 2.0F + 10.0F * seconds, 0), Vec3(0, -10, 0), 1.0F);
        const Guidance g = t.supervisor.update(t.f.scene.situation(), false, &t.north);
        EXPECT_TRUE(g.on_other);
        return g.wants_control;
    };
    EXPECT_FALSE(acts(3.1F));
    EXPECT_TRUE(acts(2.9F));
}

/// Plans for the other path are checked against all traffic to their end, cooperative or not.
TEST(OtherPath, PlansForItAreCheckedAgainstCooperativeTraffic)
{
    TwoAhead t;
    t.method = {[](const Situation& s, WorkBudget&, Manoeuvre& out) {
        out = along(s, {s.own.position, s.own.position + Vec3(0, 60, 0)}, kLeft);
        return PlanStatus::found;
    }};
    t.place(Vec3(0, 1, 0), 4.0F);
    t.f.scene.tracks[0].cooperative = true;
    const Guidance g = t.supervisor.update(t.f.scene.situation(), false, &t.north);
    EXPECT_TRUE(g.on_other);
    EXPECT_EQ(g.plan_status, PlanStatus::none_available);
    EXPECT_EQ(t.supervisor.diagnostics().answers_rejected, 2U);
}

TEST(OtherPath, AnObstacleCountsFromTheLatestManoeuvreTimeOn)
{
    TwoAhead t;
    t.f.scene.obstacle(geometry::make_sphere(t.f.scene.own.position + Vec3(0, 12, 0), 1.0F));
    Settings settings = quick();
    settings.reserve = 5.0F;
    ASSERT_TRUE(t.supervisor.configure(settings));
    const Guidance seen = t.update(TwoAhead::kNever, TwoAhead::kNever);
    ASSERT_TRUE(seen.on_other);
    settings.reserve = seen.conflict->time_to_loss;
    ASSERT_TRUE(t.supervisor.configure(settings));
    EXPECT_TRUE(t.update(TwoAhead::kNever, TwoAhead::kNever).on_other) << "exactly then";
    settings.reserve = std::nextafter(seen.conflict->time_to_loss, 0.0F);
    ASSERT_TRUE(t.supervisor.configure(settings));
    EXPECT_FALSE(t.update(TwoAhead::kNever, TwoAhead::kNever).conflict.has_value());
}

TEST(OtherPath, AnObstacleFarAheadOnItKeepsNoControl)
{
    TwoAhead t;
    Settings settings = quick();
    settings.settle = settings.least_control = 0.0F;
    ASSERT_TRUE(t.supervisor.configure(settings));
    t.f.scene.obstacle(geometry::make_sphere(t.f.scene.own.position + Vec3(0, 25, 0), 1.0F));
    const Guidance g = t.update(TwoAhead::kNever, TwoAhead::kNever, true);
    EXPECT_FALSE(g.wants_control);
    EXPECT_FALSE(g.other_conflict);
    EXPECT_EQ(t.supervisor.diagnostics().kept_control, 0U);
    TwoAhead kept;
    ASSERT_TRUE(kept.supervisor.configure(settings));
    const Guidance k = kept.update(TwoAhead::kNever, 7.0F, true);
    EXPECT_TRUE(k.wants_control);
    EXPECT_TRUE(k.other_conflict);
    EXPECT_EQ(kept.supervisor.diagnostics().kept_control, 1U);
}

/// Plans are made for the path that counts.
TEST(OtherPath, IsShownToMethodsWhereItCounts)
{
    TwoAhead t;
    std::vector<float> ends;
    t.method = {[&](const Situation& s, WorkBudget&, Manoeuvre&) {
        ends.push_back(end_of(s.reference).y());
        return PlanStatus::none_available;
    }};
    static_cast<void>(t.update(6.0F, 4.0F));
    static_cast<void>(t.update(4.0F, 6.0F));
    EXPECT_EQ(ends, (std::vector<float>{300.0F, 300.0F, 0.0F, 0.0F})) << "for a wider vehicle, then as it is";
}

// --- inputs of methods ---

struct Shown {
    bool flies = false;
    bool commanded = false;
    Vec3 command = Vec3::Zero();
    TimePoint at;
};

struct Looking {
    Guidance update(bool in_control)
    {
        f.pass(Vec3(5, 0, 0), 0.02F);
        f.scene.own.position = Vec3(0, 0, 30);
        f.scene.own.velocity = Vec3(5, 0, 0);
        return f.update(supervisor, in_control);
    }
    static Settings once_a_plan()
    {
        Settings s = quick();
        s.order = MethodOrder(kReacting);
        s.settle = s.least_control = 0.0F;
        return s;
    }
    Flight f;
    bool finds = true;
    std::vector<Shown> shown;
    ReactiveFake method{{[this](const Situation& s, WorkBudget&, Manoeuvre& out) {
        shown.push_back({s.flying != nullptr, s.commanded != nullptr,
                         s.commanded != nullptr ? s.commanded->velocity : Vec3(Vec3::Zero()),
                         s.commanded != nullptr ? s.commanded->at : TimePoint{}});
        out = {};
        out.kind = world::ManoeuvreKind::velocity;
        out.start = s.now;
        out.command = Vec3(4, -3, 0);
        path::predict_velocity_command(s.own, out.command, 6.0F, 0.2F, s.limits, out.path);
        return finds ? PlanStatus::found : PlanStatus::none_available;
    }}};
    Supervisor<ReactiveFake> supervisor{once_a_plan(), method};
};

TEST(MethodsSee, WhatIsFlownOnlyWhereSomethingIs)
{
    Looking l;
    l.finds = false;
    head_on(l.f, 45.0F);
    static_cast<void>(l.update(false));
    static_cast<void>(l.update(false));
    l.finds = true;
    static_cast<void>(l.update(false));
    static_cast<void>(l.update(false));
    ASSERT_EQ(l.shown.size(), 4U);
    EXPECT_FALSE(l.shown[0].flies);
    EXPECT_FALSE(l.shown[1].flies);
    EXPECT_FALSE(l.shown[2].flies) << "nothing was found so far";
    EXPECT_TRUE(l.shown[3].flies);
}

/// Nothing is commanded while the autopilot flies, and after control was given back.
TEST(MethodsSee, TheCommandOfTheLastUpdateInControlAlone)
{
    Looking l;
    head_on(l.f, 45.0F);
    static_cast<void>(l.update(true));
    static_cast<void>(l.update(true));
    const TimePoint second = l.f.scene.now;
    static_cast<void>(l.update(true));
    ASSERT_EQ(l.shown.size(), 3U);
    EXPECT_FALSE(l.shown[0].commanded);
    EXPECT_TRUE(l.shown[2].commanded);
    EXPECT_EQ(l.shown[2].command, Vec3(4, -3, 0));
    EXPECT_EQ(l.shown[2].at, second);
    static_cast<void>(l.update(false));
    ASSERT_EQ(l.shown.size(), 4U);
    EXPECT_FALSE(l.shown[3].commanded) << "the autopilot flies";
    Looking back;
    EXPECT_FALSE(back.update(true).wants_control) << "given back at once";
    head_on(back.f, 45.0F);
    static_cast<void>(back.update(true));
    ASSERT_GE(back.shown.size(), 1U);
    EXPECT_FALSE(back.shown[0].commanded);
}

}  // namespace
}  // namespace jink::avoid
