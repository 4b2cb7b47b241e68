// SPDX-License-Identifier: BSD-3-Clause
// A plan that goes on over several updates.
#include <array>
#include <memory>
#include <vector>

#include <gtest/gtest.h>

#include "firmware/app/fiber_flow.hpp"
#include "tests/unit/core/avoid/fakes.hpp"

namespace jink::avoid {
namespace {

using namespace test;

/// A method whose answer takes so many units, in pieces of 100.
FakeMethod takes(std::uint32_t units, float height = 6.0F)
{
    return {[=](const Situation& s, WorkBudget& budget, Manoeuvre& out) {
        for (std::uint32_t spent = 0; spent < units; spent += 100) {
            if (!budget.spend(100)) {
                return PlanStatus::budget_spent;
            }
        }
        out = detour(s, kLeft, height, 60.0F);
        return PlanStatus::found;
    }};
}

Settings in_slices()
{
    Settings settings = quick();
    settings.work = {6000, 3000};
    return settings;
}

struct TurnedSlices {
    std::vector<std::uint32_t> coming;  ///< slices, the next one last
    WorkSlice slice{[](void* self) noexcept {
                        auto& waiting = *static_cast<TurnedSlices*>(self);
                        waiting.slice.begin(waiting.coming.back());
                        waiting.coming.pop_back();
                    },
                    this};
};

TEST(WorkSlices, APieceOfWorkIsPaidOutOfOneSlice)
{
    TurnedSlices waiting{{7, 10}};
    WorkBudget budget(100, waiting.slice);
    waiting.slice.begin(10);
    EXPECT_TRUE(budget.spend(10));
    EXPECT_EQ(waiting.coming.size(), 2U) << "what fits does not wait";
    EXPECT_TRUE(budget.spend(4));
    EXPECT_EQ(waiting.slice.left(), 6U);
    EXPECT_TRUE(budget.spend(7)) << "waits, and leaves the 6";
    EXPECT_TRUE(waiting.coming.empty());
    EXPECT_EQ(waiting.slice.left(), 0U);
    EXPECT_EQ(budget.spent(), 21U);
}

TEST(WorkSlices, APieceThatNoSliceHoldsTakesAWholeOne)
{
    TurnedSlices turned{{5}};
    WorkBudget budget(100, turned.slice);
    turned.slice.begin(3);
    EXPECT_TRUE(budget.spend(12));
    EXPECT_TRUE(turned.coming.empty());
    EXPECT_EQ(turned.slice.left(), 0U);
    EXPECT_EQ(turned.slice.largest(), 12U) << "and is told";
    EXPECT_EQ(budget.spent(), 12U);
}

TEST(WorkSlices, APartSpendsOfItsBudgetsSlice)
{
    TurnedSlices waiting{{20}};
    WorkBudget budget(30, waiting.slice);
    waiting.slice.begin(8);
    WorkBudget part = budget.part(9);
    EXPECT_TRUE(part.spend(9));
    EXPECT_FALSE(part.spend(1));
    budget.charge(part);
    EXPECT_EQ(budget.left(), 21U);
    EXPECT_EQ(budget.spent(), 9U);
    EXPECT_FALSE(budget.exhausted());
    EXPECT_EQ(waiting.slice.left(), 11U);
    EXPECT_FALSE(budget.spend(22)) << "more than there is: not paid, and no slice is waited for";
    EXPECT_EQ(waiting.slice.left(), 11U);
}

struct Sliced {
    explicit Sliced(FakeMethod& method, const Settings& settings = in_slices()) : supervisor(settings, method)
    {
        supervisor.plan_in_slices(*plan);
    }
    std::unique_ptr<std::array<std::byte, 512 * 1024>> stack = std::make_unique<std::array<std::byte, 512 * 1024>>();
    app::FiberFlow fiber{*stack};
    std::unique_ptr<SlicedPlan> plan = std::make_unique<SlicedPlan>(fiber);
    Supervisor<FakeMethod> supervisor;
};

TEST(Slices, APlanGoesOnOverUpdatesAndIsFlownWhereItEnds)
{
    Flight f;
    head_on(f);
    FakeMethod method = takes(5000);
    Sliced sliced(method);
    std::vector<PlanStatus> statuses;
    Guidance g;
    do {
        g = f.update(sliced.supervisor, true);
        statuses.push_back(g.plan_status);
        EXPECT_LE(g.work, 6000U);
        EXPECT_EQ(method.asked, 1);
    } while (statuses.size() < 20 && g.plan_status == PlanStatus::running);
    // 3000 of the slice, and what the mandatory part leaves of its 3000 beside 1100 for a fallback.
    EXPECT_EQ(statuses.size(), 2U);
    EXPECT_EQ(g.plan_status, PlanStatus::found);
    EXPECT_EQ(g.state, State::avoiding);
    EXPECT_EQ(sliced.supervisor.diagnostics().plans_found, 1U);
}

TEST(Slices, APlanOfOneSliceIsThatOfOneUpdate)
{
    Flight f;
    head_on(f);
    FakeMethod method = takes(400);
    Sliced sliced(method);
    const Guidance g = f.update(sliced.supervisor, true);
    Supervisor whole(in_slices(), method);
    const Guidance same = f.update(whole, true);
    EXPECT_EQ(g.plan_status, PlanStatus::found);
    EXPECT_EQ(g.velocity, same.velocity);
    EXPECT_EQ(g.margin, same.margin);
    EXPECT_EQ(g.work, same.work);
}

TEST(Slices, AnAnswerIsCheckedAgainstWhatIsKnownWhereItEnds)
{
    Flight f;
    head_on(f);
    FakeMethod method = takes(5000);
    Sliced sliced(method);
    ASSERT_EQ(f.update(sliced.supervisor, true).plan_status, PlanStatus::running);
    f.scene.track(Vec3(12, 6, 30), Vec3::Zero(), 3.0F);  // on the way around
    Guidance g = f.update(sliced.supervisor, true);
    for (int i = 0; i < 5 && g.plan_status == PlanStatus::running; ++i) {
        g = f.update(sliced.supervisor, true);
    }
    EXPECT_EQ(g.plan_status, PlanStatus::none_available);
    EXPECT_NE(g.state, State::avoiding);
    EXPECT_EQ(sliced.supervisor.diagnostics().answers_rejected, 1U);
}

TEST(Slices, APlanThatNobodyWantsAnyMoreIsDropped)
{
    Flight f;
    head_on(f);
    FakeMethod method = takes(5000);
    Sliced sliced(method);
    ASSERT_EQ(f.update(sliced.supervisor, false).plan_status, PlanStatus::running);
    f.scene.tracks.clear();
    EXPECT_EQ(f.update(sliced.supervisor, false).plan_status, PlanStatus::no_conflict);
    EXPECT_FALSE(sliced.plan->runs());
    head_on(f);
    ASSERT_EQ(f.update(sliced.supervisor, false).plan_status, PlanStatus::running);
    EXPECT_EQ(method.asked, 2) << "anew, on what is known now";
}

TEST(Slices, WhatChangesThePlannersDropsThePlan)
{
    Flight f;
    head_on(f);
    FakeMethod method = takes(5000);
    Sliced sliced(method);
    const auto begin = [&] {
        ASSERT_EQ(f.update(sliced.supervisor, false).plan_status, PlanStatus::running);
        ASSERT_TRUE(sliced.plan->runs());
    };
    begin();
    sliced.supervisor.reset();
    EXPECT_FALSE(sliced.plan->runs());
    begin();
    ASSERT_TRUE(sliced.supervisor.configure(in_slices()));
    EXPECT_FALSE(sliced.plan->runs());
    begin();
    sliced.supervisor.drop_plan();
    EXPECT_FALSE(sliced.plan->runs());
    begin();
    sliced.supervisor.plan_in_whole();
    EXPECT_FALSE(sliced.plan->runs());
    const Guidance g = f.update(sliced.supervisor, false);
    EXPECT_EQ(g.plan_status, PlanStatus::budget_spent) << "5000 units are not to be had at once";
}

TEST(Slices, AFallbackDoesNotWaitForAPlan)
{
    Flight f;
    head_on(f, 12.0F);  // too near to wait
    FakeMethod method = takes(5000);
    Sliced sliced(method);
    const Guidance g = f.update(sliced.supervisor, true);
    EXPECT_EQ(g.plan_status, PlanStatus::running);
    EXPECT_EQ(g.state, State::braking);
    EXPECT_TRUE(sliced.plan->runs());
    EXPECT_LE(g.work, 6000U);
}

TEST(Slices, OfAFullWorldNoUpdateDoesMoreThanItMay)
{
    Flight f;
    for (int i = 0; i < 30; ++i) {
        f.scene.track(Vec3(9, 0.2F * static_cast<float>(i % 5), 30), Vec3(-3, 0, 0), 1.0F);
    }
    FakeMethod method = takes(50'000);
    Settings settings = in_slices();
    settings.plan_budget = 60'000;
    Sliced sliced(method, settings);
    for (int i = 0; i < 30; ++i) {
        EXPECT_LE(f.update(sliced.supervisor, true).work, 6000U);
    }
    EXPECT_LE(sliced.supervisor.diagnostics().most_work, 6000U);
}

}  // namespace
}  // namespace jink::avoid
