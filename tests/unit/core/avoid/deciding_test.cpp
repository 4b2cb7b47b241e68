// SPDX-License-Identifier: BSD-3-Clause
// When something is done: the commit time, the latest manoeuvre time, and which methods are asked with how much work.
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "tests/numbers.hpp"
#include "tests/unit/core/avoid/fakes.hpp"

namespace jink::avoid {
namespace {

using namespace test;
using world::ManoeuvreKind;

Seconds loss_in(const Flight& f)
{
    FakeMethod method = never();
    Supervisor supervisor(quick(), method);
    const Guidance g = supervisor.update(f.scene.situation(), false);
    return g.conflict ? g.conflict->time_to_loss : 0.0F;
}

Guidance once(const Flight& f, const Settings& settings, FakeMethod& method, bool in_control = false)
{
    Supervisor supervisor(settings, method);
    return supervisor.update(f.scene.situation(), in_control);
}

TEST(Commit, APlanIsMadeFromTheCommitTimeOn)
{
    for (const bool in_control : {false, true}) {
        Flight f;
        head_on(f);
        const Seconds loss = loss_in(f);
        Settings settings = quick();
        FakeMethod method = always(kLeft);
        settings.commit = loss;
        EXPECT_TRUE(once(f, settings, method, in_control).wants_control);
        EXPECT_EQ(method.asked, 1);
        settings.commit = std::nextafter(loss, 0.0F);
        const Guidance g = once(f, settings, method, in_control);
        EXPECT_EQ(g.wants_control, in_control);
        EXPECT_EQ(g.plan_status, PlanStatus::no_conflict) << "none was made";
        EXPECT_EQ(method.asked, 1);
    }
}

TEST(Commit, ALatestManoeuvreTimeThatIsEarlierComesFirst)
{
    Flight f;
    head_on(f, 21.0F);  // contact in 1.9 s; the stop takes longer with the reserve
    Settings settings = quick();
    settings.commit = 0.5F;
    FakeMethod method = always(kLeft, 8.0F);
    static_cast<void>(once(f, settings, method));
    const int asked = method.asked;
    EXPECT_GT(asked, 0);
    settings.reserve = 0.0F;
    EXPECT_FALSE(once(f, settings, method).wants_control);
    EXPECT_EQ(method.asked, asked);
}

/// Static, an obstacle on the path: the reserve alone is the latest time.
TEST(LatestManoeuvreTime, IsTheStopAndTheReserve)
{
    Flight f;
    f.scene.own.velocity = Vec3::Zero();
    f.scene.obstacle(geometry::make_sphere(Vec3(12, 0, 30), 1.0F));
    const Seconds loss = loss_in(f);
    ASSERT_NEAR(loss, 2.0F, 1e-4F);
    Settings settings = quick();
    FakeMethod method = never();
    settings.reserve = loss;
    EXPECT_EQ(once(f, settings, method).kind, ManoeuvreKind::brake);
    settings.reserve = std::nextafter(loss, 0.0F);
    EXPECT_EQ(once(f, settings, method).kind, ManoeuvreKind::follow_path) << "nothing is done yet";
    f.scene.own.velocity = Vec3(5, 0, 0);
    settings.reserve = loss - vehicle::stopping_time(5.0F, f.scene.limits) + 1e-3F;
    EXPECT_EQ(once(f, settings, method).kind, ManoeuvreKind::brake);
    settings.reserve -= 2e-3F;
    EXPECT_EQ(once(f, settings, method).kind, ManoeuvreKind::follow_path);
}

/// Crossing traffic that reaches the vehicle's place in `seconds`.
Flight crossing(float way_speed, float way_length, Seconds seconds)
{
    Flight f;
    f.scene.own.velocity = Vec3::Zero();
    f.scene.leg(f.scene.own.position, f.scene.own.position + Vec3(way_length, 0, 0), way_speed);
    f.scene.track(f.scene.own.position + Vec3(0, 2.0F + 10.0F * seconds, 0), Vec3(0, -10, 0), 1.0F);
    return f;
}

/// Nearly static on the path of traffic, the vehicle starts with three quarters of the fallback horizon left.
TEST(LatestManoeuvreTime, IsEarlierWhereTheVehicleAsGoodAsStands)
{
    FakeMethod method = never();
    const auto acts = [&](float speed, float length, Seconds seconds) {
        return once(crossing(speed, length, seconds), quick(), method).wants_control;
    };
    EXPECT_TRUE(acts(0.3F, 300.0F, 2.9F)) << "creeping";
    EXPECT_FALSE(acts(0.3F, 300.0F, 3.1F));
    EXPECT_FALSE(acts(1.5F, 300.0F, 1.2F)) << "fast enough to stop later";
    EXPECT_TRUE(acts(5.0F, 1.0F, 2.9F)) << "at the end of its leg";
    EXPECT_FALSE(acts(5.0F, 1.0F, 3.1F));
    EXPECT_FALSE(acts(2.0F, 1.2F, 2.9F)) << "the leg goes on for more than that";
}

TEST(LatestManoeuvreTime, StandingObstaclesAskForNoHurry)
{
    Flight f;
    f.scene.own.velocity = Vec3::Zero();
    f.scene.leg(f.scene.own.position, f.scene.own.position + Vec3(300, 0, 0), 1.0F);
    f.scene.obstacle(geometry::make_sphere(f.scene.own.position + Vec3(4, 0, 0), 1.0F));  // contact in 2 s
    FakeMethod method = never();
    EXPECT_FALSE(once(f, quick(), method).wants_control) << "a second is left to stop";
}

/// A fast vehicle at the end of its leg needs longer to stop than to get going.
TEST(LatestManoeuvreTime, IsNeverLaterThanTheStop)
{
    Flight f;
    f.scene.limits.max_acceleration = 1.0F;
    f.scene.own.velocity = Vec3(5, 0, 0);
    f.scene.leg(f.scene.own.position, f.scene.own.position + Vec3(0.5F, 0, 0), 5.0F);
    f.scene.track(f.scene.own.position + Vec3(0, 2.0F + 5.0F * 4.0F, 0), Vec3(0, -5, 0), 1.0F);
    FakeMethod method = never();
    const Seconds stop = vehicle::stopping_time(5.0F, f.scene.limits) + quick().reserve;
    ASSERT_GT(stop, 5.0F);
    EXPECT_TRUE(once(f, quick(), method).wants_control) << "4 s before";
}

// --- work ---

TEST(PlanBudget, IsTheSliceAndWhatIsNotKeptForAFallback)
{
    Flight f;
    head_on(f);
    Settings settings = quick();
    settings.work = {6000, 3000};
    settings.kept_for_next = 0;
    settings.kept_for_check = 0;
    std::vector<std::uint32_t> had;
    FakeMethod method{[&](const Situation&, WorkBudget& budget, Manoeuvre&) {
        had.push_back(budget.left());
        return PlanStatus::none_available;
    }};
    const Guidance g = once(f, settings, method);
    ASSERT_EQ(had.size(), 2U) << "for a wider vehicle, then as it is";
    constexpr std::uint32_t kKept = 600 + 500;  // one threat
    EXPECT_EQ(had[0], 6000U - kKept - g.work) << "the search for conflicts took its share";
    settings.work = {4000, 3000};
    had.clear();
    static_cast<void>(once(f, settings, method));
    EXPECT_EQ(had[0], 3000U) << "the slice alone";
}

TEST(PlanBudget, ExhaustedByTheFirstOfTwoPlansIsCounted)
{
    // A velocity is flown; its renewal spends the whole budget. A new threat conflicts with the flown velocity: a
    // second plan is found.
    Flight f;
    head_on(f, 30.0F);
    int plan = 0;
    ReactiveFake method{{[&](const Situation& s, WorkBudget& budget, Manoeuvre& out) {
        ++plan;
        if (plan == 2) {
            while (budget.spend(1000)) {
            }
            return PlanStatus::budget_spent;
        }
        out = {};
        out.kind = ManoeuvreKind::velocity;
        out.start = s.now;
        out.command = plan == 1 ? Vec3(4, 3, 0) : Vec3(0, -4, 3);
        path::predict_velocity_command(s.own, out.command, 8.0F, 0.2F, s.limits, out.path);
        return PlanStatus::found;
    }}};
    Settings settings = quick();
    settings.order = MethodOrder(kReacting);
    Supervisor supervisor(settings, method);
    ASSERT_EQ(f.update(supervisor, true).state, State::avoiding);
    EXPECT_EQ(supervisor.diagnostics().budget_spent, 0U);
    f.scene.track(Vec3(11, 7, 30), Vec3::Zero(), 2.0F);
    const Guidance g = f.update(supervisor, true);
    EXPECT_EQ(plan, 3);
    EXPECT_EQ(g.plan_status, PlanStatus::found);
    EXPECT_EQ(g.velocity, Vec3(0, -4, 3));
    EXPECT_EQ(supervisor.diagnostics().budget_spent, 1U);
}

TEST(Budget, ExhaustedByAFallbackIsCounted)
{
    Flight f;
    for (int i = 0; i < 40; ++i) {
        f.scene.track(Vec3(9, 0.2F * static_cast<float>(i % 5), 30), Vec3(-3, 0, 0), 1.0F);
    }
    Settings settings = quick();
    settings.work = {6000, 3000};
    settings.plan_budget = settings.kept_for_next = settings.kept_for_reactive = 100;
    FakeMethod method = never();
    Supervisor supervisor(settings, method);
    const Guidance g = f.update(supervisor, true);
    EXPECT_EQ(g.state, State::braking);
    EXPECT_GT(g.work, 2000U);
    EXPECT_LT(g.work, 3000U) << "the rest is kept for what is checked after a fallback";
    EXPECT_EQ(supervisor.diagnostics().budget_spent, 1U);
    EXPECT_EQ(supervisor.diagnostics().most_work, g.work);
    f.scene.tracks.clear();
    static_cast<void>(f.update(supervisor, true));
    EXPECT_EQ(supervisor.diagnostics().budget_spent, 1U);
}

/// A second nominal path costs a second search.
TEST(Budget, WithoutAnotherPathThereIsOneSearch)
{
    Flight f;
    f.scene.track(Vec3(500, 0, 30), Vec3::Zero());
    FakeMethod method = never();
    Supervisor alone(quick(), method);
    Supervisor both(quick(), method);
    const Situation s = f.scene.situation();
    EXPECT_LT(alone.update(s, false).work, both.update(s, false, &f.scene.reference).work);
}

// --- which methods ---

/// Level with floor: flown exactly on it, a margin of exactly 0 is clear.
TEST(Answers, ThatAreExactlyClearAreTaken)
{
    Flight f;
    head_on(f);
    f.scene.airspace.has_floor = true;
    f.scene.airspace.floor = 29.0F;
    FakeMethod method{[](const Situation& s, WorkBudget&, Manoeuvre& out) {
        out = {};
        out.kind = ManoeuvreKind::velocity;
        out.start = s.now;
        out.command = Vec3(0, 5, 0);
        path::predict_velocity_command(s.own, out.command, 3.0F, 0.2F, s.limits, out.path);
        return PlanStatus::found;
    }};
    f.scene.rules.clearance = 0.0F;
    const Guidance g = once(f, quick(), method, true);
    EXPECT_EQ(g.state, State::avoiding);
    EXPECT_EQ(g.margin, 0.0F);
}

TEST(Answers, AreReportedWithTheirMargin)
{
    Flight f;
    head_on(f);
    FakeMethod method = always(kLeft);
    const Guidance g = once(f, quick(), method);
    ASSERT_EQ(g.plan_status, PlanStatus::found);
    WorkBudget budget(world::test::kPlenty);
    const Situation s = f.scene.situation();
    const float margin = check_manoeuvre(s, detour(s, kLeft, 6.0F, 60.0F), quick(), budget).margin;
    EXPECT_GT(margin, 1.0F);
    EXPECT_NEAR(g.margin, margin - f.scene.rules.clearance, 0.1F) << "for the wider vehicle that was asked for first";
}

TEST(Answers, OfTheMethodThatIsAskedFirstAreNotCountedAsTheNextOnes)
{
    Flight f;
    head_on(f);
    FakeMethod first = always(kLeft);
    SecondFake second{always(-kLeft)};
    Supervisor supervisor(quick(), first, second);
    static_cast<void>(f.update(supervisor, true));
    EXPECT_EQ(supervisor.diagnostics().plans_found, 1U);
    EXPECT_EQ(supervisor.diagnostics().found_by_next, 0U);
}

}  // namespace
}  // namespace jink::avoid
