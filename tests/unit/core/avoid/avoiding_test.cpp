// SPDX-License-Identifier: BSD-3-Clause
#include "core/avoid/supervisor.hpp"

#include <gtest/gtest.h>

#include "tests/unit/core/avoid/fakes.hpp"

namespace jink::avoid {
namespace {

using namespace test;
using world::ManoeuvreKind;

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

/// A method that alternates its answers is not called while the situation is unchanged.
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

/// A method that avoids to `side` by default.
FakeMethod to_the(const Vec3& side)
{
    return {[&side](const Situation& s, WorkBudget&, Manoeuvre& out) {
        out = detour(s, side, 6.0F, 60.0F);
        return PlanStatus::found;
    }};
}

TEST(Avoiding, TheOtherSideIsTakenWhenTimeIsUpAndCounted)
{
    Flight f;
    Vec3 side = kLeft;
    FakeMethod method = to_the(side);
    Supervisor supervisor(quick(), method);
    Guidance g = avoid_head_on(f, supervisor);
    f.pass(g.velocity, 0.1F);
    f.scene.track(Vec3(33, 5, 30), Vec3::Zero(), 4.0F);  // contact in 6 s, on the detour and on the parallel offset
    side = -kLeft;
    g = f.update(supervisor, true);
    EXPECT_EQ(supervisor.diagnostics().flips, 0U) << "there is time";
    EXPECT_LT(g.margin, 0.0F) << "and it is said what is flown";
    Seconds waited = 0.0F;
    while (supervisor.diagnostics().flips == 0U) {
        ASSERT_NE(supervisor.flying(), nullptr) << static_cast<int>(g.state) << " after " << waited;
        ASSERT_GT(supervisor.flying()->side.dot(kLeft), 0.0F);
        f.pass(g.velocity, 0.05F);
        waited += 0.05F;
        g = f.update(supervisor, true);
        ASSERT_LT(waited, 6.0F);
        WorkBudget budget(world::test::kPlenty);
        ASSERT_GE(world::separation_at(f.scene.situation(), f.scene.own.position, 0.0F, budget).margin, 0.0F);
    }
    EXPECT_GT(waited, 1.0F);
    EXPECT_EQ(g.state, State::avoiding);
    EXPECT_TRUE(g.new_manoeuvre);
    EXPECT_EQ(supervisor.flying()->side, -kLeft);
    EXPECT_EQ(supervisor.diagnostics().replans, 1U);
    EXPECT_EQ(supervisor.diagnostics().manoeuvres, 1U);
}

/// A manoeuvre's named side counts besides the flown side: a manoeuvre named "up" that led to the left is not replaced
/// by one named "down".
TEST(Avoiding, TheOppositeOfWhatWasChosenIsTheOtherSideToo)
{
    Flight f;
    Vec3 called = Vec3::UnitZ();
    FakeMethod method{[&](const Situation& s, WorkBudget&, Manoeuvre& out) {
        out = detour(s, kLeft, 6.0F, 60.0F);
        out.side = called;
        return PlanStatus::found;
    }};
    Supervisor supervisor(quick(), method);
    Guidance g = avoid_head_on(f, supervisor);
    for (int i = 0; i < 40; ++i) {
        f.pass(g.velocity, 0.05F);
        g = f.update(supervisor, true);
    }
    ASSERT_GT(supervisor.flying()->side.dot(kLeft), 0.9F) << "that is where it is";
    f.scene.track(Vec3(35, 5, 30), Vec3::Zero(), 4.0F);
    called = -Vec3::UnitZ();
    g = f.update(supervisor, true);
    EXPECT_LT(g.margin, 0.0F);
    EXPECT_FALSE(g.new_manoeuvre);
    called = Vec3::UnitZ();
    f.pass(g.velocity, 0.05F);
    const std::uint32_t asked = supervisor.diagnostics().plans;
    g = f.update(supervisor, true);
    EXPECT_GT(supervisor.diagnostics().plans, asked) << "it goes on looking";
}

TEST(Avoiding, ATrackThatWasSeenWrongOnceTurnsNothingOver)
{
    Flight f;
    Vec3 side = kLeft;
    FakeMethod method = to_the(side);
    Supervisor supervisor(quick(), method);
    Guidance g = avoid_head_on(f, supervisor);
    side = -kLeft;
    for (int i = 0; i < 20; ++i) {
        f.pass(g.velocity, 0.05F);
        const bool wrong = i == 10;
        if (wrong) {
            f.scene.track(Vec3(32, 6, 30), Vec3::Zero(), 2.0F);
        }
        g = f.update(supervisor, true);
        EXPECT_EQ(g.margin < 0.0F, wrong) << "step " << i;
        if (wrong) {
            f.scene.tracks.pop_back();
        }
    }
    EXPECT_EQ(supervisor.diagnostics().flips, 0U);
    EXPECT_EQ(supervisor.diagnostics().replans, 0U);
    EXPECT_EQ(g.state, State::avoiding);
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
    f.scene.track(Vec3(33, 5, 30), Vec3::Zero(), 4.0F);  // contact in 6 s, on the detour and on the parallel offset
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

/// The entry into the margin counts, not its minimum: for a large threat the minimum is late, behind the surface.
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

}  // namespace
}  // namespace jink::avoid
