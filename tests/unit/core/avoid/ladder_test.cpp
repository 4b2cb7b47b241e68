// SPDX-License-Identifier: BSD-3-Clause
#include "core/avoid/supervisor.hpp"

#include <gtest/gtest.h>

#include "tests/unit/core/avoid/fakes.hpp"

namespace jink::avoid {
namespace {

using namespace test;
using world::ManoeuvreKind;

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

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

}  // namespace
}  // namespace jink::avoid
