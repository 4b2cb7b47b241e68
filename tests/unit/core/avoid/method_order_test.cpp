// SPDX-License-Identifier: BSD-3-Clause
#include "core/avoid/supervisor.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "tests/numbers.hpp"
#include "tests/unit/core/avoid/fakes.hpp"

namespace jink::avoid {
namespace {

using namespace test;
using world::ManoeuvreKind;

/// Each of these reports "found".
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

TEST_P(BadAnswers, TheNextMethodIsAsked)
{
    Flight f;
    f.scene.airspace.has_floor = true;
    f.scene.airspace.floor = 2.0F;
    head_on(f);
    FakeMethod bad{[&](const Situation& s, WorkBudget&, Manoeuvre& out) {
        GetParam().make(s, out);
        return PlanStatus::found;
    }};
    SecondFake good{always(kLeft)};
    Supervisor supervisor(quick(), bad, good);
    const Guidance g = f.update(supervisor, true);
    EXPECT_EQ(g.state, State::avoiding);
    EXPECT_EQ(g.plan_status, PlanStatus::found);
    EXPECT_EQ(good.asked, 1);
}

INSTANTIATE_TEST_SUITE_P(Of, BadAnswers, testing::ValuesIn(kBadAnswers),
                         [](const auto& info) { return std::string(info.param.name); });

TEST(MethodOrders, EachStatusIsReportedAndTheFirstOfTwoEqualAnswersIsFlown)
{
    for (const PlanStatus status : {PlanStatus::no_conflict, PlanStatus::too_close, PlanStatus::none_available,
                                    PlanStatus::budget_spent, PlanStatus::bad_input}) {
        Flight f;
        head_on(f);
        FakeMethod first = never(status);
        SecondFake second{never(status)};
        Supervisor supervisor(quick(), first, second);
        EXPECT_EQ(f.update(supervisor, false).plan_status, status);
        EXPECT_EQ(first.asked, second.asked);
        EXPECT_EQ(supervisor.diagnostics().answers_rejected, 0U);
    }
    Flight f;
    head_on(f);
    FakeMethod first = always(kLeft);
    SecondFake second{always(-kLeft)};
    Supervisor supervisor(quick(), first, second);
    static_cast<void>(f.update(supervisor, true));
    EXPECT_EQ(second.asked, 1);
    EXPECT_EQ(supervisor.flying()->side, kLeft);
}

/// Two detours at the same speed: the one of the method that is asked last is shorter.
TEST(MethodOrders, TheAnswerThatCostsLeastIsFlownWhoeverIsAskedFirst)
{
    for (const MethodOrder& order : {MethodOrder(kFirst, kSecond), MethodOrder(kSecond, kFirst)}) {
        Flight f;
        head_on(f);
        FakeMethod far = always(kLeft, 12.0F);
        SecondFake near{always(-kLeft, 6.0F)};
        Settings settings = quick();
        settings.order = order;
        Supervisor supervisor(settings, far, near);
        const Guidance g = f.update(supervisor, true);
        EXPECT_EQ(g.by, kSecond);
        EXPECT_EQ(g.answers, 2);
        EXPECT_GT(g.cost, 0.0F);
        EXPECT_EQ(supervisor.flying()->side, -kLeft);
        EXPECT_EQ(supervisor.diagnostics().found_by_next, order.ids().front() == kFirst ? 1U : 0U);
    }
}

/// A short descent that stops before a house costs less than a way over it but for the dead end.
TEST(MethodOrders, TheWayAroundIsFlownRatherThanAStopBeforeAHouse)
{
    for (const bool around_first : {false, true}) {
        Flight f;
        f.scene.obstacle(geometry::make_box(Vec3(27, 0, 30), Vec3(3, 5, 5)));
        const auto around = [](const Situation& s, Manoeuvre& out) { out = detour(s, kLeft, 14.0F, 80.0F); };
        const auto stops = [](const Situation& s, Manoeuvre& out) {
            out = along(s, {s.own.position, s.own.position + Vec3(15, 0, -2)}, Vec3(0, 0, -1));
        };
        const auto answer = [&](bool goes_around) {
            return [=](const Situation& s, WorkBudget&, Manoeuvre& out) {
                goes_around ? around(s, out) : stops(s, out);
                return PlanStatus::found;
            };
        };
        FakeMethod first{answer(around_first)};
        SecondFake second{{answer(!around_first)}};
        Supervisor supervisor(quick(), first, second);
        const Guidance g = f.update(supervisor, true);
        ASSERT_EQ(g.state, State::avoiding);
        EXPECT_EQ(g.answers, 2U);
        EXPECT_EQ(g.by, around_first ? kFirst : kSecond);
        // The other one costs less, but for the dead end.
        const Situation s = f.scene.situation();
        Manoeuvre stop;
        stops(s, stop);
        WorkBudget budget(world::test::kPlenty);
        const ManoeuvreCost cost = assess(s, stop, Settings{}, 0.0F, budget).cost;
        EXPECT_EQ(cost.dead_end, 6.0F);
        EXPECT_LT(cost.total() - cost.dead_end, g.cost);
        EXPECT_GT(cost.total(), g.cost);
    }
}

/// A refused answer is not compared, however little it costs.
TEST(MethodOrders, WhatIsNotClearIsNotCompared)
{
    Flight f;
    head_on(f);
    FakeMethod through = always(kLeft, 0.0F);
    SecondFake around{always(kLeft, 6.0F)};
    Supervisor supervisor(quick(), through, around);
    const Guidance g = f.update(supervisor, true);
    EXPECT_EQ(g.by, kSecond);
    EXPECT_EQ(g.answers, 1);
    EXPECT_EQ(supervisor.diagnostics().answers_rejected, 2U) << "for the wider vehicle, and as it is";
}

/// Offered to the left; then the right costs a little less, but not by so much as a change of sides.
TEST(MethodOrders, TheSideThatIsFlownIsHeldOnTo)
{
    Flight f;
    head_on(f, 45.0F);
    float right = 6.0F;
    FakeMethod both{[&](const Situation& s, WorkBudget&, Manoeuvre& out) {
        out = detour(s, kLeft, 6.0F, 60.0F);
        return PlanStatus::found;
    }};
    SecondFake other{{[&](const Situation& s, WorkBudget&, Manoeuvre& out) {
        out = detour(s, -kLeft, right, 60.0F);
        return PlanStatus::found;
    }}};
    Supervisor supervisor(quick(), both, other);
    ASSERT_EQ(f.update(supervisor, false).by, kFirst);
    right = 5.0F;
    EXPECT_EQ(f.update(supervisor, false).by, kFirst);
    Supervisor anew(quick(), both, other);
    EXPECT_EQ(f.update(anew, false).by, kSecond) << "without anything that is held on to";
}

/// Which of three methods are asked, "1", "2" and the reactive "3", when none has an answer.
std::string asked_in_order(const Settings& settings)
{
    Flight f;
    head_on(f);
    std::string order;
    const auto note = [&](const char* name) {
        return FakeMethod{[&order, name](const Situation&, WorkBudget&, Manoeuvre&) {
            if (order.empty() || order.back() != *name) {
                order += name;
            }
            return PlanStatus::none_available;
        }};
    };
    FakeMethod first = note("1");
    SecondFake second{note("2")};
    ReactiveFake third{note("3")};
    Supervisor supervisor(settings, first, second, third);
    static_cast<void>(f.update(supervisor, true));
    return order;
}

TEST(MethodOrders, AnySubsetIsAskedInAnyOrder)
{
    const std::pair<MethodOrder, const char*> orders[] = {
        {MethodOrder(kFirst, kSecond), "12"},
        {MethodOrder(kSecond, kFirst), "21"},
        {MethodOrder(kFirst), "1"},
        {MethodOrder(kSecond), "2"},
        {MethodOrder(kReacting), "3"},
        {MethodOrder(kReacting, kFirst, kSecond), "312"},
        {MethodOrder(kSecond, kReacting, kFirst), "231"},
        {MethodOrder(kFirst, kReacting), "13"},
        {MethodOrder(), "123"},
    };
    Settings settings = quick();
    for (const auto& [order, expected] : orders) {
        settings.order = order;
        EXPECT_EQ(asked_in_order(settings), expected);
    }
}

/// An order may name methods that an image was built without.
TEST(MethodOrders, MethodsThatAreNotThereAreSkipped)
{
    constexpr std::uint8_t kAbsent = 99;
    Settings settings = quick();
    settings.order = MethodOrder(kAbsent, kSecond);
    EXPECT_EQ(asked_in_order(settings), "2");
    settings.order = MethodOrder(kAbsent);
    EXPECT_EQ(asked_in_order(settings), "") << "and then no method is asked";
}

TEST(MethodOrders, TheSupervisorStampsTheMethodThatAnswered)
{
    Flight f;
    head_on(f);
    FakeMethod first = never();
    SecondFake second{always(kLeft)};
    Supervisor supervisor(quick(), first, second);
    static_cast<void>(f.update(supervisor, true));
    ASSERT_NE(supervisor.flying(), nullptr);
    EXPECT_EQ(supervisor.flying()->by, kSecond);
}

TEST(MethodOrders, WhatIsKeptForTheNextMethodIsLeftToIt)
{
    Flight f;
    head_on(f);
    Settings settings = quick();
    settings.plan_budget = 5000;
    settings.kept_for_next = 2000;
    settings.kept_for_check = 0;
    std::uint32_t first_had = 0;
    std::uint32_t second_had = 0;
    FakeMethod first{[&](const Situation&, WorkBudget& budget, Manoeuvre&) {
        first_had = std::max(first_had, budget.left());
        while (budget.spend(100)) {
        }
        return PlanStatus::budget_spent;
    }};
    SecondFake second{{[&](const Situation& s, WorkBudget& budget, Manoeuvre& out) {
        second_had = std::max(second_had, budget.left());
        out = detour(s, kLeft, 6.0F, 60.0F);
        return PlanStatus::found;
    }}};
    Supervisor supervisor(settings, first, second);
    const Guidance g = f.update(supervisor, true);
    EXPECT_EQ(first_had, 3000U);
    EXPECT_EQ(second_had, 2000U);
    EXPECT_EQ(first.asked, 1) << "without work left there is no second round";
    EXPECT_EQ(g.state, State::avoiding);
    EXPECT_EQ(supervisor.diagnostics().found_by_next, 1U);
    EXPECT_EQ(supervisor.diagnostics().budget_spent, 0U) << "the plan was made";
}

/// A method that decides anew needs less.
TEST(MethodOrders, EachKindOfMethodHasItsOwnShare)
{
    Flight f;
    head_on(f);
    Settings settings = quick();
    settings.plan_budget = 10'000;
    settings.kept_for_next = 4000;
    settings.kept_for_reactive = 1500;
    settings.kept_for_check = 500;
    std::vector<std::uint32_t> had;
    const auto spend_all = [&](const Situation&, WorkBudget& budget, Manoeuvre&) {
        had.push_back(budget.left());
        while (budget.spend(100)) {
        }
        return PlanStatus::budget_spent;
    };
    FakeMethod first{spend_all};
    SecondFake second{{spend_all}};
    ReactiveFake third{{spend_all}};
    Supervisor supervisor(settings, first, second, third);
    static_cast<void>(f.update(supervisor, true));
    EXPECT_EQ(had, (std::vector<std::uint32_t>{4000, 3500, 1500}));
}

/// Keeps a clearance buffer by itself.
struct ClearFake : FakeMethod {
    static constexpr world::MethodTraits kTraits{
        .id = 14, .reactive = false, .keeps_clearance = true, .needs_sets = false};
};

TEST(MethodOrders, AMethodThatKeepsClearanceIsAskedOnceAndForTheVehicleAsItIs)
{
    Flight f;
    head_on(f);
    std::vector<float> widths;
    const auto note = [&](const Situation& s, WorkBudget&, Manoeuvre&) {
        widths.push_back(s.limits.half_extents.x());
        return PlanStatus::none_available;
    };
    FakeMethod plain{note};
    ClearFake clear{{note}};
    const Settings settings = quick();
    Supervisor supervisor(settings, plain, clear);
    static_cast<void>(f.update(supervisor, true));
    const float width = f.scene.limits.half_extents.x();
    EXPECT_EQ(widths, (std::vector<float>{width + f.scene.rules.clearance, width, width}));
}

TEST(MethodOrders, AMethodThatSpendsTheBudgetLeavesNothingToTrust)
{
    Flight f;
    head_on(f);
    FakeMethod method{[&](const Situation& s, WorkBudget& budget, Manoeuvre& out) {
        while (budget.spend(1000)) {
        }
        out = detour(s, kLeft, 6.0F, 60.0F);
        return PlanStatus::found;
    }};
    Settings settings = quick();
    settings.kept_for_check = 0;
    Supervisor supervisor(settings, method);
    const Guidance g = f.update(supervisor, true);
    EXPECT_NE(g.state, State::avoiding) << "what could not be checked is not flown";
    EXPECT_EQ(supervisor.diagnostics().budget_spent, 1U);
    EXPECT_GE(supervisor.diagnostics().most_work, quick().plan_budget);
    EXPECT_LT(supervisor.diagnostics().most_work, quick().work.all) << "checks and fallbacks must have theirs";
}

}  // namespace
}  // namespace jink::avoid
