// SPDX-License-Identifier: BSD-3-Clause
// State cleared by reset(): each item that would be visible in later updates.
#include <gtest/gtest.h>

#include "tests/unit/core/avoid/scripted.hpp"
#include "tests/unit/core/avoid/waiting.hpp"

namespace jink::avoid {
namespace {

using namespace test;

TEST(Reset, BeginsTheLeastTimeOfControlAnew)
{
    Waiting w;
    static_cast<void>(w.update());
    EXPECT_TRUE(w.wait(4.9F).wants_control);
    w.supervisor.reset();
    EXPECT_TRUE(w.after(0.1F).wants_control);
    EXPECT_TRUE(w.wait(4.9F).wants_control);
    EXPECT_FALSE(w.after(0.1F).wants_control);
}

TEST(Reset, BeginsTheSettlingTimeAnew)
{
    Settings settings = quick();
    settings.least_control = 0.0F;
    settings.settle = 1.0F;
    Waiting w(settings);
    w.f.scene.own.position.y() = 8.0F;
    EXPECT_TRUE(w.wait(5.0F).wants_control) << "off its leg";
    w.supervisor.reset();
    w.f.scene.own.position.y() = 0.0F;
    EXPECT_TRUE(w.after(0.1F).wants_control) << "a clear way is not trusted at once";
    EXPECT_TRUE(w.wait(0.9F).wants_control);
    EXPECT_FALSE(w.after(0.1F).wants_control);
}

TEST(Reset, EndsAParallelOffset)
{
    Waiting w;
    w.f.scene.own.position = Vec3(20, 8, 30);
    w.f.scene.track(Vec3(32, 0, 30), Vec3::Zero(), 1.0F);
    w.f.scene.track(Vec3(40, 10.6F, 30), Vec3::Zero(), 1.0F);
    static_cast<void>(w.update());
    ASSERT_EQ(w.supervisor.diagnostics().holds, 1U);
    w.f.scene.tracks[1].position.y() -= 0.4F;
    ASSERT_EQ(w.update().velocity, Vec3(5, 0, 0)) << "kept with 0.2 m to spare";
    w.supervisor.reset();
    EXPECT_NE(w.update().velocity, Vec3(5, 0, 0)) << "not begun with that";
    EXPECT_EQ(w.supervisor.diagnostics().holds, 1U);
}

TEST(Reset, EndsGivingUp)
{
    Settings settings = quick();
    settings.back_off_speed = 0.0F;
    AtAWall w(settings);
    static_cast<void>(w.update(false));
    ASSERT_TRUE(w.wait(20.0F, 0.5F).blocked);
    w.supervisor.reset();
    EXPECT_FALSE(w.after(0.1F, false).blocked);
}

TEST(Reset, ForgetsGivingBack)
{
    Waiting w;
    static_cast<void>(w.update());
    ASSERT_FALSE(w.wait(6.0F).wants_control);
    w.supervisor.reset();
    EXPECT_TRUE(w.after(0.1F).wants_control) << "in control, it is ours again";
}

TEST(Reset, ForgetsWhatWasCommanded)
{
    Waiting w;
    head_on(w.f, 45.0F);
    int commanded = 0;
    w.method = {[&](const Situation& s, WorkBudget&, Manoeuvre& out) {
        commanded += s.commanded != nullptr ? 1 : 0;
        EXPECT_EQ(s.flying, nullptr);
        out = velocity_of(s, Vec3(4, -3, 0), 6.0F);
        return PlanStatus::found;
    }};
    EXPECT_TRUE(w.update().wants_control);
    w.supervisor.reset();
    EXPECT_TRUE(w.update().wants_control);
    EXPECT_EQ(commanded, 0);
}

/// Losing control while it is wanted forgets all of it, too.
TEST(Reset, IsWhatLossOfControlDoes)
{
    Waiting w;
    w.stand(Vec3(0, 0, 30));
    w.f.scene.track(Vec3(5, 0.5F, 30), Vec3(-4, 0, 0), 1.0F);
    ASSERT_EQ(w.update().state, State::braking);
    const Guidance g = w.update(false);
    EXPECT_EQ(g.state, State::watching);
    EXPECT_EQ(w.supervisor.diagnostics().control_lost, 1U);
    EXPECT_EQ(w.supervisor.flying(), nullptr);
}

}  // namespace
}  // namespace jink::avoid
