// SPDX-License-Identifier: BSD-3-Clause
#include "core/avoid/supervisor.hpp"

#include <gtest/gtest.h>

#include "core/base/random.hpp"
#include "tests/numbers.hpp"
#include "tests/unit/core/avoid/fakes.hpp"

namespace jink::avoid {
namespace {

using namespace test;
using world::ManoeuvreKind;

TEST(Supervisors, TheWorkOfEachUpdateIsReported)
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

/// In every state and for all answers of the methods, the command is within the vehicle's limits.
TEST(Supervisors, CommandsStayWithinTheLimits)
{
    constexpr std::uint64_t kSeed = 20261125;
    Random random(kSeed);
    int in_state[4] = {};
    for (int flight = 0; flight < 60; ++flight) {
        Flight f;
        f.scene.own.position += Vec3(0, random.uniform(-8, 8), random.uniform(-4, 4));
        for (int n = 0; n < 3; ++n) {
            const Seconds meets = random.uniform(2.0F, 12.0F);
            const Vec3 velocity(random.uniform(-6, 6), random.uniform(-6, 6), random.uniform(-1, 1));
            f.scene.track(f.scene.own.position + Vec3(5, 0, 0) * meets - velocity * meets, velocity, 1.5F);
        }
        FakeMethod method{[&](const Situation& s, WorkBudget&, Manoeuvre& out) {
            const float angle = random.uniform(-kPi, kPi);
            out = detour(s, Vec3(0, std::cos(angle), std::sin(angle)), random.uniform(3, 12), random.uniform(20, 60));
            return random.below(3) == 0 ? PlanStatus::none_available : PlanStatus::found;
        }};
        Supervisor supervisor(quick(), method);
        for (int i = 0; i < 300; ++i) {
            const Guidance g = f.update(supervisor, true);
            ++in_state[static_cast<int>(g.state)];
            ASSERT_LE(g.velocity.norm(), f.scene.limits.cruise_speed * 1.00001F) << "seed " << kSeed << ' ' << flight;
            ASSERT_LE(g.velocity.z(), f.scene.limits.max_climb * 1.00001F) << "seed " << kSeed << ' ' << flight;
            ASSERT_GE(g.velocity.z(), -f.scene.limits.max_descent * 1.00001F) << "seed " << kSeed << ' ' << flight;
            f.pass(g.velocity, 0.05F);
        }
        const Diagnostics& d = supervisor.diagnostics();
        EXPECT_EQ(d.updates, 300U);
        EXPECT_GE(d.plans, d.plans_found + d.answers_rejected);
        EXPECT_GE(d.brakes, d.escapes > 0 ? 1U : 0U);
        EXPECT_GE(d.replans, d.flips);
    }
    for (const int count : in_state) {
        EXPECT_GT(count, 20);
    }
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

/// Nothing is known to be clear by rules that are out of range: it does not fly on, and flies no answer.
TEST(Supervisors, RulesOutOfRangeAreAConflictNow)
{
    for (const float bad : {kNan, 1e9F}) {
        Flight f;
        FakeMethod method = always(kLeft);
        Supervisor supervisor(Settings{}, method);
        EXPECT_FALSE(f.update(supervisor, true).conflict.has_value()) << "free, by rules that are good";
        f.scene.rules.lookahead = bad;
        const Guidance g = f.update(supervisor, true);
        ASSERT_TRUE(g.conflict.has_value()) << bad;
        EXPECT_EQ(g.conflict->time_to_loss, 0.0F);
        EXPECT_EQ(g.state, State::braking);
        EXPECT_EQ(supervisor.flying(), nullptr);
    }
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
        EXPECT_TRUE(refused([&](Settings& s) { s.commit = bad; }));
        EXPECT_TRUE(refused([&](Settings& s) { s.prediction_step = bad; }));
        EXPECT_TRUE(refused([&](Settings& s) { s.fallback_horizon = bad; }));
        EXPECT_TRUE(refused([&](Settings& s) { s.reserve = bad; }));
        EXPECT_TRUE(refused([&](Settings& s) { s.settle = bad; }));
        EXPECT_TRUE(refused([&](Settings& s) { s.clear_extra = bad; }));
        EXPECT_TRUE(refused([&](Settings& s) { s.on_leg = bad; }));
        EXPECT_TRUE(refused([&](Settings& s) { s.blocked_patience = bad; }));
        EXPECT_TRUE(refused([&](Settings& s) { s.back_off_speed = bad; }));
        EXPECT_TRUE(refused([&](Settings& s) { s.back_off_limit = bad; }));
    }
    EXPECT_TRUE(refused([](Settings& s) { s.work.slice = WorkPerUpdate::kMinSlice - 1; }));
    EXPECT_TRUE(refused([](Settings& s) { s.plan_budget = 99; }));
    EXPECT_TRUE(refused([](Settings& s) { s.work.all = s.work.slice; }));
    EXPECT_TRUE(refused([](Settings& s) { s.kept_for_next = s.plan_budget + 1; }));
    EXPECT_TRUE(refused([](Settings& s) { s.kept_for_reactive = s.plan_budget + 1; }));
    EXPECT_FALSE(refused([](Settings& s) { s.commit = 12.0F; }));
    EXPECT_EQ(supervisor.settings().commit, 12.0F);
}

}  // namespace
}  // namespace jink::avoid
